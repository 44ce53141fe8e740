"""The layer against an independent solution of Navier's equations, its limits, and its symbols on
grids."""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from numpy.polynomial import chebyshev
from scipy.integrate import quad

from contactsnes.interface.bodies.layer import Layer
from contactsnes.interface.elasticity import (
    layer_compliance,
    layer_stiffness,
    rigid_stiffness,
)

POISSON = (0.0, 0.25, 0.3, 0.45, 0.49, 0.5)


def wave_numbers(shape, period):
    """Arguments of Layer.compliance for a grid."""
    full = [2 * np.pi * np.fft.fftfreq(n, length / n) for n, length in zip(shape, period)]
    half = 2 * np.pi * np.fft.rfftfreq(shape[-1], period[-1] / shape[-1])
    return (half,) if len(shape) == 1 else (full[0][:, None], half[None, :])


def matrices(blocks, components):
    """Blocks as one matrix a wave: (*half spectrum, components, components)."""
    matrix = np.zeros(blocks[0, 0].shape + (components, components), dtype=complex)
    for (i, j), block in blocks.items():
        matrix[..., i, j] = block
    return matrix


def surface_matrix(surface, sign):
    """Matrices in the order (normal, longitudinal, transverse)."""
    matrix = np.zeros(np.shape(surface.normal) + (3, 3), dtype=complex)
    matrix[..., 0, 0], matrix[..., 1, 1], matrix[..., 2, 2] = surface[:3]
    matrix[..., 1, 0] = 1j * sign * surface.coupling
    matrix[..., 0, 1] = -1j * sign * surface.coupling
    return matrix


def layer_by_collocation(qx, qy, poisson, height, prescribed, degree=48):
    """Response of a layer held at z = H by Chebyshev collocation of Navier's equations in z.

    Unknowns are displacements and tractions on planes z = const, (u_z, u_x, u_y,
    s_zz, s_xz, s_yz): Hooke's law solved for du/dz, and div s = 0. In this form
    every coefficient is finite at nu = 1/2. The `prescribed` of 'displacement'
    or 'force' takes the three unit vectors at z = 0; the other one is returned.
    """
    mu, ratio = (1 - poisson) / 2, poisson / (1 - poisson)
    system = np.zeros((6, 6), dtype=complex)
    uz = 0
    sz = 3
    tangential = ((1, 4, qx), (2, 5, qy))
    system[uz, sz] = (1 - 2 * poisson) / (2 * mu * (1 - poisson))
    for u, s, q in tangential:
        system[uz, u] = -ratio * 1j * q
        system[u, s], system[u, uz] = 1 / mu, -1j * q
        system[sz, s] = -1j * q
        # s_xz' = -i q_b s_xb, s_xb = mu (i q_x u_b + i q_b u_x) + delta_xb ratio (s_zz + 2 mu i q_c
        # u_c)
        system[s, sz] = -1j * q * ratio
        for v, _, p in tangential:
            system[s, v] += mu * q * p + 2 * mu * ratio * q * p
            system[s, u] += mu * p * p
    points = np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
    values = chebyshev.chebvander(points, degree)
    slopes = chebyshev.chebval(points, chebyshev.chebder(np.eye(degree + 1), axis=0)).T * 2 / height
    bottom, top = (chebyshev.chebvander(np.array([end]), degree) for end in (-1.0, 1.0))
    first = np.eye(6)[:3] if prescribed == "displacement" else -np.eye(6)[3:]
    matrix = np.vstack([np.kron(np.eye(6), slopes) - np.kron(system, values),
                        np.kron(first, bottom), np.kron(np.eye(6)[:3], top)])
    right = np.zeros((len(matrix), 3))
    right[6 * degree:6 * degree + 3] = np.eye(3)
    scale = np.abs(matrix).max(axis=1)
    solution = np.linalg.solve(matrix / scale[:, None], right / scale[:, None])
    other = -np.eye(6)[3:] if prescribed == "displacement" else np.eye(6)[:3]
    return np.kron(other, bottom) @ solution


