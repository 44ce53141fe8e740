"""Places at which laws of one's own are looked at, and how what is wrong there is told."""

import itertools

import numpy as np

from ..options.fields import InputError

STEP = 1e-5
"""Step of the differences, ranges of the law."""
ALIKE = 1e-4
"""Difference of tangents, over the largest entry at the place, up to which they are alike."""


def places(law, components):
    """Gaps (components, places) at which laws are looked at, none of them within two steps of a
    corner."""
    aside = [side * 3 * STEP for side in (-1, 1)]
    beyond = [law.deepest - 1.0, law.deepest + 1.0, law.range - 0.5]
    normal = [*beside((*beyond, -3.0, -0.4, *aside, 0.7, 1.0, 2.5, 6.0), law.gap_corners),
              *(c + s for c in law.gap_corners for s in aside)]
    if components == 1:
        return np.array([normal])
    slips = [0.0, *beside((3 * STEP, 0.2, 0.9, 1.0, 3.0), law.slip_corners),
             *(c + s for c in law.slip_corners for s in aside if c + s > 0.0)]
    turns = np.array([[1.0], [-1.0]]) if components == 2 else np.array([[1.0, 0.0], [-0.6, 0.8]])
    return np.array([[a, *(b * turn)] for a, b, turn in itertools.product(normal, slips, turns)]).T


def beside(wanted, corners):
    """Places that are wanted, those at a corner moved a little."""
    return [place + 0.03 * any(abs(place - corner) < 2.5 * STEP for corner in corners)
            for place in wanted]


def refuse(name, gaps, why, wrong, values, meant):
    """InputError that tells of the first place that is wrong.

    Parameters
    ----------
    name : what the sentence calls the law
    gaps : array (components, places), ranges of the law
    why : str, what is wrong
    wrong : array of bool (components, places)
    values, meant : arrays (components, places), what there is and what it has to be
    """
    if wrong.any():
        place = np.flatnonzero(wrong.any(axis=0))[0]
        raise InputError(f"the law {name}: {why}, at {in_words(gaps[:, place])}: "
                         f"{values[..., place]} for {meant[..., place]}")


def in_words(gap):
    """A gap in words."""
    slip = f" and the slip {', '.join(f'{value:.6g}' for value in gap[1:])}" if len(gap) > 1 else ""
    return f"the normal gap {gap[0]:.6g}{slip} (ranges)"


def in_kind(found):
    """What something is, in words: of an array its shape and the type of its numbers, too."""
    if isinstance(found, np.ndarray):
        return f"an array {found.shape} of {found.dtype}"
    return repr(found) if found is None else f"a {type(found).__name__}"
