"""Energies and works: spectral sums, derivatives of potentials, quadratures on nodes, and balances
that close along paths."""

import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from contactsnes import Branch, Contact, Form, Load, NoEquilibrium, Scene, Steps
from contactsnes.commands.progress import Progress
from contactsnes.contact import states
from contactsnes.contact.energies import PathEnergies, stored
from contactsnes.contact.interface_work import between, corners, released, straight
from contactsnes.contact.observables import observe
from contactsnes.contact.state import State
from contactsnes.contact.work_along import apart, gauss, held, line_rule, line_work, path_work
from contactsnes.interface.laws.mcgarry import McGarry
from contactsnes.interface.laws.modified import Modified
from contactsnes.kernels.choice import chosen

LINE = {"points": 512, "period": 40.0, "normal_maugis": 2.0, "residual_friction": 0.5}
SCENES = {"line": ({}, "normal_displacement=1.5", "tangential_displacement=20"),
          "soft layer": ({"poisson": 0.3, "height": 5.0, "work_ratio": 2.0}, "normal_force=2",
                         "tangential_displacement=2"),
          "half-space, pulled aside": ({"height": math.inf, "tangential_maugis": 0.7},
                                       "normal_displacement=1", "tangential_force=1"),
          "plane": ({"dimension": 2, "geometry": "sphere", "points": 32, "period": 8.0,
                     "poisson": 0.2, "work_ratio": 0.5}, "normal_force=0.5",
                    "tangential_force_x=1.5"),}


def points(scene, path, start="normal_displacement=0.5", step=None, **steps):
    """The points of a path and their numbers, in equal steps of its legs if ``step`` is given."""
    if step is not None:
        steps = {"initial_step": step, "largest_step": step, **steps}
    branch = Branch(Scene(**{**LINE, **scene}), Load(start=start, path=path), Steps(**steps))
    found = list(branch)
    return branch.contact, found, [observe(branch.contact, point) for point in found]


def tractions(contact, point):
    """Traction and displacement on the cell (components of the scene, nodes), in ranges."""
    displacement = np.zeros((contact.scene.components, contact.grid.size))
    cell = contact.extended(point.state)
    displacement[:len(cell)] = cell.reshape(len(cell), -1)
    gap = displacement.copy()
    gap[0] += contact.initial_gap.reshape(-1)
    return contact.law.traction(gap), displacement


def ratios(contact):
    return np.array([1.0] + [contact.scene.work_ratio] * (contact.scene.components - 1))


def test_works_of_straight_ways_take_little_memory():
    """Whole planes are asked when their other fields are all there; how many parts a way has, and
    what the nodes count, is as ever."""
    contact = Contact(Scene(dimension=2, points=256, period=20.0, geometry="sphere",
                            normal_maugis=2.0))
    fields = np.random.default_rng(1).uniform(-0.5, 2.0, (2, 1, contact.grid.size))
    first, last = (State(contact.widest, field, np.zeros(1)) for field in fields)
    contact.gap_on(contact.widest)
    tracemalloc.start()
    found = straight(contact, first, last, 3)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1.5 * fields[0].nbytes
    places, shares = np.polynomial.legendre.leggauss(40)
    begin, way = fields[0] + contact.initial_gap.reshape(1, -1), fields[1] - fields[0]
    expected = sum(share * np.sum(contact.law.traction(begin + 0.5 * (1.0 + place) * way) * way)
                   for place, share in zip(places, 0.5 * contact.grid.node_area * shares))
    np.testing.assert_allclose(found, [expected], rtol=1e-4)


# What is stored

