"""One mode among hundreds of spots: a hill that snaps alone is seen by steps and certificates, at
less than the modes of everything."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes import Branch, Load, Scene  # noqa: E402
from contactsnes.contact import states  # noqa: E402
from contactsnes.continuation.bracketing import BracketingSteps  # noqa: E402
from contactsnes.continuation.points import Leg, NotConverged  # noqa: E402
from contactsnes.continuation.predictors import PREDICTORS  # noqa: E402
from contactsnes.dynamics import jumps  # noqa: E402
from contactsnes.scene.settings import Steps  # noqa: E402

POINTS, PERIOD, PITCH, SLOPE = 256, 48.0, 3.0, 6.0
HILL, RADIUS, LOW = (17.0, 30.0), 4.0, 2.0
START, END = 0.7, 1.2
BEHIND = 0.89  # the hill snaps at 0.8983


def heights(planted=True):
    """256 steep spots of unequal heights, which come into contact smoothly, and in the place of a
    few of them a flatter hill, which is sticky."""
    x, wave = np.arange(POINTS) * PERIOD / POINTS, 2 * np.pi / PITCH
    found = SLOPE / wave * (np.cos(wave * x)[:, None] + np.cos(wave * x))
    phases = np.random.default_rng(3)
    for rows in range(1, 6):
        for columns in range(-5, 6):
            found = found + 0.05 * np.cos(2 * np.pi / PERIOD * (rows * x[:, None] + columns * x)
                                          + phases.uniform(0, 2 * np.pi))
    weight = planted * np.exp(-(distance() / RADIUS) ** 4)
    return found * (1 - weight) + weight * (2 * SLOPE / wave - LOW - 0.25 * distance() ** 2)


def distance():
    """Of each node from the hill."""
    x = np.arange(POINTS) * PERIOD / POINTS
    away = [(x - place + PERIOD / 2) % PERIOD - PERIOD / 2 for place in HILL]
    return np.hypot(away[0][:, None], away[1])


def branch_of(file, start=START, end=END, planted=True, **steps):
    """The branch that is pressed."""
    np.save(file, heights(planted))
    scene = Scene(dimension=2, geometry="file", geometry_file=str(file), points=POINTS,
                  period=PERIOD, normal_maugis=2.0)
    return Branch(scene, Load(start=f"normal_displacement={start}",
                              path=f"normal_displacement={end}"), steps=Steps(**steps))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where heights are kept."""
    return tmp_path_factory.mktemp("hill")


@pytest.fixture(scope="module")
def pressed(folder):
    """The branch in long steps, and its points."""
    branch = branch_of(folder / "pressed.npy", initial_step=0.1, largest_step=0.1)
    return branch, list(branch)


@pytest.fixture(scope="module")
def traced(folder):
    """A branch that is traced beyond the hill's fold, well away from it, and its points."""
    branch = branch_of(folder / "traced.npy", start=0.88, end=0.95, at_fold="trace",
                       initial_step=0.02, largest_step=0.04)
    points = []
    for point in branch:
        points.append(point)
        if any(kept.event == "fold" for kept in points) and point.displacements[0] < BEHIND:
            return branch, points
    pytest.fail("the branch was not traced")


def whole(branch, state):
    """Normal displacement of a state on the cell."""
    return branch.contact.extended(state)[0]


def test_without_the_hill_nothing_snaps(folder):
    branch = branch_of(folder / "plain.npy", planted=False, initial_step=0.1, largest_step=0.1)
    assert {point.event for point in branch} <= {None, ""}


