"""Iterations of a cycle of GMRES by PETSc's operator and preconditioner."""

from .basis import Orthogonality, orthogonalised


class Iterations:
    """What a cycle does with vectors: `kernels.krylov.Iterations` in single precision throughout.

    Parameters
    ----------
    operator, pc : petsc4py Mat and PC
    begin : Vec, what the cycle begins with
    vectors : (Vec, Vec) to work in, the first of which may be that
    space, made : Basis, and the one of what the preconditioner made of its rows, or None
    """

    def __init__(self, operator, pc, begin, vectors, space, made):
        self._operator, self._pc = operator, pc
        self._vectors, self._bases = vectors, (space, made)
        self._orthogonality = Orthogonality(space.kind)
        if begin is not vectors[0]:
            begin.copy(vectors[0])

    def __call__(self, place, factor):
        """Take the vector times a factor as row number ``place``, and go on with what the rows
        leave of the product; its products with them, and last its length.

        Parameters
        ----------
        place : int
        factor : float
        """
        (vector, work), (space, made) = self._vectors, self._bases
        space.keep(place, vector.getArray(), factor)
        self._pc.apply(vector, work)
        if made:
            made.keep(place, work.getArray())
        self._operator.mult(work, vector)
        found = orthogonalised(space, place + 1, vector.getArray(), self._orthogonality.bound)
        self._orthogonality.after(found)
        return found

    def end(self, factors):
        """Fill the second vector with what is added to the solution.

        Parameters
        ----------
        factors : array, the part of each row
        """
        (vector, work), (space, made) = self._vectors, self._bases
        total = work if made else vector
        total.set(0.0)
        (made or space).add(factors, total.getArray())
        if made is None:
            self._pc.apply(vector, work)
