"""States: starts without overlap, change of window, extrapolation, and the prediction that follows
the contact edge."""

import numpy as np
import pytest

from contactsnes import Branch, Load
from contactsnes.contact import edges as following
from contactsnes.contact import fronts, nearing, states
from contactsnes.contact.combining import combined
from contactsnes.contact.problem import DISPLACEMENT, FORCE, Contact
from contactsnes.contact.state import PART, Former, Mirrored, below, everywhere, lightest
from contactsnes.continuation.points import lagrange_weights
from contactsnes.grid.active import some
from contactsnes.grid.even import EvenWindow, halved
from contactsnes.grid.windows import Window
from contactsnes.interface.laws import Law
from contactsnes.kernels.choice import chosen
from contactsnes.scene.settings import Scene, Steps

POINTS = 512
PERIOD = 40.0
MAUGIS = 3.0


def line(**changes):
    return Contact(Scene(**{"points": POINTS, "period": PERIOD, "normal_maugis": MAUGIS,
                            "tangential_maugis": 2.0, **changes}))


def plane(**changes):
    return Contact(Scene(**{"dimension": 2, "points": (48, 32), "period": (18.0, 15.0),
                            "normal_maugis": 2.0, "geometry": "sphere", **changes}))


def shaped(gap):
    """A line contact whose initial gap (u_n,r) over the cell is the given one, but for a
    constant."""
    return Contact(Scene(points=len(gap), period=PERIOD, normal_maugis=MAUGIS, geometry="file",
                         geometry_file="gap.npy"), -gap)


def with_gap(contact, window, gap):
    """The state of a window with the given normal gap (delta_n) at its nodes."""
    displacement = (gap - window.take(contact.initial_gap))[None]
    return states.State(window, displacement, np.array([contact.grid.mean(displacement[0])]))


def parabola(contact, window, half, centre=0.0, opening=30.0):
    """A gap that crosses the threshold at half the width ``half`` (beta) from its centre."""
    x = window.coordinates()[0] - centre
    return with_gap(contact, window, contact.scene.contact_threshold
                    + opening * ((x / half) ** 2 - 1.0))


@pytest.mark.parametrize("nodes", [0, 1, 2 * PART + 3])
def test_nodes_below_a_level(nodes):
    """Of none, of few, and of more than are looked at together."""
    displacement, gap = np.random.default_rng(nodes).normal(size=(2, nodes))
    assert np.array_equal(below(displacement, gap, 0.3), displacement + gap < 0.3)


# States on several windows


def windows(contact, kind):
    """Three windows of one kind, none of which has all nodes of the others."""
    box = contact.grid.box
    if kind == "line":
        return [box([200], [90]), box([250], [80]), box([180], [50])]
    if kind == "nodes":
        chosen = np.random.default_rng(3).random((3, contact.grid.size)) < 0.3
        return [some(contact.grid.whole, np.flatnonzero(one)) for one in chosen]
    boxes = [box([24 - a, 16 - b], [2 * a + 1, 2 * b + 1]) for a, b in ((9, 3), (4, 6), (2, 2))]
    return [halved(one) for one in boxes] if kind == "halves" else boxes


@pytest.mark.parametrize("kind", ["line", "boxes", "nodes", "halves"])
def test_every_node_of_several_windows_counts_once(kind):
    contact = line() if kind == "line" else plane()
    field = np.cos(np.sqrt(1.0 + contact.initial_gap))  # even about the apex
    nodes, union = windows(contact, kind), np.zeros(contact.grid.shape, dtype=bool)
    found = []
    for own in nodes:
        values = own.take(field)[None]
        found.append(Mirrored.of(own, values, np.zeros(1)) if own.even
                     else states.State(own, values, np.zeros(1)))
        found[-1].window.put(np.ones((1, found[-1].window.size), dtype=bool), union[None])
    sums, counted = np.zeros(2), 0
    for grid, own, known, mask in everywhere(contact, found):
        (values,) = known[nodes.index(own)]
        assert np.array_equal(values, own.take(field))
        counts = np.ones(own.size) if mask is None else mask.astype(float)
        sums += grid.sum(np.array([counts, counts * values]))
        counted += 1
    assert counted == (2 if kind in ("boxes", "halves") else 3)
    assert sums == pytest.approx([union.sum(), field[union].sum()])


# The start without overlap


@pytest.mark.parametrize("contact", [line(), line(geometry="sinusoid"), line(gap_offset=2.0),
                                     plane()], ids=["cylinder", "sinusoid", "offset", "sphere"])
@pytest.mark.parametrize("approach", [0.3, 4.0, 15.0])
def test_undeformed_start_has_the_approach_and_no_overlap(contact, approach):
    state = states.undeformed(contact, (DISPLACEMENT,), [approach])
    gap = states.normal_gap(contact, state)
    assert state.window.is_whole
    assert -np.mean(state.displacement[0]) == pytest.approx(approach * contact.ranges[0], rel=1e-6)
    np.testing.assert_allclose(state.means, [-approach * contact.ranges[0]], rtol=1e-6)
    assert gap.min() >= -1e-9
    # Where it does not touch the surface is flat, and nowhere lower than there.
    depth = -state.displacement[0].min()
    assert np.all((np.abs(gap) < 1e-9) | (np.abs(state.displacement[0] + depth) < 1e-9))


def test_undeformed_start_off_the_flat_is_plane():
    contact = line()
    state = states.undeformed(contact, (DISPLACEMENT,), [-2.0])
    np.testing.assert_allclose(state.displacement, 2.0 * MAUGIS, rtol=1e-12)


