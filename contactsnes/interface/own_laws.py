"""Laws of one's own: their tangent is compared with differences of their tractions."""

import itertools
from functools import partial

import numpy as np

from ..options.fields import InputError
from . import law_claims
from .formula import NORMAL, SHEARED, Tractions
from .law_places import ALIKE, STEP, in_kind, in_words, places, refuse
from .laws.law import Law
from .program import fault


def check(law, name, in_file=True):
    """InputError unless a law's tangent is that of its tractions, and these are what a law's are,
    and what it declares of them; ``name`` for the sentence. A law of a file has to end where it
    says, too; objects made in Python may hold on beyond that.

    Parameters
    ----------
    law : Law
    name : what the sentence calls it
    in_file : whether it is of a file
    """
    law_claims.check_kinds(law, name)
    if type(law).evaluate is not Law.evaluate:
        vars(law)["evaluate"] = partial(_watched, law, name)
    with np.errstate(all="ignore"):
        try:
            written = law.formula is not None
        except NotImplementedError as error:
            raise InputError(f"{error}: give it one of them") from None
        if written:
            _check_formula(law, name)
        _check_tangent(law, name)
        lines = [(line, law.traction(line), law.tangent(line)) for line in _lines(law)]
        _check_finite(lines, name)
        law_claims.check_senses(law, name)
        _check_signs(law, name, in_file)
        _check_jumps(law, name, lines)
        law_claims.check_sizes(law, name)
        law_claims.check_scale(law, name)
        law_claims.check_stiffnesses(law, name)
        law_claims.check_potential(law, name)


def _check_formula(law, name):
    """InputError where tractions or their derivatives are not finite, or tractions are others than
    their formula's.

    Looked at are places as of the tangent, the corners themselves, and lines of many places.
    """
    corners = itertools.product((0.0, law.deepest, *law.gap_corners), (0.0, *law.slip_corners, 1.0))
    gaps = np.hstack([np.abs(places(law, 2)) * [[-1.0], [1.0]], places(law, 2),
                      np.array([*corners]).T, *_lines(law)])
    a, b = np.maximum(gaps[0], law.deepest), np.abs(gaps[1])
    made = Tractions(law.formula)
    for results, values in ((NORMAL, (a,)), (SHEARED, (a, b * b))):
        found = fault(made.program(results is SHEARED, False, True), *values)
        if found:
            place = in_words((found.values[0], *np.sqrt(found.values[1:])))
            of = ", ".join(f"{value:.6g}" for value in found.arguments)
            raise InputError(f"the law {name} has no finite {results[found.result]} at {place}: "
                             + (f"{found.operation} has the arguments {of}" if of else
                                f"{found.operation} stands there")
                             + "; choose by np.where what holds there")
    plain = np.array([np.broadcast_to(value, a.shape) for value in law.tractions(a, b)])
    told = np.array(made.program(True, False, False).run(a, b * b))
    refuse(name, np.array([a, b]), "tractions(a, b) gives other values when it is called again, "
           "or depends on more than the nodes' own gap and slip",
           ~np.isclose(plain, told, rtol=1e-9, atol=1e-12), plain, told)


