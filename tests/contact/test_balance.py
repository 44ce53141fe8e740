"""Residuals of stored states against those that NumPy alone finds, by kernels and laws of its own:
symmetry is tested, not believed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from processes import call

from contactsnes import Branch, Contact, Form, Load, NotConverged, Scene, Steps
from contactsnes.branch.remarks import DILUTED
from contactsnes.branch.tracing import Tracer
from contactsnes.contact.balance import Balance, Response
from contactsnes.contact.even_form import EvenForm
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.states import State
from contactsnes.contact.symmetry import Symmetry
from contactsnes.grid.boxes import Spots, convolution
from contactsnes.grid.cosines import EvenConvolution
from contactsnes.grid.even import EvenWindow
from contactsnes.grid.mirrors import lone
from contactsnes.grid.parity import UNEVEN, parities
from contactsnes.grid.windows import Window
from contactsnes.options.fields import InputError
from contactsnes.scene.settings import tangential_legs
from contactsnes.solvers.capabilities import NEWTON

OFF = Form(symmetry="off")


# What NumPy alone knows of the problem


def tractions(gap, friction, adhesion):
    """The modified law, node by node: (components, nodes) of gaps and of tractions, ranges of the
    law."""
    a, found = gap[0], np.empty_like(gap)
    b = np.sqrt((gap[1:] ** 2).sum(axis=0))
    open_part = np.exp(-np.maximum(a, 0.0))
    fading = adhesion + (1.0 - adhesion) * np.exp(-b * b) if len(gap) > 1 else 1.0
    found[0] = np.where(a > 0.0, a * open_part * fading, a * np.exp(-a))
    peak = math.sqrt(2.0 / math.e)
    before = 2.0 * b * np.exp(-b * b)
    after = peak * (friction + (1.0 - friction) * np.exp(-(b - math.sqrt(0.5)) ** 2))
    shear = np.where(b <= math.sqrt(0.5), before, after) * open_part
    found[1:] = shear * gap[1:] / np.where(b > 0.0, b, 1.0)
    return found


def compliances(q, poisson, height):
    """C_nn, C_LL, C_TT and c of u_L = i c f_n on a layer held at its top or a half-space, for wave
    numbers q > 0.

    The half-space's are Boussinesq's and Cerruti's; those of a layer are known in short for an
    incompressible one.
    """
    far = 2.0 / q
    dundurs = (1.0 - 2.0 * poisson) / (2.0 * (1.0 - poisson))
    half = np.array([far, far, 2.0 * far / (2.0 * (1.0 - poisson)), dundurs * far])
    if math.isinf(height):
        return half
    assert poisson == 0.5
    k = np.minimum(q * height, 300.0)
    bottom = np.cosh(k) ** 2 + k * k
    return np.array([far * (np.sinh(k) * np.cosh(k) - k) / bottom,
                     far * (np.sinh(k) * np.cosh(k) + k) / bottom, 2.0 * far * np.tanh(k),
                     -far * k * k / bottom])


def deformed(scene, forces):
    """Mean-free displacements (components, *cell) that forces on the body (the same shape) deform a
    periodic one by."""
    axes = [2.0 * np.pi * np.fft.fftfreq(n, length / n)
            for n, length in zip(scene.shape, scene.periods)]
    vectors = np.meshgrid(*axes, indexing="ij")
    q = np.sqrt(sum(vector ** 2 for vector in vectors))
    q.flat[0] = 1.0
    normal, along, across, coupling = compliances(q, scene.poisson, scene.height)
    waves = np.fft.fftn(forces, axes=range(1, forces.ndim))
    found = np.zeros_like(waves)
    unit = [vector / q for vector in vectors]
    found[0] = normal * waves[0]
    for i, e in enumerate(unit[:len(forces) - 1], start=1):
        # An odd function of the shortest wave in a direction is 0 on the nodes.
        odd = np.where(np.abs(vectors[i - 1]) == np.abs(axes[i - 1]).max(), 0.0, e)
        found[0] += -1j * coupling * odd * waves[i] * math.sqrt(scene.work_ratio)
        found[i] += 1j * coupling * odd * waves[0] / math.sqrt(scene.work_ratio) + across * waves[i]
        for j, other in enumerate(unit, start=1):
            twist = (e * other if i == j
                     else odd * np.where(np.abs(vectors[j - 1]) == np.abs(axes[j - 1]).max(), 0.0,
                                         other))
            found[i] += (along - across) * twist * waves[j]
    found[(slice(None), *[0] * len(axes))] = 0.0
    return np.fft.ifftn(found, axes=range(1, forces.ndim)).real


def on_nodes(contact, state, gap):
    """Displacements and tractions of a state (components, *cell), and the mask of its window, by
    positions alone."""
    scene, components = contact.scene, len(state.displacement)
    inside = np.zeros(scene.shape, dtype=bool)
    field, traction = np.zeros((2, components, *scene.shape))
    first = 0
    for part in state.window.parts:
        places = np.ix_(*[(s + np.arange(n)) % total for s, n, total in zip(part.start, part.shape,
                                                                            scene.shape)])
        count = math.prod(part.shape)
        for i in range(components):
            field[i][places] = state.displacement[i, first:first + count].reshape(part.shape)
        inside[places] = True
        first += count
    ranges = np.array([scene.normal_maugis, *[scene.tangential_maugis] * (components - 1)]).reshape(
        -1, *[1] * len(scene.shape))
    gaps = field.copy()
    gaps[0] += scene.normal_maugis * gap
    law = tractions(gaps.reshape(components, -1), scene.residual_friction,
                    scene.residual_adhesion).reshape(gaps.shape)
    traction[:, inside] = law[:, inside]
    return field, gaps, traction, inside, ranges


def imbalance(contact, point, gap, deform=deformed):
    """(residual_norm, largest imbalance where the law acts) of a point in a periodic cell, for a
    gap g_0 in u_n,r."""
    scene, components = contact.scene, len(point.state.displacement)
    field, gaps, traction, inside, ranges = on_nodes(contact, point.state, gap)
    response = -ranges * deform(scene, ranges * traction)
    cell = math.prod(scene.shape)
    node_area = math.prod(scene.periods) / cell
    rigid = ((1.0 - 2.0 * scene.poisson) * scene.height / (1.0 - scene.poisson) ** 2
             if scene.poisson < 0.5 else 0.0, *[2.0 * scene.height / (1.0 - scene.poisson)]
             * (components - 1)) if math.isfinite(scene.height) else (0.0,) * components
    signs = [-1.0, *[1.0] * (components - 1)]
    rows = []
    means = []
    for i, control in enumerate(point.controls):
        size, total = ranges.reshape(-1)[i], traction[i].sum()
        if control == "force":
            means.append(point.state.means[i])
            rows.append((signs[i] * size * node_area * total - point.load[i])
                        / max(1.0, abs(point.load[i])))
        else:
            means.append(signs[i] * size * point.load[i] - size ** 2 * rigid[i] * total / cell)
    residual = field - response - np.reshape(means, (-1, *[1] * len(scene.shape)))
    acting = inside & (gaps[0] < 37.0)
    return (math.sqrt(np.mean(residual[:, inside] ** 2) + sum(row ** 2 for row in rows)),
            float(np.max(np.abs(residual[:, acting]), initial=0.0)))


def balanced(contact, point, gap, deform=deformed):
    """Assert that a point's residuals are those that NumPy finds, and below the tolerance."""
    norm, largest = imbalance(contact, point, gap, deform)
    assert point.residual_norm <= 1e-8
    assert point.residual_norm == pytest.approx(norm, rel=1e-3, abs=2e-11)
    assert point.largest_residual == pytest.approx(largest, rel=1e-3, abs=1e-9)


