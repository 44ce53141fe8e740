"""What is measured of the tractions of a law: how steeply they soften, how large the friction
is, and where they end."""

from typing import NamedTuple

import numpy as np

NOTHING = 1e-9
"""Part of a law's peaks up to which there is no traction."""
SAMPLES = 60001
"""Slips at which friction is measured."""


class Slipped(NamedTuple):
    """The largest friction of a law, phi_t/delta_t, the least slip where it is and its steepest
    fall with the slip; the overlap, in ranges, at which that was measured."""

    peak: float
    place: float
    softening: float
    overlap: float


def slipped(law):
    """What a law's friction is at no normal gap or, where it has none there, as Coulomb's, in an
    overlap over which the repulsion grows by a factor e: a `Slipped`, its place 1 without friction.

    Parameters
    ----------
    law : Law
    """
    slip = np.linspace(0.0, law.slip_range, SAMPLES)
    for overlap in (0.0, law.repulsion):
        gap = np.array([np.full_like(slip, -overlap), slip])
        traction = law.traction(gap)[1]
        if traction.max() > NOTHING * law.normal_peak:  # what else there is, is rounding
            place = np.argmax(traction >= traction.max() * (1.0 - 1e-10))
            fall = max(np.max(-law.tangent(gap)[1, 1]), 0.0)
            return Slipped(float(traction[place]), float(slip[place]), float(fall), overlap)
    return Slipped(0.0, 1.0, 0.0, 0.0)


def softening(tangent):
    """Minus the smallest real eigenvalue of a law's scaled tangent, array (2, 2, nodes); 0 where it
    is positive or none is real."""
    (normal, opening), (weakening, slipping) = tangent
    discriminant = 0.25 * (normal - slipping) ** 2 + opening * weakening
    return np.where(discriminant >= 0.0, np.maximum(np.sqrt(np.maximum(discriminant, 0.0))
                                                    - 0.5 * (normal + slipping), 0.0), 0.0)


def certain_gap(law):
    """Normal gap, in ranges, that every node outside a window must have: 30/37 of the law's range,
    where a exp(-a) is below 1e-11 of its peak, or the range of a law that acts beyond that.

    Parameters
    ----------
    law : Law
    """
    inner = 30.0 * law.range / 37.0
    gaps = np.array(np.meshgrid(np.linspace(inner, law.range, 65)[:-1],
                                np.linspace(0.0, law.slip_range, 25))).reshape(2, -1)
    normal, tangential = np.max(np.abs(law.traction(gaps)), axis=1)
    acts = normal > NOTHING * law.normal_peak or tangential > NOTHING * law.tangential_peak
    return law.range if acts else inner
