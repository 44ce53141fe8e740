"""Steps stay on their branch: the same folds, jumps and energies whatever their size is."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from contactsnes import Branch, Load, Scene, Steps
from contactsnes.contact import combining
from contactsnes.contact.acceptance import detached, doubtful, strayed
from contactsnes.contact.problem import Contact
from contactsnes.contact.states import State
from contactsnes.scene.settings import Form

HALF_SPACE = {"points": 512, "period": 30.0, "height": inf, "normal_maugis": 2.0}
LAYER = {"points": 1024, "period": 40.0, "normal_maugis": 3.0}
APPROACHES = {"half-space": (HALF_SPACE, -5.115, 0.216, {}),
              "layer": (LAYER, -4.5, 1.0, {"window": "off"})}
STICKY = {**LAYER, "height": 50.0, "tangential_maugis": 2.0, "residual_friction": 0.3}
SMOOTH = {"points": 256, "period": 20.0, "height": 20.0, "normal_maugis": 1.0,
          "tangential_maugis": 1.0, "residual_friction": 0.0}


def walked(scene, path, first, largest, start=None, form=None, **steps):
    """The points of a path in steps of given sizes, one a leg."""
    steps = Steps(initial_step=first, largest_step=largest, **steps)
    return list(Branch(Scene(**scene), Load(start=start, path=path), steps, form))


def kinds(points):
    """Names of the folds and jumps among points."""
    found = [(point.event, point.fold_kind) for point in points]
    return [names for names in found if names[0] in ("fold", "jump")]


def folds(points):
    """Loads of the folds among points, array (folds, components)."""
    return np.array([point.load for point in points if point.event == "fold"])


def losses(points):
    """What each jump among points dissipates."""
    return np.diff([0.0] + [point.dissipated_work for point in points if point.event == "jump"])


@pytest.mark.parametrize("case", APPROACHES)
def test_steps_of_any_size_and_predictor_meet_the_same_jump(case):
    """A body that comes near jumps into contact; what it loses balances the works of its loads."""
    scene, start, end, form = APPROACHES[case]
    runs = [walked(scene, f"normal_displacement={end}", size / 40.0 * (end - start),
                   size / 20.0 * (end - start), f"normal_displacement={start}", Form(**form),
                   predictor=predictor) for size, predictor in ((1.0, "edge"), (10.0, "edge"),
                                                                (4.0, "tangent"), (2.0, "none"))]
    for points in runs:
        assert kinds(points) == [("fold", "jump_in"), ("jump", "")]
        np.testing.assert_allclose(folds(points), folds(runs[0]), rtol=1e-8)
        assert losses(points) == pytest.approx(losses(runs[0]), rel=1e-5)
        assert abs(points[-1].energy_imbalance) < 0.1 * points[-1].dissipated_work


def test_the_search_for_a_fold_passes_none():
    """Next to the softest law that jumps, where two folds are 0.003 apart on ways of 8, in steps of
    the whole way and small ones."""
    scene = {**HALF_SPACE, "points": 256, "normal_maugis": 1.5}
    path = "normal_displacement=0.7; normal_displacement=-8"
    runs = [walked(scene, path, sizes, sizes, "normal_displacement=-7")
            for sizes in ((7.7, 8.7), (0.4, 0.4))]
    for points in runs:
        assert kinds(points) == [("fold", "jump_in"), ("jump", ""), ("fold", "pull_off"),
                                 ("jump", "")]
        np.testing.assert_allclose(folds(points), folds(runs[0]), rtol=1e-8)
        np.testing.assert_allclose(losses(points), losses(runs[0]), rtol=1e-3)


NEIGHBOURS = {1.69: (-2.328162098, -2.327660358), 1.72: (-2.325368946, -2.318713966)}
"""Normal Maugis parameter -> loads of two folds, found with steps of 0.0002 and residuals of
1e-13."""


@pytest.mark.parametrize("maugis, begin, form, step, steps", [
    (1.69, "normal_force=2.114", "force", None, {"predictor": "secant"}),
    (1.69, "normal_displacement=3.25", "displacement", 0.2025, {"predictor": "edge"}),
    (1.69, "normal_displacement=3.25", "displacement", 0.2025, {"predictor": "secant"}),
    (1.69, "normal_displacement=3.25", "force", 0.81, {"predictor": "edge"}),
    (1.69, "normal_displacement=3.25", "displacement", 0.81, {"type": "arclength"}),
    (1.69, "normal_displacement=3.25", "force", 0.81, {"type": "arclength", "predictor": "secant"}),
    (1.72, "normal_displacement=3.25", "displacement", 0.2025, {"predictor": "none"}),
    (1.72, "normal_displacement=3.25", "displacement", 0.81, {"predictor": "none"})])
def test_a_trace_finds_both_of_two_folds_near_each_other(maugis, begin, form, step, steps):
    """They are 0.0005 and 0.007 apart, on a way of 8."""
    scene = {**HALF_SPACE, "points": 128, "period": 20.37, "normal_maugis": maugis}
    points = walked(scene, "normal_displacement=-4.87", step, step and 2.0 * step, begin,
                    Form(form=form, window="off"), at_fold="trace", **steps)
    assert kinds(points) == [("fold", "pull_off"), ("fold", "jump_in")]
    np.testing.assert_allclose(folds(points)[:, 0], NEIGHBOURS[maugis], rtol=1e-8)


@pytest.mark.parametrize("form, step", [
    ("displacement", 0.704), pytest.param("force", 0.704, marks=pytest.mark.study),
    ("displacement", 0.2), pytest.param("force", 0.2, marks=pytest.mark.study)])
def test_a_trace_passes_nearly_broken_bifurcations_on_its_branch(form, step, tmp_path):
    """Two spots that are nearly the same, of which one makes contact first: the branch on which it
    is the other one is near.

    The folds are those of steps of 0.005; long steps came upon two more, of the other branch.
    """
    x = 2.0 * np.pi * np.arange(-64, 64) / 128
    waves = ((1, 1.07596378, 0.00257), (2, 0.454303575, 3.35e-6), (4, 0.18402526, 0.00106))
    np.save(tmp_path / "two.npy", sum(height * np.cos(number * x + phase)
                                      for number, height, phase in waves))
    scene = {"points": 128, "period": 60.0, "height": inf, "normal_maugis": 0.847,
             "geometry": "file", "poisson": 0.0, "geometry_file": str(tmp_path / "two.npy"),
             "residual_friction": 0.52, "tangential_maugis": 0.166, "tangential": "on"}
    points = walked(scene, "normal_displacement=2.316", step, step, "normal_displacement=-0.5",
                    Form(form=form), at_fold="trace")
    assert kinds(points) == [("fold", "jump_in"), ("fold", "pull_off")]
    np.testing.assert_allclose(folds(points)[:, 0], (0.0668412, 0.058641), rtol=2e-6)


@pytest.mark.parametrize("step, stability", [
    (0.4, "off"), pytest.param(0.2, "eigenvalue", marks=pytest.mark.study)])
def test_two_modes_that_change_in_a_long_step_are_a_fold_that_it_passed(step, stability, tmp_path):
    """Three spots that are nearly the same, pulled off full contact: a step ended where two modes
    are unstable, and the path went on there to another fold and another jump."""
    x = 2.0 * np.pi * np.arange(-80, 80) / 160
    np.save(tmp_path / "three.npy",
            0.8 * np.cos(3 * x) + 0.05 * np.cos(x) - 0.02 * np.sin(2 * x))
    scene = {"points": 160, "period": 24.0, "height": inf, "normal_maugis": 2.0,
             "geometry": "file", "geometry_file": str(tmp_path / "three.npy")}
    long, short = (walked(scene, "normal_displacement=-0.8", size, size, "normal_displacement=1",
                          stability=stability) for size in (step, 0.1))
    assert kinds(long) == kinds(short) == [("fold", "pull_off"), ("jump", "")] * 2
    np.testing.assert_allclose(folds(long), folds(short), rtol=1e-7)
    np.testing.assert_allclose(losses(long), losses(short), rtol=1e-6)


# Points, period, height, Maugis parameter; waves; start, end; steps; load of the first fold.
BUMPS = {
    "a small jump on a step foretold well": (
        (160, 25.468, 5.0, 2.1946), (3, 0.24805, 0.03157, 0.31, 0.030394, 4.8765),
        (-0.3, 0.0), (0.1, 0.05), -0.111),
    "the other side of a pitchfork that is nearly one": (
        (160, 13.6414, 20.0, 2.2399), (2, 1.29185, 0.00338, 3.06533, 0.01816, 0.88753),
        (1.6806, -3.6806), (0.02,), 0.39479),
    "a fold next to which a spot is born": (
        (192, 17.663, inf, 1.7856), (3, 1.24825, 0.031171, 1.067, 0.0076005, 1.18046),
        (-2.0, -1.88), (0.1, 0.02), -1.90253),
    "three small jumps on a leg's first step, from where a mode is hardly stable": (
        (160, 18.6352, 5.0, 1.98753), (3, 0.94228, 0.000214877, 3.20436, 0.0, 0.0),
        (-1.6857, -1.0), (0.4, 0.1), -1.66567),
}


@pytest.mark.parametrize("case", BUMPS)
def test_nearly_equal_bumps_meet_the_same_fold_in_steps_of_any_size(case, tmp_path):
    """Steps passed it, or led to the branch of another bump, or ended before it: edges of a contact
    that is just born led searches across the branch."""
    (points, period, height, maugis), waves, (start, end), steps, load = BUMPS[case]
    x = 2.0 * np.pi * np.arange(-points // 2, points // 2) / points
    count, high, first, turned, second, aside = waves
    np.save(tmp_path / "bumps.npy", high * np.cos(count * x) + first * np.cos(x + turned)
            + second * np.cos(2.0 * x + aside))
    scene = {"points": points, "period": period, "height": height, "normal_maugis": maugis,
             "geometry": "file", "geometry_file": str(tmp_path / "bumps.npy")}
    for step in steps:
        found = walked(scene, f"normal_displacement={end}", step, step,
                       f"normal_displacement={start}", at_fold="stop")
        np.testing.assert_allclose(folds(found)[0, 0], load, atol=2e-5)


def test_a_branch_next_to_a_fold_is_found_though_motion_from_beyond_it_leads_back(tmp_path):
    """Two bumps that are the same to 1e-8: beside their nearly broken pitchfork the branch that
    goes on is 0.05 ranges away, and kicks of a tenth and more led back, which ended the path."""
    x = 2.0 * np.pi * np.arange(-64, 64) / 128
    np.save(tmp_path / "two.npy", 0.7193921 * np.cos(2 * x) + 1.08e-8 * np.cos(x + 0.886715))
    scene = {"points": 128, "period": 15.9997, "height": 20.0, "normal_maugis": 2.267914,
             "geometry": "file", "geometry_file": str(tmp_path / "two.npy")}
    points = walked(scene, "normal_displacement=0.43", 0.4, 0.4, "normal_displacement=0.38")
    assert kinds(points) == [("fold", "jump_in"), ("jump", "")] and points[-1].position == 1.0
    np.testing.assert_allclose(folds(points)[:, 0], 0.421016, atol=2e-6)


def test_bumps_that_are_pulled_off_without_slip_do_not_go_on_unstable(tmp_path):
    """The grid resolves states that do not slip, but not all that this law has: unstable modes were
    counted nowhere, and steps of any size followed states in which two were. The folds are where
    dense matrices and implicit motion have them."""
    x = 2.0 * np.pi * np.arange(-64, 64) / 128
    np.save(tmp_path / "three.npy", 0.56196475 * np.cos(3 * x) + 0.00092226 * np.cos(x - 0.64929)
            + 0.0033489 * np.cos(2 * x + 0.88198))
    scene = {"points": 128, "period": 23.2414, "height": 20.0, "normal_maugis": 1.33215,
             "tangential_maugis": 1.509306, "law": "xu_needleman", "xu_needleman_r": 0.3,
             "geometry": "file", "geometry_file": str(tmp_path / "three.npy")}
    points = walked(scene, "normal_displacement=-2.2", 0.4, 0.4, "normal_displacement=0.21523")
    assert kinds(points) == [("fold", "pull_off"), ("jump", "")] * 2
    np.testing.assert_allclose(folds(points)[:, 0], (-0.6024, -2.0818), atol=2e-4)


def test_a_step_that_begins_next_to_a_fold_does_not_pass_it():
    """A point 2e-7 before the fold, from which the load rises by 0.01 to the next one, is where two
    folds near each other hide."""
    scene = {"points": 192, "period": 38.343, "height": 50.0, "geometry": "sinusoid",
             "amplitude": 0.599, "normal_maugis": 1.54, "tangential_maugis": 0.574,
             "residual_friction": 0.5}
    runs = [walked(scene, "normal_displacement=0.429", step, step, "normal_displacement=-0.5", form,
                   type="arclength", predictor="secant")
            for step, form in ((0.4645, Form(first="relaxation")), (0.1, None))]
    for points in runs:
        assert kinds(points) == [("fold", "jump_in"), ("jump", "")]
        np.testing.assert_allclose(folds(points), folds(runs[-1]), rtol=1e-8)


@pytest.mark.parametrize("scene, way, first, largest, steps", [
    (STICKY, 80, (0.06, 2.0, 4.0), (0.6, 16.0, 32.0), {}),
    (SMOOTH, 50, (0.25, 5.0, 10.0), (0.5, 10.0, 20.0), {"type": "arclength"})])
def test_sliding_back_sticks_again_however_long_the_steps(scene, way, first, largest, steps):
    """The law knows no direction: where sliding sets in on the way back mirrors where it did
    there."""
    path = f"normal_force=2; tangential_displacement={way}; tangential_displacement={-way}"
    points = walked(scene, path, first, largest, **steps)
    assert kinds(points) == [("fold", "sliding"), ("jump", "")] * 3
    ahead, back, behind = folds(points)[:, 1]
    assert behind == pytest.approx(-ahead, rel=1e-7) and 0.0 < back < ahead
    there, stuck, again = losses(points)
    assert again == pytest.approx(there, rel=1e-3) and stuck > 0.0


def uniform(contact, gap, slip=0.0):
    """The state on the whole cell with a normal gap, for all nodes or each, and a uniform slip, in
    ranges."""
    fields = np.array([gap - contact.initial_gap, np.full(contact.grid.size, slip)])
    return State(contact.grid.whole, fields, np.zeros(2))


def aside(state, node, by):
    """The state with one node's normal displacement changed."""
    fields = state.displacement.copy()
    fields[0, node] += by
    return replace(state, displacement=fields)