def _check_tangent(law, name):
    """InputError unless a law's tangent is that of its tractions, and these are odd if they claim
    to be; ``name`` for the sentence.

    Looked at are both sides of every corner that it declares, overlap, no and little slip, and the
    end of its range.
    """
    for components in (1, 2, 3):
        gaps = places(law, components)
        try:
            traction, tangent = law.traction(given := gaps.copy()), law.tangent(given)
            differences = _differences(law, gaps)
            alone, kept = law.evaluate(inside := gaps.copy(), inside), law.normal(gaps[0])[0]
        except InputError:
            raise
        except (Exception, SystemExit) as error:
            raise InputError(f"the law {name} cannot be evaluated with {components} component(s) "
                             f"({type(error).__name__}: {error}); mend it") from error
        if not np.array_equal(given, gaps):
            raise InputError(f"the law {name}: its evaluate writes into the gaps that it is given, "
                             "which others go on with: work on a copy of them")
        _compare(name, gaps, tangent, differences)
        refuse(name, gaps,
               "the traction is another where it is written over the gap (traction is gap)",
               ~np.isclose(alone, traction, rtol=1e-12, atol=1e-300), alone, traction)
        some = gaps[:, -2::-2].copy()
        refuse(name, some, "the traction hangs on more than a node's own gap and slip: it is "
               "another among fewer nodes in another order",
               ~np.isclose(law.traction(some), traction[:, -2::-2], rtol=1e-9, atol=1e-12),
               law.traction(some), traction[:, -2::-2])
        still = (np.linalg.norm(gaps[1:], axis=0) == 0.0)[None]
        refuse(name, gaps,
               "without slip the normal traction is another than that of one component",
               still & ~np.isclose(traction[:1], kept, rtol=1e-9, atol=1e-12), traction[:1],
               kept[None])
        if law.odd and components > 1:
            mirror = np.array([1.0] + [-1.0] * (components - 1))[:, None]
            refuse(name, gaps, "tractions are not odd in slip, as it declares (odd = True)",
                   ~np.isclose(law.traction(mirror * gaps), mirror * traction, rtol=1e-9,
                               atol=1e-12), law.traction(mirror * gaps), mirror * traction)


def _watched(law, name, gap, traction, tangent=None):
    """What the evaluate of a law's class does, for as long as the law is in use: one that does not
    hang on gaps alone may return something else late, and end somewhere as a defect of ours.

    InputError where not the array that it is given holds the tractions, or, of a law that has been
    looked at, where something is not finite that has to be: where no gap is below its deepest, to
    which solvers may come on their way.
    """
    given = gap.copy() if traction is gap else gap
    found = type(law).evaluate(law, gap, traction, tangent)
    if found is not traction:
        raise InputError(f"the law {name}: its evaluate returns another array than the traction "
                         f"that it is given, or none ({in_kind(found)} for {in_kind(traction)}): "
                         "fill that one, and return it")
    for what, values in (("traction", traction), ("tangent", tangent)):
        # (a sum takes less than a look at each)
        if (values is not None and not np.isfinite(values.sum()) and np.isfinite(given).all()
                and vars(law).get("_looked_at") and given[0].min() >= law.deepest):
            _refuse_infinite(name, what, values, given)
    return traction


def _refuse_infinite(name, what, values, gaps):
    """InputError that tells of the first place at which a value is not finite.

    Parameters
    ----------
    name, what : str, of the law and of the values
    values : array (..., places)
    gaps : array (components, places)
    """
    wrong = ~np.isfinite(values).reshape(-1, gaps.shape[1]).all(axis=0)
    for place in np.flatnonzero(wrong)[:1]:
        raise InputError(f"the law {name} has no finite {what} at {in_words(gaps[:, place])}; "
                         "mend it")


def _check_signs(law, name, in_file):
    """InputError unless there is no traction at no gap, repulsion in overlap, and hardly any at the
    end of the range; of an object made in Python, unless its normal traction ends there.

    Parameters
    ----------
    law, name, in_file : as of `check`
    """
    a = np.array([0.0, law.deepest, -1.0, -1e-3, law.range])
    normal = law.normal(a)[0]
    for wrong, place, meant in ((abs(normal[0]) > 1e-12, 0, "0"),
                                (normal[1] >= 0, 1, "below 0 (a repulsion)"),
                                (normal[2] >= 0, 2, "below 0 (a repulsion)"),
                                (normal[3] >= 0, 3, "below 0 (a repulsion)"),
                                (abs(normal[4]) > 1e-9 * law.normal_peak, 4,
                                 "next to none: it is declared to be the end of the range")):
        if wrong and (in_file or place == 4):
            raise InputError(f"the law {name} has the normal traction "
                             f"{normal[place]:.6g} at the normal gap {a[place]:g} "
                             f"without slip: it has to be {meant}")
    left = law.traction(np.array([[law.range], [0.9]]))[1, 0]
    if in_file and abs(left) > 1e-9 * law.tangential_peak:
        raise InputError(f"the law {name} has the tangential traction {left:.6g} "
                         f"at the normal gap {law.range:g} and the slip "
                         "0.9: it has to be next to none, since that "
                         "is declared to be the end of the range")


