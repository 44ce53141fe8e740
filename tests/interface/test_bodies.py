"""Bodies that declare themselves: the coated layer against its formula and limits, and bodies of
one's own."""

import math

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes import Body, Branch, Form, InputError, Load, Scene, Steps, option  # noqa: E402
from contactsnes.commands.session import Settings  # noqa: E402
from contactsnes.commands.summary import skipped  # noqa: E402
from contactsnes.grid.cell import Grid  # noqa: E402
from contactsnes.interface import bodies  # noqa: E402
from contactsnes.interface.bodies.coated import Coated  # noqa: E402
from contactsnes.interface.bodies.layer import Layer  # noqa: E402
from contactsnes.interface.elasticity import Surface  # noqa: E402
from contactsnes.interface.unbounded import free_space  # noqa: E402
from contactsnes.scene import settings  # noqa: E402
from contactsnes.scene.resolution import resolution  # noqa: E402

LINE = {"points": 128, "period": 20.0, "normal_maugis": 1.0}
PRESSED = Load(path="normal_displacement=2")
WAVES = {1: Grid((16,), (5.0,)).wavevectors(), 2: Grid((8, 6), (5.0, 4.0)).wavevectors()}


def last(scene, load=PRESSED, **parts):
    """The last point of a scene."""
    return list(Branch(scene, load, **parts))[-1]


def matrices(blocks, components):
    """Matrices (components, components, waves), zero where a block is missing."""
    some = next(iter(blocks.values()))
    found = np.zeros((components, components, some.size), dtype=complex)
    for (i, j), block in blocks.items():
        found[i, j] = np.broadcast_to(block, some.shape).reshape(-1)
    return found.transpose(2, 0, 1)


@pytest.mark.parametrize("dimension", (1, 2))
@pytest.mark.parametrize("poisson", (0.2, 0.5))
def test_a_coating_is_a_spring_at_each_place(dimension, poisson):
    """Its compliance is the layer's and a constant, its stiffness the inverse of that."""
    layer, coated = Layer(poisson, 3.0), Coated(poisson, 3.0, 0.7, 0.4)
    components = dimension + 1
    added = (matrices(coated.compliance(WAVES[dimension], components), components)
             - matrices(layer.compliance(WAVES[dimension], components), components))
    spring = np.diag([0.7] + [0.4] * dimension)
    np.testing.assert_allclose(added[1:], np.broadcast_to(spring, added[1:].shape), atol=1e-14)
    product = (matrices(coated.stiffness(WAVES[dimension], components), components)
               @ matrices(coated.compliance(WAVES[dimension], components), components))
    np.testing.assert_allclose(product[1:], np.broadcast_to(np.eye(components), product[1:].shape),
                               atol=1e-12)
    assert coated.rigid_compliance == pytest.approx(np.add(layer.rigid_compliance, (0.7, 0.4)))


class Coarse(Body):
    """Compliances in single precision, and all of them one array that is not to be written."""

    rigid_compliance = (0.0, 0.0)

    def surface(self, wavenumber):
        each = np.broadcast_to(np.float32(0.5), np.shape(wavenumber))
        return Surface(each, each, each, np.zeros_like(each))


class Even(Coarse):
    """The same in double precision."""

    def surface(self, wavenumber):
        return Surface(*[np.array(each, float) for each in super().surface(wavenumber)])


@pytest.mark.parametrize("components", (1, 2))
def test_compliances_may_be_single_and_shared(components):
    for blocks in (Coarse().compliance(WAVES[1], components),
                   Coarse().stiffness(WAVES[1], components),
                   Coarse().diagonal(WAVES[1], components)):
        assert {block.dtype for block in blocks.values()} == {np.dtype(float)}
        assert blocks[0, 0][0] == 0 and len(set(blocks[0, 0][1:])) == 1
    assert last(Scene(**LINE), body=Coarse()).forces[0] == pytest.approx(
        last(Scene(**LINE), body=Even()).forces[0], rel=1e-12)