@pytest.fixture(scope="module")
def contact():
    return Contact(Scene(points=256, period=20.0, normal_maugis=1.0))


def test_one_node_that_jumps_is_seen_among_many(contact):
    last, found = uniform(contact, 1.0), uniform(contact, 0.5)
    assert strayed(contact, found, last, found) < 0.0
    assert strayed(contact, aside(found, 3, 0.6), last, found) > 0.0
    # Beyond the law's reach nodes are free.
    apart = aside(found, 3, 20.0)
    assert strayed(contact, aside(apart, 3, 0.6), last, apart) < 0.0


def test_a_long_way_excuses_no_jump(contact):
    """Sliding by 30 ranges, a body may not end four from where it is predicted, nor stick on the
    way."""
    last, found = uniform(contact, 0.5, slip=-40.0), uniform(contact, 0.5, slip=-10.0)
    assert strayed(contact, found, last, found) < 0.0
    assert strayed(contact, uniform(contact, 0.5, slip=-14.0), last, found) > 0.0
    beyond = uniform(contact, 0.5, slip=10.0)
    assert strayed(contact, beyond, last, beyond) > 0.0
    far = uniform(contact, 8.0, slip=10.0)
    assert strayed(contact, far, uniform(contact, 8.0, slip=-10.0), far) < 0.0


