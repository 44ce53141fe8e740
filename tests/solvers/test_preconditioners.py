"""Preconditioners against dense Jacobians of small contacts, and against exact inverses where those
are known."""

import numpy as np
import pytest
from scipy.special import lambertw

from contactsnes.contact import states
from contactsnes.contact.bordered import ArcLength
from contactsnes.contact.force_form import ForceForm
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import DISPLACEMENT, FORCE, Contact
from contactsnes.options.fields import InputError
from contactsnes.scene.settings import Scene
from contactsnes.solvers.core_zone import CoreOptions, CoreZone, core_of, inverse
from contactsnes.solvers.preconditioners import ArcElimination, ZonedStiffness

CONTROLS = [(DISPLACEMENT,), (FORCE,), (DISPLACEMENT, DISPLACEMENT), (FORCE, DISPLACEMENT),
            (DISPLACEMENT, FORCE), (FORCE, FORCE)]
every_control = pytest.mark.parametrize("controls", CONTROLS,
                                        ids=lambda controls: "-".join(control[0]
                                                                      for control in controls))
either_body = pytest.mark.parametrize("poisson", [0.5, 0.3])


def dense(apply, size):
    """Matrix of a linear function apply(vector, out)."""
    return np.array([apply(column, np.empty(size)) for column in np.eye(size)]).T


def iterations(matrix, tolerance=1e-6):
    """Iterations of GMRES without restart for a random right side, by least squares on the Krylov
    space."""
    right = np.random.default_rng(11).normal(size=len(matrix))
    basis = [right / np.linalg.norm(right)]
    while True:
        images = matrix @ np.array(basis).T
        rest = right - images @ np.linalg.lstsq(images, right, rcond=None)[0]
        if np.linalg.norm(rest) <= tolerance * np.linalg.norm(right):
            return len(basis)
        fresh = images[:, -1]
        for _ in range(2):
            fresh = fresh - np.array(basis).T @ (np.array(basis) @ fresh)
        basis.append(fresh / np.linalg.norm(fresh))


def contact_of(points=256, **changes):
    return Contact(Scene(**{"points": points, "period": 20.0, "normal_maugis": 3.0,
                            "tangential_maugis": 2.0, **changes}))


def pressed(contact, controls, half=2.5, deep=2.0, slip=0.4):
    """The displacement form of a round contact of radius ``half`` that overlaps by ``deep`` ranges,
    linearised there.

    The pressure -a exp(-a) is that of Hertz, so that the overlap is a Lambert function of it, as in
    an equilibrium.
    """
    radius = np.sqrt(sum(x ** 2 for x in contact.grid.coordinates())) / half
    pressure = deep * np.exp(deep) * np.sqrt(np.maximum(1.0 - radius ** 2, 0.0))
    gap = np.where(radius < 1.0, -lambertw(pressure).real,
                   67.5 * np.maximum(radius - 1.0, 0.0) ** 1.5)
    window = contact.window(gap)
    form = DisplacementForm(contact, window, controls)
    field = np.zeros(form.shape)
    field[0] = window.take(gap) - form.initial_gap
    field[1:] = slip * np.cos(window.take(radius) * half / 4.0)
    form.set_load(np.ones(len(controls)))
    unknown = form.pack(field, np.zeros(len(form.forced)))
    form.linearise(unknown)
    return form, unknown


def on_cell(form, unknown):
    """The force form of the same contact, linearised at the same state."""
    cell = ForceForm(form.contact, form.controls)
    cell.set_load(form.load)
    state = states.State(form.window, form.displacement(unknown), np.zeros(form.components))
    cell.linearise(cell.pack(states.onto(state, cell.window)))
    return cell


def uniform(form_of, controls, gap=-0.4, slip=0.1, **changes):
    """A form of two flats at a uniform gap, linearised there; without coupling of the components,
    by law and body."""
    contact = contact_of(points=64, geometry="flat", **changes)
    form = (DisplacementForm(contact, contact.grid.whole, controls) if form_of is DisplacementForm
            else ForceForm(contact, controls))
    field = np.full(form.shape, slip)
    field[0] = gap - form.initial_gap
    form.set_load(np.ones(len(controls)))
    unknown = form.pack(field, np.zeros(len(form.forced)))
    form.linearise(unknown)
    return form, unknown


class Rigid:
    """Stands for the convolution with the compliance of a body that does not deform."""

    def apply(self, values, out):
        out[...] = 0.0
        return out


