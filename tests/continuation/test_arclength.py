"""Arc length on contacts: folds against independent values, lengths that know no grid, what a
traced branch costs, bad input."""

from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import petsc4py
import pytest
from scipy.special import erf, expit

petsc4py.init([])

from test_continuation import Problem, System, curve, path  # noqa: E402
from test_continuation import followed as solved

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.contact import observables, states  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.contact.problem import DISPLACEMENT, Contact  # noqa: E402
from contactsnes.contact.state import State  # noqa: E402
from contactsnes.continuation.arc_steps import PACE  # noqa: E402
from contactsnes.continuation.arclength import ArcLengthSteps  # noqa: E402
from contactsnes.continuation.folds import FoldSearch  # noqa: E402
from contactsnes.continuation.limit_points import BracketEnd, LimitPoint  # noqa: E402
from contactsnes.continuation.points import Leg, NoEquilibrium, NotConverged  # noqa: E402
from contactsnes.continuation.predictors import PREDICTORS  # noqa: E402
from contactsnes.kernels.choice import chosen  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402

SOFT = {"points": 256, "period": 30.0, "normal_maugis": 2.0}
SHEARED = {"points": 512, "period": 30.0, "normal_maugis": 3.0, "tangential_maugis": 1.5,
           "residual_friction": 0.0, "height": 100.0}


def followed(scene, start, path, form=None, **steps):
    """Branch, points and what ended it (None: its own end)."""
    branch = Branch(Scene(**scene), Load(start=start, path=path),
                    Steps(**{"type": "arclength", "at_fold": "trace", **steps}), form or Form())
    points, error = [], None
    try:
        points.extend(branch)
    except NoEquilibrium as found:
        error = found
    return branch, points, error


def folds(points):
    return [point for point in points if point.event == "fold"]


