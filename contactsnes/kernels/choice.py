"""Which transforms and laws a contact computes with: those of the library, or NumPy's."""

import math
import os
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple
from weakref import WeakValueDictionary

import numpy as np

from ..grid.alternation import alternation
from ..grid.contours import crossings
from ..grid.cosines import Cosines
from ..grid.counter import Counter
from ..grid.mirrors import without_mirror
from ..grid.sides import Sides, parts_of
from ..grid.splines import sources, spline
from ..grid.transfer import blurred
from . import library

LARGE = 2 ** 16
"""Numbers of a transform from which one is kept only while something holds it."""


def default_cache():
    """The folder for what is kept between runs, where none is named."""
    # (who has no folder has none here, either: not one called ~ in the working folder)
    base = os.environ.get("XDG_CACHE_HOME") or Path("/", os.path.expanduser("~"), ".cache")
    return Path(base) / "contactsnes"


def _arrays(even, shape, count):
    """(shape, type) of the two arrays that a transform works on; of even lines they are one."""
    from .lines import in_pairs

    if even:
        return ((count, *in_pairs(shape)), float), ((count, *shape[::-1]), float)
    return ((count, *shape), float), ((count, *shape[:-1], shape[-1] // 2 + 1), complex)


def _first_part(memory, arrays):
    """Arrays, (shape, type) each, on the first bytes of others; None where these are fewer, and in
    place of what has not been made."""
    sizes = [math.prod(shape) * np.dtype(kind).itemsize for shape, kind in arrays]
    if any(given is not None and size > given.nbytes for size, given in zip(sizes, memory)):
        return None
    return [None if given is None
            else given.reshape(-1).view(np.uint8)[:size].view(kind).reshape(shape)
            for size, given, (shape, kind) in zip(sizes, memory, arrays)]


class Interpreted:
    """NumPy's forms and SciPy's transforms, and why.

    Attributes
    ----------
    reason : why the library is left out, in words
    missed : whether nobody asked for that
    law_reason : None; of `Compiled`, why its last law is not compiled
    """

    compiled = False
    law_reason = None
    spline, sources, blurred = staticmethod(spline), staticmethod(sources), staticmethod(blurred)
    crossings, alternation = staticmethod(crossings), staticmethod(alternation)

    def __init__(self, reason, missed=False):
        self.reason, self.missed = reason, missed

    @staticmethod
    def real(grid, shape, count):
        """The grid's own transforms.

        Parameters
        ----------
        grid, shape, count : as of `grid.cell.Transform`
        """
        return grid.transform(grid, shape, count)

    @staticmethod
    def circle(grid, shape, count):
        """The grid's own transforms on a circle, or what makes them once its rows have places.

        Parameters
        ----------
        grid, shape, count : as of `grid.cell.Transform`
        """
        return (grid.circle or grid.transform)(grid, shape, count)

    @staticmethod
    def even(grid, shape, count, parities=None):
        """Cosine transforms, or what makes them once their rows have places.

        Parameters
        ----------
        grid, shape, count, parities : as of `grid.cosines.Cosines`
        """
        if grid.shared:
            return grid.even_circle(grid, shape, count, parities)
        if without_mirror(parities) is not None:
            return Sides(grid, shape, count, parities, Cosines)
        return Cosines(grid, shape, count, parities)

    def law(self, law):
        """The law as it is."""
        return law


class Cell(NamedTuple):
    """What a transform asks of a grid: the cell's points, and who counts."""

    shape: tuple
    counter: Counter


class Compiled:
    """The library's transforms, a few of which are kept for all that takes them in turn; large ones
    as long as something holds them.

    Parameters
    ----------
    cache : folder for what is kept between runs
    agreed : as of `chosen`
    """

    compiled, reason, missed = True, None, False

    def __init__(self, cache, agreed):
        from . import cosines, points, sides, slab_real, slab_sides, slabs, splines, transforms
        from .fftw import remember

        self._cache, self._agreed, self.law_reason, self._plain = cache, agreed, None, None
        self.spline, self.sources, self.blurred = splines.spline, splines.sources, slabs.blurred
        self.crossings, self.alternation = points.crossings, points.alternation
        remember(cache)
        self._kinds, self._slab = (transforms.Real, cosines.Cosines), slab_real.SlabReal
        self._slab_even = slab_sides.SlabEvenReal, slab_sides.sides
        self._sides = sides.CompiledSides
        self._kept = lru_cache(maxsize=24)(self._make)
        self._held = WeakValueDictionary()

    def _make(self, even, cell, shape, count, *parities, memory=None):
        return self._kinds[even](cell, shape, count, *parities, memory=memory)

    def _large(self, *key):
        """A transform that is held, or a new one: on the memory of a held one of its kind that has
        as much, and is not at work then."""
        if key not in self._held:
            even, _, shape, count, *_ = key
            held = [made for (kind, *_), made in [*self._held.items()] if kind == even]
            arrays = _arrays(even, shape, count)
            memory = (_first_part((made.room, vars(made).get("spectrum")), arrays)
                      for made in held)
            made = self._make(*key, memory=next(filter(None, memory), None))
            self._held[key] = made
            return made
        return self._held[key]

    def real(self, grid, shape, count):
        """A transform as `grid.cell.Transform`, whose memory others use between two calls.

        Parameters
        ----------
        grid, shape, count : as of that
        """
        if grid.shared:
            return self._slab(grid, shape, count)
        return self._charged(False, grid, shape, count)

    def circle(self, grid, shape, count):
        """The same on a circle, or what makes it once its rows have places.

        Parameters
        ----------
        grid, shape, count : as of `grid.cell.Transform`
        """
        if grid.shared:
            return grid.circle(grid, shape, count, self._slab)
        return self._charged(False, grid, shape, count)

    def even(self, grid, shape, count, parities=None):
        """A transform as `grid.cosines.Cosines`, whose memory others use between two calls.

        Parameters
        ----------
        grid, shape, count, parities : as of that
        """
        if grid.shared:
            return grid.even_circle(grid, shape, count, parities, *self._slab_even)
        axis = without_mirror(parities)
        if axis is not None:
            parts = self._charged(True, grid, shape, 2 * count, parts_of(parities, axis))
            return self._sides(grid, shape, count, parities, parts)
        return self._charged(True, grid, shape, count, parities)

    def _charged(self, even, grid, shape, count, *parities):
        find = self._kept if count * math.prod(shape) < LARGE else self._large
        made = find(even, Cell(grid.shape, grid.counter), tuple(shape), count, *parities)
        made.charge()
        return made

    def law(self, law):
        """The law evaluated in C; as it is where it cannot be, here or in another process."""
        from .laws import kernel_of, with_kernel

        if law is self._plain or kernel_of(law) is not None:
            return law
        try:
            made, reason = with_kernel(law, self._cache), None
        except library.Unavailable as error:
            made, reason = law, str(error)
        self.law_reason = self._agreed(reason)
        if self.law_reason:
            made = self._plain = law
        return made


def chosen(wanted=True, cache=None, agreed=lambda reason: reason):
    """What contacts compute with.

    Parameters
    ----------
    wanted : bool, whether the library is, where there is one
    cache : folder for what is kept between runs; None: the user's own
    agreed : function of why this process has to do without C, or None; returns why all that share
        out a plane have to, since C and NumPy ask each other for different things
    """
    reason = agreed(library.reason()) if wanted else "-contact_kernels is off"
    if reason:
        return Interpreted(reason, missed=wanted and not library.switched_off())
    return Compiled(Path(cache or default_cache()), agreed)