@pytest.mark.parametrize("name", SCENES)
def test_elastic_energy_is_that_of_all_waves(name):
    # 1/2 sum over waves of conj(u) K u, by Parseval, and of the springs between mean and far
    # surface
    changes, *path = SCENES[name]
    contact, found, numbers = points(changes, "; ".join(path), smallest_step=1e-4)
    point, (_, displacement) = found[-1], tractions(contact, found[-1])
    grid, count = contact.grid, contact.scene.components
    weights = ratios(contact)
    waves = np.fft.fftn(displacement.reshape(count, *grid.shape),
                        axes=range(1, 1 + len(grid.shape))) / grid.size
    half = grid.shape[-1] // 2 + 1
    stiffness = contact.operator(count, "stiffness")
    double = np.full(half, 2.0)
    double[[0, -1]] = 1.0
    energy = sum(0.5 * weights[i] * np.sum((np.conj(waves[i][..., :half]) * block * grid.size
                                            * waves[j][..., :half]).real * double)
                 for (i, j), block in stiffness.blocks.items()) * grid.area
    rigid = np.array([k for k in contact.body.rigid_compliance][:2]
                     + [contact.body.rigid_compliance[1]])[:count]
    springs = 0.5 * np.sum(weights * rigid * point.forces ** 2) / grid.area
    assert numbers[-1]["elastic_energy"] == pytest.approx(energy + springs, rel=1e-6)


def test_a_force_that_tractions_miss_by_the_tolerance_stores_nothing_on_a_long_slip():
    contact, (*_, point), (*_, numbers) = points({"points": 64, "normal_maugis": 0.7},
                                                 "normal_displacement=1.5; "
                                                 "tangential_displacement=4000", step=4e3)
    assert numbers["mean_tangential_displacement"] > 3000.0
    missed = point.changed(forces=point.forces + np.array([0.0, 1e-6]))
    assert stored(contact, missed)[0] == pytest.approx(stored(contact, point)[0], abs=1e-8)


@pytest.mark.parametrize("law, decoupled", ((Modified(0.3, 0.2), True), (Modified(1.0), True),
                                            (McGarry(), False)))
def test_tractions_are_derivatives_of_the_potential_where_there_is_one(law, decoupled):
    ratio, step = 1.7, 1e-5
    normal = np.array([-5.0, -3.0, -0.4, 0.6, 2.0, 8.0])
    gap = np.array([normal, np.zeros(6), np.zeros(6)])
    if decoupled:
        gap[1:, :3] = [[0.3, -0.6, 1.1], [0.2, 0.5, -1.4]]
    tractions = law.traction(gap)
    for i, weight in enumerate((1.0, ratio, ratio)):
        free = slice(0, 3 if i and decoupled else 0 if i else 6)
        moved = np.zeros_like(gap)
        moved[i, free] = step
        slope = (law.potential(gap + moved, ratio) - law.potential(gap - moved, ratio)) / (2 * step)
        assert slope[free] == pytest.approx(weight * tractions[i, free], rel=1e-7, abs=1e-9)


def test_there_is_no_potential_where_slip_and_opening_meet():
    apart = Modified.range + 1.0
    open_ = 1.0
    overlap = -0.5
    for law, within in ((Modified(), True), (McGarry(), False)):
        assert law.potential(np.array([[open_], [1e-3]])) is None
        assert (law.potential(np.array([[overlap], [1e-3]])) is not None) == within
        assert law.potential(np.array([[open_, overlap, apart],
                                       [0.0, 0.0, 5.0]]))[2] == pytest.approx(0.0, abs=1e-14)


def test_a_pressed_block_that_slips_has_a_potential():
    # flat on flat in overlap everywhere: no corner is met, and the work done on the interface is
    # that of an integral T db
    block = {"geometry": "flat", "points": 32, "height": 1.0, "residual_friction": 1.0}
    _, _, numbers = points(block, "normal_displacement=1; tangential_displacement=4")
    work = [row["interfacial_energy"] - numbers[0]["interfacial_energy"] for row in numbers]
    assert np.isfinite(work).all() and work[-1] == pytest.approx(numbers[-1]["interface_work"])
    slip = numbers[-1]["mean_tangential_displacement"]
    assert slip > 0.2 and numbers[-1]["elastic_energy"] == pytest.approx(0.5 * (4 - slip) ** 2 * 40
                                                                         / 4)
    assert abs(numbers[-1]["energy_imbalance"]) < 1e-4 * numbers[-1]["external_work"]


# Works along a path

def test_line_integrals_are_exact_for_cubics():
    places = np.array([0.0, 0.4, 1.1, 1.3])
    exact = lambda s: 3 * s ** 5 / 5 - s ** 4 / 2 + s ** 3 / 3  # of (s^2) d(s^3 - s^2 + s)
    for first in (0, 2):
        basis, slopes = line_rule(places, first, gauss(4))
        area = (places ** 2 @ basis) @ ((places ** 3 - places ** 2 + places) @ slopes)
        assert area == pytest.approx(exact(places[-1]) - exact(places[first]), rel=1e-12)


