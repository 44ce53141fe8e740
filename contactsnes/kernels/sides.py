"""Transforms of the even and the odd parts of fields, products of which are the library's."""

from ..grid import sides


class CompiledSides(sides.Sides):
    """As `grid.sides.Sides`; the library's products (folded.c) take fields as they are.

    Parameters
    ----------
    grid, shape, count, parities : as of `grid.sides.Sides`
    parts : `cosines.Cosines`, whose memory it is
    """

    def __init__(self, grid, shape, count, parities, parts):
        super().__init__(grid, shape, count, parities, parts=parts)
        self.library = parts.library

    @property
    def folded(self):
        """`cosines.Folded` of the fields."""
        return self.parts.sided(self.axis, single=False)

    @property
    def single(self):
        """The same in single precision."""
        return self.parts.sided(self.axis, single=True)

    @property
    def structure(self):
        """That of the library, of the fields."""
        return self.folded.structure
