"""Windows of any nodes: their convolution, and that all results of a rough plane are those of the
whole cell."""

from types import SimpleNamespace as Namespace

import numpy as np
import pytest

from contactsnes.branch.branch import Branch
from contactsnes.commands.summary import start_window
from contactsnes.contact import observables, states
from contactsnes.contact.balance import Balance, left_by_rounding
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import Contact
from contactsnes.contact.scattered import boxed, on_nodes
from contactsnes.dynamics.modes import ACCURATE
from contactsnes.grid.active import Nodes, NodesConvolution, within
from contactsnes.grid.cell import Convolution, Grid
from contactsnes.grid.numbers import numbers_of, of_numbers
from contactsnes.grid.operator import Operator
from contactsnes.grid.windows import Window
from contactsnes.scene.load import Load
from contactsnes.scene.settings import Form, Scene, Steps

SHAPE = (48, 64)


def nodes_of(start=(40, 50), shape=(17, 25), share=0.4, seed=1):
    """Some nodes of a box that wraps around the border of a cell in both directions."""
    hull = Window(Grid(SHAPE, [0.1 * n for n in SHAPE]), start, shape)
    return Nodes(hull, np.flatnonzero(np.random.default_rng(seed).random(hull.size) < share))


def numbers(window):
    return np.arange(window.grid.size).reshape(SHAPE)[window.indices]


# Nodes and their convolution


def test_take_put_and_numbers_agree():
    window = nodes_of()
    field = np.random.default_rng(0).normal(size=(2, *SHAPE))
    values = window.take(field)
    np.testing.assert_array_equal(values, field.reshape(2, -1)[:, window.numbers])
    np.testing.assert_array_equal(numbers(window), window.numbers)
    assert len(set(window.numbers)) == window.size == values.shape[1]
    copy = np.zeros_like(field)
    window.put(values, copy)
    np.testing.assert_array_equal(window.take(copy), values)
    assert np.count_nonzero(copy) == values.size
    box = window.box(values, -7.0)
    np.testing.assert_array_equal(np.sort(box[box != -7.0]), np.sort(values, axis=None))
    hull = window.hull.take(copy)
    np.testing.assert_array_equal(hull, window.spread(values))


def test_windows_of_the_same_nodes_are_equal():
    window = nodes_of()
    assert window == nodes_of() and hash(window) == hash(nodes_of())
    assert window != nodes_of(seed=2) and window != window.hull and window.hull != window
    again = of_numbers(window.grid, numbers_of(window))
    assert again == window and type(again) is Nodes


def test_the_rim_has_neighbours_outside():
    window = nodes_of(share=0.8)
    known = set(window.numbers.tolist())
    for node, is_rim in zip(zip(*window.indices), window.rim()):
        around = [np.ravel_multi_index([(c + s) % n for c, s, n in zip(node, step, SHAPE)], SHAPE)
                  for step in ((1, 0), (-1, 0), (0, 1), (0, -1))]
        assert is_rim == any(int(number) not in known for number in around)