def test_energy_released_on_the_way_tells_of_a_jump(contact):
    """From one side of a softening law to the other the body lets go of energy; where the law
    stiffens it does not."""
    guess = uniform(contact, 0.6)
    apart, near, pressed = (uniform(contact, gap) for gap in (3.0, 0.0, -1.0))
    assert doubtful(contact, guess, apart, near)
    # A prediction may lead beyond the jump by chance.
    assert doubtful(contact, near, apart, near)
    assert not doubtful(contact, uniform(contact, -0.6), near, pressed)
    # The branch behind a jump leads back by what the load moves it only.
    far, close = uniform(contact, 2.0), uniform(contact, 1.0)
    assert doubtful(contact, close, far, close)
    assert detached(contact, close, far, close, uniform(contact, 1.2))
    assert not detached(contact, close, far, close, uniform(contact, 1.9))
    assert detached(contact, near, apart, near, uniform(contact, 2.8))


def test_a_small_part_of_a_contact_that_snaps_is_seen():
    """The last gap of a shallow wave closes by a jump that loses little beside what the whole
    contact holds."""
    wave = {"points": 128, "period": 52.923, "normal_maugis": 1.31, "geometry": "sinusoid",
            "amplitude": 0.313, "gap_offset": 0.63}
    for size in (1.063, 4.25):
        points = walked(wave, "normal_displacement=0.5", size, size, "normal_displacement=-2.29")
        assert kinds(points) == [("fold", "jump_in"), ("jump", "")]
        np.testing.assert_allclose(folds(points), [[0.2576874]], rtol=1e-6)
        assert losses(points) == pytest.approx([0.0315073], rel=1e-4)