@pytest.mark.parametrize("dimension", (1, 2))
@pytest.mark.parametrize("poisson", (0.2, 0.5))
def test_the_diagonal_is_that_of_all_blocks(dimension, poisson):
    """Of the normal component it is the same whatever others there are."""
    body, waves = Coated(poisson, 3.0, 0.7, 0.4), WAVES[dimension]
    blocks, found = body.compliance(waves, dimension + 1), body.diagonal(waves, dimension + 1)
    assert set(found) == {(i, i) for i in range(dimension + 1)}
    for key, block in found.items():
        np.testing.assert_array_equal(block, blocks[key])
    np.testing.assert_array_equal(body.diagonal(waves, 1)[0, 0], blocks[0, 0])


def test_no_coating_is_the_layer():
    point, same = last(Scene(**LINE)), last(Scene(**LINE, body="coated"))
    np.testing.assert_array_equal(point.state.displacement, same.state.displacement)
    load = Load(path="normal_force=1; tangential_displacement=1")
    point, same = (last(Scene(**LINE, poisson=0.3, body=body), load) for body in ("layer",
                                                                                  "coated"))
    np.testing.assert_array_equal(point.state.displacement, same.state.displacement)


def test_a_coated_flat_moves_by_its_springs():
    """Everything is uniform: the approach of the top is that of the surface and W/L (1/k_0 + c)."""
    scene = Scene(**LINE, geometry="flat", height=10.0, poisson=0.3, body="coated",
                  coating_normal=0.5, coating_tangential=0.25)
    branch = Branch(scene, Load(start="normal_displacement=-10",
                                path="normal_displacement=1; tangential_displacement=0.3"))
    *_, point = branch
    stiffness = 0.7 ** 2 / (0.4 * 10.0), 0.7 / 20.0
    gap = branch.contact.initial_gap[:, None].T + point.state.displacement
    tractions = branch.contact.law.traction(gap)[:, 0] * scene.ranges
    approach = -tractions[0] * (1 / stiffness[0] + 0.5) - gap[0, 0] / scene.normal_maugis
    assert point.displacements[0] == pytest.approx(approach, rel=1e-7)
    moved = tractions[1] * (1 / stiffness[1] + 0.25) + gap[1, 0] / scene.tangential_maugis
    assert point.displacements[1] == pytest.approx(moved, rel=1e-7)


def test_a_very_soft_coating_under_a_stiff_body_is_a_bed_of_springs():
    """Places do not feel each other: each is in balance with its own spring."""
    scene = Scene(points=256, period=20.0, normal_maugis=0.5, height=0.01, poisson=0.0,
                  tangential="off", body="coated", coating_normal=2.0)
    branch = Branch(scene, PRESSED)
    *_, point = branch
    gap = branch.contact.initial_gap[None] + branch.contact.extended(point.state)
    traction = branch.contact.law.traction(gap)[0] * 0.5
    spring = 2.0 + 0.01  # the layer's own, height over its modulus, E* for Poisson ratio 0
    raised = branch.contact.initial_gap / 0.5 - 2.0 - spring * traction
    np.testing.assert_allclose(gap[0] / 0.5, raised, atol=2e-3)


def test_a_coating_that_snaps_by_itself_is_refused():
    assert Scene(normal_maugis=2.0, body="coated", coating_normal=1.0)
    with pytest.raises(InputError, match="-scene_coating_normal is '2': .* allowed is less than "
                       "1.847"):
        Scene(normal_maugis=2.0, body="coated", coating_normal=2.0)
    soft = Scene(normal_maugis=1.0, tangential_maugis=3.0, residual_friction=0.0, body="coated",
                 coating_tangential=2.0)
    settings.check(soft, PRESSED)
    with pytest.raises(InputError, match="-scene_coating_tangential is '2'"):
        settings.check(soft, Load(path="tangential_displacement=1"))
    assert resolution(Scene(normal_maugis=2.0, body="coated", coating_normal=1.0), False)[0] \
        == pytest.approx(resolution(Scene(normal_maugis=2.0), False)[0]
                         / (1 - 4 * math.exp(-2)), rel=1e-12)