@pytest.mark.parametrize("hull", [((40, 50), (17, 25)), ((0, 0), SHAPE)], ids=["box", "cell"])
@pytest.mark.parametrize("transposed", [False, True])
def test_the_convolution_is_that_of_the_cell(hull, transposed):
    window, random = nodes_of(*hull), np.random.default_rng(3)
    half = (SHAPE[0], SHAPE[1] // 2 + 1)
    grid = window.grid
    # a kernel of real space, of which each block is made: any lags
    symbols = {(i, j): np.fft.rfft2(random.normal(size=SHAPE)) for i in (0, 1) for j in (0, 1)}
    assert symbols[0, 0].shape == half
    operator = Operator(grid, symbols)
    values, cell = random.normal(size=(2, window.size)), np.zeros((2, *SHAPE))
    window.put(values, cell)
    flat = cell.reshape(2, -1)
    Convolution(grid.whole, operator, 2).apply(flat, flat, transposed)
    found = NodesConvolution(window, operator, 2).apply(values, np.empty_like(values), transposed)
    np.testing.assert_allclose(found, window.take(cell), atol=1e-12 * np.abs(cell).max())


def test_states_take_the_same_or_the_nearest_nodes():
    window, other = nodes_of(), nodes_of(seed=5)
    values = np.random.default_rng(4).normal(size=(2, window.size))
    state = states.State(window, values, np.zeros(2))
    assert states.onto(state, window) is values
    found = states.onto(state, other)
    places = np.transpose(window.indices)
    for number, place, value in zip(other.numbers, np.transpose(other.indices), found.T):
        away = np.abs((places - place + np.array(SHAPE) // 2) % SHAPE - np.array(SHAPE) // 2)
        square = np.sum(away ** 2, axis=1)
        nearest = np.flatnonzero(square == square.min())
        assert any(np.array_equal(value, values[:, k]) for k in nearest), number
    box = states.onto(state, window.hull)
    np.testing.assert_array_equal(box[:, window.places], values)
    assert set(box[0]) == set(values[0])


def test_nearly_all_nodes_are_a_box():
    hull = nodes_of().hull
    assert within(hull, np.ones(SHAPE, bool)) is hull
    some = np.zeros(SHAPE, bool)
    assert within(hull, some) is hull  # none: something has to be solved for
    some[45:47, 60] = True
    assert within(hull, some).size == 2


# Rough planes


def rough(tmp_path, self_affine, seed=4, **changes):
    """The scene of a steep self-affine surface whose law acts on few nodes, and its heights."""
    heights = self_affine(48, 12.0, 6.0, 1.5, 40.0, seed, dimension=2)
    path = tmp_path / "heights.npy"
    np.save(path, heights)
    return Scene(**{"dimension": 2, "points": (48, 48), "period": 12.0, "geometry": "file",
                    "geometry_file": str(path), "normal_maugis": 2.0, "tangential_maugis": 1.0,
                    "poisson": 0.5, "height": np.inf, **changes})


def followed(scene, path, window="auto", kernels="auto", start=4, **steps):
    branch = Branch(scene, Load(start=f"normal_displacement={start}", path=path),
                    Steps(**{"initial_step": 0.5, "largest_step": 0.5, **steps}),
                    Form(window=window, kernels=kernels))
    return branch, list(branch)


@pytest.fixture
def tight(options):
    options(snes_atol="1e-11")


SHEARED = "normal_displacement=4.5; tangential_displacement_x=1", {"poisson": 0.3}
PATHS = {"displacement": ("normal_displacement=5", {}), "force": ("normal_force=12", {}),
         "sheared": SHEARED, "layer": ("normal_displacement=4.5", {"height": 6.0, "poisson": 0.3})}


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("kind", ["natural", "arclength"])
def test_results_are_those_of_the_whole_cell(name, kind, tmp_path, self_affine, tight):
    path, changes = PATHS[name]
    scene = rough(tmp_path, self_affine, **changes)
    (nodes, found), (cell, expected) = (followed(scene, path, window, type=kind)
                                        for window in ("auto", "off"))
    last = found[-1]
    assert isinstance(last.state.window, Nodes) and last.state.window.size < 0.7 * 48 ** 2
    form = nodes.corrector.form
    assert form.window == last.state.window
    unknowns = len(last.controls) * last.state.window.size + last.controls.count("force")
    assert nodes.corrector.snes.getSolution().getSize() == unknowns == form.size
    assert cell.corrector.form.nodes == 48 ** 2
    pairs = [(found[0], expected[0]), (last, expected[-1])]
    if kind == "natural":
        assert len(found) == len(expected)
        pairs = list(zip(found, expected))
    for one, other in pairs:
        np.testing.assert_allclose(one.forces, other.forces, rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(one.displacements, other.displacements, rtol=1e-8, atol=1e-9)
        np.testing.assert_allclose(nodes.contact.extended(one.state),
                                   cell.contact.extended(other.state), atol=1e-7)
        ours, theirs = (observables.observe(branch.contact, point)
                        for branch, point in ((nodes, one), (cell, other)))
        for what in ("contact_area", "minimum_gap", "maximum_pressure", "elastic_energy",
                     "interfacial_energy", "stick_area", "perimeter", "half_axis_x"):
            assert ours[what] == pytest.approx(theirs[what], rel=1e-6, abs=1e-7, nan_ok=True), what


def test_kernels_and_numpy_agree(tmp_path, self_affine, tight):
    scene = rough(tmp_path, self_affine, poisson=0.3)
    found = [followed(scene, SHEARED[0], kernels=kernels)[1]
             for kernels in ("auto", "off")]
    assert len(found[0]) == len(found[1])
    for one, other in zip(*found):
        assert one.state.window == other.state.window
        np.testing.assert_allclose(one.forces, other.forces, rtol=1e-9, atol=1e-9)
        assert one.spent["linear_iterations"] == other.spent["linear_iterations"]
        assert one.spent["transforms"] == pytest.approx(other.spent["transforms"], rel=1e-9)


def test_stability_is_that_of_the_whole_cell(tmp_path, self_affine, tight):
    scene = rough(tmp_path, self_affine)
    values = [[point.leading_eigenvalue for point in
               followed(scene, "normal_displacement=4.5", window, stability="eigenvalue")[1]]
              for window in ("auto", "off")]
    np.testing.assert_allclose(*values, rtol=ACCURATE)


def test_a_run_goes_on_from_what_is_kept(tmp_path, self_affine):
    scene = rough(tmp_path, self_affine)
    branch, points = followed(scene, "normal_displacement=6")
    history = [branch.restored(branch.packed(point)) for point in points[:3]]
    assert all(one.state.window == other.state.window for one, other in zip(history, points))
    rest = list(Branch(scene, branch.load, branch.steps, history=history))
    np.testing.assert_allclose([point.forces for point in rest],
                               [point.forces for point in points[3:]], rtol=1e-6)


def test_what_rounding_leaves_is_known_on_some_nodes(tmp_path, self_affine):
    """A path that failed on such a window ended in a traceback, in place of why it did."""
    branch, points = followed(rough(tmp_path, self_affine), "normal_displacement=5")
    last = points[-1]
    assert isinstance(last.state.window, Nodes)
    size = np.abs(last.state.displacement).max()
    left = left_by_rounding(branch.contact, last.state, last.controls, last.load)
    assert np.finfo(float).eps * 1e-2 * size < left < 1e-9


def test_nodes_are_added_when_a_solution_asks_for_them(tmp_path, self_affine, tight):
    """From a window that lacks half of the nodes a solve ends in the same state on a larger one."""
    scene = rough(tmp_path, self_affine)
    branch, points = followed(scene, "normal_displacement=5")
    point, contact = points[-1], branch.contact
    window, gap = point.state.window, states.normal_gap(contact, point.state)
    fewer = Nodes(window.hull, window.places[gap < 0.5 * np.median(gap)])
    lacking = states.State(fewer, states.onto(point.state, fewer), point.state.means)
    assert not states.covers(contact, lacking) and states.covers(contact, point.state)
    again = branch.corrector.solve(lacking, point.controls, point.load)
    assert again.state.window.size > fewer.size and states.covers(contact, again.state)
    np.testing.assert_allclose(again.forces, point.forces, rtol=1e-8)


def test_a_window_shrinks_where_most_of_its_nodes_are_out_of_range(tmp_path, self_affine):
    scene = rough(tmp_path, self_affine)
    contact = Contact(scene, np.load(scene.geometry_file))
    assert contact.scattered
    low, high = (states.undeformed(contact, ("displacement",), np.array([depth]))
                 for depth in (6.0, 0.5))
    many, few = on_nodes(contact, low), on_nodes(contact, high)
    assert few.window.size < 0.6 * many.window.size
    moved = states.State(many.window, states.onto(high, many.window), high.means)
    assert on_nodes(contact, moved).window == few.window
    assert on_nodes(contact, few) is few
    assert boxed(contact, low) is low


@pytest.mark.parametrize("part", [0.74, 0.76])
def test_the_cell_stays_where_the_law_acts_on_most_of_it(part, tmp_path, self_affine):
    """No other window holds so many nodes: none is looked for. What few need is found."""
    scene = rough(tmp_path, self_affine)
    contact = Contact(scene, np.load(scene.geometry_file))
    gap = contact.initial_gap.reshape(-1)
    reach = np.quantile(gap, part) - contact.law.range
    state = states.State(contact.widest, np.full((1, gap.size), -reach), np.array([-reach]))
    found = on_nodes(contact, state)
    again = on_nodes(contact, state, afresh=True)
    assert found.window == again.window
    if part > 0.75:
        assert found is state and found.window.is_whole


def test_even_and_convex_gaps_stay_on_boxes():
    for changes in ({"geometry": "sphere", "period": 12.0},
                    {"geometry": "sinusoid", "period": 12.0}):
        scene = Scene(dimension=2, points=(32, 32), normal_maugis=1.0, tangential_maugis=1.0,
                      **changes)
        assert not Contact(scene).scattered


def test_the_form_is_that_of_the_cell_where_the_rest_has_no_traction(tmp_path, self_affine):
    """F and J v of the whole cell at the nodes, for a state that is in balance at the others."""
    scene = rough(tmp_path, self_affine, poisson=0.3)
    branch, points = followed(scene, SHEARED[0])
    contact, point = branch.contact, points[-1]
    whole, random = contact.extended(point.state), np.random.default_rng(8)
    results = []
    for window in (point.state.window, contact.grid.whole):
        form = DisplacementForm(contact, window, point.controls)
        form.set_load(point.load)
        unknown = form.pack(window.take(whole), np.zeros(0))
        residual = form.displacement(form.residual(unknown, np.empty(form.size)))
        form.linearise(unknown)
        change = np.zeros((3, *contact.grid.shape))
        point.state.window.put(random.normal(size=(3, point.state.window.size)), change)
        random = np.random.default_rng(8)
        product = form.displacement(form.apply_jacobian(form.pack(window.take(change), []),
                                                        np.empty(form.size)))
        results.append((form, residual, product))
    (_, *found), (form, *expected) = results
    for one, other in zip(found, expected):
        other = point.state.window.take(other.reshape(3, *contact.grid.shape))
        np.testing.assert_allclose(one, other, atol=1e-8 * max(1.0, np.abs(other).max()))


def test_the_gap_beyond_the_window_is_known_from_a_residual(tmp_path, self_affine):
    scene = rough(tmp_path, self_affine, poisson=0.3)
    branch, points = followed(scene, SHEARED[0])
    point = points[-1]
    form, before = branch.corrector.form, branch.contact.grid.transforms
    found = branch.corrector.balance(point.state, point.controls, point.load, form)
    spent = branch.contact.grid.transforms - before
    assert spent == pytest.approx(2 * form.components)  # those of the residual alone
    outside = branch.contact.gap_outside(point.state)
    assert found.closest == pytest.approx(outside.min(), rel=1e-12)
    assert found.closest >= branch.contact.law.certain


@pytest.mark.parametrize("kernels", ["auto", "off"])
def test_a_response_is_not_made_twice(tmp_path, self_affine, kernels):
    """What the last residual of a solve has left tells of its state, and of no other one."""
    scene = rough(tmp_path, self_affine, poisson=0.3)
    branch, points = followed(scene, SHEARED[0], kernels=kernels)
    point, form, grid = points[-1], branch.corrector.form, branch.contact.grid
    state, given = point.state, (point.controls, point.load, form)
    moved = states.State(state.window, state.displacement + 1e-7, state.means)
    anew, unlike = (branch.corrector.balance(each, *given) for each in (state, moved))
    ended = np.linalg.norm(form.residual(form.packed(state), np.empty(form.size)))
    made = []
    for each, expected in ((state, anew), (state, anew), (moved, unlike)):
        before = grid.transforms
        found = branch.corrector.balance(each, *given, ended)
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-13)
        made.append(grid.transforms > before)
        form.residual(form.packed(state), np.empty(form.size))
        # a product leaves another response there
        if each is state and len(made) == 1:
            form.apply_jacobian(form.packed(state), np.empty(form.size))
    assert made == [False, True, True]


@pytest.mark.parametrize("dimension, made", [(1, True), (2, False)])
def test_a_point_takes_no_residual_more_than_its_solve(monkeypatch, dimension, made):
    """On planes; transforms of lines take hardly longer than to look."""
    scene = Scene(dimension=dimension, points=32, period=12.0, normal_maugis=1.0)
    branch, own, spent = Branch(scene, Load(path="normal_displacement=1")), Balance.__call__, []

    def counted(balance, *given):
        before = branch.contact.grid.transforms
        found = own(balance, *given)
        spent.append(branch.contact.grid.transforms > before)
        return found

    monkeypatch.setattr(Balance, "__call__", counted)
    list(branch)
    # (the first one on a window is made of whole transforms, where states are even)
    assert len(spent) > 3 and set(spent[2:]) == {made}


def test_what_would_be_solved_tells_the_nodes(tmp_path, self_affine):
    scene = rough(tmp_path, self_affine)
    branch, points = followed(scene, "normal_displacement=4")
    window = start_window(Namespace(scene=scene, load=branch.load, form=Form()), branch)
    assert isinstance(window, Nodes)
    assert window.size == pytest.approx(points[0].state.window.size, rel=0.5)