@pytest.mark.parametrize("soft, give, swings", [(0.0, 1.0, False), (0.9, 60.0, True)])
def test_polynomials_that_swing_give_way_to_chords(soft, give, swings):
    """A spring in series with a exp(-a), pulled in equal steps of its far end: where the spring is
    nearly as soft as the law, the force falls within one step. Works have their exact integral, and
    where nothing swings stay as exact as cubics are."""
    compliance, unit = soft * np.exp(2.0), np.ones(1)
    far = lambda a: a + compliance * a * np.exp(-a)
    done = lambda a: 1.0 - (1.0 + a) * np.exp(-a) + 0.5 * compliance * (a * np.exp(-a)) ** 2
    gaps = np.interp(np.arange(0.5, far(7.0), 0.3), far(np.linspace(0.0, 7.0, 2 ** 18)),
                     np.linspace(0.0, 7.0, 2 ** 18))
    places, forces = far(gaps)[:, None], (gaps * np.exp(-gaps))[:, None]
    errors = []
    for last in range(3, len(gaps)):
        along = slice(last - 3, last + 1)
        given = places[along], forces[along]
        work = line_work(*given, give * unit, unit, 2, gauss(4))
        exact = done(gaps[last]) - done(gaps[last - 1])
        errors.append((abs(work - exact), abs(held(work, *given, unit, 2) - exact)))
    errors = np.array(errors)
    assert np.all(errors[:, 1] <= errors[:, 0] + 1e-15)
    assert np.any(errors[:, 1] < 0.2 * errors[:, 0]) == swings


@pytest.mark.parametrize("twin", [1, 2])
def test_twins_on_a_path_tell_of_no_slope(twin):
    """Two bifurcations at one place, say, which are as far from each other as their balances are
    from exact ones: the force a exp(-a) against a, whose integral is known."""
    gaps = np.array([0.7, 0.8, 0.8, 0.9])
    gaps[twin] += 3e-7
    forces, rounding = gaps * np.exp(-gaps), np.array([0.0, 1e-8, -1e-8, 0.0])
    along, unit = (gaps[:, None], (forces + rounding * 10.0)[:, None]), np.ones(1)
    first = 2
    done = lambda a: 1.0 - (1.0 + a) * np.exp(-a)
    exact = done(gaps[-1]) - done(gaps[first])
    kept, place = apart(*along, unit, first)
    assert (kept, place) == ([0, 2, 3], 1)
    swung, work = (line_work(*(values[numbers] for values in along), unit, unit, begin,
                             gauss(len(numbers)))
                   for numbers, begin in (([0, 1, 2, 3], first), (kept, place)))
    assert abs(work - exact) < 1e-3 * exact < abs(swung - exact)
    assert apart(gaps[[0, 1, 3], None], along[1][[0, 1, 3]], unit, 0) == ([0, 1, 2], 0)


@pytest.mark.parametrize("size", [1e-2, 1.0, 1e4])
def test_works_against_forces_that_rise_many_times_over(size):
    """A force exp(6 a) against a, in steps of 0.3: a chord in which it counts for all is that of
    its last step, along which displacements swing."""
    gaps, unit = np.arange(0.0, 2.5, 0.3), np.ones(1)
    forces, errors = size * np.exp(6.0 * gaps), []
    for last in range(3, len(gaps)):
        along = gaps[last - 3:last + 1, None], forces[last - 3:last + 1, None]
        exact = (forces[last] - forces[last - 1]) / 6.0
        swung = held(line_work(*along, unit, unit, 2, gauss(4)), *along, unit, 2)
        errors.append((path_work(*along, unit, unit, 2, False) / exact - 1.0, swung / exact - 1.0))
    worst, before = np.abs(errors).max(axis=0)
    assert worst < 0.03 and before > 3.0 * worst


