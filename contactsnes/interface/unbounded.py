"""Compliance of a body that is loaded in one place only: kernels of the unbounded line and plane,
with spectral accuracy.

Tractions on nodes at distance h stand for the function that their band (waves up to pi/h in each
direction) holds. What they deform an unbounded surface by is, on the nodes, exactly the sum over
nodes of h^d G(x_i - x_j) t_j with

    G(x) = integral of C(q) exp(iqx) over the band, over (2 pi)^d

A `Grid` stands for lags here: its cell is a circle on which lags up to half of it are told apart,
so that the circulant product on it is the unbounded one for nodes that lie within half a cell of
each other.

The line's integrals are sine and cosine integrals beside Gauss-Legendre sums over what a layer
changes; far beyond its height those leave what the end of the band makes, waves that turn their
sign from node to node and fall as a power of the distance, no faster. In the plane the kernel is
cut off beyond the largest distance of two nodes, which makes its transform smooth (Vico, Greengard
and Ferrando, J. Comput. Phys. 323, 191, 2016), so that a sum over waves is as good as the integral,
but for its end: waves that turn their sign from node to node are those of a circle, and hang on its
size. Of spheres that changed displacements by 3e-10 where the grid resolves the law, at twice that
spacing by 2e-7.
"""

import math

import numpy as np
from scipy.fft import next_fast_len
from scipy.interpolate import make_interp_spline
from scipy.special import j0, j1, sici, struve

from ..grid.cell import Grid, Transform
from ..grid.operator import Operator
from .bodies.layer import Layer
from .elasticity import Surface, layer_compliance

THICK = 22.0
"""k = qH beyond which layer and half-space agree to rounding, k^2 exp(-2k) < 1e-16."""

FORGOTTEN = 45.0
"""Distance, in heights of a layer, beyond which it does not deform: exp(-0.739 45) < 1e-14, since
cos(0.739) = 0.739 is a zero of an incompressible layer's stiffness, the slowest of any."""

TURNED = np.polynomial.laguerre.laggauss(24)
"""Nodes and weights of integrals along waves whose numbers grow by an imaginary part."""

PLACES = 3001
"""Distances at which splines of what a layer changes are given."""