def exact(k, poisson, name):
    """Stiffness over q by the plain formula of the layer, in 90 digits."""
    with localcontext() as context:
        context.prec = 90
        k, nu = Decimal(float(k)), Decimal(float(poisson))
        sinh, cosh = (k.exp() - (-k).exp()) / 2, (k.exp() + (-k).exp()) / 2
        kappa = 3 - 4 * nu
        below = (kappa * sinh) ** 2 - k * k
        above = {"normal": 2 * (1 - nu) ** 2 * (kappa * sinh * cosh + k),
                 "longitudinal": 2 * (1 - nu) ** 2 * (kappa * sinh * cosh - k),
                 "coupling": (1 - nu) * (kappa * (1 - 2 * nu) * sinh * sinh - k * k)}[name]
        return float(above / below)


@pytest.mark.parametrize("poisson", POISSON)
@pytest.mark.parametrize("thickness", (0.05, 0.3, 1.0, 3.0, 10.0))
def test_layer_solves_navier(poisson, thickness):
    angle, q = 2.2, thickness / 1.7
    qx, qy = q * np.cos(angle), q * np.sin(angle)
    body = Layer(poisson, 1.7)
    # three rows, so that qx is not Nyquist's
    waves = (np.array([[0.0], [qx], [0.0]]), np.array([[0.0, qy]]))
    for prescribed, blocks in (("displacement", body.stiffness(waves, 3, last_even=False)),
                               ("force", body.compliance(waves, 3, last_even=False))):
        expected = layer_by_collocation(qx, qy, poisson, 1.7, prescribed)
        np.testing.assert_allclose(matrices(blocks, 3)[1, 1], expected, rtol=0,
                                   atol=3e-9 * abs(expected).max())


@pytest.mark.parametrize("poisson", POISSON)
@pytest.mark.parametrize("thickness", (0.2, 1.0, 4.0))
def test_plane_strain_solves_navier(poisson, thickness):
    waves = (np.array([0.0, thickness]),)
    body = Layer(poisson, 1.0)
    for prescribed, blocks in (("displacement", body.stiffness(waves, 2, last_even=False)),
                               ("force", body.compliance(waves, 2, last_even=False))):
        expected = layer_by_collocation(thickness, 0.0, poisson, 1.0, prescribed)[:2, :2]
        np.testing.assert_allclose(matrices(blocks, 2)[1], expected, rtol=0,
                                   atol=1e-10 * abs(expected).max())


@pytest.mark.parametrize("poisson", (*POISSON, 0.4999, 0.5 - 1e-9))
def test_no_cancellation(poisson):
    k = np.concatenate([np.logspace(-8, 1.5, 40), [0.999, 1.001, 1.999, 2.001]])
    stiffness = layer_stiffness(k / 3.0, poisson, 3.0)
    for name in ("normal", "longitudinal"):
        expected = np.array([exact(x, poisson, name) for x in k]) * k / 3.0
        np.testing.assert_allclose(getattr(stiffness, name), expected, rtol=2e-14)
    expected = np.array([exact(x, poisson, "coupling") for x in k]) * k / 3.0
    # the coupling changes sign for 1/4 < nu < 1/2, so its error is measured against the diagonal
    size = np.sqrt(stiffness.normal * stiffness.longitudinal)
    np.testing.assert_allclose(stiffness.coupling / size, expected / size, rtol=0, atol=1e-14)


@pytest.mark.parametrize("poisson", (*POISSON, 0.4999))
@pytest.mark.parametrize("height", (1.0, 2000.0, math.inf))
def test_every_thickness(poisson, height):
    k = np.logspace(-8, 6, 300)
    q = k / height if height < math.inf else k
    with np.errstate(all="raise"):
        stiffness = layer_stiffness(q, poisson, height)
        compliance = layer_compliance(q, poisson, height)
    m, c = surface_matrix(stiffness, -1), surface_matrix(compliance, 1)
    assert np.all(np.linalg.eigvalsh(c) > 0)
    # in units that make the diagonal of M one, where the sizes of all entries compare
    unit = np.sqrt(np.einsum("qii->qi", m).real)
    m, c = m / unit[:, :, None] / unit[:, None, :], c * unit[:, :, None] * unit[:, None, :]
    np.testing.assert_allclose(m @ c, np.broadcast_to(np.eye(3), m.shape), rtol=0, atol=2e-14)
    assert np.all(np.linalg.eigvalsh(m) > 0)