def test_a_first_step_that_closes_the_last_pocket_is_seen_to_jump():
    """It ends where its prediction has it, and loses 0.005 of what the loads do; the branch behind
    it does not lead back. It opens again by a jump, too."""
    scene = {"points": 256, "period": 4.604, "height": 2.11, "normal_maugis": 4.2,
             "geometry": "rough", "rough_slope": 0.953, "rough_shortest": 0.144,
             "rough_hurst": 0.3, "rough_seed": 17}
    for size in (0.03, 1.0):
        points = walked(scene, "normal_force=0.123461; normal_force=-0.7", size, size,
                        "normal_displacement=0.790093")
        assert kinds(points) == [("fold", "jump_in"), ("jump", ""), ("fold", "pull_off"),
                                 ("jump", "")]
        np.testing.assert_allclose(folds(points)[:, 0], [-0.529797, -0.590322], rtol=1e-5)
        assert losses(points) == pytest.approx([0.00152523, 0.00204805], rel=1e-4)


@pytest.mark.parametrize("predictor, first", [("edge", "none"), ("none", "relaxation")])
def test_a_jump_of_a_quarter_range_is_not_stepped_over(predictor, first):
    """Edges that a coarse grid pins: their folds, whatever steps end beside them, and what relaxes
    goes over."""
    scene = {"points": 96, "period": 16.0, "normal_maugis": 3.0, "tangential_maugis": 3.0,
             "height": inf, "poisson": 0.3, "work_ratio": 0.5, "residual_friction": 0.2}
    points = walked(scene, "tangential_displacement=1.9", 0.02, 0.02,
                    "normal_displacement=0.5, tangential_displacement=1.4", Form(first=first),
                    predictor=predictor)
    np.testing.assert_allclose(folds(points)[:, 1], [1.56585, 1.74267], atol=1e-5)


