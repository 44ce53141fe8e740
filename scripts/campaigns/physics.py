"""The model as its formulas say it, for checking archives: laws, elastic body, geometries. NumPy
alone, nothing of the package.

Scaled units: E* = 1, lengths in beta, displacements in u_n,r and u_t,r. Tractions as archives have
them, in phi_n/delta_n and phi_t/delta_t, attraction positive; the scaled ones are lambda times
those. Components: normal, then tangential.
"""

import itertools
import math

import numpy as np

PEAK_SLIP = math.sqrt(0.5)
PEAK = math.sqrt(2.0 / math.e)


def tractions(scene, a, b):
    """Tractions for normal gaps ``a`` and tangential gaps ``b`` (directions, ...) in ranges of the
    law: (1 + directions, ...).

    scene : name -> value of its options. Law 'mcgarry': a exp(-a) exp(-b^2) and
        2 b exp(-a) exp(-b^2). 'modified': the same where the surfaces are apart, but with the
        shares residual_friction and residual_adhesion left at large slip; in overlap neither
        depends on the other. 'pressure_friction': friction grows in overlap by
        1 + alpha p / tau_max. 'dugdale': see `_constant`. 'xu_needleman': derivatives of
        exp(-a) {(1 - r + a) (1 - q)/(r - 1) - [q + (r - q)/(r - 1) a] exp(-b^2)}.
    """
    law, slip = scene["law"], np.sqrt(np.sum(b ** 2, axis=0))
    bell, near = np.exp(-slip ** 2), np.exp(-a)
    secant = 2.0 * bell
    if law == "mcgarry":
        return np.concatenate([[a * near * bell], secant * near * b])
    if law == "xu_needleman":
        q, r = scene["xu_needleman_q"], scene["xu_needleman_r"]
        left, grows = (1.0 - q) / (r - 1.0), (r - q) / (r - 1.0)
        normal = near * ((r - a) * left + (q - grows + grows * a) * bell)
        return np.concatenate([[normal], secant * near * (1.0 + grows / q * a) * b])
    if law not in ("modified", "dugdale", "pressure_friction"):
        raise ValueError(f"the checker has no law '{law}' of its own")
    friction, adhesion = scene["residual_friction"], scene["residual_adhesion"]
    attraction, past, pressed = a * near, slip > PEAK_SLIP, 1.0
    if law == "dugdale":
        attraction, near = _constant(a, scene["dugdale_width"])
    if law == "pressure_friction":
        pressed = 1.0 - scene["pressure_friction"] * attraction / PEAK
    with np.errstate(divide="ignore", invalid="ignore"):
        softened = PEAK * (friction + (1.0 - friction) * np.exp(-(slip - PEAK_SLIP) ** 2)) / slip
    secant = np.where(past, softened, secant)
    apart = a > 0.0
    return np.concatenate([[attraction * np.where(apart, adhesion + (1.0 - adhesion) * bell, 1.0)],
                           secant * np.where(apart, near, pressed) * b])


def _constant(a, width):
    """(1 - exp(-a/w)) / (1 + exp((a-c)/w)), and its second factor over what that is at a = 0, for
    the law 'dugdale' with w = ``width``; the work of adhesion is 1 by the choice of c."""
    with np.errstate(over="ignore"):
        end = 1.0 / (1.0 + np.exp((a - dugdale_end(width)) / width))
    return (1.0 - np.exp(-a / width)) * end, end * (1.0 + math.exp(-dugdale_end(width) / width))


def dugdale_end(width):
    """c of the law 'dugdale', by halving."""
    low, high = 0.0, 4.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = ((middle, high) if _dugdale_potential(0.0, width, middle) > -1.0
                     else (low, middle))
    return 0.5 * (low + high)


def _dugdale_potential(a, width, end):
    """Minus the integral of the attraction of the law 'dugdale' from ``a`` on: by y = exp(-x/w),
    of w (1 - y) / (y + exp(-c/w)) from 0."""
    share = math.exp(-end / width)
    return -width * ((1.0 + share) * np.logaddexp(0.0, (end - a) / width) - np.exp(-a / width))