def test_a_coating_on_a_plane_is_resolved_where_it_does_not_snap():
    """The layer is softer for waves across the slip, the coating is not."""
    plane = {**LINE, "dimension": 2, "geometry": "sphere", "points": 32, "poisson": 0.3}
    free, coated = (resolution(Scene(**plane, body="coated", coating_normal=normal,
                                     coating_tangential=normal), True) for normal in (0.0, 3.0))
    assert free[0] < coated[0] < math.inf
    assert free == resolution(Scene(**plane), True)


def test_what_is_told_of_a_body():
    names = ["scene_coating_normal"]
    assert settings.ineffective(Scene(), PRESSED, names) == [(names[0], "the body layer has none")]
    assert not settings.ineffective(Scene(body="coated"), PRESSED, names)
    told = settings.attributes(Scene(body="coated", coating_normal=0.01))
    assert (told["body"], told["coating_normal"], told["poisson"]) == ("coated", 0.01, 0.5)
    assert not {"body", "coating_normal"} & set(settings.attributes(Scene()))


def test_an_isolated_coated_contact():
    """On an unbounded flat a coating is a spring at each place, too: as in a long cell."""
    grid = Grid((64,), (16.0,))
    plain, coated = (free_space(body, grid, 1)[0, 0] for body in (Layer(0.5, 50.0),
                                                                  Coated(0.5, 50.0, 0.7, 0.0)))
    np.testing.assert_allclose(coated - plain, 0.7, rtol=1e-12)
    values = dict(normal_maugis=1.0, height=5.0, body="coated", coating_normal=0.7)
    lone = last(Scene(period=math.inf, spacing=0.1, **values), Load(path="normal_force=3"))
    cell = last(Scene(period=80.0, points=800, **values), Load(path="normal_force=3"))
    assert lone.state.displacement[0].min() < 0
    assert lone.in_contact == cell.in_contact


class Graded(Body):
    """A half-space that stiffens with depth: 2/(q + q0), with no coupling."""

    graded_rate = option(0.0, "q0 of the body Graded", "1/beta", minimum=0)
    rigid_compliance = (0.0, 0.0)

    def surface(self, wavenumber):
        """`Surface` compliance."""
        compliance = 2 / (np.asarray(wavenumber, dtype=float) + self.graded_rate)
        return Surface(compliance, compliance, compliance, 0 * compliance)


def test_what_is_left_out_of_a_body_of_ones_own_is_not_told_of_a_layer():
    load = Load(path="normal_displacement=1; tangential_displacement=1")
    for body, has_none in ((Graded(), "the body"), (Layer(), "an incompressible layer")):
        made = Branch(Scene(**LINE), load, body=body)
        told, = (line for line in skipped(Settings(made.scene, Form(), load, Steps(), None), made)
                 if "elastic coupling" in line)
        assert f"displacements: {has_none}" in told


def test_a_body_of_ones_own():
    """Without grading it is the half-space without Poisson's ratio; graded it is stiffer."""
    own = last(Scene(**LINE), body=Graded())
    assert own.forces[0] == pytest.approx(last(Scene(**LINE, height=math.inf)).forces[0], rel=1e-9)
    assert last(Scene(**LINE), body=Graded(1.0)).forces[0] > own.forces[0]
    branch = Branch(Scene(**LINE), PRESSED, body=Graded(3.0))
    assert branch.attributes()["body"] == "Graded(graded_rate=3.0)"
    assert "poisson" not in branch.attributes()
    with pytest.raises(InputError, match="-scene_body is .*far_field"):
        Branch(Scene(period=math.inf, spacing=0.2), Load(path="normal_force=1"), body=Graded())