def test_works_of_full_contact_are_what_is_stored():
    """Bodies that touch everywhere, pressed in default steps: the normal force rises from nothing
    to three million, and all of its work is stored."""
    scene = {"geometry": "sinusoid", "points": 128, "period": 6.0, "height": 5.0,
             "normal_maugis": 2.0, "tangential": "off"}
    _, _, numbers = points(scene, "normal_displacement=6", start="normal_displacement=0")
    assert numbers[-1]["normal_force"] > 3e6
    # (0.045, where forces count for all of the length)
    assert abs(numbers[-1]["energy_imbalance"]) < 3e-3 * numbers[-1]["external_work"]


def test_works_of_a_steep_fall_stay_near_what_is_stored():
    """A flat that leaves a layer nearly as soft as the law: there is a potential, and the balance
    is a test of the work of the load."""
    scene = {"geometry": "flat", "points": 32, "period": 5.0, "height": 2.0, "poisson": 0.2,
             "tangential": "off"}
    _, _, numbers = points(scene, "normal_displacement=-4", start="normal_displacement=0")
    imbalance, work = (np.array([row[name] for row in numbers])
                       for name in ("energy_imbalance", "external_work"))
    assert np.abs(imbalance).max() < 0.02 * work.max()  # 0.49 without chords


@pytest.mark.parametrize("changes, start, path, step",
                         (({}, "normal_displacement=0.5", "normal_displacement=4.5", 0.4),
                          ({}, "normal_displacement=0.5", "normal_force=2", 0.2),
                          ({"height": 4.0, "poisson": 0.45, "tangential": "off"},
                           "normal_displacement=0.5", "normal_force=2", 0.2),
                          ({"dimension": 2, "geometry": "sphere", "points": 32, "period": 8.0},
                           "normal_displacement=0.5", "normal_displacement=1.5", 0.1),
                          ({"dimension": 2, "geometry": "sphere", "period": math.inf,
                            "points": None, "spacing": 0.25}, "normal_force=0.5", "normal_force=4",
                           0.4), ({"period": math.inf, "height": math.inf, "points": None,
                                   "spacing": 0.08}, "normal_force=0.5", "normal_force=2.5", 0.2),
                          ({"height": 5.0, "normal_maugis": 1.0, "tangential_maugis": 0.7,
                            "residual_friction": 1.0}, "normal_displacement=1.5",
                           "tangential_displacement=4", 0.2),
                          ({"poisson": 0.3, "height": 5.0, "work_ratio": 2.0}, "normal_force=1",
                           "tangential_displacement=2", 0.2),
                          pytest.param({"dimension": 2, "geometry": "sphere", "points": 32,
                                        "period": 8.0, "height": 4.0, "poisson": 0.2,
                                        "work_ratio": 0.5, "normal_maugis": 1.0,
                                        "tangential_maugis": 0.7}, "normal_force=2",
                                       "tangential_displacement_x=3", 0.125,
                                       marks=pytest.mark.study)),
                         ids=("displacement", "force", "layer", "plane", "isolated sphere",
                              "isolated cylinder", "slip", "compressible layer", "sheared sphere"))
def test_balance_closes_as_the_fourth_power_of_the_step(changes, start, path, step):
    # the work of the loads is a quadrature, the rest differences of energies or, where there is no
    # potential, a quadrature over nodes
    imbalances = []
    for part in (1.0, 0.5):
        contact, found, numbers = points(changes, path, start, part * step, predictor="secant")
        imbalances.append(abs(found[-1].energy_imbalance))
        assert numbers[-1]["dissipated_work"] == 0.0
    total = abs(found[-1].elastic_energy) + abs(np.nan_to_num(found[-1].interfacial_energy))
    assert imbalances[1] < max(imbalances[0] / 7.0, 2e-8 * total) and imbalances[0] < 1e-4 * total
    undefined = contact.isolated and contact.scene.dimension == 1
    assert math.isnan(numbers[-1]["external_work"]) == math.isnan(
        numbers[-1]["elastic_energy"]) == undefined


def test_a_jump_that_is_stepped_over_is_missing_in_the_balance():
    # no potential: the work on the interface is a sum over nodes, the loads' a quadrature
    scene = Scene(**LINE | {"height": 4.0, "tangential_maugis": 1.0, "residual_friction": 0.0})
    branch = Branch(scene, Load(start="normal_displacement=1", path="tangential_displacement=20"))
    found = list(branch)
    at = [point.event for point in found].index("jump")
    assert math.isnan(found[at].interfacial_energy) and found[at].jump_balance == "motion"
    lost = found[at].dissipated_work
    before = [point for point in found[:at] if point.event is None][-3:]
    over = PathEnergies(branch.contact, before).completed(replace(found[at], event=None))
    assert over.dissipated_work == 0.0 and abs(found[at].energy_imbalance) < 0.01 * lost
    assert over.energy_imbalance == pytest.approx(lost, rel=0.2)