def rigid_form(controls, **changes):
    """A form without mean-free compliance and with a random tangent that is nowhere stiff: no core
    is left."""
    contact = contact_of(points=32, **changes) if "dimension" not in changes else Contact(
        Scene(normal_maugis=3.0, points=(16, 16), period=(15.0, 14.0), geometry="sphere",
              **changes))
    form = DisplacementForm(contact, contact.grid.whole, controls)
    form.set_load(np.linspace(0.5, 2.0, len(controls)))
    form.convolution = Rigid()
    return form


def random_tangent(form):
    form.tangent[...] = np.random.default_rng(5).uniform(-1.0, 1.0, form.tangent.shape)
    for i in range(form.components):
        form.tangent[i, i] = -np.abs(form.tangent[i, i]) - 0.1


# The core zone


@every_control
@either_body
def test_core_zone_gathers_the_eigenvalues(controls, poisson):
    """A condition number of thousands falls to ten; without preconditioner the stiffest eigenvalue
    is in the hundreds."""
    form, _ = pressed(contact_of(poisson=poisson), controls)
    jacobian = dense(form.apply_jacobian, form.size)
    inverse = dense(CoreZone(form).apply, form.size)
    assert np.linalg.cond(jacobian) > 1000 and np.abs(np.linalg.eigvals(jacobian)).max() > 500
    assert np.linalg.cond(jacobian @ inverse) < 15
    eigenvalues = np.linalg.eigvals(jacobian @ inverse)
    assert eigenvalues.real.min() > 0.25 and np.abs(eigenvalues).max() < 2.0


@pytest.mark.parametrize("controls", [(DISPLACEMENT,), (FORCE,)], ids=["displacement", "force"])
def test_core_zone_does_not_depend_on_the_grid(controls):
    counts = []
    for points in (512, 1024):
        form, _ = pressed(contact_of(points), controls)
        counts.append(iterations(dense(form.apply_jacobian, form.size) @ dense(CoreZone(form).apply,
                                                                               form.size)))
    assert counts[1] <= counts[0]


@pytest.mark.parametrize("deep", [0.5, 4.0, 7.0])
def test_core_zone_holds_for_shallow_and_deep_contact(deep):
    """Tangents up to e^7 (1 + 7): few iterations, where the Jacobian alone takes one for most waves
    of the contact."""
    form, _ = pressed(contact_of(512), (DISPLACEMENT,), deep=deep)
    jacobian = dense(form.apply_jacobian, form.size)
    inverse = dense(CoreZone(form).apply, form.size)
    few, many = iterations(jacobian @ inverse), iterations(jacobian)
    assert few < 25 and few < 0.4 * many


def test_core_zone_in_two_dimensions():
    contact = Contact(Scene(dimension=2, points=(16, 16), period=(7.0, 8.0), geometry="sphere",
                            normal_maugis=2.0, tangential_maugis=1.0))
    form, _ = pressed(contact, (FORCE, DISPLACEMENT, FORCE), slip=0.2)
    jacobian = dense(form.apply_jacobian, form.size)
    inverse = dense(CoreZone(form).apply, form.size)
    assert iterations(jacobian @ inverse) < 0.5 * iterations(jacobian)


def test_core_zone_is_exact_for_waves_on_a_uniform_foundation():
    """Two flats: 1 + C D is diagonal in Fourier space; the mean alone, which is no wave, is treated
    otherwise."""
    for controls in ((DISPLACEMENT,), (DISPLACEMENT, DISPLACEMENT)):
        form, _ = uniform(DisplacementForm, controls)
        jacobian = dense(form.apply_jacobian, form.size)
        inverse = dense(CoreZone(form).apply, form.size)
        waves = np.random.default_rng(2).normal(size=form.shape)
        waves -= waves.mean(axis=1, keepdims=True)
        np.testing.assert_allclose(inverse @ jacobian @ waves.ravel(), waves.ravel(), atol=1e-11)


@every_control
@either_body
def test_scalars_are_eliminated_exactly(controls, poisson):
    """Without cores only the scalars and the rigid compliance are left: M is the inverse, the law's
    coupling included."""
    form = rigid_form(controls, poisson=poisson)
    random_tangent(form)
    product = dense(form.apply_jacobian, form.size) @ dense(CoreZone(form).apply, form.size)
    np.testing.assert_allclose(product, np.eye(form.size), atol=1e-8)