@pytest.mark.parametrize("changes, words", (
    ({"surface": lambda self, q: Surface(q - 1, q, q, 0 * q)}, "its normal compliance is -0.68"),
    ({"surface": lambda self, q: Surface(1 / q, 1 / q, 1 / q, 2 / q)}, "the determinant .* is -30"),
    ({"surface": lambda self, q: Surface(1 / q, 1 / q, q / 0, 0 * q)}, "transverse .* is inf"),
    ({"surface_stiffness": lambda self, q: Surface(q, q, q, 0 * q)},
     "its normal stiffness times its compliance is 2 at the wave number 0.314159 1/beta: .* be 1"),
    ({"surface_stiffness": lambda self, q: Body.surface_stiffness(self, q)._replace(transverse=q)},
     "its transverse stiffness times its compliance is"),
    ({"surface_stiffness": lambda self, q: Surface(*[np.float32(0.5) * np.float32(q)] * 3, 0 * q)},
     r"normal stiffness times its compliance is (1\.0+|0\.9+)[1-9]\d* at .* be 1 to 1e-08, as in"),
    ({"rigid_compliance": (-1.0, 0.0)}, "rigid_compliance is"),
    ({"rigid_compliance": 0.0}, "cannot be evaluated .TypeError"),
    ({"local_compliance": (-1.0, 0.0)}, "local_compliance is .-1.0, 0.0.: both have to be from 0"),
    ({"surface": lambda self, q: q.no_such}, "cannot be evaluated .AttributeError"),
    ({"surface": lambda self, q: (2 / q, 2 / q, 2 / q, 0 * q)},
     r"its surface returns a tuple in place of a Surface\(normal, longitudinal, transverse, coupl"),
    ({"surface_stiffness": lambda self, q: None}, "its surface_stiffness returns a NoneType"),
    # at one of the grid's own waves
    ({"surface": lambda self, q: Surface(np.where(abs(q - 0.942478) < 1e-6, -1, 2 / q), 2 / q,
                                         2 / q, 0 * q)},
     "normal compliance is -1 at the wave number 0.94"),
    ({"surface": lambda self, q: Surface(2.0, 2 / q, 2 / q, 0 * q)},
     "normal compliance has the shape .., .* give one value for each"),
    ({"local_compliance": 0.0}, "local_compliance is 0.0: both"),
    ({"surface": lambda self, q: Surface(2 / q, 2 / q, 2 / q, 0.1j / q)},
     "its coupling compliance is complex"),
    ({"compliance": lambda self, waves, components: {}}, "a compliance of its own"),
    ({"stiffness": lambda self, waves, components: {}}, "a stiffness of its own"),
    ({"transverse_stiffness": -1.0}, "transverse_stiffness is -1: .* positive"),
    ({"transverse_stiffness": 0.5}, "transverse_stiffness is 0.5, that of its shortest waves 1 of"),
))
def test_what_is_wrong_with_a_body_is_told(changes, words):
    with pytest.raises(InputError, match=f"-scene_body is 'Other.*: .*{words}"):
        Branch(Scene(**LINE), PRESSED, body=type("Other", (Graded,), changes)())


@pytest.mark.parametrize("surface, dimension, words", (
    (lambda self, q: Surface(2 / q + 1 / q.max(), 2 / q, 2 / q, 0 * q), 1,
     "normal compliance, of fewer wave numbers in another order, is .* on its own wave number"),
    (lambda self, q: Surface(*[2 / np.ravel(q)] * 3, 0), 2,
     r"normal compliance has the shape \(\d+,\), the wave numbers have \(2, \d+\)")))
def test_compliances_are_those_of_each_wave_number_of_any_array(surface, dimension, words):
    """Planes have wave numbers in two dimensions, finer grids higher ones."""
    scene = Scene(**LINE, dimension=dimension, geometry=("cylinder", "sphere")[dimension - 1])
    with pytest.raises(InputError, match=f"-scene_body is 'Other.*: its {words}"):
        Branch(scene, PRESSED, body=type("Other", (Graded,), {"surface": surface})())


@pytest.mark.parametrize("name, claim, dimension", (
    ("couples", lambda self, smallest: False, 1),
    ("coupled", lambda self, scene: False, 1),
    ("anisotropy", lambda self, smallest: 0.0, 2),
))
def test_what_a_body_claims_to_lack_is_looked_for(name, claim, dimension):
    class Tilting(Graded):
        def surface(self, wavenumber):
            found = super().surface(wavenumber)
            return found._replace(coupling=0.1 * found.normal, transverse=2 * found.transverse)

    scene = Scene(**{**LINE, "dimension": dimension, "points": 32,
                     "geometry": ("cylinder", "sphere")[dimension - 1]})
    assert Branch(scene, PRESSED, body=Tilting()).contact.couples()
    with pytest.raises(InputError, match=rf"that it has none by its {name}: .* 0, or {name} = Bo"):
        Branch(scene, PRESSED, body=type("Other", (Tilting,), {name: claim})())