@pytest.mark.parametrize("compiled", [True, False])
def test_works_on_the_interface_do_not_swing_into_overlap(compiled):
    # a cubic through three points near each other and one far off leaves the way by thousands of
    # ranges; along the chords the work is that of the law's potential
    kernels = chosen(compiled)
    contact = Contact(Scene(**LINE | {"tangential": "off", "height": 2.0}), kernels=kernels)
    gap, count = np.zeros(4), contact.grid.size
    gap[:] = -2.0 + np.array([0.0, 1e-3, -1e-3, 1.9])
    known = [State(contact.grid.whole, value - contact.gap_on(contact.grid.whole)[None],
                   np.zeros(1)) for value in gap]
    done = between(contact, known, 2)
    potential = contact.law.potential(gap[None], 1.0)
    assert done[0] == pytest.approx(contact.grid.node_area * count * (potential[3] - potential[2]),
                                    rel=0.02)
    # a state again, and one that is as good as another, tell nothing
    assert between(contact, [known[0], known[3], known[3]], 1) == 0.0
    twin = replace(known[3], displacement=known[3].displacement + 1e-12)
    assert between(contact, [known[0], twin, known[3]], 0) == pytest.approx(
        between(contact, [known[0], known[3]], 0), rel=1e-9)


@pytest.mark.parametrize("name", SCENES)
def test_works_are_those_of_tractions_on_nodes(name):
    # the trapezoidal rule closes the balance whatever the step (reciprocity); its distance from
    # ours falls as the step squared
    changes, pressed, path = SCENES[name]
    apart = []
    end = float(path.split("=")[1])
    for steps in (8, 16):
        contact, found, numbers = points(changes, f"{pressed}; {path}",
                                         initial_step=(0.1, end / steps),
                                         largest_step=(0.1, end / steps), predictor="secant")
        first = next(k for k, point in enumerate(found) if point.leg == 2) - 1
        assert len(found) == first + 1 + steps
        fields = [tractions(contact, point) for point in found[first:]]
        weights, area = ratios(contact), contact.grid.node_area
        interface = area * sum(weights @ np.sum(0.5 * (t + s) * (v - u), axis=1)
                               for (s, u), (t, v) in zip(fields, fields[1:]))
        loads = [np.array([np.append(values, [0.0] * 3)[:contact.scene.components]
                           for values in pair]) for pair in ((point.displacements, point.forces)
                                                             for point in found[first:])]
        external = sum(weights @ (0.5 * (b[1] + a[1]) * (b[0] - a[0]))
                       for a, b in zip(loads, loads[1:]))
        gained = found[-1].elastic_energy - found[first].elastic_energy
        assert external - interface == pytest.approx(gained,
                                                     abs=1e-5 * (abs(gained) + abs(interface)))
        done = found[-1].interface_work - found[first].interface_work
        apart.append(abs(done - interface))
        assert math.isnan(numbers[-1]["interfacial_energy"])
    assert 3.0 < apart[0] / apart[1] < 5.5 and apart[1] < 0.02 * abs(interface)


