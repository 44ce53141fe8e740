"""Stability of points: against dense eigenvalues of the force balance on the whole cell, a motion
in time, folds, other grids."""

from dataclasses import replace
from itertools import takewhile

import numpy as np
import petsc4py
import pytest
from processes import call
from scipy import linalg

petsc4py.init([])

from dense_cell import Cell  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.contact.problem import DISPLACEMENT, FORCE, Contact  # noqa: E402
from contactsnes.contact.states import State  # noqa: E402
from contactsnes.continuation.points import NotConverged  # noqa: E402
from contactsnes.dynamics import modes, projection  # noqa: E402
from contactsnes.dynamics.linearised import (  # noqa: E402
    Overdamped,
    evened,
    mirrored,
    symmetries,
)
from contactsnes.dynamics.modes import ACCURATE, NEUTRAL  # noqa: E402
from contactsnes.dynamics.stability import Stability  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.output.reading import read as read_archive  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402

SMALL = {"points": 256, "period": 30.0, "normal_maugis": 3.0}
SHEARED = {"points": 128, "period": 20.0, "normal_maugis": 2.0, "tangential_maugis": 0.5}
COUPLED = {**SHEARED, "poisson": 0.3, "height": 20.0}
PULLED = "normal_displacement=-2.6"


def branch(scene, path, stability="off", start="normal_displacement=0", log=lambda sentence: None,
           **steps):
    return Branch(Scene(**scene), Load(start=start, path=path), Steps(stability=stability, **steps),
                  Form(), log=log)


def followed(made):
    """Points of a branch up to its end or failure."""
    points = []
    try:
        points.extend(made)
    except RuntimeError:
        pass
    return points


def under(point, *controls):
    """The same equilibrium under other controls."""
    load = np.where([control == FORCE for control in controls], point.forces, point.displacements)
    return replace(point, controls=controls, load=load)


@pytest.fixture(scope="module")
def pulled():
    """A branch that is pulled off by its displacement, and its points."""
    made = branch(SMALL, PULLED)
    return made, followed(made)


@pytest.fixture(scope="module")
def sheared():
    """The same of a sheared one, uncoupled, and with coupling in a layer."""
    return [(made, followed(made))
            for made in (branch(SHEARED, "normal_displacement=1; tangential_displacement=60"),
                         branch(COUPLED, "normal_displacement=1; tangential_displacement=15"))]


def assert_as_dense(made, point, unstable=None):
    """The module's modes of a point are the dense ones."""
    expected = Cell(made.contact, point).eigenvalues()
    found = Stability(made.corrector, "eigenvalue")(point)
    assert found.unstable_modes == np.sum(expected.real < -NEUTRAL) == (found.unstable_modes
                                                                        if unstable is None
                                                                        else unstable)
    assert found.stable == (expected[0].real > NEUTRAL)
    leading = expected[0] if expected[0].imag >= 0.0 else expected[0].conj()
    assert abs(found.leading_eigenvalue - leading) < 4e-4
    assert abs(Stability(made.corrector, "eigenvalue").modes(point, 1e-8).leading - leading) < 1e-7
    assert Stability(made.corrector, "sign")(point).unstable_modes == found.unstable_modes


@pytest.mark.parametrize("control", [DISPLACEMENT, FORCE])
@pytest.mark.parametrize("part", [0.0, 0.5, 1.0])
def test_normal_contact_as_dense(pulled, control, part):
    made, points = pulled
    point = under(points[int(part * (len(points) - 1))], control)
    assert_as_dense(made, point, int(control == FORCE and part == 1.0))


@pytest.mark.parametrize("controls", [(DISPLACEMENT, DISPLACEMENT), (FORCE, DISPLACEMENT),
                                      (DISPLACEMENT, FORCE), (FORCE, FORCE)])