class Stiffer(Layer):
    """A layer that is stiffer than it is, and says nothing else of itself."""

    surface_stiffness = Body.surface_stiffness

    def surface(self, wavenumber):
        """`Surface` compliance."""
        found = super().surface(wavenumber)
        return found._replace(normal=0.8 * found.normal)


@pytest.mark.parametrize("field, words", (
    (Stiffer.far_field, "says by its far_field.. .*: its normal compliance is"),
    (lambda self: 3, "its far_field.. is 3: it has to be a Layer, or None"),
    (Body.far_field, "its kernel on an unbounded flat is not known"),
))
def test_an_isolated_body_is_the_layer_that_it_names(field, words):
    scene, load = Scene(period=math.inf, spacing=0.2), Load(path="normal_force=1")
    with pytest.raises(InputError, match=words):
        Branch(scene, load, body=type("Other", (Stiffer,), {"far_field": field})(0.3, math.inf))


@pytest.mark.parametrize("poisson", (0.5, 0.3))
def test_an_isolated_body_of_ones_own_couples_as_its_layer(poisson):
    class Own(Body):
        rigid_compliance = (0.0, 0.0)

        def surface(self, wavenumber):
            return self.far_field().surface(wavenumber)

        def far_field(self):
            return Layer(poisson, math.inf)

    scene = Scene(period=math.inf, spacing=0.25, normal_maugis=1.0, poisson=poisson,
                  height=math.inf)
    own, layer = (last(scene, Load(path="normal_force=1"), **body)
                  for body in ({"body": Own()}, {}))
    np.testing.assert_allclose(own.state.displacement, layer.state.displacement, atol=1e-9)


def test_bodies_couple_as_they_are_seen_to():
    class Tilting(Graded):
        def surface(self, wavenumber):
            found = super().surface(wavenumber)
            return found._replace(coupling=0.1 * found.normal, transverse=2 * found.transverse)

    body = Tilting().with_work_ratio(4.0)
    assert body.couples(0.1) and not Graded().couples(0.1) and body.anisotropy(0.1) == 0.5
    compliance = matrices(body.compliance(WAVES[2], 3), 3)[1:]
    stiffness = matrices(body.stiffness(WAVES[2], 3), 3)[1:]
    np.testing.assert_allclose(stiffness @ compliance, np.broadcast_to(np.eye(3), compliance.shape),
                               atol=1e-12)


@pytest.mark.parametrize("name", ("surface", "surface_stiffness"))
def test_bodies_that_write_into_wave_numbers_are_refused(name):
    """What is looked at were other waves than those of the grid, all of them alike."""
    def written(self, wavenumber):
        return getattr(Layer, name)(self, np.maximum(wavenumber, 2.0, out=wavenumber))

    with pytest.raises(InputError, match=f"its {name} writes into the wave numbers"):
        Branch(Scene(points=64, period=20.0, normal_maugis=1.0),
               Load(path="normal_displacement=1"), body=type("Own", (Layer,), {name: written})())


def test_a_body_in_a_file(tmp_path, monkeypatch):
    monkeypatch.setattr(bodies.REGISTRY, "own", {})
    (tmp_path / "mine.py").write_text(
        "from contactsnes import Body\nfrom contactsnes.interface.bodies.layer import Layer\n\n\n"
        "class Stiff(Layer):\n    surface_stiffness = Body.surface_stiffness\n\n"
        "    def surface(self, wavenumber):\n        found = super().surface(wavenumber)\n"
        "        return found._replace(normal=found.normal / 2)\n", encoding="utf-8")
    name = f"{tmp_path / 'mine.py'}:Stiff"
    scene = Scene(**LINE, body=name)
    assert last(scene).forces[0] > last(Scene(**LINE)).forces[0]
    assert len(Branch(scene, PRESSED).attributes()["body_sha256"]) == 64
    with pytest.raises(InputError, match="has no body 'Soft': its bodies are Stiff"):
        Scene(body=f"{tmp_path / 'mine.py'}:Soft")