def test_scalars_are_eliminated_exactly_in_two_dimensions():
    form = rigid_form((FORCE, DISPLACEMENT, FORCE), dimension=2, poisson=0.3)
    random_tangent(form)
    product = dense(form.apply_jacobian, form.size) @ dense(CoreZone(form).apply, form.size)
    np.testing.assert_allclose(product, np.eye(form.size), atol=1e-8)


@every_control
@either_body
def test_the_load_is_eliminated_exactly(controls, poisson):
    form = rigid_form(controls, poisson=poisson)
    rng = np.random.default_rng(8)
    anchor, tangent = rng.normal(size=(2, form.size))
    arc = ArcLength(form, np.zeros(len(controls)), rng.uniform(1.0, 2.0, len(controls)), anchor,
                    tangent, 0.3)
    arc.linearise(np.append(anchor, 0.4))
    random_tangent(form)
    product = dense(arc.apply_jacobian, arc.size) @ dense(ArcElimination(arc).apply, arc.size)
    np.testing.assert_allclose(product, np.eye(arc.size), atol=1e-5)


def test_a_body_off_the_flat_has_no_core():
    """The tangent is nowhere positive; M is the identity where nothing is eliminated."""
    contact = contact_of(gap_offset=2.0)
    form = DisplacementForm(contact, contact.grid.whole, (DISPLACEMENT,))
    form.set_load([0.0])
    form.linearise(np.zeros(form.size))
    vector = np.random.default_rng(0).normal(size=form.size)
    assert core_of(form, 0, CoreOptions()) is None
    np.testing.assert_array_equal(CoreZone(form).apply(vector, np.empty(form.size)), vector)


@every_control
@pytest.mark.parametrize("offset", [2.0, 10.0, 400.0])
def test_nothing_breaks_off_the_flat(controls, offset):
    """Where nothing answers to a force, up to a law that is exactly zero, M stays finite."""
    contact = contact_of(gap_offset=offset)
    form = DisplacementForm(contact, contact.grid.whole, controls)
    form.set_load(np.zeros(len(controls)))
    form.linearise(np.zeros(form.size))
    for zone, size in ((CoreZone(form), form.size),
                       (ZonedStiffness(on_cell(form, np.zeros(form.size))), form.count)):
        assert np.all(np.isfinite(zone.apply(np.random.default_rng(0).normal(size=size),
                                             np.empty(size))))


@pytest.mark.parametrize("controls", [(DISPLACEMENT, DISPLACEMENT), (FORCE, DISPLACEMENT),
                                      (FORCE, FORCE)])
def test_tangents_that_are_but_rounding_make_no_core(controls):
    """In gross sliding without weakening the tangential tangent is zero in contact and below
    rounding beyond it.

    Through the adhesion that fades with slip the Jacobian is regular nevertheless.
    """
    form, unknown = pressed(contact_of(), controls, slip=1.5)
    assert form.tangent[1, 1].max() < 1e-10
    cell = on_cell(form, unknown)
    for problem, zone in ((form, CoreZone(form)), (cell, ZonedStiffness(cell))):
        largest = np.linalg.norm(dense(zone.apply, problem.size), 2)
        assert largest < 1e3 * np.linalg.norm(np.linalg.inv(dense(problem.apply_jacobian,
                                                                  problem.size)), 2)


def test_weight_of_the_core():
    """One inside, zero outside, between the two over the width; the mean tangent is that of the
    core."""
    form, _ = pressed(contact_of(512), (DISPLACEMENT,), slip=0.0)
    tangent = form.tangent[0, 0]
    core = core_of(form, 0, CoreOptions(threshold=0.5, width=0.0))
    np.testing.assert_array_equal(core.everywhere(form.window), tangent > 0.5)
    assert core.tangent == pytest.approx(tangent[tangent > 0.5].mean())
    smooth = core_of(form, 0, CoreOptions(threshold=0.5, width=0.6)).everywhere(form.window)
    x = form.window.coordinates()[0]
    edge = np.abs(x[tangent > 0.5]).max()
    # 0.6 / lambda_n is a fifth of beta; three times that is about the reach of three running means.
    np.testing.assert_allclose(smooth[np.abs(x) < edge - 0.6], 1.0)
    np.testing.assert_allclose(smooth[np.abs(x) > edge + 0.6], 0.0, atol=1e-12)
    assert (np.all(np.diff(smooth[x >= 0.0]) <= 1e-12) and smooth.min() >= 0.0
            and smooth.max() <= 1.0)