# Surfaces


def waves(shape, periods, seed, even, slope=0.6):
    """A few random waves on a parabola, heights on the grid: about its apex even in every
    direction, or not."""
    random, h = np.random.default_rng(seed), 0.0
    x = np.meshgrid(*[(np.arange(n) - n // 2) * length / n for n, length in zip(shape, periods)],
                    indexing="ij")
    for _ in range(5):
        wave = 1.0
        for places, length in zip(x, periods):
            number = random.integers(1, 7)
            angle = (
                2.0 * np.pi * number * np.minimum(places + length / 2, length / 2 - places) / length
                if even
                else 2.0 * np.pi * (number * places / length + random.uniform())
            )
            wave = wave * np.cos(angle)
        h = h + random.normal() * slope * wave
    return h - sum(places ** 2 for places in x) / 2


def branch_of(contact, load, form=Form(), steps=Steps(), log=lambda sentence: None):
    """The branch of a contact that was made by hand."""
    scene = replace(contact.scene, geometry="flat", geometry_file="")
    branch = Branch(scene, load, steps, form, log=log)
    vars(branch).update(contact=contact, corrector=Tracer(contact, form, log))
    return branch


LINE = Scene(points=128, period=20.0, normal_maugis=1.5, tangential_maugis=1.0, height=math.inf,
             residual_friction=0.5)
PLANE = Scene(dimension=2, points=(32, 24), period=(10.0, 9.0), normal_maugis=1.0,
              geometry="sphere", height=math.inf)
CASES = {"line": (LINE, Load(start="normal_displacement=0.5", path="normal_displacement=1")),
         "force": (replace(LINE, height=30.0), Load(start="normal_force=2", path="normal_force=4")),
         "sheared": (LINE, Load(start="normal_displacement=1", path="tangential_displacement=1")),
         "coupled": (replace(LINE, poisson=0.3, work_ratio=1.4),
                     Load(start="normal_displacement=1", path="normal_displacement=1.5")),
         "thin": (replace(LINE, height=3.0), Load(start="normal_force=1", path="normal_force=2")),
         "plane": (PLANE, Load(start="normal_displacement=0", path="normal_displacement=0.5")),
         "slid": (replace(PLANE, poisson=0.2, tangential_maugis=0.7),
                  Load(start="normal_displacement=0.5",
                       path="tangential_displacement_x=0.5, tangential_displacement_y=-0.2"))}


@pytest.mark.parametrize("even", [False, True])
@pytest.mark.parametrize("name", CASES)
def test_symmetry_is_what_heights_have(name, even):
    """Heights in place of a geometry: the default does what no symmetry does, and takes half where
    they are even."""
    scene, load = CASES[name]
    heights = waves(scene.shape, scene.periods, seed=len(name), even=even)
    forces = []
    for form in (Form(), OFF):
        contact = Contact(scene, heights)
        branch = branch_of(contact, load, form, Steps(initial_step=0.5, largest_step=0.5))
        for point in branch:
            balanced(contact, point, heights.max() - heights)
        assert isinstance(branch.corrector.form, EvenForm) == (even and form != OFF
                                                               and name != "slid")
        assert (contact.unevenness <= UNEVEN) == even
        forces.append(point.forces)
    np.testing.assert_allclose(*forces, rtol=1e-7, atol=1e-7)


def drawn(seed):
    """A random scene, its heights, load, form and steps."""
    random = np.random.default_rng(seed)
    line, height = random.random() < 0.8, float(random.choice([math.inf, 3.0, 30.0, 2000.0]))
    scene = Scene(dimension=1 if line else 2, points=int(random.choice([64, 96, 200])) if line
                  else (16, 24), period=float(random.uniform(8.0, 30.0)) if line else (8.0, 9.5),
                  geometry="cylinder" if line else "sphere",
                  normal_maugis=float(random.uniform(0.7, 1.8)),
                  tangential_maugis=float(random.uniform(0.5, 1.5)), height=height, poisson=0.5
                  if math.isfinite(height) else float(random.choice([0.5, 0.3, 0.0])),
                  residual_friction=0.5)
    heights = waves(scene.shape, scene.periods, seed, even=random.random() < 0.6,
                    slope=float(random.uniform(0.1, 0.8)))
    if random.random() < 0.4:
        heights = heights + 10.0 ** random.uniform(-13.0, -3.0) * random.normal(size=heights.shape)
    start = float(random.uniform(-0.5, 1.0))
    path = [f"normal_displacement={start + 0.5:.3f}", "normal_force=1.5"][random.integers(2)]
    path += ["",
             f"; tangential_displacement{'' if line else '_x'}={random.uniform(0.2, 1.0):.3f}"][
        random.integers(2)]
    form = {"window": str(random.choice(["auto", "off"]))}
    return scene, heights, Load(start=f"normal_displacement={start:.3f}", path=path), form


@pytest.mark.study
@pytest.mark.parametrize("seed", range(40))
def test_any_surface_is_balanced_with_symmetry_and_without(seed):
    scene, heights, load, given = drawn(seed)
    ends = []
    for symmetry in ("auto", "off"):
        contact = Contact(scene, heights)
        branch = branch_of(contact, load, Form(symmetry=symmetry, **given))
        for point in branch:
            balanced(contact, point, heights.max() - heights)
            assert point.state.window.is_whole or contact.gap_outside(point.state).min() >= 30.0
        ends.append(point.forces)
    np.testing.assert_allclose(*ends, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("moved", [0.5, 1.0])
def test_a_body_beside_its_node_is_not_even(moved):
    """Its apex between two nodes, or at another one than the cell's middle: the same body,
    somewhere else."""
    x = (np.arange(128) - 64 - moved) * LINE.spacings[0]
    contact = Contact(LINE, -x ** 2 / 2)
    assert contact.convex and contact.unevenness > 1.0
    load = Load(start="normal_displacement=1", path="normal_displacement=2")
    *_, point = branch_of(contact, load)
    balanced(contact, point, x ** 2 / 2 - np.min(x ** 2) / 2)
    *_, plain = Branch(LINE, load)
    np.testing.assert_allclose(point.forces, plain.forces, rtol=1e-2)


@pytest.mark.parametrize("height, alone", [(600.0, True), (2.0, True), (2.0, False),
                                           (math.inf, True)])
def test_an_isolated_layer_moves_sideways(height, alone):
    """At Poisson ratio 1/2, too: by the unbounded layer's own kernel, a band-limited integral for
    each lag."""
    scene = Scene(period=math.inf, spacing=0.3, normal_maugis=1.0, tangential_maugis=1.0,
                  height=height)
    if not alone:
        scene = replace(scene, period=40.0, points=128, spacing=None)
    branch = Branch(scene, Load(start="normal_force=1",
                                path="normal_force=5" + ("" if alone else "; normal_force=6")))
    *_, point = branch
    contact, state = branch.contact, point.state
    if not alone:
        x = (np.arange(128) - 64) * scene.spacings[0]
        balanced(contact, point, x ** 2 / 2)
        return
    assert isinstance(branch.corrector.form, EvenForm)
    (first,) = state.window.start
    (count,) = state.window.shape
    h = 0.3
    x = (first + np.arange(count) - contact.grid.shape[0] // 2) * h
    gaps = state.displacement + np.vstack([x ** 2 / 2, 0.0 * x])[:len(state.displacement)]
    traction, far = tractions(gaps, 1.0, 0.0), 1.0 if math.isinf(height) else 0.0
    nodes, weights = np.polynomial.legendre.leggauss(16)
    panels = 4000
    q = ((np.arange(panels)[:, None] + 0.5 + 0.5 * nodes) * math.pi / h / panels).ravel()
    weights = np.tile(0.5 * weights * math.pi / h / panels, panels)
    normal, along, _, coupling = (row * weights / math.pi for row in compliances(q, 0.5, height))
    lags = h * np.arange(count)
    angles = np.outer(lags, q)
    # Displacements that a uniform motion may be added to: for a half-space the integral itself is
    # one only so.
    even = np.cos(angles) @ normal - far * normal.sum()
    other = np.cos(angles) @ along - far * along.sum()
    odd = np.sin(angles) @ coupling
    between = np.arange(count)[:, None] - np.arange(count)
    pull, shear = -h * traction[0], -h * traction[1] if len(traction) > 1 else None
    sine = np.sign(between) * odd[np.abs(between)]
    found = [even[np.abs(between)] @ pull] if shear is None else [
        even[np.abs(between)] @ pull + sine @ shear, other[np.abs(between)] @ shear - sine @ pull]
    off = state.displacement - found
    assert (np.ptp(off, axis=1).max() < 5e-8
            and h * -traction[0].sum() == pytest.approx(5.0, abs=1e-7))


@pytest.mark.parametrize("scene, force, wanted", [({"height": 2000.0}, 50, False),
                                                  ({"height": 2000.0}, 500, True),
                                                  ({"height": math.inf}, 5000, False),
                                                  ({"height": 2000.0, "tangential_maugis": 20.0},
                                                   50, True), ({"height": 500.0}, 1, True)])
def test_a_sphere_on_a_tall_layer_slides_under_a_large_force(scene, force, wanted):
    """What is left out is less than 1e-4 ranges of slip: measured 2.3e-5 for a force of 50 on a
    height of 1000."""
    scene = Scene(dimension=2, geometry="sphere", period=math.inf, normal_maugis=1.0, **scene)
    assert tangential_legs(scene, Load(path=f"normal_force={force}")) == (wanted, wanted)


def test_what_a_tall_layer_leaves_out_is_told(tmp_path):
    words = ("-scene_dimension 2 -scene_geometry sphere -scene_period inf "
             "-scene_normal_maugis 1 -load_path normal_force=1".split())
    assert ("no tangential unknowns: the load names none, and so tall a "
            "layer slides by less than "
            "0.0001 ranges" in call("info", *words, folder=tmp_path).stdout)


@pytest.mark.study
def test_slip_of_a_sphere_on_a_tall_layer():
    """The estimate that decides is an upper one, and not far from what a solve finds."""
    scene = Scene(dimension=2, geometry="sphere", period=math.inf, normal_maugis=1.0, height=1000.0,
                  spacing=0.4, tangential="on")
    branch = Branch(scene, Load(start="normal_force=50", path="normal_force=50"))
    *_, point = branch
    estimate = 1.087 / (2.0 * math.pi) * 50.0 * (0.75 * 50.0) ** (1.0 / 3.0) / 1000.0 ** 2
    assert 0.5 * estimate < branch.observe(point)["maximum_tangential_gap"] < estimate


# Heights as a user brings them


def of_file(folder, heights, scene=LINE):
    """The scene of a file of heights."""
    np.save(folder / "heights.npy", heights)
    return replace(scene, geometry="file", geometry_file=str(folder / "heights.npy"))


def test_symmetry_asked_for_says_how_uneven_the_gap_is(tmp_path):
    heights = waves(LINE.shape, LINE.periods, seed=3, even=True)
    load = Load(path="normal_displacement=1")
    Branch(of_file(tmp_path, heights), load, form=Form(symmetry="even"))
    heights[70] -= 0.002
    with pytest.raises(InputError,
                       match=r"-contact_symmetry is 'even', but .*differ by up to 0.003 delta_n"):
        Branch(of_file(tmp_path, heights), load, form=Form(symmetry="even"))


@pytest.mark.parametrize("heights", [np.zeros(127), np.zeros((128, 128)), np.zeros(1),
                                     np.full(128, np.nan), np.zeros(128) * 1j])
def test_heights_that_do_not_fit_are_refused(heights):
    with pytest.raises(InputError, match="heights"):
        Contact(LINE, heights)


def test_what_heights_are_is_asked_of_them():
    """Not of the name of the geometry that they stand in for: a second summit makes a gap that is
    not convex."""
    x = (np.arange(128) - 64) * LINE.spacings[0]
    assert (Contact(LINE, -x ** 2 / 2).convex and Contact(LINE).convex
            and not Contact(replace(LINE, geometry="flat")).convex)
    two = Contact(LINE, np.maximum(-x ** 2, -4.0 * (np.abs(x) - 7.0) ** 2 - 0.1))
    assert not two.convex
    plane = np.add.outer(np.arange(-8, 8) ** 2.0, np.arange(-8, 8) ** 2.0)
    saddle = np.multiply.outer(np.arange(-8, 8), np.arange(-8, 8))
    square = Scene(dimension=2, points=16, period=16.0, geometry="sphere")
    assert (Contact(square, -plane - 1.9 * saddle).convex
            and not Contact(square, -plane - 2.1 * saddle).convex)


# What is stored is right, whatever was believed


def test_a_wrong_belief_in_symmetry_ends_it(monkeypatch):
    """The residual of all nodes is found again for every point: were unevenness not seen, points
    would be right, and say why."""
    monkeypatch.setattr("contactsnes.contact.symmetry.obstacle", lambda *given: None)
    scene, load = CASES["line"]
    heights, said = waves(scene.shape, scene.periods, 3, even=False), []
    branch = branch_of(Contact(scene, heights), load, log=said.append)
    for point in branch:
        balanced(branch.contact, point, heights.max() - heights)
    assert not isinstance(branch.corrector.form, EvenForm)
    assert any("going on without symmetry" in sentence for sentence in said)


def test_a_body_that_couples_ends_symmetry_on_an_arc_too(monkeypatch):
    monkeypatch.setattr("contactsnes.contact.symmetry.parities_of",
                        lambda operator, components, loaded: ((1,),) * components)
    scene, load = CASES["coupled"]
    said = []
    branch = Branch(scene, load, Steps(type="arclength"), log=said.append)
    x = (np.arange(128) - 64) * scene.spacings[0]
    for point in branch:
        balanced(branch.contact, point, x ** 2 / 2)
    assert any("going on without symmetry" in sentence for sentence in said)
    assert np.abs(point.state.displacement[1]).max() > 1e-3


@pytest.mark.parametrize("name", ["line", "coupled", "plane"])
def test_responses_are_those_of_all_nodes(name):
    """Of fields as even or odd as the body allows by halves, of any others by whole transforms: to
    rounding the same."""
    scene = CASES[name][0]
    contact, count = Contact(scene), 1 if scene.dimension == 2 else 2
    window = Window(contact.grid, [n // 2 - 5 for n in scene.shape], [11] * scene.dimension)
    signs = parities(contact.operator(count), count)
    half = EvenConvolution(EvenWindow(window, signs), contact.operator(count), count)
    response = Response(window, contact.operator(count), count, half)
    whole = convolution(window, contact.operator(count), count)
    field = np.random.default_rng(2).normal(size=(count, window.size))
    even = half.window.unfold(half.window.fold(field))
    for values, by_halves in ((even, True), (even + 1e-12 * field, False), (field, False)):
        before = contact.grid.transforms
        found = response.apply(values, np.empty_like(values))
        by_whole = response._whole is not None
        assert by_halves != by_whole and contact.grid.transforms > before
        np.testing.assert_allclose(found, whole.apply(values, np.empty_like(values)), atol=1e-12)


def test_wrong_halves_end_symmetry(monkeypatch):
    """Were the transforms of halves wrong, the first point would tell: it is asked by whole
    ones."""
    own, said = EvenConvolution.apply, []
    monkeypatch.setattr(EvenConvolution, "apply", lambda self,
                        *given: np.multiply(own(self, *given), 1.001, out=given[1]))
    scene, load = CASES["line"]
    # (NumPy's are those that are made wrong)
    branch = Branch(scene, load, form=Form(kernels="off"), log=said.append)
    x = (np.arange(128) - 64) * scene.spacings[0]
    for point in branch:
        balanced(branch.contact, point, x ** 2 / 2)
    assert (not isinstance(branch.corrector.form, EvenForm)
            and any("going on without symmetry" in sentence for sentence in said))


def test_rounding_costs_an_iteration_and_no_point(monkeypatch):
    """A residual of all nodes that lies a hair above the tolerance, where that of half of them does
    not."""
    scene, load = CASES["line"]
    branch = Branch(scene, load)
    asked = []
    own = Balance.__call__

    def above(self, *given):
        found = own(self, *given)
        if self is branch.corrector.balance:  # and not that of a coarser grid
            asked.append(found.norm)
            found = found._replace(norm=1.0000001e-8) if len(asked) == 1 else found
        return found

    monkeypatch.setattr(Balance, "__call__", above)
    point = next(iter(branch))
    assert (len(asked) == 2 and asked[1] <= 5e-9 and point.residual_norm == asked[1]
            and isinstance(branch.corrector.form, EvenForm))
    assert branch.corrector.snes.getTolerances()[1] == 1e-8  # for the next point as before


def test_the_state_that_is_stored_is_asked(monkeypatch):
    """A solver that ends anywhere else than it says makes no point."""
    state_of = DisplacementForm.state

    def moved(form, unknown):
        found = state_of(form, unknown)
        return State(found.window, found.displacement + 1e-7, found.means)

    for form in (DisplacementForm, EvenForm):
        monkeypatch.setattr(form, "state", moved)
    with pytest.raises(NotConverged, match="residual_norm"):
        next(iter(Branch(LINE, Load(path="normal_displacement=1"))))


def test_states_on_one_side_are_not_even():
    """The law acts where nothing is known of the mirror image."""
    scene = replace(LINE, points=64)
    x = (np.arange(64) - 32) * scene.spacings[0]
    contact, said = Contact(scene, -4.0 * (np.abs(x) - 5.0) ** 2), []
    symmetry = Symmetry(contact, Form(), NEWTON, said.append)
    window = Window(contact.grid, (32,), (31,))
    assert np.flatnonzero(lone(window)).tolist() == list(range(1, 31))
    symmetry.checked(State(window, np.zeros((1, 31)), np.zeros(1)))
    assert said == ["the state is not even about the apex: going on without symmetry"]
    both = Spots(contact.grid, [(10,), (50,)], (5,))
    assert np.array_equal(lone(both), [False] * 10)
    symmetry = Symmetry(contact, Form(), NEWTON, said.append)
    symmetry.checked(State(both, np.arange(10.0)[None], np.zeros(1)))
    assert len(said) == 2


def test_even_spots_far_apart():
    """Boxes around them where that is cheaper, else half of one window; the same states."""
    scene = replace(LINE, points=4096, period=200.0)
    x = np.abs((np.arange(4096) - 2048) * scene.spacings[0])
    found = []
    for form, halved in ((Form(symmetry="even"), True), (Form(), False)):
        contact, said = Contact(scene, -(x - 50.0) ** 2 / 2), []
        branch = branch_of(contact, Load(start="normal_force=1", path="normal_force=2"), form,
                           log=said.append)
        *_, point = branch
        assert isinstance(branch.corrector.form,
                          EvenForm) == halved and (len(point.state.window.parts) == 1) == halved
        assert any("boxes around the spots cost less" in sentence
                   for sentence in said) == (not halved)
        balanced(contact, point, (x - 50.0) ** 2 / 2)
        found.append(point.displacements[0])
    assert found[0] == pytest.approx(found[1], abs=1e-8)


def test_a_node_far_out_of_balance_is_told(monkeypatch):
    """Once in a run: what a mean over many nodes hides."""
    said, own = [], Balance.__call__
    monkeypatch.setattr(Balance, "__call__", lambda *given: own(*given)._replace(largest=2e-6))
    list(Branch(LINE, Load(path="normal_displacement=1"), log=said.append))
    assert len([sentence for sentence in said
                if "largest_residual" in sentence]) == 1 and DILUTED == 100.0


def test_largest_residual_is_kept():
    branch = Branch(LINE, Load(path="normal_displacement=1"))
    point = next(iter(branch))
    row = branch.observe(point)
    assert 0.0 < row["largest_residual"] == point.largest_residual == branch.restored(
        branch.packed(point)).largest_residual
    apart = Branch(LINE, Load(start="normal_displacement=-40", path="normal_displacement=-40"))
    assert next(iter(apart)).largest_residual == 0.0