@pytest.mark.parametrize("poisson", POISSON)
@pytest.mark.parametrize("height", (60.0, math.inf))
def test_half_space(poisson, height):
    """Johnson, Contact Mechanics (1985); transverse: antiplane shear, mu q."""
    q, mu = np.array([0.9, 3.0, 1e4]), (1 - poisson) / 2
    dundurs = (1 - 2 * poisson) / (2 * (1 - poisson))
    compliance = layer_compliance(q, poisson, height)
    stiffness = layer_stiffness(q, poisson, height)
    for value, expected in ((compliance.normal, 2 / q), (compliance.longitudinal, 2 / q),
                            (compliance.transverse, 1 / (mu * q)),
                            (compliance.coupling, 2 * dundurs / q),
                            (stiffness.normal, q / 2 / (1 - dundurs**2)),
                            (stiffness.longitudinal, stiffness.normal),
                            (stiffness.transverse, mu * q),
                            (stiffness.coupling, dundurs * q / 2 / (1 - dundurs**2))):
        np.testing.assert_allclose(value, expected, rtol=1e-14, atol=1e-25)


@pytest.mark.parametrize("poisson", (0.0, 0.3, 0.45))
def test_long_waves_feel_the_rigid_stiffness(poisson):
    stiffness = layer_stiffness(1e-5, poisson, 3.0)
    normal, tangential = rigid_stiffness(poisson, 3.0)
    mu = (1 - poisson) / 2
    # oedometer
    assert normal == pytest.approx(2 * mu * (1 - poisson) / (1 - 2 * poisson) / 3.0, rel=1e-14)
    assert tangential == pytest.approx(mu / 3.0, rel=1e-14)
    assert stiffness.normal == pytest.approx(normal, rel=1e-8)
    assert stiffness.longitudinal == pytest.approx(tangential, rel=1e-8)
    assert stiffness.transverse == pytest.approx(tangential, rel=1e-8)
    assert Layer(poisson, 3.0).rigid_compliance == pytest.approx((1 / normal, 1 / tangential),
                                                                rel=1e-15)


def test_long_waves_of_the_incompressible_layer():
    """Lubrication: M_nn = 12 mu/(q^2 H^3), M_LL = 4 mu/H, with mu = 1/4."""
    q, height = 1e-4, 3.0
    stiffness = layer_stiffness(q, 0.5, height)
    assert stiffness.normal == pytest.approx(3 / (q**2 * height**3), rel=1e-6)
    assert stiffness.longitudinal == pytest.approx(1 / height, rel=1e-6)
    assert stiffness.transverse == pytest.approx(0.25 / height, rel=1e-6)


def test_rigid_compliance_vanishes_where_the_mean_follows_the_top():
    assert rigid_stiffness(0.5, 4.0) == (math.inf, 0.0625)
    assert Layer(0.5, 4.0).rigid_compliance == (0.0, 16.0)
    assert rigid_stiffness(0.3, math.inf) == (math.inf, math.inf)
    assert Layer(0.3, math.inf).rigid_compliance == (0.0, 0.0)


@pytest.mark.parametrize("shape, components", (((8,), 1), ((8,), 2), ((9,), 2), ((8, 6), 1),
                                               ((8, 6), 3), ((7, 6), 3), ((8, 9), 3), ((2, 2), 3)))
@pytest.mark.parametrize("work_ratio, poisson, height", ((1.0, 0.3, 0.8), (3.0, 0.3, 0.8),
                                                         (1.0, 0.0, math.inf), (2.0, 0.0, 0.8),
                                                         (1.0, 0.5, math.inf), (1.0, 0.5, 0.8),
                                                         (1.0, 0.2, 2000.0)))
