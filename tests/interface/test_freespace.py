"""Kernels of the unbounded line and plane against integrals by quadrature, closed forms and large
periods."""

import math

import numpy as np
import pytest
from scipy.special import j0, j1, jv, struve

from contactsnes.grid.cell import Convolution, Grid
from contactsnes.grid.operator import Operator
from contactsnes.grid.windows import Window
from contactsnes.interface.bodies.layer import Layer
from contactsnes.interface.elasticity import layer_compliance
from contactsnes.interface.unbounded import _integral_of_j0, free_space

WIDTH = 0.7
"""Standard deviation of the Gaussian tractions of these tests: their waves beyond 6/WIDTH are below
1e-7."""


def deformed(body, grid, fields):
    """Displacements (components, *box) of tractions on the middle half of the cell; the window,
    too."""
    window = Window(grid, [n // 4 for n in grid.shape], [n // 2 for n in grid.shape])
    components = len(fields)
    operator = Operator(grid, free_space(body, grid, components))
    values = np.stack([np.broadcast_to(f(*window.coordinates()), window.shape).ravel()
                       for f in fields])
    return window, window.box(Convolution(window, operator,
                                          components).apply(values, np.empty_like(values)))


def gaussian(*x):
    return np.exp(-sum(a ** 2 for a in x) / (2 * WIDTH ** 2))


def nothing(*x):
    return np.zeros(np.broadcast_shapes(*(np.shape(a) for a in x)))


def integral(function):
    """The integral of a function of many wavenumbers as far as the Gaussian's transform reaches, by
    thirty nodes of Gauss a panel, within which no wave of these tests turns once."""
    edges = np.append(np.geomspace(1e-13, 1e-2, 60), np.linspace(0.1, 12 / WIDTH, 120))
    nodes, weights = np.polynomial.legendre.leggauss(30)
    halves = np.diff(edges)[:, None] / 2
    q = edges[:-1, None] + halves * (1.0 + nodes)
    return np.sum(halves * weights * function(q))


def line_integral(body, entry, wave, x):
    """1/pi times the integral of an entry of the surface compliance times the Gaussian's transform
    and cos or sin."""
    transform = lambda q: math.sqrt(2 * math.pi) * WIDTH * np.exp(-(q * WIDTH) ** 2 / 2)
    return integral(lambda q: getattr(layer_compliance(q, body.poisson, body.height), entry)
                    * transform(q) * wave(q * x)) / math.pi


@pytest.mark.parametrize("height", [math.inf, 500.0, 3.0, 0.3])
@pytest.mark.parametrize("poisson", [0.5, 0.3])
def test_line_is_the_integral(height, poisson):
    body, grid = Layer(poisson, height).with_work_ratio(2.0), Grid((256,), (256 * 0.25,))
    window, normal = deformed(body, grid, (gaussian, nothing))
    _, tangential = deformed(body, grid, (nothing, gaussian))
    x, ratio = window.coordinates()[0], math.sqrt(2.0)
    middle = len(x) // 2
    for node in (0, middle, middle + 3, len(x) - 1):
        for values, entry in ((normal[0], "normal"), (tangential[1], "longitudinal")):
            if np.isinf(height):
                expected = line_integral(body, entry, lambda phase: np.cos(phase) - 1.0, x[node])
                found = values[node] - values[middle]
            else:
                expected, found = line_integral(body, entry, np.cos, x[node]), values[node]
            assert found == pytest.approx(expected, abs=3e-9)
        sideways = line_integral(body, "coupling", np.sin, x[node])
        assert normal[1][node] == pytest.approx(-sideways / ratio, abs=1e-9)
        assert tangential[0][node] == pytest.approx(sideways * ratio, abs=1e-9)


@pytest.mark.parametrize("poisson, height", [(0.5, math.inf), (0.3, math.inf), (0.3, 4.0)])
def test_line_is_the_limit_of_large_periods(poisson, height):
    body, errors = Layer(poisson, height), []
    _, alone = deformed(body, Grid((128,), (32.0,)), (gaussian, gaussian))
    for factor in (8, 16):
        grid = Grid((128 * factor,), (32.0 * factor,))
        window = Window(grid, [128 * factor // 2 - 32], [64])
        values = np.stack([gaussian(window.coordinates()[0])] * 2)
        cell = Convolution(window, Operator(grid, body.compliance(grid.wavevectors(), 2)),
                           2).apply(values, np.empty_like(values))
        difference = cell - alone
        errors.append(np.max(np.abs(difference - difference[:, :1])))
    assert errors[1] < max(0.6 * errors[0], 1e-12)


def lagged(body, points, spacing):
    """Blocks of the kernel of a line, each at all lags of half a cell: array (3, lags)."""
    grid = Grid((points,), (points * spacing,))
    operator = Operator(grid, free_space(body, grid, 2))
    return np.stack([operator.kernel(key)[:points // 2] for key in ((0, 0), (1, 1), (0, 1))])


@pytest.mark.parametrize("poisson, height", [(0.5, 0.4), (0.3, 0.4), (0.3, 3.0), (0.0, 0.02)])
def test_kernel_of_a_line_does_not_depend_on_its_length(poisson, height):
    """That of the band's waves, by Gauss over panels of less than a turn; what the band's end makes
    falls as a power of the lag, and is more than rounding at a hundred heights and more."""
    body, spacing = Layer(poisson, height), 0.15
    kernels = [lagged(body, points, spacing) for points in (64, 256, 1024)]
    lags = np.arange(512) * spacing
    edges = np.linspace(0.0, math.pi / spacing, 400)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    q = (edges[:-1, None] + np.diff(edges)[:, None] / 2 * (1.0 + nodes)).ravel()
    each = np.outer(np.diff(edges) / 2, weights).ravel() * spacing / math.pi
    surface, phase = layer_compliance(q, poisson, height), np.outer(q, lags)
    exact = np.stack([(surface.normal * each) @ np.cos(phase),
                      (surface.longitudinal * each) @ np.cos(phase),
                      (surface.coupling * each) @ np.sin(phase)])
    for kernel in kernels:
        np.testing.assert_allclose(kernel, exact[:, :kernel.shape[1]], rtol=0,
                                   atol=1e-12 * exact.max())


def plane_integral(body, combine, order, r):
    """1/(2 pi) times the integral of a combination of the compliance's entries times the transform
    and q J_order(q r)."""
    bessel = {0: j0, 1: j1, 2: lambda z: jv(2, z)}[order]
    transform = lambda q: 2 * math.pi * WIDTH ** 2 * np.exp(-(q * WIDTH) ** 2 / 2)
    return integral(lambda q: combine(layer_compliance(q, body.poisson, body.height))
                    * transform(q) * q * bessel(q * r)) / (2 * math.pi)


@pytest.mark.parametrize("height", [0.2, 0.35, 2.4, 2.5])
def test_a_layer_in_the_plane_does_not_depend_on_the_size_of_the_grid(height):
    """Layers as thin as a distance of two nodes, whose waves end beyond the band, and thicker ones:
    what they change is smooth from seven distances on."""
    body, fields = Layer(0.3, height), (gaussian, nothing, nothing)
    (_, small), (_, large) = (deformed(body, Grid((n, n), (0.35 * n, 0.35 * n)), fields)
                              for n in (40, 160))
    inner = np.pad(np.ones((20, 20), bool), 30)
    np.testing.assert_allclose(small, large[:, inner].reshape(small.shape), rtol=0, atol=2e-6)


def test_integral_of_j0_is_that_of_sums_and_of_struve_functions():
    """SciPy's own is wrong in some versions. Sums of Gauss over panels of length 1, and
    x J_0 + pi x/2 (J_1 H_0 - J_0 H_1), which rounding grows in."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    sums = np.cumsum(j0(np.arange(400)[:, None] + (1.0 + nodes) / 2) @ weights / 2)
    found = _integral_of_j0(np.arange(1.0, 401.0))
    assert found == pytest.approx(sums, rel=0, abs=2e-12)
    assert found[49:] == pytest.approx(sums[49:], rel=0, abs=2e-14)
    x = np.geomspace(50.0, 1e4, 2000)
    exact = x * j0(x) + np.pi * x / 2 * (j1(x) * struve(0, x) - j0(x) * struve(1, x))
    assert _integral_of_j0(x) == pytest.approx(exact, rel=0, abs=1e-12)
    assert _integral_of_j0(np.array([0.0, 1e-9, 1e9])) == pytest.approx([0.0, 1e-9, 1.0], abs=4e-5)


@pytest.mark.parametrize("poisson, height", [(0.5, math.inf), (0.3, 4.0), (0.3, 0.3),
                                             (0.0, 2000.0)])
def test_plane_is_the_integral(poisson, height):
    body, grid = Layer(poisson, height).with_work_ratio(2.0), Grid((128, 96), (32.0, 21.0))
    window, normal = deformed(body, grid, (gaussian, nothing, nothing))
    _, along = deformed(body, grid, (nothing, gaussian, nothing))
    _, across = deformed(body, grid, (nothing, nothing, gaussian))
    (x, y), ratio = window.coordinates(), math.sqrt(2.0)
    for i, j in ((32, 24), (36, 25), (3, 43)):
        place = np.array([x[i, 0], y[0, j]])
        r = math.hypot(*place)
        cosine, sine = place / r if r else (1.0, 0.0)
        slope = plane_integral(body, lambda c: c.coupling, 1, r)
        mean = plane_integral(body, lambda c: (c.longitudinal + c.transverse) / 2, 0, r)
        bent = plane_integral(body, lambda c: (c.longitudinal - c.transverse) / 2, 2, r)
        expected = {"nn": plane_integral(body, lambda c: c.normal, 0, r),
                    "xn": -slope * cosine / ratio, "yn": -slope * sine / ratio,
                    "nx": slope * cosine * ratio, "xx": mean - bent * (cosine ** 2 - sine ** 2),
                    "yx": -2 * bent * cosine * sine, "ny": slope * sine * ratio,
                    "xy": -2 * bent * cosine * sine, "yy": mean + bent * (cosine ** 2 - sine ** 2)}
        found = {f"{row}{column}": field[k][i, j] for column, field in (("n", normal), ("x", along),
                                                                        ("y", across))
                 for k, row in enumerate("nxy")}
        assert found == pytest.approx(expected, abs=3e-8)