def _lines(law):
    """Gaps and slips (2, places) along lines of many places: overlap, opening, up to the end of the
    range, and slip."""
    a = np.concatenate([np.linspace(law.deepest, -3.0, 4001), np.linspace(-3.0, law.opening_range,
                                                                          4001)[1:],
                        np.linspace(law.opening_range, law.range, 4001)[1:]])
    b = np.linspace(0.0, law.slip_range, 4001)
    return [*(np.array([a, np.full_like(a, slip)]) for slip in (0.0, 0.4, 2.0)),
            *(np.array([np.full_like(b, gap), b]) for gap in (-1.0, 0.0, 1.0))]


def _check_finite(lines, name):
    """InputError where a traction or its tangent is not finite on lines, [(gaps and slips,
    tractions, tangents), ...]; ``name`` for the sentence."""
    for line, traction, tangent in lines:
        _refuse_infinite(name, "traction", traction, line)
        _refuse_infinite(name, "tangent", tangent, line)


def _check_jumps(law, name, lines):
    """InputError where a traction jumps as the gap or the slip grows, or goes to infinity on both
    sides of a place: no equilibrium is sure to exist there.

    Parameters
    ----------
    law, name : Law, str
    lines : as of `_check_finite`
    """
    for line, traction, tangent in lines:
        low, high, change = line[:, :-1], line[:, 1:], np.diff(traction)
        ends = [np.einsum("ijn,jn->in", end, high - low)
                for end in (tangent[..., :-1], tangent[..., 1:])]
        # a pole turns round what the tangents at both of its sides say
        against = (change * ends[0] < 0.0) & (change * ends[1] < 0.0) & (np.abs(change) > 1e-6)
        steep = np.where(against, np.inf, np.abs(change) / (1e-9 + np.maximum(*np.abs(ends))))
        for i, worst in enumerate(np.argmax(steep, axis=1)):
            _refuse_jump(law, name, i, low[:, [worst]], high[:, [worst]])


def _refuse_jump(law, name, i, low, high):
    """InputError if a traction t_i jumps between two gaps (components, 1), found by halving."""
    start = law.traction(low)[i, 0], law.traction(high)[i, 0]
    for _ in range(30):
        middle = 0.5 * (low + high)
        first, last = (abs(law.traction(middle)[i, 0] - law.traction(end)[i, 0])
                       for end in (low, high))
        low, high = (low, middle) if first > last else (middle, high)
    jump = abs(law.traction(high)[i, 0] - law.traction(low)[i, 0])
    if jump > 0.5 * abs(start[1] - start[0]) and jump > 1e-6:
        raise InputError(f"the law {name} has a traction t_{i} that jumps by {jump:.6g} at "
                         f"{in_words(high[:, 0])}; tractions have to be continuous")


def _differences(law, gaps):
    """Central differences of the tractions, an array (components, components, places)."""
    found = np.empty((len(gaps), *gaps.shape))
    for j in range(len(gaps)):
        step = np.zeros((len(gaps), 1))
        step[j] = STEP
        found[:, j] = (law.traction(gaps + step) - law.traction(gaps - step)) / (2 * STEP)
    return found


def _compare(name, gaps, tangent, differences):
    """InputError where a tangent is not that of the differences, telling of the worst place, or
    where one of them is not finite."""
    for what, values in (("traction beside", differences), ("tangent at", tangent)):
        for place in np.flatnonzero(~np.isfinite(values).all(axis=(0, 1)))[:1]:
            raise InputError(f"the law {name} has no finite {what} {in_words(gaps[:, place])}; "
                             "mend it")
    size = np.abs(differences).max(axis=(0, 1))
    error = np.abs(tangent - differences) - ALIKE * size - 1e-9
    if error.max() > 0.0:
        i, j, place = np.unravel_index(np.argmax(error / (size + 1e-9)), error.shape)
        raise InputError(f"the law {name} has a tangent that is not that "
                         f"of its traction: at {in_words(gaps[:, place])} d t_{i} "
                         f"/ d g_{j} is {tangent[i, j, place]:.8g}, but "
                         f"differences of t_{i} give {differences[i, j, place]:.8g}; "
                         "mend one, or, if there is a corner, name it "
                         "in gap_corners or slip_corners")