def test_stiffness_inverts_compliance_at_every_wave(shape, components, work_ratio, poisson, height):
    waves = wave_numbers(shape, (5.0, 7.0)[:len(shape)])
    body, even = Layer(poisson, height).with_work_ratio(work_ratio), shape[-1] % 2 == 0
    compliance = matrices(body.compliance(waves, components, last_even=even), components)
    stiffness = matrices(body.stiffness(waves, components, last_even=even), components)
    product = (stiffness @ compliance).reshape(-1, components, components)
    np.testing.assert_allclose(product[1:], np.broadcast_to(np.eye(components), product[1:].shape),
                               atol=1e-14)
    assert (not compliance.reshape(product.shape)[0].any()
            and not stiffness.reshape(product.shape)[0].any())
    if work_ratio == 1.0:
        np.testing.assert_allclose(compliance, compliance.conj().swapaxes(-1, -2), atol=1e-15)
        assert np.all(np.linalg.eigvalsh(compliance.reshape(product.shape)[1:]) > 0)


def test_frictionless_stiffness_lets_the_tangential_displacement_free():
    q = np.array([0.0, 0.7, 1.4, 2.1])
    full = Layer(0.2, 1.0).stiffness((q,), 2, last_even=False)
    free = (full[0, 0] * full[1, 1] - full[0, 1] * full[1, 0])[1:].real / full[1, 1][1:]
    np.testing.assert_allclose(Layer(0.2, 1.0).stiffness((q,), 1)[0, 0][1:], free, rtol=1e-13)