def test_what_ends_off_its_prediction_by_much_of_a_steps_way_is_adrift():
    corrector = Branch(Scene(points=256, period=20.0, normal_maugis=1.0),
                       Load("normal_displacement=1", "normal_displacement=2")).corrector
    last, found = (uniform(corrector.contact, gap) for gap in (1.0, 0.7))
    for by, way, adrift in ((0.1, 0.0, False), (0.3, 0.0, True), (0.3, 1.5, False)):
        start = last if not way else uniform(corrector.contact, 0.7 + way)
        assert corrector.adrift(aside(found, 3, by), start, found) is adrift


@pytest.mark.parametrize("kind", ["arclength", "natural"])
def test_a_body_off_the_flat_lets_go_along_the_arc_too(kind):
    points = walked({**LAYER, "points": 256, "period": 30.0}, "normal_force=0.5", 1.0, 1.0,
                    "normal_displacement=-3", type=kind)
    fold = next(point for point in points if point.event == "fold")
    assert fold.load[0] == fold.forces[0] == 0.0 and points[-1].load[0] == 0.5


def test_a_contact_is_not_made_or_lost_in_one_step():
    """A shallow wave under a thick layer, in steps as long as the leg: the tangent foretells the
    body off the flat."""
    wave = {"points": 128, "period": 12.0, "normal_maugis": 2.0, "geometry": "sinusoid",
            "amplitude": 0.2}
    for ends in ((1.0, -4.0), (-4.0, 1.0)):
        runs = [walked(wave, f"normal_displacement={ends[1]}", size, size,
                       f"normal_displacement={ends[0]}", predictor=predictor)
                for size, predictor in ((20.0, "secant"), (20.0, "none"), (0.1, "edge"))]
        assert kinds(runs[2])[0][0] == "fold"
        for points in runs[:2]:
            assert kinds(points) == kinds(runs[2])
            np.testing.assert_allclose(folds(points), folds(runs[2]), rtol=1e-7)


