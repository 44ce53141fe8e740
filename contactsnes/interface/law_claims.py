"""What laws of one's own declare: its kinds, and whether it is what their tractions have."""

import itertools
from numbers import Real

import numpy as np

from ..options.fields import InputError
from .law_places import ALIKE, STEP, beside, in_kind, places, refuse
from .laws.law import Law

APART = 1e-4
"""Potential at the end of the range, over that at no gap, that counts as none."""
SPANS = 0.25, 8.0
"""Least and largest gap, ranges, up to which a law attracts by half of its peak: the ways by which
steps, folds and jumps are told apart are fixed parts of a range."""
USUAL = 2.678
"""That of a exp(-a)."""


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


def check_senses(law, name):
    """InputError where a law has no attraction that rises and falls again, or a friction that
    drives the slip."""
    if not np.all(np.isfinite(law._opened)):
        raise InputError(f"the law {name} has a normal traction or tangent that is not finite at "
                         f"some gap from 0 to {law.range:g} (ranges); mend it")
    if not min(law._opened[:2]) > 0.0:
        raise InputError(f"the law {name} attracts nowhere: its normal traction has to rise "
                         "above 0 as the gap grows, and to fall to 0 again")
    little = law.tangent(np.zeros((2, 1)))[1, 1, 0]
    if not little >= 0.0:
        raise InputError(f"the law {name} has a friction that drives the slip: at no gap and "
                         f"little slip it grows by {little:.6g} of the slip; what acts against it "
                         "is positive")


def check_sizes(law, name):
    """InputError where a law claims another size or less softening than its tractions have."""
    sampled = {"normal_peak": law._opened[0], "softening": law._opened[1],
               "barrier": law._opened[2],
               "tangential_peak": Law.tangential_peak.fget(law),
               "slip_softening": law._slipped.softening}
    for what, found in sampled.items():
        claimed = getattr(law, what)
        wrong = (not claimed >= 0.99 * found - 1e-9 if what.endswith("softening")
                 else not abs(claimed - found) <= 1e-3 * found + 1e-9)
        if wrong:
            raise InputError(f"the law {name} declares {what} = {claimed:.6g}, or has it from its "
                             f"base, but its tractions give {found:.6g}: mend it, or take the "
                             f"sampled one, {what} = Law.{what}")


def check_scale(law, name):
    """InputError where a law attracts over so many ranges, or so small a part of one, that folds
    would be passed; ``name`` for the sentence."""
    gaps = np.concatenate([np.linspace(0.0, end, 20001) for end in (law.opening_range, law.range)])
    span = np.max(gaps[law.normal(gaps)[0] >= 0.5 * law.normal_peak], initial=0.0)
    if not SPANS[0] <= span <= SPANS[1]:
        part = span / USUAL
        raise InputError(f"the law {name} attracts by half of its peak up to a gap of {span:.3g} "
                         f"ranges, where a exp(-a) does to {USUAL:.3g}: folds are looked for on "
                         f"the way of a range, and allowed is {SPANS[0]:g} to {SPANS[1]:g}; with "
                         f"s = {part:.2g} take s N(s a) in place of N(a), and divide "
                         "-scene_normal_maugis by s")


def check_stiffnesses(law, name):
    """InputError where the slip at the peak or a stiffness of the regularised gap is none, or gap
    and slip together soften more than they are said to; ``name`` for the sentence."""
    for what, least in (("slip_peak", 0.0), ("moving_stiffness", law.softening),
                        ("newton_stiffness", law.softening)):
        if not isinstance(value := getattr(law, what), Real) or not value > least:
            raise InputError(f"the law {name} declares {what} = {value!r}: allowed is a number "
                             f"above {least:.6g}")
    if type(law).coupled_softening is Law.coupled_softening:
        return
    try:
        claimed = float(law.coupled_softening(1.0, 1.0))
    except (Exception, SystemExit) as error:
        raise InputError(f"the law {name} has a coupled_softening(normal_maugis, "
                         f"tangential_maugis) that cannot be evaluated ({type(error).__name__}: "
                         f"{error}); mend it") from error
    found = Law.coupled_softening(law, 1.0, 1.0)
    if not claimed >= 0.99 * found - 1e-9:
        raise InputError(f"the law {name} has a coupled_softening of {claimed:.6g} at Maugis "
                         f"parameters of 1, but its tractions give {found:.6g}: mend it, or take "
                         "the sampled one, coupled_softening = Law.coupled_softening")


def check_potential(law, name):
    """InputError where the gradient of a law's potential is not its traction, whatever the ratio
    of the works, or where it is not zero at the end of the range; where it says that there is
    none, nothing is."""
    normal = places(law, 1)
    slips = beside((0.2, 0.9, 3.0), law.slip_corners)
    parts = [np.array([(a, *(b * turn)) for a in beside(gaps, law.gap_corners) for b in slips]).T
             for turn in (np.ones(1), np.array([-0.6, 0.8])) for gaps in ((-3.0, -0.4), (0.7, 2.5))]
    for gaps in (normal[:, normal[0] > law.deepest + 0.5], *parts):
        for work_ratio, j in itertools.product((1.0, 3.0), range(len(gaps))):
            _check_gradient(law, name, gaps, work_ratio, j)
    ends = potential(law, name, np.array([[0.0, law.range]]), 1.0)
    if ends is not None and not abs(ends[1]) <= APART * abs(ends[0] - ends[1]):
        raise InputError(f"the law {name} has the potential {ends[1]:.6g} at the normal gap "
                         f"{law.range:g} without slip, the end of the range: it has to be 0 where "
                         "the surfaces are apart; subtract it from all of the potential")


def _check_gradient(law, name, gaps, work_ratio, j):
    """InputError where differences of a law's potential along a component are not its traction.

    Parameters
    ----------
    law, name : Law, str
    gaps : array (components, places)
    work_ratio : phi_t / phi_n
    j : number of the component
    """
    step = np.zeros((len(gaps), 1))
    step[j] = STEP
    ends = [potential(law, name, gaps + sign * step, work_ratio) for sign in (1, -1)]
    if any(end is None for end in ends):
        return
    found = (ends[0] - ends[1]) / (2 * STEP)
    meant = law.traction(gaps)[j] * (work_ratio if j else 1.0)
    rounding = np.maximum(*np.abs(ends)) * 1e-15 / STEP
    times = f" times the work_ratio {work_ratio:g}" if j and work_ratio != 1.0 else ""
    refuse(name, gaps, f"differences of its potential along g_{j} are not its traction{times} "
           "(a law without one has potential() return None)",
           ~(np.abs(found - meant) <= ALIKE * np.abs(meant) + 1e-7 + 10 * rounding)[None],
           found[None], meant[None])


def potential(law, name, gaps, work_ratio):
    """A law's potential, an array (places), phi_n, or None; InputError where it is neither, or
    cannot be evaluated.

    Parameters
    ----------
    law, name, gaps, work_ratio : as of `_check_gradient`
    """
    try:
        found = law.potential(gaps, work_ratio)
    except (Exception, SystemExit) as error:
        raise InputError(f"the law {name} has a potential(gap, work_ratio) that cannot be "
                         f"evaluated ({type(error).__name__}: {error}); mend it") from error
    if found is not None and not (isinstance(found, np.ndarray) and found.dtype.kind == "f"
                                  and found.shape == gaps.shape[1:]):
        raise InputError(f"the law {name} has a potential(gap, work_ratio) that returns "
                         f"{in_kind(found)} for {gaps.shape[1]} nodes: it has to be None, or an "
                         "array of one real number for each")
    return found
