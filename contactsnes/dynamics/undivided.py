"""Vectors whose parts by symmetry are not told apart."""


class Undivided:
    """A vector without symmetries: it is its own part.

    Parameters
    ----------
    size : int, of vectors
    """

    def __init__(self, size):
        self.lengths = [size]

    def parts(self, vector):
        """The vector alone, a list."""
        return [vector]

    def whole(self, number, rows):
        """Vectors (..., size) of the part of a number: the rows themselves."""
        return rows
