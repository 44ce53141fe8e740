"""Linear systems of many spots on two grids: against dense operators, NumPy beside the library, and
in paths that lose their stability."""

from dataclasses import replace

import numpy as np
import pytest

from contactsnes import Branch, Contact, Form, Load, Scene, Steps
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import DISPLACEMENT
from contactsnes.grid.active import Nodes
from contactsnes.kernels import library
from contactsnes.kernels.choice import chosen
from contactsnes.kernels.krylov import Rows
from contactsnes.solvers import krylov, patch_systems, spots, two_grids
from contactsnes.solvers.core_zone import CoreOptions
from contactsnes.solvers.patch_systems import APART, WITHIN, Patches
from contactsnes.solvers.ritz import Ritz
from contactsnes.solvers.snes import create_snes
from contactsnes.solvers.vectors import create_vector

POINTS = 16, 24


@pytest.fixture
def small(monkeypatch):
    """Few nodes have two grids, too."""
    monkeypatch.setattr(two_grids, "LARGE", 1)


@pytest.fixture
def exact(monkeypatch):
    """Systems of patches are solved as far as rounding allows."""
    monkeypatch.setattr(patch_systems, "LEFT", 1e-13)


def form_on(window=lambda grid: grid.whole, kernels=True):
    """A form of a rough plane on a window of its cell."""
    contact = Contact(Scene(dimension=2, points=POINTS, period=(8.0, 12.0), geometry="rough",
                            rough_on="flat", rough_longest=6.0, rough_shortest=3.0,
                            rough_slope=1.0, normal_maugis=2.0), kernels=chosen(kernels))
    return DisplacementForm(contact, window(contact.grid), (DISPLACEMENT,))


def some(grid):
    """Three fifths of the nodes of the cell: of some patches none."""
    kept = np.random.default_rng(2).random(grid.size) < 0.6
    kept.reshape(grid.shape)[4:8, 8:12] = False
    return Nodes(grid.whole, np.flatnonzero(kept))


def tangent_of(form, pulls=-0.2):
    """A tangent that is stiff at some nodes and softens at others."""
    largest = 2.0 / patch_systems.compliance_between(form.contact, 0, APART)
    return largest * np.random.default_rng(5).uniform(pulls, 1.0, form.nodes)


def patches_of(form, tangent, single=False):
    """The component's patches with a tangent."""
    made = Patches(form, 0, 1.25, single)
    made.take(tangent)
    return made


def matrix(apply, size):
    """Matrix of what replaces a field."""
    def column(unit):
        apply(unit)
        return unit

    return np.array([column(unit) for unit in np.eye(size)]).T