@pytest.mark.parametrize("coupled", [0, 1])
def test_sheared_contact_as_dense(sheared, controls, coupled):
    made, points = sheared[coupled]
    points = [point for point in points if len(point.controls) == 2]
    for point in (points[0], points[len(points) // 2], points[-1]):
        assert_as_dense(made, under(point, *controls))


def test_a_disturbance_grows_at_the_rate_of_the_eigenvalue(pulled):
    """Explicit steps in time from a slightly disturbed unstable state, whatever the disturbance."""
    made, points = pulled
    point = under(points[-1], FORCE)
    cell, found = Cell(made.contact, point), Stability(made.corrector, "eigenvalue")(point)
    assert found.leading_eigenvalue.real < 0.0
    unknown = cell.unknown.reshape(-1) + 1e-9 * np.random.default_rng(0).standard_normal(cell.n)
    # The fast decaying motion needs short steps; a disturbance has to grow out of the mixture
    # first.
    fastest = cell.eigenvalues()[-1].real
    size, times = [], (40.0, 60.0)
    steps = int(times[1] * fastest)
    length = times[1] / steps
    for step in range(steps):
        if step == round(times[0] / length):
            size.append(np.linalg.norm(unknown - cell.unknown.reshape(-1)))
        unknown = unknown + length * cell.rate(unknown)
    size.append(np.linalg.norm(unknown - cell.unknown.reshape(-1)))
    assert np.log(size[1] / size[0]) / (times[1] - times[0]) == pytest.approx(
        -found.leading_eigenvalue.real, rel=1e-2)


def test_the_leading_eigenvalue_vanishes_at_a_fold():
    """As the square root of the distance of the load from it, and `stable` is 0 at the fold
    itself."""
    points = followed(branch(SMALL, "normal_displacement=2; normal_force=-1.9", "eigenvalue"))
    fold = points[-1]
    assert fold.event == "fold" and fold.stable == 0 and abs(fold.leading_eigenvalue) < 1e-3
    on_the_way = [point for point in points if point.leg == 2 and point is not fold]
    assert all(point.stable == 1 and point.unstable_modes == 0 for point in on_the_way)
    near = [(point.load[0] - fold.load[0], point.leading_eigenvalue.real)
            for point in on_the_way[-3:]]
    slopes = np.diff(np.log(near), axis=0)
    assert slopes[-1, 1] / slopes[-1, 0] == pytest.approx(0.5, abs=0.15)


@pytest.mark.parametrize("scene, path", [(SMALL, "normal_displacement=2"),
                                         ({**SMALL, "normal_maugis": 2.0, "tangential_maugis": 0.5},
                                          "normal_displacement=1, tangential_displacement=4")])
def test_eigenvalues_and_their_cost_do_not_depend_on_the_grid(scene, path):
    runs = [followed(branch({**scene, "points": points}, path, "eigenvalue",
                            start=path.replace("=2", "=1.9").replace("=4", "=3.9")))
            for points in (512, 1024, 2048)]
    values = [run[-1].leading_eigenvalue for run in runs]
    assert abs(values[1] - values[2]) < ACCURATE and abs(values[0] - values[2]) < 1e-3
    products = [run[-1].spent["jacobian_products"] for run in runs]
    assert max(products) <= min(products) + 8


def test_a_check_costs_about_two_steps():
    """In transforms, of steps that use the symmetry that modes may break; the sign less."""
    runs = {kind: followed(branch({**SMALL, "points": 1024}, "normal_displacement=4", kind))
            for kind in ("off", "sign", "eigenvalue")}
    plain, sign, value = (np.mean([point.spent["transforms"] for point in run[2:]])
                          for run in runs.values())
    assert value <= 3.0 * plain and sign <= 2.2 * plain
    assert all(point.stable == -1 and point.unstable_modes == -1 for point in runs["off"])
    assert all(point.stable == 1 and np.isnan(point.leading_eigenvalue.real)
               for point in runs["sign"])


def test_a_point_without_a_certificate_is_no_end(monkeypatch):
    def lost(*_):
        raise NotConverged("the modes of the point were not found")

    said = []
    points = iter(branch(SMALL, "normal_displacement=0.2", "sign", log=said.append))
    assert next(points).stable == 1
    with monkeypatch.context() as patched:
        patched.setattr("contactsnes.dynamics.stability.leading_modes", lost)
        missed = next(points)
    assert (missed.stable, missed.unstable_modes) == (0, -1) and "not certified" in said[-1]
    rest = list(points)
    assert all(point.stable == 1 for point in rest) and rest[-1].position == 1.0


@pytest.mark.parametrize("values, unstable", [((-2e-4, 0.3), 0), ((2e-4, 0.3), 0),
                                              ((-0.5, -2e-4, 0.3), 1), ((-0.5, 2e-4), 1),
                                              ((-0.5, 0.4), 1), ((0.3, 0.4), 0)])
def test_the_null_mode_of_a_fold_is_neither_stable_nor_counted(monkeypatch, values, unstable):
    """The last pairs are those of corners, where an eigenvalue jumps through zero and none is
    small."""
    made = branch(SMALL, "normal_displacement=0.2", "sign")
    point, values = next(iter(made)), np.array(values, dtype=complex)
    vectors = np.zeros((len(values), made.stability.modes(point).vectors.shape[1]))
    found = projection.Modes(values, vectors, vectors, np.ones(len(values), dtype=bool))
    monkeypatch.setattr(made.stability, "modes", lambda point, accurate: found)
    monkeypatch.setattr(made.stability, "_leave_symmetry", lambda modes: None)
    fold = made.stability(replace(point, event="fold"))
    assert (fold.stable, fold.unstable_modes) == (0, unstable)
    plain = made.stability(point)
    assert (plain.stable, plain.unstable_modes) == (int(values[0].real > NEUTRAL),
                                                    int(np.sum(values.real < -NEUTRAL)))


def test_what_a_point_tells():
    made = branch(SMALL, "normal_displacement=0.2", "eigenvalue")
    for point in made:
        row = made.observe(point)
        assert (row["stable"], row["unstable_modes"]) == (1, 0)
        assert (row["leading_eigenvalue"] == point.leading_eigenvalue.real
                and row["leading_eigenvalue_imaginary"] == 0.0)
        kept = made.restored(made.packed(point))
        assert (kept.stable, kept.unstable_modes, kept.leading_eigenvalue) == (
            1,
            0,
            point.leading_eigenvalue,
        )


def test_it_is_said_once_what_is_certified():
    said = []
    followed(branch(SMALL, "normal_displacement=0.5", "sign", log=said.append))
    assert [sentence.startswith("stable:") for sentence in said].count(True) == 1


def test_relaxation_has_no_tangent(options):
    options(snes_type="python", snes_python_type="contactsnes.solvers.relaxation.Verlet")
    with pytest.raises(InputError, match="-continuation_stability is 'sign'.*newtonls"):
        Branch(Scene(**SMALL), Load(path="normal_displacement=1"), Steps(stability="sign"),
               Form(form="force"))


def test_isolated_contacts_have_stability_too():
    """A cylinder alone under force control: as one in a long cell."""
    scene = {"normal_maugis": 3.0, "period": np.inf, "spacing": 0.06, "height": np.inf}
    alone = followed(branch(scene, "normal_force=1", "eigenvalue", start="normal_force=0.8"))[-1]
    cell = followed(branch({"normal_maugis": 3.0, "period": 1000.0, "points": 17000,
                            "height": np.inf}, "normal_force=1", "eigenvalue",
                           start="normal_force=0.8"))[-1]
    assert alone.stable == cell.stable == 1
    assert alone.leading_eigenvalue.real == pytest.approx(cell.leading_eigenvalue.real, rel=2e-3)


def test_spheres_and_shear_in_the_plane():
    """Modes of a round contact come in pairs of different symmetry; all are found."""
    scene = {"dimension": 2, "geometry": "sphere", "points": (16, 16), "period": 8.0,
             "normal_maugis": 1.0}
    for path in ("normal_displacement=1", "normal_displacement=1, tangential_displacement_x=0.3"):
        made = branch({**scene, "tangential_maugis": 0.5}, path)
        point = followed(made)[-1]
        modes = Stability(made.corrector, "eigenvalue").modes(point, 1e-6)
        window = point.state.window
        operator = Overdamped(made.contact, window, point.controls)
        operator.linearise(point.state)
        dense = np.sort(linalg.eigvals(np.array([operator.apply(unit)
                                                 for unit in np.eye(operator.size)]).T).real)
        assert abs(modes.leading - dense[0]) < 1e-5
        assert np.all(np.abs(modes.values.real[:2] - dense[:2]) < 5e-3)


def test_leading_modes_are_archived_and_drawn(tmp_path):
    file = tmp_path / "run.h5"
    options = ("-scene_points 256 -scene_period 30 -scene_normal_maugis 3 "
               "-load_path normal_force=0.5 -archive_fields all "
               f"-continuation_stability eigenvalue -archive_file {file}").split()
    done = call("run", *options, folder=tmp_path)
    assert (done.returncode == 0
            and "stable: all eigenvalues" in done.stdout), done.stdout + done.stderr
    record = read_archive(file)
    assert (list(record["stable"]) == [1] * record.points
            and np.all(record["leading_eigenvalue"] > 0.0))
    mode = record.field("mode", record.points - 1)[0]
    assert np.abs(mode).max() == 1.0
    # It solves J x = s x on the whole cell: (s - 1) (K v) = D v beside the mean.
    scene = Scene(points=256, period=30.0, normal_maugis=3.0)
    contact = Contact(scene)
    gap = contact.ranges[0] * record.field("displacement",
                                           record.points - 1)[0] + contact.initial_gap
    tangent = np.zeros((1, 1, 256))
    contact.law.evaluate(gap[None].copy(), np.empty((1, 256)), tangent)
    stiffness = contact.operator(1, "stiffness").blocks[0, 0] * 256
    imbalance = (record["leading_eigenvalue"][-1]
                 - 1.0) * np.fft.irfft(np.fft.rfft(mode) * stiffness) - tangent[0, 0] * mode
    assert np.abs(imbalance - imbalance.mean()).max() < 0.02 * np.abs(tangent[0, 0] * mode).max()
    drawn = call("plot", file, folder=tmp_path)
    assert drawn.returncode == 0, drawn.stderr


def test_a_resumed_branch_is_as_stable():
    path = "normal_displacement=1; normal_force=-1"
    whole = followed(branch(SMALL, path, "eigenvalue"))
    made = branch(SMALL, path, "eigenvalue")
    made.history = [made.restored(made.packed(point)) for point in whole[5:9]]
    rest = followed(made)
    assert len(rest) == len(whole) - 9
    for point, other in zip(rest, whole[9:]):
        assert (point.stable, point.unstable_modes) == (other.stable, other.unstable_modes)
        assert abs(point.leading_eigenvalue - other.leading_eigenvalue) < 2.0 * ACCURATE


def test_a_rough_projection_does_not_certify_an_instability():
    """The tangent of a stiff slip front is so far from symmetric that projections of it have had an
    eigenvalue of -0.8, with this residual, where the least one is 0.07."""
    def settled(value, residual):
        defects = np.array([[residual, 0.0]])
        found = projection.Modes(np.array([value + 0j]), np.eye(1, 2), defects, np.array([True]))
        return not modes._loose({0: found}, None, 0, modes.NEUTRAL)

    assert settled(0.8, 0.21) and not settled(-0.8, 0.21)
    assert settled(-0.8, 0.01)


def test_a_wide_soft_contact_has_no_unstable_mode():
    """Long searches of its modes hold nearly dependent vectors: images told as sums of products
    cancelled, and it had two of its odd modes unstable."""
    point = next(iter(branch({"points": 2048, "normal_maugis": 0.55}, "normal_displacement=2.809",
                             "sign", start="normal_displacement=2.809")))
    assert (point.stable, point.unstable_modes) == (1, 0)


def test_points_beside_a_fold_need_no_dense_matrix(monkeypatch):
    """However slowly a mode that is nearly neutral settles."""
    monkeypatch.setattr(modes, "_all_modes", None)
    scene = Scene(points=8192, tangential_maugis=0.1, residual_friction=0.8)
    load = Load(start="normal_displacement=2.809", path="normal_force=0.8; "
                "normal_displacement=hold, tangential_displacement=45", stop="pull_off")
    points = list(Branch(scene, load, Steps(initial_step=(0.5, 1.5), largest_step=(1.0, 1.5),
                                            type="arclength", stability="sign")))
    assert any(point.event == "fold" for point in points)
    assert all(point.stable >= 0 for point in points)


@pytest.mark.parametrize("spots, pitch, points, maugis, counts", ((2, 9.0, 112, 2.5, {0, 1}),
                                                                  (3, 12.0, 252, 2.0, {0, 2})))
def test_a_mode_that_softens_in_one_step_is_found(spots, pitch, points, maugis, counts):
    """Valleys between equal spots, which are closed at first: every eigenvalue is 1 and more at one
    point, and one of each mirror image's, or of one alone, below 0 at the next."""
    scene = Scene(geometry="flat", points=points, period=pitch * spots, normal_maugis=maugis,
                  height=20.0)
    branch = Branch(scene, Load(start="normal_displacement=2", path="normal_displacement=-4"),
                    Steps(stability="sign"),
                    geometry=lambda x: 1.5 * (1 - np.cos(2 * np.pi * x / pitch)))
    found = [point for point in takewhile(lambda point: point.load[0] > 1.1, branch)
             if not point.event]
    expected = [np.sum(Cell(branch.contact, point).eigenvalues().real < -NEUTRAL)
                for point in found]
    assert [point.unstable_modes for point in found] == expected and set(expected) == counts


def test_modes_of_a_nearly_even_state_do_not_mix_symmetries():
    """A solve next to a neutral mode leaves a state even to less than modes are accurate to. One of
    two mirror images leaves this one as it is: J may not tie what is even to what is odd."""
    made = Branch(Scene(dimension=2, geometry="flat", points=(24, 16), period=(16.0, 10.7),
                        normal_maugis=1.5),
                  Load(start="normal_displacement=-0.5", path="normal_displacement=-0.5"),
                  geometry=lambda x, y: 2.0 - np.cos(np.pi * x / 4.0)
                  - np.cos(2.0 * np.pi * y / 10.7))
    point, random = next(iter(made)), np.random.default_rng(0)
    field = made.contact.extended(point.state)
    uneven = 4e-7 * random.uniform(-1.0, 1.0, field.shape)
    uneven += 1e-3 * np.sin(2.0 * np.pi * np.arange(16) / 16.0)
    window = made.contact.grid.whole
    state = State(window, (field + uneven).reshape(1, -1), point.state.means)
    stability = Stability(made.corrector, "eigenvalue")
    stability.modes(replace(point, state=state))
    (axis,), window = symmetries(made.contact, state), state.window
    operator = Overdamped(made.contact, window, point.controls)
    operator.linearise(evened(state, [axis]))
    vector = random.standard_normal(window.size)

    def mirror(vector):
        return mirrored(window, vector[None], *axis)[0]

    np.testing.assert_allclose(operator.apply(mirror(vector)), mirror(operator.apply(vector)),
                               atol=1e-11)


FLATS = {
    "waves": ({"points": 48, "period": 7.165048459874749, "poisson": 0.45,
               "normal_maugis": 1.199778481191915, "tangential_maugis": 0.8458118698848589,
               "height": float("inf")}, "normal_displacement=0.0014",
              "normal_displacement=-3.09; normal_displacement=0.0014", 1.0),
    "the mean": ({"points": 32, "period": 16.233, "poisson": 0.3, "normal_maugis": 0.8,
                  "tangential_maugis": 1.9, "height": 4.0},
                 "normal_displacement=0.18", "normal_displacement=-4.47", 3.0)}


@pytest.mark.parametrize("kernels", ("auto", "off"))
@pytest.mark.parametrize("name", FLATS)
def test_leading_eigenvalues_of_flats_are_those_of_the_dense_balance(name, kernels):
    """Where the law acts everywhere alike many modes have nearly one eigenvalue: at a gap of one
    range any vector is a mode, and Krylov vectors hardly differ. (An eigenvalue of 1 is told of
    stiffer ones.)"""
    scene, start, path, step = FLATS[name]
    made = Branch(Scene(geometry="flat", law="xu_needleman", **scene), Load(start=start, path=path),
                  Steps(stability="eigenvalue", initial_step=step, largest_step=step),
                  Form(kernels=kernels))
    for point in made:
        expected = min(1.0, Cell(made.contact, point).eigenvalues()[0].real)
        assert point.leading_eigenvalue.real == pytest.approx(expected, abs=2e-3)


def test_modes_of_two_symmetries_that_lose_their_stability_at_once_are_both_counted():
    """Waves of a flat come in pairs, one even and one odd, which both symmetries may miss."""
    scene = Scene(geometry="flat", points=44, period=26.62779626357976, poisson=0.3, law="dugdale",
                  normal_maugis=1.232545857334401, tangential_maugis=0.5566276020415379,
                  residual_friction=0.38194014799688764, height=float("inf"), dugdale_width=0.5,
                  body="coated", coating_normal=0.6028657323892129, coating_tangential=0.1)
    made = Branch(scene, Load(start="normal_displacement=-1.2", path="normal_displacement=-1.36"),
                  Steps(stability="sign", initial_step=0.05, largest_step=0.05))
    counts = []
    for point in made:
        if point.event is None:
            values = Cell(made.contact, point).eigenvalues().real
            assert point.unstable_modes == np.sum(values < -NEUTRAL)
            counts.append(point.unstable_modes)
    assert point.position == 1.0 and max(counts) >= 6


@pytest.mark.parametrize("scene, start, path, most", [
    # next to nothing acts on what is held by the layer alone
    ({"points": 64, "period": 10.0, "height": 3.0, "normal_maugis": 1.0, "law": "dugdale",
      "dugdale_width": 0.2, "work_ratio": 0.5},
     "normal_displacement=-2.248", "normal_displacement=-2", 0.25),
    # a mean that begins to move, and one that a law without friction at a distance lets go
    ({"points": 128, "period": 6.0, "normal_maugis": 1.0, "tangential_maugis": 0.3,
      "tangential": "on", "law": "dugdale", "dugdale_width": 0.2},
     "normal_displacement=0.761", "normal_force=1", 0.35),
    ({"points": 96, "period": 16.0, "poisson": 0.3, "height": 1.0, "normal_maugis": 1.0,
      "tangential_maugis": 2.0, "law": "mcgarry", "work_ratio": 2.0},
     "normal_displacement=-2.5", "normal_displacement=-3.1", 0.91)])
def test_modes_of_the_body_as_a_whole_are_among_the_leading_ones(scene, start, path, most):
    """They are as the preconditioner foretells, so that runs from noise do not tell them apart."""
    made = branch(scene, path, "eigenvalue", start)
    for point in made:
        least = Cell(made.contact, point).eigenvalues()[0].real
        assert point.leading_eigenvalue.real == pytest.approx(least, abs=ACCURATE)
    assert least < most