@pytest.mark.parametrize("method", ("compliance", "stiffness"))
def test_work_ratio_is_a_change_of_tangential_units(method):
    waves = wave_numbers((8, 6), (5.0, 7.0))
    unit = np.diag([1.0, np.sqrt(2.5), np.sqrt(2.5)])  # u_t,r and w_t,r over u_n,r and w_n,r
    one = matrices(getattr(Layer(0.3, 2.0), method)(waves, 3), 3)
    other = matrices(getattr(Layer(0.3, 2.0).with_work_ratio(2.5), method)(waves, 3), 3)
    np.testing.assert_allclose(other, np.linalg.inv(unit) @ one @ unit, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("method", ("compliance", "stiffness"))
@pytest.mark.parametrize("points", (8, 9))
def test_kernels_of_the_line(method, points):
    waves = wave_numbers((points,), (5.0,))
    blocks = getattr(Layer(0.3, 1.5), method)(waves, 2, last_even=points % 2 == 0)
    kernels = {key: np.fft.irfft(block, points) for key, block in blocks.items()}
    # a real kernel has exactly this spectrum: irfft dropped nothing
    for key, block in blocks.items():
        np.testing.assert_allclose(np.fft.rfft(kernels[key]), block, atol=1e-15)
        assert np.iscomplexobj(block) == (key[0] != key[1])
    mirror = -np.arange(points) % points
    for (i, j), kernel in kernels.items():
        np.testing.assert_allclose(kernel[mirror], kernel if i == j else -kernel, atol=1e-14)
    np.testing.assert_allclose(kernels[1, 0], kernels[0, 1][mirror], atol=1e-14)


@pytest.mark.parametrize("method", ("compliance", "stiffness"))
@pytest.mark.parametrize("shape", ((8, 6), (7, 6), (8, 5), (7, 5), (1, 6), (6, 1)))
def test_kernels_of_the_plane(method, shape):
    blocks = getattr(Layer(0.3, 1.5), method)(wave_numbers(shape, (5.0, 4.0)), 3,
                                             last_even=shape[1] % 2 == 0)
    kernels = {key: np.fft.irfft2(block, shape) for key, block in blocks.items()}
    mirror_x, mirror_y = (-np.arange(n) % n for n in shape)
    for (i, j), kernel in kernels.items():
        np.testing.assert_allclose(np.fft.rfft2(kernel), blocks[i, j], atol=3e-14)
        # components along x change sign in a mirror x -> -x, those along y in y -> -y
        np.testing.assert_allclose(kernel[mirror_x], kernel * (-1) ** ((i == 1) + (j == 1)),
                                   atol=1e-14)
        np.testing.assert_allclose(kernel[:, mirror_y], kernel * (-1) ** ((i == 2) + (j == 2)),
                                   atol=1e-14)
        # reciprocity (Betti)
        np.testing.assert_allclose(kernels[j, i], kernel[mirror_x][:, mirror_y], atol=1e-14)


def test_plane_is_isotropic():
    waves = wave_numbers((6, 6), (5.0, 5.0))
    kernels = {key: np.fft.irfft2(block, (6, 6))
               for key, block in Layer(0.3, 1.5).compliance(waves, 3).items()}
    swap = {0: 0, 1: 2, 2: 1}
    for (i, j), kernel in kernels.items():
        np.testing.assert_allclose(kernels[swap[i], swap[j]], kernel.T, atol=1e-14)


def test_logarithmic_kernel():
    """u(x) = 2/(pi E*) int ln|2 sin(pi (x - y)/L)| p(y) dy for an attraction p, L the period."""
    points, period = 64, 7.0

    def attraction(x):
        return np.exp(np.sin(2 * np.pi * x / period)) + 0.3 * np.cos(6 * np.pi * x / period)

    x = np.arange(points) * period / points
    blocks = Layer(0.5, math.inf).compliance(wave_numbers((points,), (period,)), 2)
    displacement = np.fft.irfft(-blocks[0, 0] * np.fft.rfft(attraction(x)), points)
    np.testing.assert_allclose(blocks[0, 0], blocks[1, 1], rtol=1e-14)
    for i in (0, 11, 40):
        # the logarithm has no mean: subtracting p(x) takes its singularity away
        expected = quad(lambda s: np.log(2 * np.sin(np.pi * s / period))
                        * (attraction(x[i] + s) - attraction(x[i])), 0, period, epsabs=1e-12,
                        epsrel=1e-12)[0]
        assert displacement[i] == pytest.approx(2 / np.pi * expected, abs=1e-10)


def test_pressure_draws_a_compressible_surface_in():
    """Flamant: a pressure moves the surface of a body with nu < 1/2 towards the loaded point."""
    points, period = 256, 10.0
    blocks = Layer(0.2, math.inf).compliance(wave_numbers((points,), (period,)), 2)
    x = (np.arange(points) - points // 2) * period / points
    pressure = np.exp(-(x / 0.3) ** 2)
    tangential = np.fft.irfft(blocks[1, 0] * np.fft.rfft(pressure), points)
    dundurs = (1 - 0.4) / 1.6
    # plane strain: |u_x| jumps by (1-2nu)/(2 mu) P across the load, less the mean strain of the
    # period
    force = pressure.sum() * period / points
    expected = -np.sign(x) * dundurs * force * (1 - 2 * abs(x) / period)
    far = abs(x) > 1.5
    np.testing.assert_allclose(tangential[far & (abs(x) < 4.9)], expected[far & (abs(x) < 4.9)],
                               atol=1e-6)


@pytest.mark.parametrize("poisson, height, couples", ((0.5, math.inf, False), (0.5, 2000.0, False),
                                                      (0.5, 50.0, True), (0.49, math.inf, True),
                                                      (0.3, 2000.0, True), (0.0, 1.0, True)))
def test_what_vanishes_is_left_out(poisson, height, couples):
    body = Layer(poisson, height)
    line, plane = wave_numbers((16,), (100.0,)), wave_numbers((8, 6), (100.0, 100.0))
    assert body.couples(2 * np.pi / 100) is couples
    for method in (body.compliance, body.stiffness):
        assert ((0, 1) in method(line, 2)) is couples
        assert set(method(line, 1)) == {(0, 0)}
        assert set(method(plane, 1)) == {(0, 0)}
        normal = {(0, 1), (1, 0), (0, 2), (2, 0)} if couples else set()
        assert set(method(plane, 3)) == {(0, 0), (1, 1), (2, 2), (1, 2), (2, 1)} | normal


def test_isotropic_half_space_keeps_no_shear_block():
    """nu = 0: longitudinal and transverse compliance of the half-space are equal; stiffnesses are
    not, by what couples."""
    waves = wave_numbers((8, 6), (5.0, 5.0))
    for height, keeps in ((math.inf, False), (2.0, True)):
        assert ((1, 2) in Layer(0.0, height).compliance(waves, 3)) is keeps
        assert (1, 2) in Layer(0.0, height).stiffness(waves, 3)


def test_components_must_fit_the_interface():
    with pytest.raises(ValueError, match="use 1 .* or 3"):
        Layer(0.3, 1.0).compliance(wave_numbers((8, 6), (5.0, 5.0)), 2)
