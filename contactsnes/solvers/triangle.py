"""The small least-squares problem of GMRES."""

import numpy as np


class Triangle:
    """The least-squares problem of a cycle: its Hessenberg matrix, turned to a triangle by Givens
    rotations.

    Parameters
    ----------
    size : float, norm of the residual that the cycle begins with
    most : int, iterations
    """

    def __init__(self, size, most):
        self.matrix = np.zeros((most + 1, most))
        self._turned, self._right = np.zeros((most + 1, most)), np.zeros(most + 1)
        self._right[0], self._turns, self.count = size, [], 0

    def add(self, column):
        """Take the next column; the norm of the residual that is left.

        Parameters
        ----------
        column : array, the products with the rows, and the norm of what they leave
        """
        place = self.count
        self.matrix[:place + 2, place] = column
        values = list(map(float, column))
        for k, (cosine, sine) in enumerate(self._turns):
            above, below = values[k], values[k + 1]
            values[k], values[k + 1] = cosine * above + sine * below, cosine * below - sine * above
        length = float(np.hypot(values[place], values[place + 1]))
        turn = ((values[place] / length, values[place + 1] / length) if length > 0.0
                else (0.0, 1.0))
        self._turns.append(turn)
        self._turned[:place + 1, place] = [*values[:place], length]
        right = self._right[place]
        self._right[place], self._right[place + 1] = turn[0] * right, -turn[1] * right
        self.count += 1
        return abs(float(self._right[self.count]))

    def factors(self):
        """The solution: the part of each row."""
        count = self.count
        triangle, found = self._turned[:count, :count], np.zeros(count)
        for k in range(count - 1, -1, -1):
            known = triangle[k, k + 1:] @ found[k + 1:]
            found[k] = (self._right[k] - known) / triangle[k, k] if triangle[k, k] else 0.0
        return found

    def ritz_values(self):
        """Eigenvalues of the square part of the matrix."""
        return np.linalg.eigvals(self.matrix[:self.count, :self.count])