def potential(scene, a):
    """Energy of the interface without slip, phi_n: its derivative is the normal traction, and it
    vanishes far away."""
    if scene["law"] == "dugdale":
        width = scene["dugdale_width"]
        return _dugdale_potential(a, width, dugdale_end(width))
    return -(1.0 + a) * np.exp(-a)


def near(scene):
    """Gap, in ranges of the law, up to which it acts."""
    if scene["law"] != "dugdale":
        return 37.0
    return min(37.0, dugdale_end(scene["dugdale_width"]) + 37.0 * scene["dugdale_width"])


def overlap_unit(scene):
    """Overlap, in ranges, over which the repulsion grows by a factor e: formulas hold down to 30 of
    them."""
    return scene["dugdale_width"] if scene["law"] == "dugdale" else 1.0


def plane_strain(wavenumber, poisson, height):
    """Compliance of a layer held at its top, by the four exponential solutions of Navier's
    equations at each wave number > 0.

    Papkovich and Neuber's representation: u = grad f and u = (3 - 4 nu) f e_z - z grad f with f =
    exp(i q x +- q z). Returns real arrays K (2, 2, ...): u_x = K00 f_x + i K01 f_z and u_z = -i K10
    f_x + K11 f_z for forces f on the body.
    """
    q = np.asarray(wavenumber, dtype=float).reshape(-1)
    h = np.minimum(q * height, 60.0)
    kappa, decay = 3.0 - 4.0 * poisson, np.exp(-h)
    boundary, bottom = np.zeros((q.size, 4, 4)), np.zeros((q.size, 2, 4))
    for column, (sign, z_bottom, z_top, at_bottom, at_top) in enumerate(
            ((-1.0, 0.0 * h, h, 1.0, decay), (1.0, -h, 0.0 * h, decay, 1.0))):
        for kind in (0, 1):
            place = 2 * column + kind

            def displacement(z, kind=kind, sign=sign):
                return (np.ones_like(z), sign + 0 * z) if kind == 0 else (-z, kappa - sign * z)

            top, base = displacement(z_top), displacement(z_bottom)
            boundary[:, 0, place], boundary[:, 1, place] = top[0] * at_top, top[1] * at_top
            bottom[:, 0, place], bottom[:, 1, place] = base[0] * at_bottom, base[1] * at_bottom
            shear, normal = (sign, 1.0) if kind == 0 else (1.0 - 2.0 * poisson - sign * z_bottom,
                                                           2.0 * (1.0 - poisson) * sign - z_bottom)
            boundary[:, 2, place], boundary[:, 3, place] = -shear * at_bottom, -normal * at_bottom
    loads = np.zeros((q.size, 4, 2))
    loads[:, 2, 0] = loads[:, 3, 1] = 1.0
    modulus = (1.0 - poisson) / 2.0
    found = bottom @ np.linalg.solve(boundary, loads) / (2.0 * modulus * q)[:, None, None]
    return np.moveaxis(found, 0, -1).reshape(2, 2, *np.shape(wavenumber))


def mean_compliance(poisson, height):
    """Displacement of the mean surface against the top per traction, normal and tangential; 0 for a
    half-space, and where rigid."""
    if math.isinf(height):
        return 0.0, 0.0
    return (1.0 - 2.0 * poisson) * height / (1.0 - poisson) ** 2, 2.0 * height / (1.0 - poisson)