def test_undeformed_start_never_overlaps_however_deep():
    """An approach deeper than the whole gap: the start is closed, not overlapping."""
    contact = line(geometry="sinusoid", amplitude=1.0)
    gap = states.normal_gap(contact, states.undeformed(contact, (DISPLACEMENT,), [50.0]))
    assert np.abs(gap).max() < 1e-9


def carried(contact, state):
    """Normal force that the flat carries where it touches, w_n,r: the traction that bends the body,
    by NumPy's FFT."""
    stiffness = contact.operator(1, "stiffness").blocks[0, 0] * contact.grid.size
    traction = np.fft.irfft(stiffness * np.fft.rfft(state.displacement[0]), POINTS)
    return contact.load_factor(1)[0] * -traction[np.abs(states.normal_gap(contact, state))
                                                 < 1e-9].sum()


@pytest.mark.parametrize("controls", [(FORCE,), (FORCE, DISPLACEMENT), (FORCE, FORCE),
                                      (DISPLACEMENT, FORCE)])
@pytest.mark.parametrize("force", [4.0, 40.0])
@pytest.mark.parametrize("offset", [0.0, 5.0])
def test_undeformed_start_of_every_control(controls, force, offset):
    """Under a normal force a part of the body is flattened that carries it; tangential
    displacements are zero."""
    contact = line(gap_offset=offset)
    state = states.undeformed(contact, controls, [force, 7.0][:len(controls)])
    assert state.displacement.shape == (len(controls), POINTS)
    assert not state.displacement[1:].any()
    np.testing.assert_allclose(state.means, state.displacement.mean(axis=1), atol=1e-9)
    gap = states.normal_gap(contact, state)
    assert gap.min() > -1e-9
    assert np.all((np.abs(gap) < 1e-9)
                  | (np.abs(state.displacement[0] - state.displacement[0].min()) < 1e-9))
    if controls[0] == FORCE:
        # Nodes touch one by one; a node more or less is several per cent.
        assert carried(contact, state) == pytest.approx(force, rel=0.2)


def test_undeformed_start_under_a_pull_touches_at_a_point():
    contact = line()
    state = states.undeformed(contact, (FORCE,), [-3.0])
    assert np.ptp(state.displacement) == 0.0 and states.normal_gap(contact, state).min() == 0.0


@pytest.mark.parametrize("height, slip, left", ((20.0, 0.0, 1.0), (60.0, 0.0, 5.0),
                                                (60.0, 2.4, 3.0), (60.0, 9.0, -nearing.OVERLAP)))
def test_lowered_is_moved_as_a_whole(height, slip, left):
    """... until it feels the law, which slip may hide, if it comes from out of its range; until it
    touches, if slip has left but repulsion."""
    contact, rng = line(), np.random.default_rng(1)
    window = contact.grid.whole
    field = rng.normal(size=(2, POINTS))
    field += np.array([[height], [slip]]) - field.mean(axis=1, keepdims=True)
    lowered = nearing.within_range(contact, states.State(window, field, contact.grid.mean(field)))
    assert states.normal_gap(contact, lowered).min() == pytest.approx(left, abs=1e-12)
    assert np.ptp(lowered.displacement[0] - field[0]) < 1e-9
    np.testing.assert_array_equal(lowered.displacement[1], field[1])
    np.testing.assert_allclose(lowered.means, lowered.displacement.mean(axis=1))


def test_components_are_added_as_zeros_and_left_out():
    contact = line()
    state = parabola(contact, Window(contact.grid, (200,), (112,)), 2.0)
    assert states.with_components(state, 1) is state
    sheared = states.with_components(state, 2)
    np.testing.assert_array_equal(sheared.displacement, [state.displacement[0], np.zeros(112)])
    np.testing.assert_array_equal(sheared.means, [state.means[0], 0.0])
    back = states.with_components(sheared, 1)
    np.testing.assert_array_equal(back.displacement, state.displacement)
    np.testing.assert_array_equal(back.means, state.means)


@pytest.mark.parametrize("signs", [None, ((-1,),)])
def test_components_are_added_to_half_a_state(signs):
    """What is even in all components stays known by its half: zeros are even, too."""
    contact = line()
    half = EvenWindow(Window(contact.grid, (200,), (112,)), signs)
    once = np.random.default_rng(2).normal(size=(1, half.size))
    state = Mirrored.of(half, once, np.ones(1))
    sheared = states.with_components(state, 2)
    assert (sheared.half == half) == (signs is None)
    np.testing.assert_array_equal(sheared.displacement, [state.displacement[0], np.zeros(112)])
    np.testing.assert_array_equal(sheared.means, [1.0, 0.0])
    back = states.with_components(sheared, 1)
    np.testing.assert_array_equal(back.displacement, state.displacement)


# Change of window