def _series(count):
    """Coefficients of the powers of 1/x in the integral of J_0 to x: even ones and odd ones."""
    found = [1.0, 0.625]
    for k in range(1, count - 1):
        found.append((1.5 * (k + 0.5) * (k + 5 / 6) * found[k]
                      - 0.5 * (k + 0.5) ** 2 * (k - 0.5) * found[k - 1]) / (k + 1))
    return np.reshape(found, (-1, 2)).T * (-1.0) ** np.arange(count // 2)


SERIES = _series(18)
"""Enough of it from 50 on: the last ones are below rounding there."""


def free_space(body, grid, components):
    """Symbols of the unbounded body's compliance on the circle of lags: {(i, j): array over the
    half spectrum}.

    As `Body.compliance`, but with their zero mode, and exact for nodes within half a cell of each
    other. Displacements are those against the far surface; where that has none, for the half-plane,
    against the mean over the cell.

    Parameters
    ----------
    body : Body with a ``far_field``
    grid : Grid of lags, even numbers of points
    components : 1 (normal), or one more than there are directions
    """
    symbols = _of_layer(body.far_field(), grid, components)
    for i in range(components):
        # what is left for the shortest waves is a spring at each place
        if body.local_compliance[min(i, 1)]:
            symbols[i, i] = symbols[i, i] + body.local_compliance[min(i, 1)]
    return symbols


def _of_layer(body, grid, components):
    """Symbols of an unbounded layer or half-space."""
    if len(grid.shape) > 1 and min(grid.periods) / 2 >= FORGOTTEN * body.height:
        return _with_means(body, grid, components)
    kernels = (_line if len(grid.shape) == 1 else _plane)(body, grid, components)
    plan, symbols = Transform(grid, grid.shape, 1), {}
    for (i, j), kernel in kernels.items():
        plan.real[0] = kernel * grid.node_area
        odd = (i == 0) != (j == 0)
        if odd or i != j:
            # Lags of half a cell have no sign.
            for axis, points in enumerate(grid.shape):
                np.moveaxis(plan.real[0], axis, 0)[points // 2] = 0.0
        plan.forward()
        symbols[i, j] = 1j * plan.spectrum[0].imag if odd else plan.spectrum[0].real.copy()
    if np.isinf(body.height) and len(grid.shape) == 1:
        for i in range(components):
            symbols[i, i][0] = 0.0
    return symbols


def _dundurs(poisson):
    """Dundurs' constant of a body on a rigid one."""
    return (1 - 2 * poisson) / (2 * (1 - poisson))


def _panels(limit, reach):
    """Nodes and weights of Gauss-Legendre panels over wave numbers 0 to limit, for waves over a
    distance ``reach``."""
    count = 24 + math.ceil(limit * reach / 8.0)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    width = limit / count
    places = (np.arange(count)[:, None] + 0.5 * (1.0 + nodes)) * width
    return places.ravel(), np.tile(0.5 * width * weights, count)


def _line(body, grid, components):
    """Kernels G_ij at the lags of a line."""
    spacing, points = grid.spacings[0], grid.shape[0]
    lags = np.arange(points // 2 + 1)
    normal, longitudinal, sine = _line_integrals(body, lags * spacing, math.pi / spacing)
    fold = np.minimum(np.arange(points), points - np.arange(points))
    kernels = {(0, 0): normal[fold]}
    if components == 2:
        kernels[1, 1] = longitudinal[fold]
        if np.any(np.abs(sine) > 1e-15 * np.max(np.abs(normal))):
            signed = np.where(np.arange(points) < points // 2, 1.0, -1.0) * sine[fold]
            ratio = math.sqrt(body.work_ratio)
            kernels[1, 0], kernels[0, 1] = -signed / ratio, signed * ratio
    return kernels


def _line_integrals(body, x, band):
    """1/pi times the integrals over 0 to ``band`` of C_nn cos qx, C_LL cos qx and c sin qx, at
    distances x (the first 0)."""
    dundurs = _dundurs(body.poisson)
    if np.isinf(body.height):
        sine, cosine = sici(band * x[1:])
        even = np.append(0.0, cosine - np.euler_gamma - np.log(band * x[1:])) * 2 / math.pi
        return even, even, np.append(0.0, sine) * 2 * dundurs / math.pi
    limit = min(THICK / body.height, band)
    near = int(np.searchsorted(x, FORGOTTEN * body.height, side="right"))
    q, weights = _panels(limit, x[near - 1])
    rows = _in_line(body, q) * weights / math.pi
    result = np.empty((3, x.size))
    result[:, near:] = -_beyond(body, x[near:], limit) / math.pi
    for part in np.array_split(np.arange(near), max(1, near * q.size // 2 ** 21)):
        phase = np.outer(q, x[part])
        result[:2, part] = rows[:2] @ np.cos(phase)
        result[2, part] = rows[2] @ np.sin(phase)
    if limit < band:
        (sine, cosine), (low_sine, low_cosine) = sici(band * x[1:]), sici(limit * x[1:])
        result[:2] += np.append(math.log(band / limit), cosine - low_cosine) * 2 / math.pi
        result[2] += np.append(0.0, sine - low_sine) * 2 * dundurs / math.pi
    return result


def _in_line(body, q):
    """C_nn, C_LL and c of a layer at wave numbers q, array (3, *shape of q)."""
    surface = layer_compliance(q, body.poisson, body.height)
    return np.stack([surface.normal, surface.longitudinal, surface.coupling])


def _beyond(body, x, limit):
    """Integrals of C_nn cos qx, C_LL cos qx and c sin qx from ``limit`` on, at distances x at which
    those from 0 on are nothing: along limit + is, where the waves fall as exp(-sx)."""
    places, weights = TURNED
    falling = _in_line(body, limit + 1j * places[:, None] / x)
    waves = 1j * np.exp(1j * limit * x) / x * np.einsum("k,ikn->in", weights, falling)
    return np.stack([*waves[:2].real, waves[2].imag])


def _integral_of_j0(x):
    """Integral of J_0 from 0 to x, to 1e-12: by Struve functions below 50, beyond, to rounding, by
    its series in 1/x (Zhang and Jin, Computation of Special Functions, 1996, chapter 4). SciPy's
    `itj0y0` is less exact below, and 1e10 beyond 20 in its version 1.15.3."""
    close = x < 50.0
    near, far = x[close], x[~close]
    result, falling = np.empty_like(x), 1.0 / far
    result[close] = near * j0(near) + np.pi * near / 2 * (j1(near) * struve(0, near)
                                                          - j0(near) * struve(1, near))
    even, odd = (np.polynomial.polynomial.polyval(falling ** 2, part) for part in SERIES)
    result[~close] = 1.0 - np.sqrt(2.0 * falling / np.pi) * (
        even * np.cos(far + np.pi / 4) + falling * odd * np.sin(far + np.pi / 4))
    return result


class _CutHalfspace(Layer):
    """A half-space whose surface does not deform beyond a distance from its load."""

    def __init__(self, body, distance):
        super().__init__(body.poisson, math.inf)
        self.distance, self.work_ratio = distance, body.work_ratio

    def surface(self, wavenumber):
        """Transforms of 1/(pi r), -cos 2 theta/(pi r) and beta_D cos theta/(pi r), cut off, with
        the half-space's factors."""
        shear, phase = 1 / (1 - self.poisson), wavenumber * self.distance
        even = 2 / wavenumber * _integral_of_j0(phase)
        bent = even - 4 / wavenumber * j1(phase)
        mean, deviation = (1 + shear) / 2 * even, (1 - shear) / 2 * bent
        return Surface(even, mean + deviation, mean - deviation,
                       2 * _dundurs(self.poisson) / wavenumber * (1 - j0(phase)))

    @property
    def rigid_compliance(self):
        """Of waves without end."""
        return 2.0 * self.distance, (1.0 + 1.0 / (1.0 - self.poisson)) * self.distance


def _plane(body, grid, components):
    """Kernels G_ij at the lags of a plane.

    The waves of a layer thinner than some nodes end beyond the band: what it changes is no sum over
    nodes, but it forgets so soon that a cell somewhat larger is as good as none.
    """
    thin = body.height * math.pi / max(grid.spacings) < THICK
    sides = [period / 2 for period in grid.periods]
    distance = FORGOTTEN * body.height if thin else math.hypot(*sides)
    shape = [2 * next_fast_len(math.ceil((distance + side) / spacing / 2) + 1)
             for side, spacing in zip(sides, grid.spacings)]
    padded = Grid(shape, [n * spacing for n, spacing in zip(shape, grid.spacings)], grid.counter)
    symbols = _with_means(body if thin else _CutHalfspace(body, distance), padded, components)
    lags = [np.append(np.arange(n // 2 + 1), np.arange(-n // 2 + 1, 0)) for n in grid.shape]
    operator = Operator(padded, symbols)
    kernels = {key: operator.kernel(key)[np.ix_(*lags)] / grid.node_area for key in symbols}
    if np.isfinite(body.height) and not thin:
        _add_layer(body, [lag * spacing for lag, spacing in zip(lags, grid.spacings)], distance,
                   kernels, components)
    return kernels


def _with_means(body, grid, components):
    """Symbols of a body's compliance on a cell, with their zero mode."""
    symbols = body.compliance(grid.wavevectors(), components)
    for i in range(components):
        symbols[i, i].flat[0] = body.rigid_compliance[min(i, 1)]
    return symbols


def _add_layer(body, axes, distance, kernels, components):
    """Add to kernels of the half-space in the plane what a layer of finite height changes, which is
    smooth."""
    x, y = np.meshgrid(*axes, indexing="ij")
    r = np.hypot(x, y)
    normal, *others = (spline(r.ravel()).reshape(r.shape)
                       for spline in _layer_splines(body, distance, components))
    kernels[0, 0] += normal
    if components == 1:
        return
    mean, bent, slope = others
    r[0, 0] = 1.0
    cosine = x / r
    sine = y / r
    ratio = math.sqrt(body.work_ratio)
    kernels[1, 1] += mean - bent * (cosine ** 2 - sine ** 2)
    kernels[2, 2] += mean + bent * (cosine ** 2 - sine ** 2)
    for a, direction in ((1, cosine), (2, sine)):
        for key, factor in (((a, 0), -1.0 / ratio), ((0, a), ratio)):
            kernels[key] = kernels.get(key, 0.0) + factor * slope * direction
    kernels[1, 2] = kernels[2, 1] = kernels.get((1, 2), 0.0) - 2.0 * bent * cosine * sine


def _j2(x):
    """J_2(x), to rounding of 1: by recurrence in a fifth of the time of SciPy's own."""
    return 2.0 * np.divide(j1(x), x, out=np.full_like(x, 0.5), where=x > 0.0) - j0(x)


def _layer_splines(body, distance, components):
    """Splines over r of 1/(2 pi) times the integrals of C_nn, tangential mean, half difference and
    c: layer less half-space; of one component, the first.

    Parameters
    ----------
    body : Layer
    distance : float, the largest r
    components : int
    """
    q, weights = _panels(THICK / body.height, distance)
    layer, half = (layer_compliance(q, body.poisson, height) for height in (body.height, math.inf))
    change = Surface(*(first - second for first, second in zip(layer, half)))
    r = np.linspace(0.0, distance, PLACES)
    weights = weights * q / (2 * math.pi)
    orders = ((0, change.normal), (0, (change.longitudinal + change.transverse) / 2),
              (2, (change.longitudinal - change.transverse) / 2), (1, change.coupling))
    orders = orders[:1] if components == 1 else orders
    values = np.empty((len(orders), PLACES))
    for part in np.array_split(np.arange(PLACES), max(1, PLACES * q.size // 2 ** 20)):
        phase = np.outer(r[part], q)
        bessel = {order: function(phase) for order, function in enumerate((j0, j1, _j2))
                  if order in dict(orders)}
        for row, (order, surface) in enumerate(orders):
            values[row, part] = bessel[order] @ (surface * weights)
    return [make_interp_spline(r, row, k=5) for row in values]