# The two zones of the force form


@every_control
@either_body
def test_two_zones_gather_the_eigenvalues(controls, poisson):
    """But for one eigenvalue (the mean of a rigid body under displacement control) all lie within a
    factor of ten."""
    form = on_cell(*pressed(contact_of(192), controls))
    jacobian = dense(form.apply_jacobian, form.size)
    inverse = dense(ZonedStiffness(form).apply, form.size)
    eigenvalues = np.sort(np.abs(np.linalg.eigvals(jacobian @ inverse)))
    assert np.linalg.cond(jacobian) > 1000
    assert eigenvalues[0] > 0.2 and eigenvalues[-2] < 2.0 and eigenvalues[-1] < 25.0


@every_control
def test_two_zones_are_exact_on_a_uniform_foundation(controls):
    """Two flats: K + D is diagonal in Fourier space, the balance of the mean included, whatever is
    controlled."""
    form, _ = uniform(ForceForm, controls)
    product = dense(form.apply_jacobian, form.size) @ dense(ZonedStiffness(form).apply, form.size)
    np.testing.assert_allclose(product, np.eye(form.size), atol=1e-9)


# All of them


def every_preconditioner():
    form, unknown = pressed(contact_of(128, poisson=0.3), (FORCE, DISPLACEMENT))
    rng = np.random.default_rng(4)
    arc = ArcLength(form, np.zeros(2), np.ones(2), unknown, rng.normal(size=form.size), 0.1)
    arc.linearise(np.append(unknown, 1.0))
    cell = on_cell(form, unknown)
    return [(CoreZone(form), form.size), (ArcElimination(arc), arc.size),
            (ZonedStiffness(cell), cell.size)]


@pytest.mark.parametrize("number", range(3), ids=["core", "arc", "two zones"])
def test_preconditioners_are_linear_and_leave_their_argument(number):
    """Applied again and again, in any order, they give the same."""
    zone, size = every_preconditioner()[number]
    first, second = np.random.default_rng(6).normal(size=(2, size))
    kept = first.copy()
    alone = [zone.apply(vector, np.empty(size)).copy() for vector in (first, second)]
    np.testing.assert_array_equal(first, kept)
    both = zone.apply(2.0 * first - 3.0 * second, np.full(size, np.nan))
    np.testing.assert_allclose(both, 2.0 * alone[0] - 3.0 * alone[1], rtol=1e-9,
                               atol=1e-9 * np.abs(both).max())
    first.setflags(write=False)
    np.testing.assert_array_equal(zone.apply(first, np.empty(size)), alone[0])


def test_forms_share_circles_without_harm():
    """Buffers of the core's circle are shared: a core that has shrunk does as one alone, at once
    and in turns."""
    contact, controls = contact_of(512), (DISPLACEMENT, DISPLACEMENT)
    forms = [pressed(contact, controls, half=half)[0] for half in (2.6, 2.4)]
    zones = [CoreZone(form) for form in forms]
    assert len({id(zone.blocks[0].transform) for zone in zones}) == 1
    assert len({str(zone.blocks[0].index) for zone in zones}) > 1
    vectors = [np.random.default_rng(k).normal(size=form.size) for k, form in enumerate(forms)]
    alone = [CoreZone(pressed(contact_of(512), controls, half=half)[0]).apply(vector,
                                                                              np.empty_like(vector))
             for half, vector in zip((2.6, 2.4), vectors)]
    for _ in range(2):
        for zone, vector, expected in zip(zones, vectors, alone):
            np.testing.assert_array_equal(zone.apply(vector, np.empty_like(vector)), expected)


@pytest.mark.parametrize("size", [1, 2])
def test_means_without_a_response_stay(size):
    """Nor where what responds is so little that one over it overflows."""
    with np.errstate(all="raise"):
        np.testing.assert_array_equal(inverse(np.full((size, size), 1e-320), 0.0),
                                      np.zeros((size, size)))


def test_a_circle_beyond_all_cells_is_refused():
    """To round it up by powers of two would have no end."""
    with pytest.raises(InputError, match="-pc_core_pad is '1e\\+26'.*at most 1000"):
        CoreOptions(pad=1e26)
