"""What laws of one's own declare: its kinds, and whether it is what their tractions have."""

from numbers import Real

import numpy as np

from ..options.fields import InputError
from .laws.law import Law


def check_kinds(law, name):
    """InputError where a law declares what is no number, or no list of numbers or names; ``name``
    for the sentence."""
    for what in ("range", "deepest", "repulsion", "opening_range", "slip_range"):
        if not isinstance(value := getattr(law, what), Real) or not np.isfinite(value):
            raise InputError(f"the law {name} declares {what} = {value!r}: allowed is a number")
        if not (value < 0.0 if what == "deepest" else value > 0.0):
            raise InputError(f"the law {name} declares {what} = {value!r}: allowed is a number "
                             f"{'below' if what == 'deepest' else 'above'} 0")
    for what, known in (("gap_corners", None), ("slip_corners", None),
                        ("slip_options", law.declared()), ("derived", dir(law))):
        values = getattr(law, what)
        if not isinstance(values, (tuple, list)) or not all(
                isinstance(value, Real) and np.isfinite(value) if known is None else value in known
                for value in values):
            raise InputError(f"the law {name} declares {what} = {values!r}: allowed is a tuple of "
                             + ("numbers" if known is None else "names of its options"
                                if what == "slip_options" else "names of its properties"))


def check_sizes(law, name):
    """InputError where a law claims another size or less softening than its tractions have."""
    sampled = {"normal_peak": law._opened[0], "softening": law._opened[1],
               "tangential_peak": law._slipped[0], "slip_softening": law._slipped[2]}
    for what in ("normal_peak", "softening"):
        if not sampled[what] > 0.0:
            raise InputError(f"the law {name} attracts nowhere: its normal traction has to rise "
                             "above 0 as the gap grows, and to fall to 0 again")
    for what, found in sampled.items():
        claimed = getattr(law, what)
        wrong = (not claimed >= 0.99 * found - 1e-9 if what.endswith("softening")
                 else not abs(claimed - found) <= 1e-3 * found + 1e-9)
        if wrong:
            raise InputError(f"the law {name} declares {what} = {claimed:.6g}, or has it from its "
                             f"base, but its tractions give {found:.6g}: mend it, or take the "
                             f"sampled one, {what} = Law.{what}")


def check_stiffnesses(law, name):
    """InputError where the slip at the peak or a stiffness of the regularised gap is none, or gap
    and slip together soften more than they are said to; ``name`` for the sentence."""
    for what, least in (("slip_peak", 0.0 if law.tangential_peak > 0.0 else -1.0),
                        ("moving_stiffness", law.softening), ("newton_stiffness", law.softening)):
        if not isinstance(value := getattr(law, what), Real) or not value > least:
            raise InputError(f"the law {name} declares {what} = {value!r}: allowed is a number "
                             f"above {least:.6g}")
    if type(law).coupled_softening is Law.coupled_softening:
        return
    try:
        claimed = float(law.coupled_softening(1.0, 1.0))
    except Exception as error:
        raise InputError(f"the law {name} has a coupled_softening(normal_maugis, "
                         f"tangential_maugis) that cannot be evaluated ({type(error).__name__}: "
                         f"{error}); mend it") from error
    found = Law.coupled_softening(law, 1.0, 1.0)
    if not claimed >= 0.99 * found - 1e-9:
        raise InputError(f"the law {name} has a coupled_softening of {claimed:.6g} at Maugis "
                         f"parameters of 1, but its tractions give {found:.6g}: mend it, or take "
                         "the sampled one, coupled_softening = Law.coupled_softening")