def dense_fold(scene, guess, load):
    """D at the fold of a normal contact nearby, by Newton's method on [F, J w, |w|^2 - 1] with
    dense matrices.

    v + C t(a + v) + lambda D = 0 with the body's compliance 2/|q|, lambda^2 scaled, from its
    Fourier sum (Moore and Spence 1980).
    """
    count = scene["points"]
    period = scene["period"]
    maugis = scene["normal_maugis"]
    x = (np.arange(count) - count // 2) * period / count
    wave = 2 * np.pi * np.fft.rfftfreq(count, period / count)
    kernel = np.fft.irfft(np.append(0.0, 2.0 * maugis ** 2 / wave[1:]), count)
    compliance = kernel[(np.arange(count)[:, None] - np.arange(count)) % count]
    v, gap = guess.copy(), maugis * 0.5 * x ** 2
    mode = np.linalg.svd(np.eye(count) + compliance * ((1 - gap - v) * np.exp(-gap - v)))[2][-1]
    for _ in range(12):
        a = gap + v
        slope, bend = (1 - a) * np.exp(-a), (a - 2) * np.exp(-a)
        jacobian = np.eye(count) + compliance * slope
        residual = np.concatenate([v + compliance @ (a * np.exp(-a)) + maugis * load,
                                   jacobian @ mode, [mode @ mode - 1]])
        matrix = np.block([[jacobian, np.zeros((count, count)), np.full((count, 1), maugis)],
                           [compliance * (bend * mode), jacobian, np.zeros((count, 1))],
                           [np.zeros((1, count)), 2 * mode[None], np.zeros((1, 1))]])
        step = np.linalg.solve(matrix, residual)
        v = v - step[:count]
        mode = mode - step[count:-1]
        load = load - step[-1]
    assert np.linalg.norm(step) < 1e-9
    return load, v, mode


# Folds


def test_folds_are_those_of_an_extended_system(options):
    """Pull-off and jump-in under a displacement: load to 1e-9, null vector, on a small grid, by
    dense matrices."""
    options(snes_atol="1e-10")
    branch, points, error = followed(SOFT, "normal_displacement=0", "normal_displacement=-4")
    assert error is None and [point.fold_kind for point in folds(points)] == ["pull_off", "jump_in"]
    for fold in folds(points):
        state = branch.contact.extended(fold.state)[0]
        load, v, mode = dense_fold(SOFT, state + 1e-3 * np.cos(np.linspace(0.0, 3.0, state.size)),
                                   fold.load[0] + 1e-3)
        assert fold.load[0] == pytest.approx(load, rel=1e-9)
        np.testing.assert_allclose(state, v, atol=1e-4)
        tangent, = fold.tangents
        found, expected = (vector / np.linalg.norm(vector)
                           for vector in (tangent.state.displacement[0],
                                          tangent.state.window.take(mode)))
        assert abs(found @ expected) == pytest.approx(1.0, abs=1e-6)


def test_folds_converge_to_johnson_kendall_and_roberts():
    """Force at pull-off with the force held, and displacement with the displacement held: nearer at
    a shorter range."""
    missed = []
    for maugis, count in ((2.0, 512), (5.0, 2048)):
        scene = {"points": count, "period": 100.0, "normal_maugis": maugis}
        held = followed(scene, "normal_displacement=1", "normal_force=-3",
                        at_fold="stop")[1][-1].forces[0]
        moved = followed(scene, "normal_displacement=1", "normal_displacement=-5",
                         at_fold="stop")[1][-1].displacements[0]
        missed.append([abs(held + 1.743883), abs(moved + 4.1136)])
    assert (np.all(np.array(missed[1]) < 0.25 * np.array(missed[0])) and missed[1][0] < 0.02
            and missed[1][1] < 0.04)


@pytest.mark.parametrize("path", ["normal_displacement=-5", "normal_force=-3",
                                  "normal_force=1; tangential_displacement=150",
                                  "normal_force=1; tangential_force=8"])
def test_null_vectors_are_annihilated(options, path):
    """J v = 0 at a fold with one tangent; at one in a corner, two tangents of loads that rise and
    fall."""
    options(snes_atol="1e-10")
    branch, points, _ = followed(SHEARED, "normal_displacement=1", path, at_fold="stop")
    fold = points[-1]
    assert fold.event == "fold" and fold.fold_kind == ("sliding" if "tangential" in path
                                                       else "pull_off")
    if len(fold.tangents) == 2:
        before, after = fold.tangents
        assert before.rate > 0.0 > after.rate
        return
    tangent, = fold.tangents
    form = DisplacementForm(branch.contact, tangent.state.window, fold.controls)
    form.set_load(fold.load)
    form.linearise(form.pack(states.onto(fold.state, form.window), fold.state.means[form.forced]))
    vector = form.pack(tangent.state.displacement, tangent.state.means[form.forced])
    assert np.linalg.norm(form.apply_jacobian(vector, np.empty(form.size))) < 1e-3 * np.linalg.norm(
        vector)
    assert abs(tangent.rate) < 1e-4


def test_null_vectors_are_kept_with_fields():
    """Beside displacement and traction, where no mode was looked for: the mode that stability finds
    at the fold."""
    found = []
    for stability in ("off", "eigenvalue"):
        branch, points, _ = followed(SOFT, "normal_displacement=0", "normal_displacement=-4",
                                     at_fold="stop", stability=stability)
        fields = [observables.Measurement(branch.contact, point).fields()
                  for point in (points[-2], points[-1])]
        assert branch.steps.keeps_modes and len(fields[0]) == (2 if stability == "off" else 3)
        row = observables.observe(branch.contact, points[-1])
        assert row["fold_tangents"] == 1 and 0.0 < row["fold_precision"] <= 1e-8
        assert branch.restored(branch.packed(points[-1])).fold_precision == row["fold_precision"]
        found.append(fields[1][2])
    np.testing.assert_allclose(found[0], found[1], atol=1e-3)


def test_a_sheared_fold_does_not_depend_on_steps():
    """Through corners of the law: the same load from long and short steps."""
    loads = [folds(followed(SHEARED, "normal_displacement=1",
                            "normal_force=1; tangential_displacement=150", at_fold="stop",
                            largest_step=step)[1])[0].load[1] for step in (3.0, 12.0)]
    assert loads[0] == pytest.approx(loads[1], rel=2e-8)


# Lengths and steps


def test_steps_know_neither_grid_nor_window():
    """The same places along the branch on two grids, and on the whole cell."""
    places = []
    for count, window in ((256, "auto"), (512, "auto"), (256, "off")):
        _, points, _ = followed({**SOFT, "points": count}, "normal_displacement=2",
                                "normal_displacement=-2", Form(window=window))
        assert folds(points) == []
        places.append([point.position for point in points])
    for other in places[1:]:
        assert len(other) == len(places[0])
        # A solve that takes an iteration more or less changes the next step by a tenth.
        np.testing.assert_allclose(other, places[0], atol=1e-2)


def test_chords_measure_the_law():
    """Length and row of a way are those on any window that holds what the law acts on, and on any
    grid."""
    found = []
    for count in (256, 512):
        contact = Contact(Scene(**{**SOFT, "points": count}))
        first, last = (states.undeformed(contact, (DISPLACEMENT,), [depth]) for depth in (1.0, 1.3))
        for wide in (20.0, 60.0):
            window = contact.grid.whole if wide > 50 else contact.window(contact.initial_gap - wide)
            row, length = states.chord(contact, first, last, window)
            way = states.onto(last, window) - states.onto(first, window)
            assert np.sum(row * way) == pytest.approx(length, rel=1e-12)
            here = State(window, states.onto(last, window), last.means)
            assert states.chord_length(contact, first, here) == pytest.approx(length, rel=1e-12)
            found.append(length)
    assert found[1] == pytest.approx(found[0], rel=1e-12)
    assert found[2] == pytest.approx(found[0], rel=0.03)


def test_a_way_off_the_flat_has_a_length():
    """Where the law acts on no node, of all of them, by either kernels."""
    for kernels in (None, chosen(False)):
        contact = Contact(Scene(**SOFT), kernels=kernels)
        away = states.apart(contact)
        farther = State(away.window, away.displacement + 3.0, away.means + 3.0)
        row, length = states.chord(contact, away, farther, away.window)
        assert length == pytest.approx(3.0, rel=1e-12)
        assert states.chord_length(contact, away, farther) == pytest.approx(3.0, rel=1e-12)
        assert np.sum(row * 3.0) == pytest.approx(3.0, rel=1e-12)


@pytest.mark.parametrize("start, path", [("normal_displacement=2", "normal_displacement=-2"),
                                         ("normal_displacement=1", "normal_force=6"),
                                         ("normal_displacement=3",
                                          "normal_force=4; tangential_displacement=30")])
def test_a_traced_branch_costs_little_more_than_natural_steps(start, path):
    """Transforms of a path without folds: at most half as many again, the exact ends the same."""
    natural, traced = (followed({**SHEARED, "points": 1024}, start, path, type=kind)[1]
                       for kind in ("natural", "arclength"))
    assert folds(natural) == folds(traced) == []
    cost = [sum(point.spent["transforms"] for point in points) for points in (natural, traced)]
    assert cost[1] <= 1.5 * cost[0]
    np.testing.assert_array_equal(traced[-1].load, natural[-1].load)
    np.testing.assert_allclose(traced[-1].forces, natural[-1].forces, rtol=1e-6, atol=1e-9)


def test_quantities_that_move_together_end_exactly():
    path = "normal_force=3,tangential_displacement=20; normal_force=5,tangential_force=1"
    _, points, error = followed(SHEARED, "normal_displacement=2", path)
    assert error is None and points[-1].load.tolist() == [5.0, 1.0]
    middle, = [point for point in points if point.leg == 1 and point.position == 1.0]
    assert middle.load.tolist() == [3.0, 20.0]


def test_legs_that_only_switch_controls_add_no_point():
    path = "normal_force=hold; normal_displacement=hold; normal_displacement=1.5"
    _, points, error = followed(SOFT, "normal_displacement=1", path)
    assert error is None and {point.leg for point in points} == {0, 3} and points[-1].load[0] == 1.5


# Ends


@pytest.mark.parametrize("kind", ["natural", "arclength"])
def test_a_trace_is_resumed_at_any_of_its_points(kind):
    """From what an archive keeps of the last four points, the fold itself and the points behind it
    included."""
    branch, points, _ = followed(SOFT, "normal_displacement=0", "normal_displacement=-4", type=kind)
    first = [point.event for point in points].index("fold")
    for cut in (first, first + 1, first + 2, len(points) - 2):
        again = Branch(branch.scene, branch.load, branch.steps, Form(),
                       history=[branch.restored(branch.packed(point))
                                for point in points[max(cut - 4, 0):cut]])
        whole = points[:cut] + list(again)
        assert whole[-1].load[0] == -4.0
        assert [point.load[0] for point in folds(whole)] == pytest.approx([point.load[0]
                                                                           for point in folds(
            points)], rel=1e-8)


def test_a_body_that_is_pulled_off_by_force_leaves():
    """Pull-off, then the unstable branch to where the law ends: its points stay, and there is no
    equilibrium."""
    branch, points, error = followed(SOFT, "normal_displacement=1", "normal_force=-3")
    assert isinstance(error, NoEquilibrium) and ("left the range of the law" in str(error)
                                                 or "came back" in str(error))
    assert [point.event for point in points if point.event] == ["fold", "pull_off"]
    assert abs(points[-1].forces[0]) < 0.2


def test_gross_sliding_is_located():
    """The last node slips at that very load: to a part of its range that is as small as the
    load's."""
    branch, points, _ = followed(SHEARED, "normal_displacement=1",
                                 "normal_force=1; tangential_displacement=150")
    sliding, = [point for point in points if point.event == "gross_sliding"]
    assert sliding.sliding and 0.0 <= branch.corrector.margin(sliding, "gross_sliding") < 1e-6
    slip = observables.observe(branch.contact, sliding)["maximum_tangential_gap"]
    assert slip * 1.5 > np.sqrt(0.5)


def test_a_load_that_stands_still_turns_nowhere():
    """The whole contact slides at its residual friction: what the load still changes by is
    rounding, whatever its sign."""
    scene = {"points": 96, "period": 60.0, "normal_maugis": 0.759, "geometry": "rough",
             "poisson": 0.5, "rough_slope": 0.224, "rough_shortest": 5.0, "rough_hurst": 0.8,
             "rough_seed": 349, "residual_friction": 0.5, "tangential_maugis": 0.2}
    steps = {"type": "natural", "predictor": "tangent", "initial_step": (3.65467, 1.09333),
             "largest_step": (3.65467, 1.09333)}
    _, points, error = followed(scene, "normal_displacement=-0.5",
                                "normal_displacement=2.241; tangential_force=0.82", **steps)
    assert isinstance(error, NoEquilibrium) and "slides without end" in str(error)
    assert abs(points[-1].forces[1] / points[-3].forces[1] - 1.0) < 1e-7
    assert [point.event for point in points if point.event] == ["fold", "gross_sliding"]


def test_a_first_step_along_the_arc_passes_no_fold():
    """The contact spreads over the cell at -0.3365; long steps of the load fail, and nothing tells
    how long one along the arc may be."""
    scene = {"points": 192, "period": 60.0, "normal_maugis": 1.2, "geometry": "sinusoid",
             "height": 48.8, "amplitude": 0.413}
    branch = Branch(Scene(**scene), Load(start="normal_displacement=-0.5",
                                         path="normal_displacement=3.497"),
                    Steps(type="arclength", initial_step=0.99925, largest_step=0.99925))
    found = [(point.event, point.load[0]) for point in branch if point.event]
    assert ([event for event, _ in found] == ["fold", "jump"]
            and found[0][1] == pytest.approx(-0.336494, abs=1e-5))


def test_nothing_infinite_is_followed():
    branch, points, _ = followed(SOFT, "normal_displacement=0", "normal_displacement=-0.2")
    leg = Leg(1, ("displacement",), np.zeros(1), np.array([-0.2]), 0, 1 / 40, 1 / 20, 1e-6)
    steps = ArcLengthSteps(branch.corrector, leg, [(0.0, points[0])], PREDICTORS["edge"], "trace")
    steps.history = [(0.5, replace(point, position=0.5)) for point in points[:2]]
    assert np.isfinite(steps._pace ** 2)
    lost = replace(points[1].state, displacement=np.full_like(points[1].state.displacement, np.inf))
    for solve in (lambda: branch.corrector.solve(lost, points[1].controls, points[1].load),
                  lambda: branch.corrector.solve_arc((points[0].state, points[1].state), 0.1, lost,
                                                     0.5, steps.leg)):
        with pytest.raises(NotConverged, match="its start holds NaN or infinite"):
            solve()


@pytest.mark.parametrize("steps", [{"type": "arclength"}, {"type": "natural", "at_fold": "trace"}])
def test_methods_without_a_tangent_are_refused(options, steps):
    options(snes_type="ngmres")
    with pytest.raises(InputError, match="no tangent"):
        Branch(Scene(**SOFT), Load(start="normal_displacement=1", path="normal_displacement=2"),
               Steps(**steps), Form())


@pytest.mark.parametrize("heading", [1.0, -1.0])
@pytest.mark.parametrize("back, turns", [(0.2, True), (-0.2, True), (-0.6, False)])
def test_two_folds_in_a_step_are_seen_from_its_ends(heading, back, turns):
    """On position = s^3 - back s, from -1 to 1, which leads on at both ends; what nearly turns may
    do so."""
    def bracket_end(place):
        point = SimpleNamespace(position=heading * (place ** 3 - back * place))
        return BracketEnd(place, point, SimpleNamespace(rate=heading * (3.0 * place ** 2 - back)))

    limit = LimitPoint.__new__(LimitPoint)
    limit.left, limit.right = bracket_end(-1.0), bracket_end(1.0)
    assert limit.turns_between(heading) is turns


@pytest.mark.parametrize("heading", [1.0, -1.0])
@pytest.mark.parametrize("noise", [1e-12, -1e-12])
def test_beyond_a_fold_its_own_slope_decides_nothing(heading, noise):
    """From the fold at 0 of heading (s^2 - 2 s^3 / 3) the load goes on as it heads, and turns at
    1."""
    def direction(point, chord, leg):
        place = point.position
        return SimpleNamespace(rate=heading * (2.0 * place - 2.0 * place ** 2)
                               + (noise if place == 0.0 else 0.0))

    system = SimpleNamespace(chord_length=lambda first, last: 1.5, direction=direction)
    before, beyond = (SimpleNamespace(state=None, position=place) for place in (0.0, 1.5))
    limit = LimitPoint(system, None, before, beyond, heading)
    assert limit.sign == heading and limit.bracketed


@pytest.mark.parametrize("back", [1e-2, 1e-3])
def test_two_folds_near_each_other_are_found(back):
    """load = u^3 - back u turns at -sqrt(back/3) and its opposite, much nearer to each other than
    steps are long."""
    problem = Problem(lambda x, load: x ** 3 - back * x - load, lambda x,
                      load: np.array([[3.0 * x[0] ** 2 - back]]), lambda x, load: np.array([-1.0]))
    points, error = solved(path(System(problem), (-1.0, 1.0), (-1.1,), stepper=ArcLengthSteps,
                                at_fold="trace"))
    found = [point.state[0] for point in points if point.event == "fold"]
    assert error is None and found == pytest.approx([-np.sqrt(back / 3.0), np.sqrt(back / 3.0)],
                                                    rel=1e-3)


def points_of(back, *unknowns):
    """As `points_on`, of load = u^3 - back u."""
    return points_on(lambda u: u ** 3 - back * u, lambda u: 3.0 * u ** 2 - back, unknowns)


def points_on(load, slope, unknowns):
    """System, leg, and [(position, point), ...] of load(u) at some u."""
    system = System(curve(load, slope))
    leg = Leg(1, ("displacement",), np.array([-1.5]), np.array([1.5]), 0, 0.1, 0.1, 1e-6)
    points = [system.solve([u], leg.controls, np.array([load(u)])) for u in unknowns]
    return system, leg, [(place, point.changed(leg=1, position=place)) for point in points
                         for place in ((point.load[0] + 1.5) / 3.0,)]


@pytest.mark.parametrize("slope, found", [(0.8, True), (300.0, False)])
def test_a_slope_that_grows_within_the_bracket_tells_of_no_fold(slope, found, monkeypatch):
    """Where branches meet the slope of the load grows, and turns by chance: of load = -u^2, with a
    search whose next two points are said to have slopes of their own."""
    system, leg, points = points_on(lambda u: -u ** 2, lambda u: -2.0 * u, (-0.5, 0.4))
    limit = LimitPoint(system, leg, points[0][1], points[1][1])
    slopes, really = iter((slope, -1e-12)), limit._point_at

    def at(place, tight):
        end = really(place, tight)
        rate = next(slopes, None)
        return end if rate is None else end._replace(direction=replace(end.direction, rate=rate))

    monkeypatch.setattr(limit, "_point_at", at)
    with (nullcontext() if found else pytest.raises(NotConverged, match="branches meet")):
        assert limit.locate().event == "fold"


def test_a_first_step_is_no_longer_than_tells_of_two_folds():
    """Of load that falls from -0.04 to 0.04 in a step from -0.5 to 0.5, no slope at its ends tells:
    3 and 1."""
    system, leg, points = points_on(
        lambda u: u - 0.04 * np.logaddexp(0.0, -50.0 * (u + 0.4))
        - 0.0375 * np.sqrt(np.pi) * erf(20.0 * u),
        lambda u: 1.0 + 2.0 * expit(-50.0 * (u + 0.4)) - 1.5 * np.exp(-400.0 * u ** 2),
        (-0.501, -0.5, -0.3, 0.5))
    steps = ArcLengthSteps(system, leg, points[:1], PREDICTORS["edge"], "trace")
    steps._restart()
    steps.history = points[:2]
    with pytest.raises(NotConverged, match="much less than where this first step begins"):
        steps._fold_before(points[3][1])
    assert steps._fold_before(points[2][1]) == (None, False)


def test_a_step_from_next_to_a_fold_is_asked_for_two():
    """Its mean is larger than that of the short step to there, as where the branch leads straight
    on."""
    system, leg, points = points_of(0.01, -1.1, -0.2, -0.058, 0.3)
    steps = ArcLengthSteps(system, leg, points[:1], PREDICTORS["edge"], "trace")
    steps._restart()
    steps.history = points[:2]
    assert steps._fold_before(points[2][1]) == (None, False)
    steps.history = points[1:3]
    with pytest.raises(NotConverged, match="turns more than once"):
        steps._fold_before(points[3][1])


@pytest.mark.parametrize("back, more", [(0.01, True), (-0.01, False)])
def test_a_search_that_finds_the_load_risen_asks_whether_it_has_turned_twice(back, more):
    system, leg, points = points_of(back, -0.2, -0.07, 0.12)
    search = FoldSearch(system, leg, points[:2])
    if more:
        with pytest.raises(NotConverged, match="turns more than once"):
            search._locate(points)
    else:
        fold, beyond, trail = search._locate(points)
        assert fold is beyond is None and trail[:3] == points


def test_what_the_position_counts_follows_the_points():
    asked = []

    def length(first, last):
        asked.append((first, last))
        return abs(last - first)

    steps = object.__new__(ArcLengthSteps)
    steps.system = SimpleNamespace(chord_length=length)
    steps.history = [(place, SimpleNamespace(state=state, position=place))
                     for place, state in ((0.0, 0.0), (0.25, 3.0), (0.5, 5.0))]
    for _ in range(3):
        assert steps._pace == pytest.approx(PACE * 5.0 / 0.5)
    assert len(asked) == 2  # lengths are taken once
    steps.history = [*steps.history[1:], (0.6, SimpleNamespace(state=9.0, position=0.6))]
    assert steps._pace == pytest.approx(PACE * 6.0 / 0.35)
    steps.history[-2:] = steps.history[-2:][::-1]
    assert steps._pace == pytest.approx(PACE * 10.0 / 0.45)


def test_a_fold_next_to_an_event_is_met():
    """The body loses its last contact a millionth of the leg before the fold: the place of the
    event hid that the branch turns back in that step."""
    scene = {"points": 106, "period": 21.80762318759686, "normal_maugis": 1.9667202247093578,
             "height": float("inf")}
    found = [followed(scene, "normal_displacement=0.3", "normal_displacement=-5.023", type=kind)
             for kind in ("natural", "arclength")]
    folds, others = ([point.position for point in points if point.event == "fold"]
                     for _, points, _ in found)
    assert len(folds) == 2 and others == pytest.approx(folds, abs=1e-8)
    events = [point.event for point in found[1][1] if point.event]
    assert events == ["fold", "pull_off", "fold"]


@pytest.mark.parametrize("held", ["", "normal_force=hold; "])
@pytest.mark.parametrize("kind", ["natural", "arclength"])
def test_a_branch_ends_where_slip_has_taken_the_law(kind, held):
    """Surfaces that slipped so far that nothing pulls any more are not followed through noise."""
    scene = {"points": 16, "period": 5.0, "normal_maugis": 2.0, "geometry": "flat", "height": 50.0,
             "poisson": 0.283, "tangential_maugis": 0.713, "residual_friction": 0.0}
    path = f"{held}tangential_displacement=95.9; normal_force=-0.45"
    _, points, error = followed(scene, "normal_displacement=0.775", path, type=kind)
    assert isinstance(error, NoEquilibrium) and "slip has taken" in str(error)
    assert len(points) < 150 and abs(points[-1].forces[0]) < 1e-8


@pytest.mark.parametrize("at_fold", ["jump", "trace"])
def test_an_attraction_that_ends_is_a_fold_for_steps_of_any_length(at_fold):
    """Off the flat a growing force leads out of the law's range: there the body jumps in, or its
    trace ends."""
    reached = []
    for kind, size in (("natural", 0.1), ("arclength", 0.5), ("arclength", 0.02)):
        _, points, error = followed(SOFT, "normal_displacement=-3", "normal_force=0.1", type=kind,
                                    at_fold=at_fold, initial_step=size, largest_step=size)
        told = [(point.event, point.fold_kind) for point in points if point.event]
        assert told[0] == ("fold", "jump_in") and folds(points)[0].load[0] == pytest.approx(
            0.0, abs=1e-12)
        if at_fold == "trace":
            assert len(told) == 1 and "left the range of the law" in str(error)
        else:
            assert error is None and points[-1].load[0] == 0.1
            reached.append(points[-1].displacements[0])
    np.testing.assert_allclose(reached, reached[:1] * len(reached), rtol=1e-7)


@pytest.mark.parametrize("method", [
    {"snes_type": "newtontrdc"},
    {"ksp_type": "richardson", "ksp_norm_type": "none", "ksp_max_it": "5"}])
def test_folds_lie_where_they_do_however_the_linear_solves_of_a_method_end(options, method):
    """A trust region, or a number of iterations, is no accuracy of the branch's direction."""
    def loads():
        points, _ = solved(Branch(Scene(points=128, period=20.0, normal_maugis=3.0, height=20.0),
                                  Load("normal_displacement=1", "normal_displacement=-4"),
                                  Steps(at_fold="trace", stability="sign")))
        return [point.load[0] for point in folds(points)]

    usual = loads()
    options(**method)
    found = loads()
    assert len(usual) == 2 and found == pytest.approx(usual[:len(found)], rel=1e-8)