def dense(form, tangent):
    """I + c (I - P R) D + P C R D of dense matrices, C by FFTs."""
    contact, window = form.contact, form.window
    shape = [points // APART for points in POINTS]
    waves = [2.0 * np.pi * np.fft.fftfreq(n, APART * spacing)
             for n, spacing in zip(shape, contact.grid.spacings)]
    wave = np.hypot(waves[0][:, None], waves[1][None])
    compliance = np.divide(1.0, wave, out=np.zeros(shape), where=wave > 0.0)
    compliance *= contact.operator(1).blocks[0, 0][0, 1] * contact.grid.size * waves[1][1]
    within = WITHIN * max(compliance[0, shape[1] // 2], compliance[shape[0] // 2, 0])
    count = compliance.size
    places = getattr(window, "places", np.arange(window.size))
    rows, columns = np.divmod(places, POINTS[1])
    spread = np.zeros((len(places), count))
    spread[np.arange(len(places)), rows // APART * shape[1] + columns // APART] = 1.0
    mean = spread.T / np.maximum(spread.sum(axis=0), 1.0)[:, None]
    unit = np.fft.fft2(np.eye(count).reshape(count, *shape))
    coarse = np.fft.ifft2(compliance * unit).real.reshape(count, count).T
    response = np.diag(tangent)
    return (np.eye(len(places)) + within * (response - spread @ mean @ response)
            + spread @ coarse @ spread.T @ response / APART ** 2)


@pytest.mark.parametrize("kernels", [True, False], ids=["library", "numpy"])
@pytest.mark.parametrize("window", [lambda grid: grid.whole, some], ids=["cell", "some nodes"])
def test_patches_are_the_inverse_that_they_say(exact, kernels, window):
    form = form_on(window, kernels)
    tangent = tangent_of(form)
    found = matrix(patches_of(form, tangent).apply, form.nodes)
    np.testing.assert_allclose(found @ dense(form, tangent), np.eye(form.nodes), atol=1e-9)


@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
def test_numpy_and_the_library_do_the_same(single):
    given, found = np.random.default_rng(7).standard_normal(POINTS[0] * POINTS[1]), []
    for kernels in (True, False):
        form = form_on(kernels=kernels)
        made, field = patches_of(form, tangent_of(form), single), given.copy()
        made.apply(field)
        found.append([*field, made.softest])
    np.testing.assert_allclose(*found, rtol=1e-4 if single else 1e-10, atol=1e-5 if single else 0)


@pytest.mark.skipif(library.reason() is not None, reason="no compiled library")
@pytest.mark.parametrize("window", [lambda grid: grid.whole, some], ids=["cell", "some nodes"])
@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
def test_what_stands_for_patches_tells_what_was_made(window, single):
    """A sum of what was made of fields follows from these and from what stood for patches in
    it."""
    form = form_on(window)
    made, random = patches_of(form, tangent_of(form), single), np.random.default_rng(4)
    fields = random.standard_normal((5, form.nodes)).astype(np.float32)
    factors, out = random.standard_normal(5), random.standard_normal(form.nodes)
    expected, stood = out.copy(), []
    for field, factor in zip(fields, factors):
        own = field.astype(float)
        made.apply(own)
        stood.append(made.library.stands.copy())
        expected += factor * own
    made.library.add(Rows(fields).places(), factors, stood, out)
    np.testing.assert_allclose(out, expected, atol=1e-5)


@pytest.mark.skipif(library.reason() is not None, reason="no compiled library")
@pytest.mark.parametrize("rounds", [False, True], ids=["single", "rounded"])
@pytest.mark.parametrize("until", [2, np.inf], ids=["taken over", "throughout"])
def test_cycles_keep_what_stands_for_patches(small, monkeypatch, rounds, until):
    """A row of a sixteenth of the nodes for each that is preconditioned, also where the zone takes
    over in the middle of a cycle (asked when it is set up, and after each one): the residual is
    what was asked for."""
    monkeypatch.setattr(krylov, "LARGE", 1)
    monkeypatch.setattr(krylov, "WIDE", 1 if rounds else np.inf)
    form, kept, asked = form_on(), [], []
    monkeypatch.setattr(two_grids.CompiledTwoGrids, "softest", property(
        lambda own: asked.append(0) or (-1.0 if len(asked) > until else 1.0)))
    snes = create_snes(form, single=True, packed=True)
    form.linearise(np.zeros(form.size))
    form.tangent[0, 0] = tangent_of(form, -0.24)
    snes.setUseEW(False)
    ksp, matrix = snes.getKSP(), snes.getJacobian()[0]
    matrix.assemble()
    ksp.setOperators(matrix)
    ksp.setTolerances(rtol=3e-4, atol=1e-50)
    grids = ksp.getPC().getPythonContext()
    assert isinstance(grids, spots.SpotsPC)
    make = krylov.Basis.make
    monkeypatch.setattr(krylov.Basis, "make", lambda own, place: kept.append(own._size)
                        or make(own, place))
    right, found = (create_vector(form) for _ in range(2))
    right.setArray(np.random.default_rng(3).standard_normal(form.size))
    ksp.solve(right, found)
    count = ksp.getIterationNumber()
    assert count > 3 and (grids.is_ours == (until < np.inf))
    patches = form.nodes // APART ** 2
    assert kept.count(form.nodes) == count
    assert kept.count(patches) == min(count, until)
    left = form.apply_jacobian(found.getArray(), np.empty(form.size)) - right.getArray()
    assert np.linalg.norm(left) < 3.03e-4 * right.norm()


def test_means_of_waves_on_a_uniform_law_are_answered_exactly(exact):
    """1 / (1 + C D) of the cell's own compliance, which patches have of waves that they tell
    apart."""
    form, tangent = form_on(), np.full(POINTS[0] * POINTS[1], 0.3)
    wave = np.cos(2.0 * np.pi * np.indices(POINTS)[1] / POINTS[1]).ravel()
    field = wave.copy()
    patches_of(form, tangent).apply(field)
    before, after = (values.reshape(POINTS[0] // APART, APART, POINTS[1] // APART, APART).mean(
        axis=(1, 3)) for values in (wave, field))
    compliance = form.contact.operator(1).blocks[0, 0][0, 1] * form.grid.size
    np.testing.assert_allclose(after, before / (1.0 + 0.3 * compliance), atol=1e-9)


def test_a_mode_that_patches_have_is_told(exact):
    """A law that softens all over by more than the body is stiff has unstable modes, and these a
    negative Ritz value; one that is stiff all over has none."""
    form = form_on()
    compliance = form.contact.operator(1).blocks[0, 0][0, 1] * form.grid.size
    field = np.random.default_rng(1).standard_normal(form.nodes)
    softening = np.full(form.nodes, -1.5 / compliance)
    softening[:4 * POINTS[1]] = 0.5 / compliance  # there is a core to make a zone for
    made = patches_of(form, softening)
    made.apply(field.copy())
    assert made.softest < 0.0
    made.take(tangent_of(form, pulls=0.0))
    if made.library:  # what was solved with another tangent tells nothing
        made.tell(made.library.matrix)
    assert np.isnan(made.softest)
    made.apply(field.copy())
    assert made.softest > 0.0
    with pytest.raises(two_grids.Unsuited):
        made.take(np.full(form.nodes, -0.1 / compliance))


@pytest.mark.parametrize("kernels", [True, False], ids=["library", "numpy"])
@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_what_is_no_number_is_passed_on(kernels, number):
    """PETSc then tells of it; nothing is raised on the way."""
    form = form_on(kernels=kernels)
    made, field = patches_of(form, tangent_of(form)), np.ones(form.nodes)
    field[7] = number
    with np.errstate(all="ignore"):
        made.apply(field)
    assert not np.isfinite(field).all() and np.isnan(made.softest)


def test_stiff_laws_and_steep_softening_have_no_patches(small):
    form = form_on(kernels=False)
    between = patch_systems.compliance_between(form.contact, 0, APART)
    for tangent, suits in ((two_grids.SOFT, True), (1.01 * two_grids.SOFT, False)):
        form.tangent[0, 0] = 0.999 * tangent / between
        for steep in (0.0, 1.01 * two_grids.PULLS):
            form.tangent[0, 0, 0] = -steep / between
            if suits and not steep:
                two_grids.TwoGrids(form, CoreOptions(), False, {})
            else:
                with pytest.raises(two_grids.Unsuited):
                    two_grids.TwoGrids(form, CoreOptions(), False, {})


def test_what_suits(small, monkeypatch):
    """Planes with many spots, of any set of nodes; neither lines nor contacts of one spot, nor
    three components."""
    sheared = DisplacementForm(form_on().contact, form_on().contact.grid.whole, 3 * (DISPLACEMENT,))
    assert not two_grids.suits(sheared)
    assert two_grids.suits(form_on()) and two_grids.suits(form_on(some))
    sphere = Contact(Scene(dimension=2, points=16, period=8.0, geometry="sphere"))
    odd = Contact(Scene(dimension=2, points=(18, 16), period=(9.0, 8.0), geometry="rough",
                        rough_on="flat", rough_longest=4.0, rough_shortest=2.0,
                        rough_slope=1.0))
    line = Contact(Scene(points=64, period=8.0))
    for contact in (sphere, odd, line):
        assert not two_grids.suits(DisplacementForm(contact, contact.grid.whole, (DISPLACEMENT,)))
    monkeypatch.setattr(two_grids, "LARGE", 2 ** 14)
    assert not two_grids.suits(form_on())


class Spots:
    """What a monitor asks of `spots.SpotsPC`."""

    begun = 0

    def __init__(self, softest):
        self.softest = softest

    def begin(self):
        """Count solves."""
        self.begun += 1


@pytest.mark.parametrize("within, outer, expected", [
    (-0.1, [0.9, 1.0, 1.1], -0.1), (0.4, [-0.2, 1.0, 1.1], -0.2), (0.4, [0.9, 1.1], 0.4),
    (np.nan, [0.9, 1.0, 1.1], 0.9), (np.nan, [0.9, 1.1], np.nan)])
def test_ritz_values_of_both_grids_are_told(monkeypatch, within, outer, expected):
    from contactsnes.solvers import ritz

    class Solver:
        def getKSP(self):
            return self

    monkeypatch.setattr(ritz, "ritz_values", lambda ksp: np.array(outer, dtype=complex))
    spots = Spots(within)
    monitor = Ritz(spots)
    for iteration in (0, 1):
        monitor(Solver(), iteration, 1.0)
    assert spots.begun == 1
    np.testing.assert_equal(monitor.smallest, expected)


def sticky(**changes):
    """A rough flat that jumps out of contact, spot by spot."""
    return Scene(**{"dimension": 2, "points": 64, "period": 8.0, "geometry": "rough",
                    "rough_on": "flat", "rough_slope": 1.0, "rough_longest": 8.0, "rough_seed": 2,
                    "rough_shortest": 1.0, "normal_maugis": 3.0, **changes})


PATHS = {"pulled": (sticky(), Load("normal_displacement=0", "normal_displacement=-0.8")),
         "pulled by a force": (sticky(period=12.0, rough_slope=2.0, rough_shortest=1.5,
                                      normal_maugis=2.0),
                               Load("normal_displacement=1", "normal_force=-30"))}


@pytest.mark.parametrize("name, kernels", [
    *((name, "auto") for name in PATHS), ("pulled", "off"),
    pytest.param("pulled by a force", "off", marks=pytest.mark.study)])
def test_paths_are_those_of_the_zone(monkeypatch, name, kernels):
    """The same events and points, of fewer iterations."""
    scene, load = PATHS[name]

    def followed(large):
        monkeypatch.setattr(two_grids, "LARGE", large)
        branch = Branch(scene, load, Steps(initial_step=0.1, largest_step=0.1),
                        form=Form(kernels=kernels))
        points = list(branch)
        return points, sum(point.spent["linear_iterations"] for point in points[1:])

    (points, iterations), (others, expected) = followed(1), followed(np.inf)
    assert [point.event for point in points if point.event] == [
        point.event for point in others if point.event]
    np.testing.assert_allclose(points[-1].forces, others[-1].forces, rtol=1e-6)
    assert iterations < 0.8 * expected


def test_unstable_equilibria_are_told(monkeypatch):
    """Solved again from beside a branch beyond a fold, with the zone and on two grids."""
    scene, load = PATHS["pulled"]
    branch = Branch(scene, load, Steps(initial_step=0.1, largest_step=0.1, at_fold="trace",
                                       locate_folds=True, stability="eigenvalue"))
    unstable = next(point for point in branch if point.stable == 0 and not point.event)
    for large in (1, np.inf):
        monkeypatch.setattr(two_grids, "LARGE", large)
        again = Branch(scene, load, Steps()).corrector
        beside = replace(unstable.state, displacement=unstable.state.displacement + 1e-3)
        point = again.solve(beside, unstable.controls, unstable.load)
        assert point.softest < 0.0


@pytest.mark.parametrize("method, offered", [("fgmres", True), ("gmres", False), ("bcgs", False)])
def test_krylov_methods_that_need_one_function_have_the_zone(small, options, method, offered):
    options(ksp_type=method)
    pc = create_snes(form_on()).getKSP().getPC()
    context = pc.getPythonContext() if pc.getType() == "python" else None
    assert isinstance(context, spots.SpotsPC) == offered


@pytest.mark.parametrize("name", ["none", "jacobi"])
def test_other_preconditioners_are_left_alone(small, options, name):
    options(pc_type=name)
    assert create_snes(form_on()).getKSP().getPC().getType() == name


@pytest.mark.parametrize("kernels", [True, False], ids=["library", "numpy"])
def test_what_a_solver_says_of_itself(small, capfd, kernels):
    create_snes(form_on(kernels=kernels)).view()
    assert "two grids, of nodes and of patches of nodes" in capfd.readouterr().out