def test_works_cost_no_transform_and_survive_a_resume():
    load = Load(start="normal_displacement=0.5",
                path="normal_displacement=2; normal_displacement=0")
    branch = Branch(Scene(**LINE), load)
    found = list(branch)
    before = branch.contact.grid.counter.transforms
    stored(branch.contact, found[-1])
    PathEnergies(branch.contact, found[:3]).completed(found[3])
    assert branch.contact.grid.counter.transforms == before
    for done in (1, 2, 3, len(found) // 2, len(found) // 2 + 2):
        again = Branch(Scene(**LINE), load)
        again.history = [again.restored(branch.packed(point))
                         for point in found[max(0, done - 4):done]]
        rest = list(again)
        assert rest[-1].external_work == pytest.approx(found[-1].external_work, rel=1e-9)
        assert rest[-1].energy_imbalance == pytest.approx(found[-1].energy_imbalance, abs=1e-9)


def test_work_on_a_straight_way_is_the_difference_of_a_potential():
    contact = Branch(Scene(points=64, period=12.0, normal_maugis=2.0),
                     Load(path="normal_displacement=0.1")).contact
    near, far = states.undeformed(contact, ("displacement",), [0.5]), states.apart(contact)
    potential = [contact.grid.node_area * contact.grid.sum(contact.law.potential(
        state.displacement + contact.initial_gap)) for state in (near, far)]
    errors = [abs(straight(contact, near, far, panels)[0] / (potential[1] - potential[0]) - 1.0)
              for panels in (4, 8, 60)]
    assert errors[1] < 0.05 * errors[0] and errors[2] < 1e-9


@pytest.mark.parametrize("changes, start, path", [
    ({"normal_maugis": 5.0}, "normal_displacement=-3", "normal_displacement=-1"),
    ({"height": 2.0, "residual_friction": 0.0, "tangential_maugis": 2.0},
     "normal_displacement=0.5", "tangential_displacement=6")])
def test_a_jump_releases_what_it_dissipates(changes, start, path):
    """Both ends tell, whether the law has a potential or not; what the way there is like matters in
    the fourth digit. The way back would take as much."""
    contact, found, _ = points(changes, path, start)
    fold, jump = next(pair for pair in zip(found, found[1:]) if pair[1].event == "jump")
    free = [released(contact, *ends) @ ratios(contact)[:len(fold.forces)]
            for ends in ((fold.state, jump.state), (jump.state, fold.state))]
    lost = jump.dissipated_work - fold.dissipated_work
    known = not np.isnan(jump.interfacial_energy)
    assert free[0] == pytest.approx(lost, rel=1e-6 if known else 5e-3)
    assert free[1] == pytest.approx(-free[0], rel=1e-9)


@pytest.mark.parametrize("changes", [
    {}, {"dimension": 2, "geometry": "sphere", "points": 24, "period": 12.0}])
@pytest.mark.parametrize("symmetry", ["auto", "off"])
def test_works_out_of_the_range_of_the_law_are_those_of_fine_steps(changes, symmetry):
    """Where a force vanishes, far out of range, the law acts on none of the window's few nodes, but
    it did where the way began."""
    scene = Scene(**{"points": 128, "period": 12.0, "normal_maugis": 1.7, "height": 2.6,
                     "poisson": 0.3, **changes})
    form, kinds = Form(symmetry=symmetry), ("external_work", "interface_work")

    def path(start, end, step):
        return list(Branch(scene, Load(f"normal_displacement={start!r}", end),
                           Steps(initial_step=step, largest_step=step, at_fold="stop"), form))

    *_, before, released = path(-2.5, "normal_force=1", 0.4)
    assert released.event == "fold" and released.forces[0] == 0.0 and not released.in_contact
    stepped = path(float(before.displacements[0]), "normal_displacement=-15", 0.1)[-1]
    for kind in kinds:
        work = getattr(released, kind) - getattr(before, kind)
        assert work == pytest.approx(getattr(stepped, kind), rel=1e-3), kind


def test_a_jump_without_potential_needs_the_works_along_its_motion():
    contact, found, _ = points({}, "tangential_displacement=4")
    works = PathEnergies(contact, found[-3:-1])
    jump = works.completed(replace(found[-1], event="jump"))
    assert (jump.jump_balance == "unknown" and math.isnan(jump.dissipated_work)
            and math.isnan(jump.interface_work))
    assert math.isfinite(jump.external_work)
    before, jumped = found[-2], replace(found[-1], event="jump")
    free = jump.external_work - before.external_work - (jump.elastic_energy - before.elastic_energy)
    small = 2e-3 * abs(free)
    for work, viscous, lost in ((free - 0.1, 0.099, 0.1), (free - small, 0.1 * small, 0.1 * small),
                                (free - 10.0 * small, small, 10.0 * small),
                                (free + 0.001, 1e-4, 1e-4), (free - 0.1, -0.03, 0.1),
                                (free + 0.001, -1e-4, 0.0), (free + 0.001, math.nan, 0.0)):
        # A work on the interface whose error exceeds all that is lost says nothing of the latter;
        # one that is far off what viscosity takes says that the kick took the beginning.
        known = PathEnergies(contact, found[-3:-1]).completed(replace(jumped, jump_work=work,
                                                                      viscous_work=viscous))
        assert (known.jump_balance == "motion"
                and known.energy_imbalance == pytest.approx(before.energy_imbalance))
        assert known.dissipated_work == pytest.approx(lost)
        assert known.interface_work - before.interface_work == pytest.approx(free - lost)


def test_the_loss_of_a_jump_in_a_bracket_is_one_that_ways_without_detours_have():
    """A short step of hardly any slip as a jump under the loads of its begin: these do less than
    body and interface take up by half of what they change, whatever another motion tells."""
    contact, found, _ = points({}, "tangential_displacement=4")
    before, after = found[-2], replace(found[-1], event="jump")
    fold = replace(before, event="fold", fold_precision=1e-3)
    missing = -0.5 * (after.forces - before.forces) @ (after.displacements - before.displacements)
    for told in (0.7, -0.7):
        works = PathEnergies(contact, found[-4:-1])
        lost = works.completed(fold).dissipated_work
        lost = works.completed(replace(after, jump_work=told)).dissipated_work - lost
        assert lost == pytest.approx(missing, rel=1e-2)


def test_ways_around_corners_do_what_their_straight_parts_do():
    """In each part one component alone moves, so that its own traction does the work."""
    contact, found, _ = points({}, "tangential_displacement=4")
    first, last = states.with_components(found[0].state, 2), found[-1].state
    (start, end), law = (states.onto(state, last.window) for state in (first, last)), contact.law
    start, end = start.copy(), end.copy()
    for displacement in (start, end):
        displacement[0] += last.window.take(contact.initial_gap)
    for own, middle in zip(corners(contact, first, last), ([end[0], start[1]], [start[0], end[1]])):
        done = np.zeros(2)
        for one, other in ((start, np.array(middle)), (np.array(middle), end)):
            places = np.linspace(0.0, 1.0, 4001)
            rates = [np.sum(law.traction(one + place * (other - one)) * (other - one), axis=1)
                     for place in places]
            done += trapezoid(rates, places, axis=0)
        np.testing.assert_allclose(own, contact.grid.node_area * done, rtol=1e-5, atol=1e-9)


# Loops

def test_a_path_without_folds_retraces_itself_and_the_program_says_what_that_means():
    ends = [2.0, 6.0, 12.0]
    legs = [f"tangential_displacement={end}" for end in (*ends, *ends[-2::-1], 0.0, 2.0)]
    sentences = []
    branch = Branch(Scene(**LINE), Load(start="normal_displacement=1", path="; ".join(legs)),
                    log=sentences.append)
    found = list(branch)
    reached = [branch.observe(point) for point in found if point.position == 1.0 or point.leg == 0]
    assert {point.event for point in found} == {None} and len(reached) == 1 + len(legs)
    there, back = [reached[0], *reached[1:3]], [reached[6], *reached[5:3:-1]]
    for one, other in zip(there, back):
        for name in ("normal_force", "tangential_force", "mean_tangential_displacement",
                     "contact_area", "elastic_energy"):
            assert one[name] == pytest.approx(other[name], abs=1e-7), name
        assert one["interface_work"] == pytest.approx(other["interface_work"], abs=1e-6)
    assert reached[-1]["dissipated_work"] == 0.0
    assert len([sentence for sentence in sentences if "no memory" in sentence]) == 1


@pytest.mark.parametrize("step, most", ((0.2, 3e-3), (0.05, 5e-5)))
def test_area_of_a_loop_is_what_its_jumps_dissipate(step, most):
    # jump-in and pull-off of a line contact under displacement control
    _, found, numbers = points({"normal_maugis": 3.0},
                               "normal_displacement=2; normal_displacement=-5",
                               "normal_displacement=-5", step)
    events = [(row["event"], row["fold_kind"]) for row in numbers if row["event"] != "none"]
    assert (events[:2] == [("fold", "jump_in"), ("jump", "")]
            and events[2:] == [("fold", "pull_off"), ("jump", ""), ("pull_off", "")])
    area = sum(0.5 * (one["normal_force"] + other["normal_force"]) * (other["normal_displacement"]
                                                                      - one["normal_displacement"])
               for one, other in zip(numbers, numbers[1:]))
    last, jumps = numbers[-1], [k for k, row in enumerate(numbers) if row["event"] == "jump"]
    lost = [numbers[k]["dissipated_work"] - numbers[k - 1]["dissipated_work"] for k in jumps]
    assert ({row["jump_balance"] for row in numbers} == {"", "potential"}
            and {numbers[k]["jump_balance"] for k in jumps} == {"potential"})
    assert min(lost) > 0.1 and sum(lost) == pytest.approx(last["dissipated_work"], rel=1e-12)
    assert last["external_work"] == pytest.approx(last["dissipated_work"], abs=most)
    assert last["external_work"] == pytest.approx(area, abs=0.3 * step)
    assert last["interface_work"] == pytest.approx(0.0, abs=1e-9)


def test_jumps_under_a_force_dissipate_the_work_of_the_force_too():
    branch = Branch(Scene(**LINE), Load(start="normal_displacement=-4",
                                        path="normal_force=1; normal_force=-5"),
                    Steps(largest_step=0.1))
    found = []
    with pytest.raises(NoEquilibrium):
        for point in branch:
            found.append(point)
    at = [point.event for point in found].index("jump")
    before, after = found[at - 1], found[at]
    work = before.forces[0] * (after.displacements[0] - before.displacements[0])
    energy = [point.elastic_energy + point.interfacial_energy for point in (before, after)]
    assert after.dissipated_work == pytest.approx(work - energy[1] + energy[0],
                                                  rel=1e-12) and after.dissipated_work > 1.0
    assert found[-1].event == "fold" and abs(found[-1].energy_imbalance) < 1e-3


@pytest.mark.parametrize("changes, start, path, step, events",
                         (({"height": 4.0, "poisson": 0.45, "tangential": "off",
                            "normal_maugis": 4.0}, "normal_displacement=-4",
                           "normal_displacement=1; normal_displacement=-4", 0.2,
                           ["fold", "jump", "fold", "jump", "pull_off"]),
                          ({"dimension": 2, "geometry": "sphere", "points": 64, "period": 8.0,
                            "normal_maugis": 4.0}, "normal_displacement=-2",
                           "normal_displacement=0.5; normal_displacement=-2", 0.1,
                           ["fold", "jump", "fold", "jump", "pull_off"]),
                          ({"points": None, "period": math.inf, "height": math.inf, "spacing": 0.04,
                            "normal_maugis": 3.0}, None, "normal_force=1; normal_force=-1.6", 0.2,
                           ["fold", "jump"])), ids=("layer", "plane", "isolated cylinder"))
def test_balance_closes_through_folds_and_jumps(changes, start, path, step, events):
    _, found, _ = points(changes, path, start, step)
    assert [point.event for point in found if point.event] == events
    assert found[-1].dissipated_work > 0.3 and abs(
        found[-1].energy_imbalance) < 2e-3 * found[-1].dissipated_work


def test_a_run_ends_with_what_its_jumps_dissipated():
    path = Load(start="normal_displacement=-5", path="normal_displacement=1")
    branch = Branch(Scene(**LINE), path)
    progress = Progress(Scene(**LINE), path, [].append, live=False)
    for point in branch:
        progress.point(branch.observe(point), point.position)
    assert (f"dissipated    {point.dissipated_work:.6g} w_n,r u_n,r in jumps" in progress.summary(0)
            and point.dissipated_work > 0.1)
    assert "dissipated" not in Progress(Scene(**LINE), path, [].append, live=False).summary(0)


@pytest.mark.parametrize("part, told", [(0.05, True), (-3e-3, True), (1e-3, False),
                                        (math.nan, False)])
def test_a_run_says_where_its_works_are_not_known(part, told):
    path = Load(start="normal_displacement=1", path="normal_displacement=2")
    branch = Branch(Scene(**LINE), path)
    progress = Progress(Scene(**LINE), path, [].append, live=False)
    for point in branch:
        row = branch.observe(point)
        progress.point({**row, "energy_imbalance": part * row["external_work"]}, point.position)
    assert ("is missing in the balance of energies" in progress.summary(0)) is told
