"""Even and odd modes apart: against the whole window's J, and dense eigenvalues of either kind."""

from dataclasses import replace

import numpy as np
import petsc4py
import pytest
from scipy import linalg

petsc4py.init([])

from dense_cell import Cell  # noqa: E402
from test_stability import SHEARED, followed  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.contact import states  # noqa: E402
from contactsnes.contact.problem import DISPLACEMENT, FORCE  # noqa: E402
from contactsnes.contact.states import State  # noqa: E402
from contactsnes.dynamics.holding import holding, in_step, lengths  # noqa: E402
from contactsnes.dynamics.linearised import Overdamped, symmetries  # noqa: E402
from contactsnes.dynamics.parted import Parted  # noqa: E402
from contactsnes.dynamics.projection import Space  # noqa: E402
from contactsnes.dynamics.stability import Stability  # noqa: E402
from contactsnes.grid.mirrors import centred  # noqa: E402
from contactsnes.kernels import library  # noqa: E402
from contactsnes.kernels import modes as compiled  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402

LAYER = {**SHEARED, "poisson": 0.3, "height": 20.0}
SPHERE = {"dimension": 2, "geometry": "sphere", "points": (16, 16), "period": 8.0,
          "normal_maugis": 1.0, "tangential_maugis": 0.5}
SCENES = {
    "line": (SHEARED, "normal_displacement=1; tangential_displacement=40"),
    "layer": ({**LAYER, "tangential": "on"}, "normal_displacement=1"),
    "window": ({**SHEARED, "points": 512, "period": 80.0}, "normal_displacement=0.5"),
    "isolated": ({"normal_maugis": 3.0, "period": np.inf, "spacing": 0.06, "height": np.inf},
                 "normal_force=0.3"),
    "sphere": (SPHERE, "normal_displacement=1, tangential_displacement_x=0.3"),
    "coupled along x": ({**SPHERE, "poisson": 0.3},
                        "normal_displacement=1, tangential_displacement_x=0.3"),
    "coupled along y": ({**SPHERE, "poisson": 0.3, "points": (16, 18), "period": (8.0, 9.0)},
                        "normal_displacement=1, tangential_displacement_y=0.3")}


def branch(scene, path, at=0.2):
    start = f"{path.partition('=')[0]}={at:g}"
    return Branch(Scene(**scene), Load(start=start, path=path), Steps(), Form(),
                  log=lambda sentence: None)


def both(contact, point, controls):
    """(J on the whole window, J apart for each symmetry) of a point under controls."""
    window = centred(point.state.window)
    state = State(window, states.onto(point.state, window), point.state.means)
    axes = symmetries(contact, state)
    assert len(axes) == (1 if len(window.shape) > 1 and contact.couples() else len(window.shape))
    made = Overdamped(contact, window, controls), Parted(contact, window, controls, axes)
    for operator in made:
        operator.linearise(state)
    return made


@pytest.mark.parametrize("name", SCENES)
def test_the_parts_are_those_of_the_whole_operator(name):
    scene, path = SCENES[name]
    made = branch(scene, path)
    point = followed(made)[-1]
    count = len(point.controls)
    tried = {tuple(point.controls), *(() if name == "isolated" else (
        (FORCE,) * count, (DISPLACEMENT, FORCE, FORCE)[:count]))}
    for controls in tried:
        whole, parted = both(made.contact, point, controls)
        vector = np.random.default_rng(0).standard_normal(whole.size)
        own = parted.vector(whole.state(vector))
        assert np.linalg.norm(own) == pytest.approx(np.linalg.norm(vector), rel=1e-12)
        np.testing.assert_allclose(whole.vector(parted.state(own)), vector, atol=1e-12)
        np.testing.assert_allclose(whole.vector(parted.state(parted.apply(own))),
                                   whole.apply(vector), atol=1e-10)
        for part in (parted.whole(number, row) for number, row in enumerate(parted.parts(own))):
            image = parted.apply(part)
            for other in parted.parts(image - parted.whole(
                    *next((k, row) for k, row in enumerate(parted.parts(image)) if row.any()))):
                assert not other.any()


def by_parity(cell, signs):
    """Leading eigenvalues of a dense cell at displacements that are even times ``signs`` (one a
    component), and at those that are odd."""
    nodes = np.arange(cell.n)
    mirror = np.kron(np.diag(signs), np.eye(cell.n)[-nodes % cell.n])
    found = []
    for parity in (1.0, -1.0):
        part = cell.basis.T @ (mirror * parity + np.eye(len(mirror))) @ cell.basis / 2.0
        values, vectors = linalg.eigh(part)
        basis = cell.basis @ vectors[:, values > 0.5]
        values = linalg.eigvals(basis.T @ (cell.stiffness + cell.tangent()) @ basis,
                                basis.T @ cell.mass @ basis)
        found.append(np.min(values.real))
    return found


@pytest.mark.parametrize("name, signs", [("line", (1.0, 1.0)), ("layer", (1.0, -1.0))])
@pytest.mark.parametrize("controls", [(DISPLACEMENT, DISPLACEMENT), (FORCE, FORCE)])
def test_leading_modes_of_either_parity_are_the_dense_ones(name, signs, controls):
    scene, path = SCENES[name]
    made = branch(scene, path)
    point = followed(made)[-1]
    load = np.where([control == FORCE for control in controls], point.forces, point.displacements)
    point = replace(point, controls=controls, load=load)
    stability = Stability(made.corrector, "eigenvalue")
    modes = stability.modes(point, 1e-8)
    parted = stability._operator
    for parity, expected in enumerate(by_parity(Cell(made.contact, point), signs)):
        first = next(k for k, vector in enumerate(modes.vectors)
                     if lengths(parted.parts(vector)[parity]) > 0.5)
        assert modes.values[first].real == pytest.approx(
            expected, abs=max(1e-7, 2.0 * modes.residuals[first]))


