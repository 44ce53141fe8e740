"""Line contacts under shear with Coulomb friction, without adhesion."""

import numpy as np

from .checks import ROUNDING, at_most, positive, require
from .line import (
    hertz_line_approach,
    hertz_line_half_width,
    hertz_line_load,
    hertz_line_pressure,
)


def cattaneo_line_stick_half_width(half_width, tangential_force, friction, period=np.inf):
    """Half width s of the stick zone of a Hertzian cylinder with Coulomb friction f (ratio of
    scaled tractions), from Q = f [W(a) - W(s)]: s/a = sqrt(1 - Q/fW) (Cattaneo 1938; periodic by
    the superposition of Ciavarella 1998), exact for a normal load held while the force grows from
    nothing to at most fW. Needs friction in proportion to the pressure and no adhesion, which
    no law of the package has.

    Parameters
    ----------
    half_width : float or array, beta
    tangential_force : float or array, w_t,r
    friction : float or array > 0, f, dimensionless
    period : float, beta; `inf`: isolated
    """
    load = hertz_line_load(half_width, period)
    positive(friction=friction)
    require(np.greater_equal(tangential_force, 0) & np.less_equal(tangential_force,
                                                                  friction * load * (1 + ROUNDING)),
            f"tangential_force {tangential_force} must lie between 0 and "
            f"friction times load, {friction * load}")
    return hertz_line_half_width(np.maximum(load - tangential_force / friction, 0.0), period)


def cattaneo_line_traction(x, half_width, stick_half_width, friction, period=np.inf):
    """Tangential traction f [p(x; a) - p(x; s)], p the Hertzian pressure of each half width, s <= a
    (Cattaneo 1938); conditions of `cattaneo_line_stick_half_width`.

    Parameters
    ----------
    x, half_width, stick_half_width : float or array, beta
    friction, period : as of `cattaneo_line_stick_half_width`
    """
    _require_stick(half_width, stick_half_width, friction)
    outer, inner = (hertz_line_pressure(x, edge, period) for edge in (half_width, stick_half_width))
    return friction * (outer - inner)


def cattaneo_line_displacement(half_width, stick_half_width, friction, period):
    """Displacement of the stick zone relative to the mean surface, f [d(a) - d(s)], d Hertz's
    approach; conditions of `cattaneo_line_stick_half_width`, and a finite period.

    Parameters
    ----------
    half_width, stick_half_width : float or array, beta
    friction, period : as of `cattaneo_line_stick_half_width`
    """
    _require_stick(half_width, stick_half_width, friction)
    return friction * (hertz_line_approach(half_width, period)
                       - hertz_line_approach(stick_half_width, period))


def _require_stick(half_width, stick_half_width, friction):
    positive(friction=friction)
    at_most(stick_half_width, half_width,
            f"stick_half_width {stick_half_width} exceeds half_width {half_width}")
