"""Names that a name may stand for."""

import difflib
from itertools import chain

SLIP = 0.92
"""How alike names are, by `difflib`, that a slip of the finger tells apart."""

NEAR = 0.65
"""How alike the rest of names has to be, without the words that both begin with: these alone make
names of one prefix look alike."""

WORD = 0.85
"""How alike words are that stand for the same."""


def nearest(name, names, cutoff=0.5):
    """The one of some names that a name most likely stands for, or an empty text where none is
    like it: one that a slip of the finger tells apart, else one that has all its words, in
    whatever order (scene_maugis: scene_normal_maugis), else one that begins with it, else the one
    that looks most like it, of those that do so beyond the words that both begin with.

    Parameters
    ----------
    name : str
    names : iterable of str
    cutoff : float, 0 to 1, how alike names have to be
    """
    names, words = list(names), set(name.split("_"))
    having_all = [other for other in names if words <= set(other.split("_"))]
    longer = [other for other in names if len(name.split("_")[-1]) > 2 and other.startswith(name)]
    near = [other for other in names if _is_near(name, other)]
    return next(chain.from_iterable(
        difflib.get_close_matches(name, among, n=1, cutoff=max(cutoff, least))
        for among, least in ((names, SLIP), (having_all, 0.0), (longer, 0.0), (near, 0.0))), "")


def _is_near(name, other):
    """Whether a name may stand for another: beyond the words that both begin with they look alike,
    have a word in common, or one of them has none."""
    ours, theirs = name.split("_"), other.split("_")
    while ours and theirs and ours[0] == theirs[0]:
        del ours[0], theirs[0]
    rests = "_".join(ours), "_".join(theirs)
    return (not all(rests) or difflib.SequenceMatcher(None, *rests).ratio() >= NEAR
            or any(difflib.get_close_matches(word, theirs, n=1, cutoff=WORD) for word in ours))


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