def test_an_odd_mode_that_becomes_unstable_first_is_seen_on_an_even_state(tmp_path):
    """Two equal spots pulled off together: one lets go first, which even states know nothing of."""
    file = tmp_path / "two.npy"
    np.save(file, -1.5 * np.cos(4.0 * np.pi * np.arange(-96, 96) / 192))
    scene = {"geometry": "file", "geometry_file": str(file), "points": 192, "period": 18.0,
             "normal_maugis": 2.0}
    points = followed(branch(scene, "normal_displacement=-1.75", at=-1.2))
    made, counts = branch(scene, "normal_displacement=-1.75", at=-1.2), []
    for point in points[::2]:
        expected = by_parity(Cell(made.contact, point), (1.0,))
        stability = Stability(made.corrector, "eigenvalue")
        found = stability(point)
        assert made.corrector.symmetry.holds(1) == (expected[1] > 0.0)
        assert found.leading_eigenvalue.real == pytest.approx(min(expected), abs=4e-4)
        counts.append(found.unstable_modes)
        assert found.unstable_modes == np.sum(np.array(expected) < -1e-5)
        if expected[1] < 0.0 < expected[0]:
            break
    assert counts[0] == 0 and counts[-1] == 1
    mode = found.mode.displacement[0]
    centre = found.mode.window.grid.shape[0] // 2 - found.mode.window.origin[0]
    reach = min(centre, len(mode) - 1 - centre)
    after, before = mode[centre:centre + reach + 1], mode[centre - reach:centre + 1][::-1]
    np.testing.assert_allclose(after, -before, atol=1e-3)


@pytest.mark.skipif(library.reason() is not None, reason="no compiled kernels")
def test_compiled_and_numpy_hold_the_same_vectors():
    random = np.random.default_rng(1)
    size, vectors = 301, random.standard_normal((9, 301))
    vectors[4] = vectors[3] + 1e-4 * vectors[4]
    vectors[6] = vectors[:3].sum(axis=0)
    images = random.standard_normal(vectors.shape)
    kept = []

    def hold(*words):
        return in_step([holding(*words)])[0]

    for act in (hold, compiled.hold):
        held, count = (np.zeros((2, 10, size)), np.zeros((10, 10)), np.zeros(10)), 0
        for pair in zip(vectors, images):
            count += act(held, count, pair, 1e-6)
        rows, products, errors = held
        kept.append((count, rows[:, :count], products[:count, :count], errors[:count]))
    assert kept[0][0] == kept[1][0] == len(vectors) - 1
    for expected, found in zip(kept[0][1:], kept[1][1:]):
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
    assert kept[1][3][4] > 1e3 * kept[1][3][3] > 0.0  # of which a part of 1e-4 was new
    basis, images = kept[1][1]
    np.testing.assert_allclose(basis @ basis.T, np.eye(len(basis)), atol=1e-12)
    np.testing.assert_allclose(kept[1][2], basis @ images.T, atol=1e-9 * np.abs(images).max())


@pytest.mark.skipif(library.reason() is not None, reason="no compiled kernels")
@pytest.mark.parametrize("name", ["line", "layer", "isolated"])
def test_runs_in_the_library_span_what_numpys_span(name):
    class Interpreted:
        """An operator without what the library has for it."""

        kernels = None

        def __init__(self, operator):
            self.operator = operator

        def __getattr__(self, name):
            return getattr(self.operator, name)

    scene, path = SCENES[name]
    made = branch(scene, path)
    point = followed(made)[-1]
    for operator in both(made.contact, point, point.controls):
        begin = np.random.default_rng(2).standard_normal(operator.size)
        if operator.occupied is not None:
            begin[~operator.occupied] = 0.0
        spaces = [Space(operator), Space(Interpreted(operator))]
        for space in spaces:
            for shift, count in ((0.0, 1), (0.1, 4)):
                space.run(shift, begin / (1.0 + shift), count)
        for one, other in zip(*(space._sectors for space in spaces)):
            assert one.count == other.count > 3
            held = slice(0, one.count)
            bases = [sector._rows[0, held] for sector in (one, other)]
            turned = bases[0] @ bases[1].T
            np.testing.assert_allclose(turned @ turned.T, np.eye(one.count), atol=1e-6)
            expected = turned @ other._products[held, held] @ turned.T
            np.testing.assert_allclose(one._products[held, held], expected,
                                       atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("step", [0.25, 0.4])
def test_no_symmetry_loses_its_leading_mode_from_point_to_point(step, tmp_path):
    """Of two spots whose edges pass several nodes in a step: modes of the last point are far from
    those of the next, and those of one symmetry no nearer to its first than to its second."""
    places = 4.0 * np.pi * np.arange(-32, 32) / 64
    np.save(tmp_path / "two.npy", 1.5 * np.cos(places))
    scene = Scene(points=64, period=16.0, normal_maugis=2.2, height=np.inf, geometry="file",
                  geometry_file=str(tmp_path / "two.npy"))
    made = Branch(scene, Load(start="normal_displacement=-1.4", path="normal_displacement=0.3"),
                  Steps(stability="eigenvalue", initial_step=(step,), largest_step=(step,)), Form(),
                  log=lambda sentence: None)
    points = list(made)
    assert len(points) > 4
    for point in points:
        value = Cell(made.contact, point).eigenvalues()[0]
        assert value.real > 0.01 and point.stable == 1
        assert abs(point.leading_eigenvalue - value) < 3e-3
