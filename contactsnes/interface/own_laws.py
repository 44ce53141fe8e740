"""Laws of one's own: their tangent is compared with differences of their tractions."""

import itertools

import numpy as np

from ..options.fields import InputError

STEP = 1e-5
"""Step of the differences, ranges of the law."""
ALIKE = 1e-4
"""Difference of tangents, over the largest entry at the place, up to which they are alike."""


def check(law, name):
    """InputError unless a law's tangent is that of its tractions, and these are what a law's are;
    ``name`` for the sentence.

    Looked at are both sides of every corner that it declares, overlap, no and little slip, and the
    end of its range.
    """
    for components in (1, 2, 3):
        gaps = places(law, components)
        try:
            with np.errstate(all="ignore"):
                traction, tangent = law.traction(gaps), law.tangent(gaps)
                differences = _differences(law, gaps)
                alone, kept = law.evaluate(inside := gaps.copy(), inside), law.normal(gaps[0])[0]
        except Exception as error:
            raise InputError(f"the law {name} cannot be evaluated with "
                             f"{components} component(s) ({type(error).__name__}: "
                             f"{error}); mend it") from error
        _compare(name, gaps, tangent, differences)
        _refuse(name, gaps,
                "the traction is another where it is written over the gap (traction is gap)",
                ~np.isclose(alone, traction, rtol=1e-12, atol=1e-300), alone, traction)
        still = (np.linalg.norm(gaps[1:], axis=0) == 0.0)[None]
        _refuse(name, gaps,
                "without slip the normal traction is another than that of one component",
                still & ~np.isclose(traction[:1], kept, rtol=1e-9, atol=1e-12), traction[:1],
                kept[None])
        if law.odd and components > 1:
            mirror = np.array([1.0] + [-1.0] * (components - 1))[:, None]
            _refuse(name, gaps, "tractions are not odd in slip, as it declares (odd = True)",
                    ~np.isclose(law.traction(mirror * gaps), mirror * traction, rtol=1e-9,
                                atol=1e-12), law.traction(mirror * gaps), mirror * traction)
    _check_signs(law, name)


def _check_signs(law, name):
    """InputError unless there is no traction at no gap, repulsion in overlap, and hardly any at the
    end of the range."""
    a = np.array([0.0, law.deepest, -1.0, -1e-3, law.range])
    normal = law.normal(a)[0]
    for wrong, place, meant in ((abs(normal[0]) > 1e-12, 0, "0"),
                                (normal[1] >= 0, 1, "below 0 (a repulsion)"),
                                (normal[2] >= 0, 2, "below 0 (a repulsion)"),
                                (normal[3] >= 0, 3, "below 0 (a repulsion)"),
                                (abs(normal[4]) > 1e-9 * law.normal_peak, 4,
                                 "next to none: it is declared to be the end of the range")):
        if wrong:
            raise InputError(f"the law {name} has the normal traction "
                             f"{normal[place]:.6g} at the normal gap {a[place]:g} "
                             f"without slip: it has to be {meant}")
    left = law.traction(np.array([[law.range], [0.9]]))[1, 0]
    if abs(left) > 1e-9 * law.tangential_peak:
        raise InputError(f"the law {name} has the tangential traction {left:.6g} "
                         f"at the normal gap {law.range:g} and the slip "
                         "0.9: it has to be next to none, since that "
                         "is declared to be the end of the range")


def places(law, components):
    """Gaps (components, places) at which laws are looked at, none of them within two steps of a
    corner."""
    aside = [side * 3 * STEP for side in (-1, 1)]
    beyond = [law.deepest - 1.0, law.deepest + 1.0, law.range - 0.5]
    normal = [*beyond, -3.0, -0.4, *aside, 0.7, 1.0, 2.5, 6.0,
              *(c + s for c in law.gap_corners for s in aside)]
    if components == 1:
        return np.array([normal])
    slips = [0.0, 3 * STEP, 0.2, 0.9, 1.0, 3.0, *(c + s for c in law.slip_corners for s in aside
                                                  if c + s > 0.0)]
    turns = np.array([[1.0], [-1.0]]) if components == 2 else np.array([[1.0, 0.0], [-0.6, 0.8]])
    return np.array([[a, *(b * turn)] for a, b, turn in itertools.product(normal, slips, turns)]).T


def _differences(law, gaps):
    """Central differences of the tractions, an array (components, components, places)."""
    found = np.empty((len(gaps), *gaps.shape))
    for j in range(len(gaps)):
        step = np.zeros((len(gaps), 1))
        step[j] = STEP
        found[:, j] = (law.traction(gaps + step) - law.traction(gaps - step)) / (2 * STEP)
    return found


def _compare(name, gaps, tangent, differences):
    """InputError where a tangent is not that of the differences, telling of the worst place."""
    size = np.abs(differences).max(axis=(0, 1))
    error = np.abs(tangent - differences) - ALIKE * size - 1e-9
    error = np.where(np.isfinite(error), error, np.inf)
    if error.max() > 0.0:
        i, j, place = np.unravel_index(np.argmax(error / (size + 1e-9)), error.shape)
        raise InputError(f"the law {name} has a tangent that is not that "
                         f"of its traction: at {_place(gaps[:, place])} d t_{i} "
                         f"/ d g_{j} is {tangent[i, j, place]:.8g}, but "
                         f"differences of t_{i} give {differences[i, j, place]:.8g}; "
                         "mend one, or, if there is a corner, name it "
                         "in gap_corners or slip_corners")


def _refuse(name, gaps, why, wrong, values, meant):
    """InputError that tells of the first place that is wrong, an array (components, places)."""
    if wrong.any():
        place = np.flatnonzero(wrong.any(axis=0))[0]
        raise InputError(f"the law {name}: {why}, at {_place(gaps[:, place])}: "
                         f"{values[..., place]} for {meant[..., place]}")


def _place(gap):
    """A gap in words."""
    slip = f" and the slip {', '.join(f'{value:.6g}' for value in gap[1:])}" if len(gap) > 1 else ""
    return f"the normal gap {gap[0]:.6g}{slip} (ranges)"