def test_a_first_step_that_would_lead_too_far_does_not_fail():
    """From contact at no force, where short-ranged adhesion makes the first step long."""
    said = []
    scene = Scene(points=8192, residual_friction=0.5)
    points = list(Branch(scene, Load(path="normal_force=2"),
                         Steps(initial_step=0.638, largest_step=1.3), log=said.append))
    assert not [sentence for sentence in said if "failed" in sentence]
    assert points[-1].load[0] == 2.0 and 0.0 < points[1].position < 0.5


def test_a_jump_is_met_too_where_the_grid_is_coarse_for_slip_that_does_not_come(tmp_path):
    """Hills that come into contact in a layer that couples directions: shorter steps tell where."""
    places, heights = 2.0 * np.pi * np.arange(128) / 128, tmp_path / "hills.npy"
    np.save(heights, 0.09 * np.cos(places - 0.42) + 0.08 * np.cos(2 * places - 2.32)
            + 0.73 * np.cos(3 * places + 0.02) + 0.14 * np.cos(4 * places + 1.29))
    scene = {"points": 128, "period": 16.0, "height": 20.0, "normal_maugis": 2.0,
             "tangential_maugis": 3.0, "residual_friction": 0.2, "geometry": "file",
             "geometry_file": str(heights)}
    start, length = -1.22, 1.86
    coarse, fine = (walked(scene, "normal_displacement=0.64", 0.5 * length / most, length / most,
                           f"normal_displacement={start}", at_fold="stop")[-1]
                    for most in (20.0, 400.0))
    assert coarse.event == fine.event == "fold"
    assert coarse.load[0] == pytest.approx(fine.load[0], rel=1e-8)


def test_a_bracket_holds_the_fold_of_a_body_that_is_sheared_through_a_soft_layer():
    """Motion under the load at the bracket's end begins with the contact's own slip, not with that
    of the body's top, which would have it slide before its fold."""
    scene = Scene(points=216, period=12.0, normal_maugis=2.0, tangential_maugis=2.0,
                  residual_friction=0.1)
    load = Load(path="normal_displacement=1.2; tangential_displacement=7780", stop="gross_sliding")
    located, bracketed = (
        next(point for point in Branch(scene, load, Steps(locate_folds=locate))
             if point.event == "fold") for locate in (True, False))
    before, limit = bracketed.load[1], located.load[1]
    assert before <= limit <= before * (1.0 + bracketed.fold_precision)


@pytest.mark.parametrize("values", [
    dict(points=256, period=40.0, normal_maugis=0.3),
    dict(points=32, period=16.0, normal_maugis=0.7, dimension=2, geometry="sphere")])
def test_a_contact_of_a_long_range_that_vanishes_is_foretold(values, monkeypatch):
    """Its edges move ever faster: followed, they would lead to where no solve ends, and step after
    step would be refused."""
    load, counts = Load(path="normal_displacement=2; normal_displacement=-12"), []
    for steep in (combining.STEEP, inf):
        monkeypatch.setattr(combining, "STEEP", steep)
        said = []
        points = list(Branch(Scene(**values, height=inf), load, log=said.append))
        assert [point.event for point in points if point.event] == ["pull_off"]
        counts.append(sum("failed" in sentence for sentence in said))
    assert counts[0] == 0 and counts[1] > 2
