"""Bodies of one's own: what they declare is looked at on the cell's waves and far shorter ones."""

import numpy as np

from ..options.fields import InputError
from .bodies import BODIES

WAVES = 10.0 ** np.arange(0, 5, 0.5)
"""Wave numbers over that of the cell at which a body is looked at besides those of the grid."""

MANY = 2 ** 18
"""Waves of a plane's grid above which those along its axes are looked at, not all."""

ALIKE = 1e-8
"""Relative difference up to which a stiffness is the inverse of a compliance."""


def check_own(body, scene):
    """InputError unless a body of one's own has finite compliances that store energy, and a
    stiffness that is their inverse."""
    if type(body) in BODIES.values():
        return
    named = f"{scene.option_name('body')} is '{scene.body}'"
    q = _waves(scene)
    try:
        with np.errstate(all="ignore"):
            c, m, rigid = body.surface(q), body.surface_stiffness(q), body.rigid_compliance
            determinant = c.normal * c.longitudinal - c.coupling ** 2
            inverse = (("normal", c.normal * m.normal - c.coupling * m.coupling),
                       ("longitudinal", c.longitudinal * m.longitudinal - c.coupling * m.coupling),
                       ("transverse", c.transverse * m.transverse))
            normal, tangential = (float(value) for value in rigid)
            left = np.array([np.broadcast_to(part, q.shape)[-1]
                             for part in (c.normal, c.longitudinal)], dtype=float)
            local = np.array(body.local_compliance, dtype=float) + np.zeros(2)
    except Exception as error:
        raise InputError(f"{named}: it cannot be evaluated ({type(error).__name__}: "
                         f"{error}); mend it") from error
    if np.shape(c.normal) != q.shape:
        raise InputError(f"{named}: its normal compliance has the shape {np.shape(c.normal)}, the "
                         f"wave numbers have {q.shape}: give one value for each")
    for words, values in (("its normal compliance", c.normal),
                          ("its transverse compliance", c.transverse),
                          ("the determinant of its normal and longitudinal compliance",
                           determinant)):
        _refuse(f"{named}: {words}", q, values, ~(np.isfinite(values) & (values > 0)),
                "positive and finite")
    for words, values in inverse:
        _refuse(f"{named}: its {words} stiffness times its compliance", q, values,
                ~(np.abs(values - 1) < ALIKE), "1")
    if not (0 <= normal < np.inf and 0 <= tangential < np.inf):
        raise InputError(f"{named}: its rigid_compliance is {rigid}: both have to be finite and at "
                         "least 0")
    if not np.all((local >= 0) & (local <= left * (1 + ALIKE))):
        raise InputError(f"{named}: its local_compliance is {body.local_compliance}: both have to "
                         f"be from 0 to what is left at short waves, at most {left[0]:.6g} "
                         f"normally and {left[1]:.6g} along the surface")


def _waves(scene):
    """Wave numbers at which a body is looked at, 1/beta, in their order; where the grid has yet to
    be chosen, without its own."""
    longest = max((period for period in scene.periods if np.isfinite(period)), default=100.0)
    q = 2 * np.pi / longest * WAVES
    if scene.isolated or scene.points == "auto":
        return q
    axes = [2 * np.pi / period * np.arange(points // 2 + 1) for period, points in zip(scene.periods,
                                                                                      scene.shape)]
    if len(axes) > 1 and np.prod([len(axis) for axis in axes]) <= MANY:
        axes = [np.hypot(*np.meshgrid(*axes)).reshape(-1)]
    q = np.unique(np.concatenate([q, *axes]))
    return q[q > 0]


def _refuse(words, q, values, wrong, meant):
    """InputError that tells of the first wave number at which a value is wrong."""
    if np.any(wrong):
        place = np.argmax(np.broadcast_to(wrong, q.shape))
        raise InputError(f"{words} is {np.broadcast_to(values, q.shape)[place]:.6g} at the wave "
                         f"number {q[place]:.6g} 1/beta: it has to be {meant}")