def compliance(shape, periods, poisson, height, ratio):
    """Symbols (components, components, *shape) of u = C f over NumPy's whole spectrum, 0 at the
    mean.

    ratio : sqrt(phi_t / phi_n), by which scaled tangential quantities differ from normal ones. A
        wave at half the sampling
    frequency is the mean of its two directions.
    """
    dimension = len(shape)
    waves = [2.0 * np.pi * np.fft.fftfreq(n, period / n) for n, period in zip(shape, periods)]
    total, signs = 0.0, list(itertools.product((1.0, -1.0), repeat=dimension))
    for sign in signs:
        own = [np.where(np.arange(len(q)) == len(q) // 2, s * q, q) for s, q in zip(sign, waves)]
        total = total + _compliance(np.meshgrid(*own, indexing="ij"), poisson, height, ratio)
    return total / len(signs)


def _compliance(waves, poisson, height, ratio):
    """Symbols at the given wave vectors."""
    dimension = len(waves)
    q = np.sqrt(sum(wave ** 2 for wave in waves))
    zero = q == 0.0
    q = np.where(zero, 1.0, q)
    distinct, back = np.unique(q, return_inverse=True)
    surface = plane_strain(distinct, poisson, height)[:, :, back.reshape(q.shape)]
    symbols = np.zeros((1 + dimension, 1 + dimension, *q.shape), dtype=complex)
    symbols[0, 0] = surface[1, 1]
    across = 2.0 * np.tanh(np.minimum(q * height, 60.0)) / ((1.0 - poisson) * q)
    for i in range(dimension):
        along = waves[i] / q
        symbols[1 + i, 0] = 1j * surface[0, 1] * along / ratio
        symbols[0, 1 + i] = -1j * surface[1, 0] * along * ratio
        for j in range(dimension):
            symbols[1 + i, 1 + j] = (surface[0, 0] * along * waves[j] / q
                                     + across * ((i == j) - along * waves[j] / q))
    symbols[..., zero] = 0.0
    return symbols


def unbounded(nodes, spacing, poisson, height, ratio):
    """Symbols (2, 2, 2 nodes) of the unbounded line's compliance on a circle of twice the nodes of
    a window.

    The kernel is that of a cell so large that only the images of a half-plane matter, which are
    known: their normal and tangential parts are ln(sin(pi x/L) / (pi x/L)), and a tilt is what they
    couple.
    """
    large = 1 << max(17,
                     math.ceil(math.log2(max(8 * nodes, 0 if math.isinf(height)
                                             else 24.0 * height / spacing))))
    symbols = compliance((large,), (large * spacing,), poisson, height, ratio)
    place = np.fft.fftfreq(large)
    if math.isinf(height):
        images = np.fft.fft(np.log(np.sinc(place))) * 2.0 / np.pi * spacing
        tilt = np.fft.fft(2.0 * place) * spacing * (1.0 - 2.0 * poisson) / (2.0 * (1.0 - poisson))
        symbols += np.array([[images, tilt * ratio], [-tilt / ratio, images]])
    else:
        limits = mean_compliance(poisson, height) if poisson < 0.5 else (0.0, height)
        symbols[0, 0, 0], symbols[1, 1, 0] = limits
    kernel = np.fft.ifft(symbols).real
    return np.fft.fft(np.concatenate([kernel[..., :nodes], kernel[..., -nodes:]], axis=-1))


def initial_gap(scene, coordinates):
    """Gap of the undeformed body for the shapes that a formula gives; None for the others."""
    grids = np.meshgrid(*coordinates, indexing="ij")
    if scene["geometry"] == "flat":
        gap = 0.0 * grids[0]
    elif scene["geometry"] == "cylinder":
        gap = grids[0] ** 2 / 2.0
    elif scene["geometry"] == "sphere":
        gap = sum(x ** 2 for x in grids) / 2.0
    elif scene["geometry"] == "sinusoid":
        gap = sum(amplitude * (1.0 - np.cos(2.0 * np.pi * x / length))
                  for amplitude, x, length in zip(scene["amplitude"], grids, scene["period"]))
    else:
        return None
    return gap + scene["gap_offset"]


def softening(law, a, b, friction=1.0, adhesion=0.0):
    """Tangents dt_i/dg_j of one tangential direction by central differences of ``tractions``, (2,
    2, nodes)."""
    found, width = np.empty((2, 2, a.size)), 1e-6
    for j in (0, 1):
        shift = np.zeros((2, a.size))
        shift[j] = width
        above = tractions(law, a + shift[0], b + shift[1:], friction, adhesion)
        below = tractions(law, a - shift[0], b - shift[1:], friction, adhesion)
        found[:, j] = (above - below) / (2.0 * width)
    return found
