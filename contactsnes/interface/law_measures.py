"""What is measured of the tractions of a law: how steeply they soften, and where they end."""

import numpy as np

NOTHING = 1e-9
"""Part of a law's peaks up to which there is no traction."""


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