def test_the_hill_snaps_alone(pressed):
    """Steps of 0.1 see it, and what motion of everything with inertia says is the same."""
    branch, points = pressed
    fold, jump = (next(point for point in points if point.event == name)
                  for name in ("fold", "jump"))
    assert [point.event for point in points].count("jump") == 1
    moved = np.abs(whole(branch, jump.state) - whole(branch, fold.state)) > 0.3
    assert moved.any() and distance()[moved].max() < 1.5 * RADIUS and moved.mean() < 0.04
    beyond = fold.load * (1 + fold.fold_precision)
    ahead = jumps.by_inertia(branch.corrector, fold.state, fold.controls, beyond, "here")
    back = branch.corrector.solve(ahead.state, fold.controls, fold.load, 200)
    assert states.missed(branch.contact, jump.state, back.state, largest=True) < 1e-4


def test_a_step_that_ends_beyond_the_fold_is_refused(pressed, monkeypatch):
    """A solve that happens to end where the hill has snapped, though all nodes move little on
    average."""
    branch, points = pressed
    number = next(number for number, point in enumerate(points) if point.event == "fold")
    jump = points[number + 1]
    history = [(point.load[0], point) for point in points[number - 3:number]]
    leg = Leg(1, ("displacement",), np.zeros(1), np.ones(1), 0, 0.1, 0.1, 1e-6)
    steps = BracketingSteps(branch.corrector, leg, history, PREDICTORS["edge"], "jump")
    target = float(jump.load[0])
    straight = steps._step(target, PREDICTORS["edge"])
    assert states.missed(branch.contact, straight.state, jump.state) < 0.5
    monkeypatch.setattr(branch.corrector, "solve", lambda *_: jump)
    with pytest.raises(NotConverged, match="another branch"):
        steps._step(target, PREDICTORS["edge"])


def test_certificates_see_its_mode(traced):
    """On the part behind the fold: one mode, on the hill; none before."""
    branch, points = traced
    examiner, counter = branch.corrector.examiner, branch.contact.grid.counter
    assert examiner(points[0]).unstable_modes == 0
    spent, modes = counter.weighed, examiner.modes(points[-1], None)
    assert modes.unstable == 1 and counter.weighed - spent < 1000
    field = np.abs(mode_of(branch, modes))
    assert np.sum(field[distance() < 1.5 * RADIUS] ** 2) > 0.9 * np.sum(field ** 2)


def test_motion_leaves_that_part_to_either_side(traced):
    """What the certificate says, by motion alone: from the hill's sides to two states."""
    branch, points = traced
    point = points[-1]
    mode = mode_of(branch, branch.corrector.examiner.modes(point, None))
    mode *= np.sign(mode.flat[np.argmax(np.abs(mode))]) / np.abs(mode).max()
    ends = []
    for side in (-0.2, 0.2):
        state = states.State(point.state.window, point.state.displacement
                             + side * point.state.window.take(mode)[None], point.state.means)
        ends.append(jumps.by_inertia(branch.corrector, state, point.controls, point.load, "here"))
    for end in ends:
        assert states.missed(branch.contact, point.state, end.state, largest=True) > 0.3
    assert states.missed(branch.contact, ends[0].state, ends[1].state, largest=True) > 1.0


@pytest.mark.parametrize("side", [-0.05, 0.05])
def test_linear_solves_that_lead_onto_it_tell(traced, side):
    """Newton's method leads from beside that part onto it, and its linear systems tell of the one
    mode, without any eigenvalue."""
    branch, points = traced
    point, system = points[-1], branch.corrector
    hill = side * np.exp(-(distance() / RADIUS) ** 2)
    state = states.State(point.state.window, point.state.displacement
                         + point.state.window.take(hill)[None], point.state.means)
    found = system.solve(state, point.controls, point.load, 200)
    assert states.missed(branch.contact, found.state, point.state, largest=True) < 1e-4
    assert found.softest < 0.0
    assert system.solve(points[0].state, points[0].controls, points[0].load + 0.003).softest > 0.0


def mode_of(branch, modes):
    """The first of some modes on the cell."""
    mode = branch.corrector.examiner._operator.state(modes.vectors[0].real)
    field = np.zeros(branch.contact.grid.shape)
    mode.window.put(mode.displacement[0], field)
    return field
