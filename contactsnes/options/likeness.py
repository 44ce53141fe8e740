"""Names that a name may stand for."""

import difflib
from itertools import chain

SLIP = 0.92
"""How alike names are, by `difflib`, that a slip of the finger tells apart."""


def nearest(name, names, cutoff=0.5):
    """The one of some names that a name most likely stands for, or an empty text where none is
    like it: one that a slip of the finger tells apart, else one that has all its words, in
    whatever order (scene_maugis: scene_normal_maugis), else one that begins with it, else the one
    that looks most like it.

    Parameters
    ----------
    name : str
    names : iterable of str
    cutoff : float, 0 to 1, how alike names have to be
    """
    names, words = list(names), set(name.split("_"))
    having_all = [other for other in names if words <= set(other.split("_"))]
    longer = [other for other in names if len(name) > 2 and other.startswith(name)]
    return next(chain.from_iterable(
        difflib.get_close_matches(name, among, n=1, cutoff=max(cutoff, least))
        for among, least in ((names, SLIP), (having_all, 0.0), (longer, 0.0), (names, 0.0))), "")


def meant(name, names, otherwise="", prefix="", cutoff=0.5):
    """How a sentence about a name that is none ends: with the one that may be meant, or otherwise.

    Parameters
    ----------
    name, names, cutoff : as of `nearest`
    otherwise : str
    prefix : str, what stands before a name where it is used
    """
    guess = nearest(name, names, cutoff)
    return f": did you mean {prefix}{guess}?" if guess else otherwise