@pytest.mark.parametrize("start, extent", [(200, 100), (490, 60), (0, 40), (480, 32)])
@pytest.mark.parametrize("first, known", [(220, 50), (500, 30), (10, 20), (470, 80)])
def test_onto_keeps_known_nodes_and_takes_the_nearest_elsewhere(start, extent, first, known):
    grid = line().grid
    values = np.random.default_rng(0).normal(size=(2, known))
    found = states.onto(states.State(Window(grid, (first,), (known,)), values, np.zeros(2)),
                        Window(grid, (start,), (extent,)))
    here = (first + np.arange(known)) % POINTS
    for node, column in zip((start + np.arange(extent)) % POINTS, found.T):
        away = np.abs((here - node + POINTS // 2) % POINTS - POINTS // 2)
        nearest = np.flatnonzero(away == away.min())
        assert any(np.array_equal(column, values[:, k]) for k in nearest)


def test_former_states_take_half_the_memory_and_miss_a_ten_millionth_of_the_way():
    """Of several before one another, too, and of no small ones, nor on another window."""
    contact, random = plane(points=160), np.random.default_rng(4)
    whole, means = contact.grid.whole, np.zeros(3)
    first = random.normal(size=(3, whole.size))
    ways = 1e-4 * random.normal(size=(2, 3, whole.size))
    given = [first, first + ways[0], first + ways[0] + ways[1]]
    oldest, older, last = (states.State(whole, field, means) for field in given)
    made = Former.of(Former.of(oldest, older), last)
    for field in (made.displacement, made.once, states.onto(made, whole)):
        np.testing.assert_allclose(field, given[0], rtol=0, atol=3e-7 * np.abs(ways).max())
    np.testing.assert_array_equal(made.normal, made.displacement[0])
    held = [kept for kept in vars(made).values() if isinstance(kept, np.ndarray)]
    assert sum(kept.nbytes for kept in held) < 0.51 * first.nbytes
    assert made.components == 3 and made.means is means and lightest(older) is older
    kept = Former.of(older, last)
    assert lightest(older) is kept and lightest(kept) is kept
    del kept
    assert lightest(older) is older
    part = Window(contact.grid, [0, 0], [150, 160])
    assert Former.of(older, states.State(part, np.zeros((3, part.size)), means)) is older
    few = [states.State(whole, field[:1], means[:1]) for field in given[:2]]
    assert Former.of(*few) is few[0]


@pytest.mark.parametrize("compiled", [True, False])
def test_former_states_are_known_by_the_next_and_combined_as_they_are(compiled):
    """The last one of a sum may be a former one itself; of a row that goes on, only the state
    behind the last one is made anew."""
    contact = Contact(plane(points=160).scene, kernels=chosen(compiled))
    random = np.random.default_rng(5)
    whole, ways = contact.grid.whole, 1e-3 * random.normal(size=(4, 3, contact.grid.size))
    given = [states.State(whole, field, field.mean(axis=1))
             for field in 1.0 + np.cumsum(ways, axis=0)]
    row = Former.row(given[:3])
    longer = Former.row([*row, given[3]])
    assert row[2] is given[2] and longer[3] is given[3] and longer[:2] == row[:2]
    assert all(isinstance(state, Former) for state in longer[:3])
    for light, plain in ((longer, given), (longer[:3], given[:3]), (longer[2:], given[2:])):
        weights = np.array([-1.0, 0.5, 2.5, -1.0])[:len(light)]
        found, expected = (combined(contact, known, weights) for known in (light, plain))
        np.testing.assert_allclose(found.displacement, expected.displacement, rtol=0, atol=3e-9)
        np.testing.assert_array_equal(found.means, expected.means)


def test_onto_in_two_dimensions_and_onto_itself():
    grid = plane().grid
    values = np.arange(6.0 * 5.0).reshape(1, 30)
    state = states.State(Window(grid, (46, 10), (6, 5)), values, np.zeros(1))
    assert states.onto(state, Window(grid, (46, 10), (6, 5))) is values
    found = states.onto(state, Window(grid, (45, 11), (4, 6))).reshape(4, 6)
    rows, columns = np.array([0, 0, 1, 2]), np.array([1, 2, 3, 4, 4, 4])
    np.testing.assert_array_equal(found, values.reshape(6, 5)[np.ix_(rows, columns)])


def test_onto_the_whole_cell_and_back():
    contact = line()
    state = parabola(contact, Window(contact.grid, (200,), (112,)), 2.0)
    whole = states.State(contact.grid.whole, states.onto(state, contact.grid.whole), state.means)
    np.testing.assert_array_equal(states.onto(whole, state.window), state.displacement)


def test_wider_reaches_further_on_either_side_and_keeps_the_middle():
    contact = line()
    for start in (200, 470, 2):
        state = parabola(contact, Window(contact.grid, (start,), (60,)), 2.0)
        wide = states.wider(state, state.window)
        assert wide.window.size == 84
        np.testing.assert_array_equal(states.onto(wide, state.window), state.displacement)
        np.testing.assert_array_equal(wide.displacement[0, :12], state.displacement[0, 0])
    whole = parabola(contact, contact.grid.whole, 2.0)
    assert states.wider(whole, whole.window).window == whole.window


def test_a_window_that_fits_is_kept():
    contact = line()
    # At the rim the gap is 2.7 + 30 (4 - 1) = 93 ranges: beyond the law, and not far beyond.
    state = parabola(contact, Window(contact.grid, (POINTS // 2 - 51,), (103,)), 2.0)
    assert Law.range < states.normal_gap(contact, state)[0] < 4 * Law.range
    assert states.fitted(contact, state) is state and states.covers(contact, state)


def test_a_window_that_is_too_small_grows():
    contact = line()
    small = Window(contact.grid, (POINTS // 2 - 20,), (41,))
    state = parabola(contact, small, 2.0, opening=4.0)
    assert not states.covers(contact, state)
    fitted = states.fitted(contact, state)
    assert fitted.window.size > small.size
    np.testing.assert_allclose(states.onto(fitted, small), state.displacement, atol=1e-9)
    outside = contact.extended(state)[0] + contact.initial_gap
    outside[fitted.window.indices] = np.inf
    assert outside.min() >= Law.range


def test_the_whole_cell_is_left_where_the_contact_is_small():
    contact = line()
    state = states.undeformed(contact, (DISPLACEMENT,), [0.1])
    fitted = states.fitted(contact, state)
    assert fitted.window.size < POINTS // 2
    np.testing.assert_array_equal(fitted.displacement,
                                  fitted.window.take(state.displacement.reshape(1, -1)))
    assert np.all(states.normal_gap(contact, state)[np.delete(np.arange(POINTS),
                                                              fitted.window.take(
        np.arange(POINTS)))] >= Law.range)
    np.testing.assert_array_equal(fitted.means, state.means)


def two_bumps(depth):
    """Parabolas at -10 and 10, the second one lower by ``depth`` (u_n,r)."""
    x = (np.arange(POINTS) - POINTS // 2) * PERIOD / POINTS
    return shaped(np.minimum((x + 10) ** 2 / 2, (x - 10) ** 2 / 2 + depth))


def test_a_second_spot_within_range_is_not_covered_and_is_taken_in():
    contact = two_bumps(depth=5.0)
    window = Window(contact.grid, (POINTS // 2 - 128 - 70,), (141,))
    state = states.State(window, np.zeros((1, 141)), np.zeros(1))
    # Fifteen ranges are left at the second spot, far more at the rim of the window around the
    # first.
    assert states.normal_gap(contact, state)[[0, -1]].min() > Law.range
    assert not states.covers(contact, state)
    far = two_bumps(depth=20.0)
    assert states.covers(far, states.State(Window(far.grid, window.start, window.shape),
                                           np.zeros((1, 141)), np.zeros(1)))


# Distances


def test_distance_and_missed():
    """Root mean squares over the window of the second, and over the nodes where the law acts on
    either."""
    contact = line()
    window = Window(contact.grid, (POINTS // 2 - 51,), (103,))
    state = parabola(contact, window, 2.0)
    moved = states.State(window, state.displacement + 0.3, state.means)
    assert states.distance(contact, state, moved) == pytest.approx(0.3)
    assert states.missed(contact, state, moved) == pytest.approx(0.3)
    gap = states.normal_gap(contact, state)
    far = states.State(window, state.displacement + 5.0 * (gap > 20.0), state.means)
    assert states.missed(contact, state, far) == 0.0 and states.distance(contact, state, far) > 1.0
    off = states.State(window, state.displacement + 100.0, state.means)
    assert states.missed(contact, off, states.State(window, off.displacement + 1.0,
                                                    off.means)) == 0.0


# Extrapolation


def test_combined_is_the_weighted_sum_on_the_last_window():
    contact = line()
    windows = [Window(contact.grid, (POINTS // 2 - n,), (2 * n + 1,)) for n in (50, 52, 55)]
    given = [parabola(contact, window, half) for window, half in zip(windows, (1.8, 1.9, 2.0))]
    weights = lagrange_weights([0.0, 1.0, 2.0], 2.2)
    found = combined(contact, given, weights)
    assert found.window == windows[-1]
    expected = sum(weight * states.onto(state, windows[-1])
                   for weight, state in zip(weights, given))
    floor = states.normal_gap(contact, given[-1]).min() - 1.0
    gap = np.maximum(expected[0] + windows[-1].take(contact.initial_gap), floor)
    np.testing.assert_allclose(states.normal_gap(contact, found), gap, atol=1e-9)
    np.testing.assert_allclose(found.means, sum(weight * state.means
                                                for weight, state in zip(weights, given)))


def test_combined_does_not_go_into_deep_overlap():
    contact = line()
    window = Window(contact.grid, (POINTS // 2 - 51,), (103,))
    given = [parabola(contact, window, 2.0, opening=opening) for opening in (10.0, 20.0)]
    found = combined(contact, given, np.array([-3.0, 4.0]))
    assert states.normal_gap(contact, found).min() == pytest.approx(states.normal_gap(contact,
                                                                                      given[
        -1]).min() - 1.0)


def profile(contact, window, left, right, components=1):
    """A state whose gap is a fixed function of the place between two contact edges (beta)."""
    x = window.coordinates()[0]
    s = 2.0 * (x - left) / (right - left) - 1.0
    state = with_gap(contact, window, contact.scene.contact_threshold + 25.0 * (s ** 2 - 1.0)
                     * (1.0 + 0.2 * s))
    if components == 1:
        return state
    field = np.array([state.displacement[0], np.exp(-s ** 2) * (1.0 + s)])
    return states.State(window, field, contact.grid.mean(field))


@pytest.mark.parametrize("components", [1, 2])
def test_following_the_edge_is_exact_for_a_profile_that_travels(components):
    """Edges that move linearly or quadratically, with different speeds: only interpolation between
    nodes is left."""
    contact = line()
    window = Window(contact.grid, (POINTS // 2 - 60,), (121,))
    for order in (1, 2):
        edges = [(-2.0 - 0.11 * s + (order - 1) * 0.01 * s * s,
                  2.2 + 0.2 * s - (order - 1) * 0.02 * s * s) for s in (0, 1, 2, 3)]
        given = [profile(contact, window, *ends, components) for ends in edges]
        weights = lagrange_weights(range(3 - order - 1, 3), 3)
        found = following.follow_edge(contact, given[2 - order:3], weights)
        near = states.normal_gap(contact, given[3]) < 0.7 * states.NEAR
        wrong = np.abs(found.displacement - given[3].displacement)[:, near].max()
        still = np.abs(combined(contact, given[2 - order:3], weights).displacement
                       - given[3].displacement)[:, near].max()
        assert wrong < 1e-3 and wrong < 0.02 * still
        np.testing.assert_allclose(found.means,
                                   weights @ [state.means for state in given[2 - order:3]])


def test_following_the_edge_converges_with_the_grid():
    wrong = []
    for points in (256, 512):
        contact = line(points=points)
        window = Window(contact.grid, (points // 2 - 15 * points // 128,),
                        (30 * points // 128 + 1,))
        given = [profile(contact, window, -2.0 - 0.13 * s, 2.0 + 0.17 * s, 2) for s in range(3)]
        found = following.follow_edge(contact, given[:2], np.array([-1.0, 2.0]))
        near = states.normal_gap(contact, given[2]) < 0.7 * states.NEAR
        wrong.append(np.abs(found.displacement - given[2].displacement)[:, near].max())
    assert wrong[1] < wrong[0] / 7


@pytest.mark.parametrize("shift", [3, 40, 60, 70, 100, 200, 240, 256, 300, 400, 470, 511])
def test_following_the_edge_does_not_depend_on_where_the_contact_lies(shift):
    """Moving everything by a number of nodes moves the prediction by as many, over the border of
    the cell, too."""
    predictions = []
    for nodes in (0, shift):
        x = (np.arange(POINTS) - POINTS // 2) * PERIOD / POINTS
        contact = shaped(np.roll(x ** 2 / 2, nodes))
        given = []
        for extent, half in ((51, 2.0), (55, 2.1), (58, 2.2)):
            centred = Window(contact.grid, (POINTS // 2 - extent,), (2 * extent + 1,))
            window = Window(contact.grid, (POINTS // 2 - extent + nodes,), (2 * extent + 1,))
            gap = contact.scene.contact_threshold + 25.0 * ((centred.coordinates()[0] / half) ** 2
                                                            - 1.0)
            given.append(with_gap(contact, window, gap))
        found = following.follow_edge(contact, given, lagrange_weights([0, 1, 2], 3))
        assert found.window == given[-1].window
        predictions.append(states.normal_gap(contact, found))
    np.testing.assert_allclose(predictions[1], predictions[0], atol=1e-9)


@pytest.mark.parametrize("reach", [46, 60, 120, POINTS // 2 - 1])
def test_small_changes_are_carried_along_with_the_edges(reach):
    """Between the edges a change is stretched with them, on a window that is hardly wider than the
    contact, too; to another window, and with its means."""
    contact = line()
    window = Window(contact.grid, (POINTS // 2 - reach,), (2 * reach + 1,))
    other = Window(contact.grid, (POINTS // 2 - 50,), (101,))
    origin, state = parabola(contact, window, 2.0), parabola(contact, other, 2.2)
    before, after = (nodes.coordinates()[0] / half for nodes, half in ((window, 2.0), (other, 2.2)))
    changes = [states.State(window, np.array([np.cos(turn * before)]), np.array([turn]))
               for turn in (1.0, 2.0)]
    within = np.abs(after) < 0.95
    for turn, found in zip((1.0, 2.0), following.carried(contact, changes, origin, state)):
        assert found.window == other and found.means == turn
        np.testing.assert_allclose(found.displacement[0, within], np.cos(turn * after)[within],
                                   atol=2e-3)


@pytest.mark.parametrize("shift, end", [(-30.0, 0), (POINTS - 2.0, -1), (POINTS + 30.0, -1)])
def test_rows_that_were_all_beyond_a_window_have_its_border(shift, end):
    """As some of several processes ask for where a contact moves far."""
    contact, kinds = line(), (chosen(), chosen(False))
    state = states.State(contact.widest, np.random.default_rng(1).normal(size=(1, POINTS)),
                         np.zeros(1))
    wanted = (state.displacement + contact.initial_gap)[0, end]
    for kernels in kinds:
        contact = Contact(contact.scene, kernels=kernels)
        found = following._stretched(contact, state, state.window, [[shift, shift + 9.0]],
                                     [[0.0, 9.0]], (slice(2, 6),))
        np.testing.assert_allclose(found, np.full((1, 4), wanted), rtol=1e-12)
        assert following._stretched(contact, state, state.window, [[0.0, 9.0]], [[0.0, 9.0]],
                                    (slice(6, 6),)).shape == (1, 0)


def test_there_is_no_edge_to_follow_off_the_flat_or_with_two_spots():
    contact = line()
    window = Window(contact.grid, (POINTS // 2 - 60,), (121,))
    x = window.coordinates()[0]
    off = with_gap(contact, window, 10.0 + x ** 2)
    two = with_gap(contact, window, (x ** 2 - 4.0) ** 2)
    touching_the_rim = with_gap(contact, window, -5.0 + x)
    good = parabola(contact, window, 2.0)
    for state in (off, two, touching_the_rim):
        assert fronts.edges(contact, state) is None
        assert following.follow_edge(contact, [good, state], np.array([-1.0, 2.0])) is None
        assert following.follow_edge(contact, [state, good], np.array([-1.0, 2.0])) is None


def test_progress_does_not_ask_for_nodes_of_one_end_alone():
    """A first point may be known on a wider window than the next one."""
    contact = line()
    wide, narrow = (Window(contact.grid, (POINTS // 2 - n,), (2 * n + 1,)) for n in (90, 50))
    for first, second in ((wide, narrow), (narrow, wide), (wide, wide)):
        begin, end = parabola(contact, first, 2.0), parabola(contact, second, 2.4)
        between = states.State(second, 0.7 * end.displacement + 0.3 * states.onto(begin, second),
                               end.means)
        for origin, ahead, part in ((begin, end, 0.7), (end, begin, 0.3)):
            assert states.progress(contact, origin, ahead, between) == pytest.approx(part, abs=1e-9)


@pytest.mark.parametrize("far", [300.0, -300.0])
def test_edges_that_would_leave_the_window_are_not_followed(far):
    """Two states near each other, of two loads that are nearly one, foretell anything."""
    contact = line()
    window = contact.grid.whole
    x = window.coordinates()[0]
    given = [with_gap(contact, window, (x - shift) ** 2 - 4.0) for shift in (0.0, 0.1)]
    assert following.follow_edge(contact, given, np.array([-1.0, 2.0])) is not None
    assert following.follow_edge(contact, given, np.array([1.0 - far, far])) is None


def spot(contact, window, places, level):
    """A state of three components that touches in an ellipse with the given first and last places
    (two directions, beta)."""
    s = [2.0 * (x - left) / (right - left) - 1.0 for x, (left, right) in zip(window.coordinates(),
                                                                             places)]
    radius = sum(scaled ** 2 for scaled in s)
    fields = [level + 12.0 * (radius - 1.0) * (1.0 + 0.1 * s[0]), np.exp(-radius) * (1.0 + s[1]),
              s[0] * np.exp(-radius)]
    fields = np.array([np.broadcast_to(field, window.shape).reshape(-1) for field in fields])
    fields[0] -= window.take(contact.initial_gap)
    return states.State(window, fields, contact.grid.mean(fields))


@pytest.mark.parametrize("boxed", [False, True])
def test_following_the_edge_in_two_dimensions(boxed):
    """An ellipse whose four ends move with different speeds, quadratically."""
    contact = Contact(Scene(dimension=2, points=(96, 128), period=(12.0, 12.0), geometry="sphere",
                            normal_maugis=2.0))
    window = Window(contact.grid, (10, 12), (76, 104)) if boxed else contact.grid.whole
    given = [spot(contact, window, [(-2.0 - 0.11 * t + 0.01 * t * t, 2.2 + 0.15 * t),
                                    (-2.5 + 0.1 * t, 2.4 - 0.12 * t - 0.01 * t * t)],
                  contact.scene.contact_threshold) for t in range(4)]
    assert np.all(np.isfinite(fronts.edges(contact, given[0])))
    weights = lagrange_weights(range(3), 3)
    found = following.follow_edge(contact, given[:3], weights)
    near = states.normal_gap(contact, given[3]) < 0.7 * states.NEAR
    wrong, still = (np.abs(state.displacement - given[3].displacement)[:, near].max()
                    for state in (found, combined(contact, given[:3], weights)))
    assert wrong < 0.01 and wrong < 0.1 * still
    np.testing.assert_allclose(found.means, weights @ [state.means for state in given[:3]])


def test_two_spots_of_a_plane_have_no_edge_to_follow():
    contact = Contact(Scene(dimension=2, points=64, period=12.0, geometry="sphere",
                            normal_maugis=2.0))
    x, y = contact.grid.coordinates()
    for gap in (np.minimum((x - 2) ** 2, (x + 2) ** 2) + y ** 2,
                np.minimum((x - 2) ** 2 + (y - 2) ** 2, (x + 2) ** 2 + (y + 2) ** 2)):
        displacement = (4.0 * gap - contact.initial_gap).reshape(1, -1)
        assert fronts.edges(contact, states.State(contact.grid.whole, displacement,
                                                     np.zeros(1))) is None


def test_what_has_an_edge_on_a_box_may_have_one_on_some_of_its_nodes(monkeypatch):
    """Random ellipses, some of them in pairs: whatever has an edge passes, and far pairs do not, of
    which nothing more is looked at."""
    contact, random = plane(points=(64, 48)), np.random.default_rng(3)
    x, y = contact.grid.coordinates()
    lone = []
    for _ in range(300):
        middle, half = random.uniform(-4.0, 4.0, (2, 2)), random.uniform(0.4, 3.0, (2, 2))
        gaps = [((x - place[0]) / size[0]) ** 2 + ((y - place[1]) / size[1]) ** 2 - 1.0
                for place, size in zip(middle, half)]
        gap = 5.0 * (gaps[0] if random.random() < 0.5 else np.minimum(*gaps))
        whole = with_gap(contact, contact.grid.whole, gap.reshape(-1)
                         + contact.scene.contact_threshold)
        nodes = some(contact.grid.whole, np.flatnonzero(gap.reshape(-1) < 4.0))
        part = states.State(nodes, nodes.take(whole.displacement.reshape(1, *gap.shape)),
                            whole.means)
        lone.append(fronts.may_be_lone(contact, part))
        assert lone[-1] or fronts.edges(contact, whole) is None
    assert 100 < sum(lone) < 250
    few = some(contact.grid.whole, np.array([3, 40]))
    touching = states.State(few, contact.scene.contact_threshold - 1.0
                            - few.take(contact.initial_gap)[None], np.zeros(1))
    assert not fronts.may_be_lone(contact, touching)
    monkeypatch.setattr(following, "onto", None)
    assert following.follow_edge(contact, [touching, touching], np.array([-1.0, 2.0])) is None
    # one of many places touches, and what is around it is not all that comes near
    gap = np.where(x ** 2 + y ** 2 < 1.0, -1.0, np.cos(8.0 * x) + np.cos(8.0 * y) + 1.5)
    places = np.flatnonzero(gap < 0.0)
    for nodes, told in ((places, False), (np.flatnonzero(x ** 2 + y ** 2 < 9.0), True)):
        nodes = some(contact.grid.whole, nodes)
        one = np.where(x ** 2 + y ** 2 < 1.0, -1.0, 1.0) + contact.scene.contact_threshold
        peak = states.State(nodes, nodes.take((one - contact.initial_gap)[None]), np.zeros(1))
        assert fronts.may_be_lone(contact, peak) is told
    apart = states.State(few, touching.displacement + 9.0, np.zeros(1))
    assert not fronts.may_be_lone(contact, apart)


def test_a_second_spot_next_to_the_window_is_no_trouble():
    """A spike just outside the window, which the displacement at its rim would bring into
    contact."""
    x = (np.arange(POINTS) - POINTS // 2) * PERIOD / POINTS
    contact = shaped(np.minimum((x + 10) ** 2 / 2, 3.0 + 20.0 * np.abs(x + 2)))
    window = Window(contact.grid, (POINTS // 2 - 128 - 76,), (153,))
    given = [states.State(window, np.full((1, 153), depth), np.array([depth]))
             for depth in (-13.9, -14.0)]
    assert fronts.edges(contact, given[-1]) is not None
    found = following.follow_edge(contact, given, np.array([-1.0, 2.0]))
    assert found is None or np.all(np.isfinite(found.displacement))


def test_an_edge_that_would_vanish_is_not_followed():
    contact = line()
    window = Window(contact.grid, (POINTS // 2 - 60,), (121,))
    given = [parabola(contact, window, half) for half in (2.0, 1.0)]
    assert following.follow_edge(contact, given, np.array([-1.0, 2.0])) is None


def test_following_the_edge_does_not_go_into_deep_overlap():
    contact = line()
    window = Window(contact.grid, (POINTS // 2 - 51,), (103,))
    given = [parabola(contact, window, 2.0, opening=opening) for opening in (10.0, 20.0)]
    found = following.follow_edge(contact, given, np.array([-3.0, 4.0]))
    assert states.normal_gap(contact, found).min() == pytest.approx(states.normal_gap(contact,
                                                                                      given[
        -1]).min() - 1.0)


def slipping(contact, half, front, spread=0.15):
    """A contact of a half width (beta) into which slip fronts have come as far as ``front``, sharp
    within ``spread``."""
    window = contact.grid.whole
    gap = parabola(contact, window, half)
    x = np.abs(window.coordinates()[0])
    slip = 20.0 / (1.0 + np.exp(-(x - front) / spread)) * np.where(x > half,
                                                                   (half / np.maximum(x,
                                                                                      1e-9)) ** 2,
                                                                   1.0)
    fields = np.array([gap.displacement[0], slip])
    return states.State(window, fields, contact.grid.mean(fields))


@pytest.mark.parametrize("residual, points", [(0.0, 2048), (0.5, 2048), (1.0, 16384), (1.0, 2048)])
def test_following_slip_fronts(residual, points):
    """Fronts that run ahead of the edges; with full residual friction they are left in place where
    they rise within a spacing."""
    contact = line(points=points, tangential_maugis=10.0, residual_friction=residual)
    given = [slipping(contact, 3.0 - 0.01 * t, 2.4 - 0.2 * t - 0.02 * t * t) for t in range(4)]
    ends = fronts.edges(contact, given[0])
    found = fronts.slip_fronts(contact, given[0], ends)
    assert ends[0, 0] < found[0, 0] < found[0, 1] < ends[0, 1]
    np.testing.assert_allclose(np.diff(found)[0],
                               2 * (2.4 - 0.15 * np.log(20.0 / np.sqrt(0.5) - 1.0))
                               / contact.grid.spacings[0], rtol=1e-3)
    weights = lagrange_weights(range(3), 3)
    ahead = following.follow_edge(contact, given[:3], weights)
    inside = np.abs(contact.grid.coordinates()[0].reshape(-1)) < 2.8
    wrong, still = (np.abs(state.displacement - given[3].displacement)[1, inside].max()
                    for state in (ahead, combined(contact, given[:3], weights)))
    rise = 100.0 * contact.grid.spacings[0] * contact.law.tangential_peak / contact.law.slip_peak
    assert (wrong < 0.2 * still) == (residual < 1.0 or rise < 1.0)


def test_short_steps_after_long_ones_follow_fronts_too():
    """As solves within a step do: their guess is made of states whose fronts are far apart, however
    near its own is to the last one's."""
    contact = line(points=4096, tangential_maugis=6.0, residual_friction=0.5)
    length = 1.0 / (contact.scene.tangential_maugis ** 2 * contact.law.slip_softening)

    def at(time):
        return slipping(contact, 3.0, 2.0 - 0.5 * length * time, length)

    given = [at(time) for time in range(3)]
    inside = np.abs(contact.grid.coordinates()[0].reshape(-1)) < 2.8
    for time in (1.5, 2.2):
        weights = lagrange_weights(range(3), time)
        ahead = following.follow_edge(contact, given, weights)
        wrong, still = (np.abs(state.displacement - at(time).displacement)[1, inside].max()
                        for state in (ahead, combined(contact, given, weights)))
        assert 0.5 * (abs(time - 2.0)) < fronts.FAR and wrong < 0.2 * still


def test_there_are_no_fronts_where_nothing_or_everything_slips():
    contact = line(points=2048, tangential_maugis=10.0)
    for front in (0.0, 3.5):
        state = slipping(contact, 3.0, front, 0.05)
        assert fronts.slip_fronts(contact, state, fronts.edges(contact, state)) is None
    pressed = parabola(contact, contact.grid.whole, 3.0)
    assert fronts.slip_fronts(contact, pressed, fronts.edges(contact, pressed)) is None


def test_ends_of_pressure_stay_while_fronts_move(monkeypatch):
    """Where slip has taken the adhesion, gap and slip are rough at the end of pressure: stretched
    from there to the front, its place moves with neither."""
    contact = line(points=2048, tangential_maugis=10.0, residual_friction=0.2)
    x = np.abs(contact.grid.whole.coordinates()[0])

    def state(front):
        found = slipping(contact, 3.0, front, 0.04)
        rim = np.maximum(x - 2.5, 0.0)
        found.displacement[0] = 2.0 * rim ** 1.5 - 0.01 - contact.gap_on(contact.grid.whole)
        found.displacement[1] += 5.0 * np.sqrt(rim)
        return states.State(found.window, found.displacement, contact.grid.mean(found.displacement))

    given = [state(2.2 - 0.15 * t) for t in range(4)]
    ends = fronts.edges(contact, given[0])
    slip = fronts.slip_fronts(contact, given[0], ends)
    found = fronts.pressed_ends(contact, given[0], ends, slip)
    np.testing.assert_allclose(np.diff(found)[0], 2 * (2.5 + 0.005 ** (2 / 3))
                               / contact.grid.spacings[0], rtol=1e-3)
    wrong = []
    for follow in (fronts.pressed_ends, lambda *_: None):
        monkeypatch.setattr(fronts, "pressed_ends", follow)
        again = [state(2.2 - 0.15 * t) for t in range(4)]
        ahead = following.follow_edge(contact, again[:3], lagrange_weights(range(3), 3))
        aside = np.abs(ahead.displacement - again[3].displacement)
        wrong.append(aside[:, (x > 2.4) & (x < 2.9)].max())
    assert wrong[0] < 0.1 * wrong[1]
    monkeypatch.undo()
    # and where the front is too near to them, they are left out
    near = state(2.62)
    assert fronts.pressed_ends(contact, near, ends, fronts.slip_fronts(contact, near,
                                                                             ends)) is None


def test_ends_of_pressure_beside_fronts_are_not_followed(monkeypatch):
    """Where the piece between both would be stretched by much, fronts are followed as without
    them."""
    contact = line(points=2048, tangential_maugis=10.0, residual_friction=0.2)
    x = np.abs(contact.grid.whole.coordinates()[0])

    def state(front):
        found = slipping(contact, 3.0, front, 0.04)
        found.displacement[0] = (2.0 * np.maximum(x - 2.3, 0.0) ** 1.5 - 0.01
                                 - contact.gap_on(contact.grid.whole))
        return states.State(found.window, found.displacement, contact.grid.mean(found.displacement))

    found = []
    for follow in (fronts.pressed_ends, lambda *_: None):
        monkeypatch.setattr(fronts, "pressed_ends", follow)
        given = [state(2.2 - 0.15 * t) for t in range(3)]
        assert len(fronts.followed_places(contact, given)[0][0]) == (6 if not found else 4)
        found.append(following.follow_edge(contact, given, lagrange_weights(range(3), 3)))
    np.testing.assert_array_equal(found[0].displacement, found[1].displacement)


@pytest.mark.parametrize("residual", [0.0, 0.2])
def test_fronts_are_where_they_were_foretold_or_not(residual):
    """After a way of several cohesive lengths, to a part of one."""
    contact = line(points=4096, tangential_maugis=6.0, residual_friction=residual)
    length = 1.0 / (contact.scene.tangential_maugis ** 2 * contact.law.slip_softening)
    last, found, beside = (slipping(contact, 3.0, front) for front in (2.4, 2.0,
                                                                       2.0 + 0.2 * length))
    near = slipping(contact, 3.0, 2.0 + 0.01 * length)
    assert fronts.fronts_moved(contact, last, found)
    assert fronts.fronts_foretold(contact, found, last, found)
    assert fronts.fronts_foretold(contact, near, last, found)
    assert not fronts.fronts_foretold(contact, beside, last, found)
    # a front that has not moved tells nothing, nor does none
    assert not fronts.fronts_foretold(contact, near, found, found)
    assert not fronts.fronts_moved(contact, found, near)
    pressed = parabola(contact, contact.grid.whole, 3.0)
    pressed = states.with_components(pressed, 2)
    assert not fronts.fronts_foretold(contact, found, pressed, found)
    assert not fronts.fronts_moved(contact, pressed, found)


def test_stiff_fronts_are_followed_without_refused_steps():
    """Solves within a step begin from what follows the fronts as well, so that no step is refused
    for one of them, however far fronts move; the fold is that of steps a quarter as long."""
    scene = Scene(points=4096, period=20.0, height=100.0, normal_maugis=3.0, tangential_maugis=6.0,
                  residual_friction=0.2)
    load = Load(start="normal_displacement=4",
                path="normal_displacement=hold, tangential_displacement=500", stop="gross_sliding")
    found = []
    for largest in (20.0, 5.0):
        said = []
        points = list(Branch(scene, load, Steps(initial_step=(2.0,), largest_step=(largest,),
                                                at_fold="stop"), log=said.append))
        found.append((points, sum("in between" in line or "mode that is stable" in line
                                  for line in said)))
    (points, refused), (finer, _) = found
    assert points[-1].event == finer[-1].event == "fold" and not refused
    assert points[-1].load[1] == pytest.approx(finer[-1].load[1], rel=2e-3)


@pytest.mark.study
def test_followed_fronts_halve_the_cost_of_incipient_sliding(monkeypatch):
    """And lead to the same fold."""
    scene = Scene(points=2048, period=20.0, height=100.0, normal_maugis=3.0, tangential_maugis=6.0,
                  residual_friction=0.5)
    load = Load(start="normal_displacement=4",
                path="normal_displacement=hold, tangential_displacement=500", stop="gross_sliding")
    found = []
    for far in (fronts.FAR, np.inf):
        for module in (following, fronts):
            monkeypatch.setattr(module, "FAR", far)
        found.append(list(Branch(scene, load, Steps(initial_step=(2.0,), largest_step=(20.0,),
                                                    at_fold="stop"))))
    followed, plain = found
    assert followed[-1].event == plain[-1].event == "fold"
    assert followed[-1].load[1] == pytest.approx(plain[-1].load[1], rel=1e-3)
    costs = [sum(point.spent["transforms"] for point in points) for points in found]
    assert costs[0] < 0.65 * costs[1] and len(followed) < len(plain)
