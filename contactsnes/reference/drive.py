"""The elastic layer through which a contact is sheared: a displacement of its top held or moved,
and what starts with a jump."""

import numpy as np

from .checks import positive, require


def drive_stiffness(period, height, poisson=0.5):
    """Force per tangential displacement of the top at a held surface, L k_0t = L (1 - nu)/(2 H),
    the simple shear of a layer, exact for the mean surface of a cell. Needs a finite period and a
    top that moves as a rigid whole.

    Parameters
    ----------
    period, height : float or array, beta
    poisson : float or array, 0 to 0.5
    """
    positive(period=period, height=height)
    require(np.isfinite(period), "the force per cell needs a finite period")
    require(np.greater_equal(poisson, 0) & np.less_equal(poisson, 0.5),
            f"poisson {poisson} must lie between 0 and 0.5")
    return period * (1 - poisson) / (2 * height)


def driven_displacement(mean_slip, tangential_force, period, height, poisson=0.5):
    """Tangential displacement of the top, U = mean u_t + T/(L k_0t), exact. The path (mean u_t, T)
    is the same for all heights above about the period (exp(-4 pi H/L) << 1, where the layer deforms
    as a half-space); sliding starts with a jump where dT/d(mean u_t) < -`drive_stiffness`. After
    gross sliding T is constant.

    Parameters
    ----------
    mean_slip : float or array, u_t,r
    tangential_force : float or array, w_t,r per cell
    period, height, poisson : as of `drive_stiffness`
    """
    return mean_slip + tangential_force / drive_stiffness(period, height, poisson)


def drive_critical_height(softening, period, poisson=0.5):
    """Height H = L (1 - nu)/(2 S) of the layer above which sliding starts with a jump (a fold in
    the displacement of the top), for the steepest fall S = max(-dT/d(mean u_t)) > 0 of the force
    along the path; lower layers slide gradually. S is `uniform_slip_softening` for small tangential
    Maugis parameters; a law without a fall (full residual friction) may have none.

    Parameters
    ----------
    softening : float or array, w_t,r/u_t,r
    period, poisson : as of `drive_stiffness`
    """
    positive(softening=softening)
    return drive_stiffness(period, 1.0, poisson) / softening


def driven_fold(mean_slip, tangential_force, period, height, poisson=0.5):
    """(mean_slip, tangential_force, displacement) where the displacement of the top first stops
    growing along a path, given by arrays of mean slip and force in its order, three points and
    more: sliding starts there with a jump, dT/d(mean u_t) = -`drive_stiffness`. By the parabolas
    over the slip through the three points about it: as exact as they are close. The path of one
    height serves all above about the period. ValueError where the displacement grows throughout:
    sliding begins gradually.

    Parameters
    ----------
    mean_slip : array (points), u_t,r
    tangential_force : array (points), w_t,r per cell
    period, height, poisson : float, as of `drive_stiffness`
    """
    slip, force = np.asarray(mean_slip, float), np.asarray(tangential_force, float)
    require(slip.ndim == 1 and slip.shape == force.shape and slip.size > 2,
            "the path needs two arrays of three points and more")
    path = np.array([slip, force, driven_displacement(slip, force, period, height, poisson)])
    # not by rounding, before the shear
    falls = np.flatnonzero(np.diff(path[2]) < -1e-9 * np.ptp(path[2]))
    require(falls.size, "the displacement grows along the whole path: sliding begins gradually")
    near = np.clip(falls[0], 1, slip.size - 2) + np.arange(-1, 2)
    steps = slip[near] - slip[near[1]]
    require(np.diff(steps) > 0, "the mean slip must grow along the path up to the fold")
    displacement, through = (np.polyfit(steps, values[near], 2) for values in path[[2, 1]])
    place = np.clip(-displacement[1] / (2 * displacement[0]), steps[0], steps[-1])
    return float(slip[near[1]] + place), float(np.polyval(through,
                                                          place)), float(np.polyval(displacement,
                                                                                    place))
