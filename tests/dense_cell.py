"""The force balance of small cells as dense matrices, for tests of stability and bifurcations."""

from functools import cached_property

import numpy as np
from scipy import linalg

from contactsnes.contact.problem import DISPLACEMENT, FORCE


class Cell:
    """The balance M u' = -(K u + t) of a whole periodic cell as dense matrices, from the body's
    stiffness alone."""

    def __init__(self, contact, point):
        self.contact, self.controls = contact, point.controls
        self.count, self.n = len(point.controls), contact.grid.size
        self.unknown = contact.extended(point.state).reshape(self.count, -1)
        symbols = contact.operator(self.count, "stiffness").blocks
        self.stiffness = np.zeros((self.count, self.n, self.count, self.n))
        for (i, j), symbol in symbols.items():
            spectrum = np.fft.rfft(np.eye(self.n)).T * (symbol * self.n)[:, None]
            self.stiffness[i, :, j] = np.fft.irfft(spectrum, self.n, axis=0)
        self.mass, mean = self.stiffness.copy(), np.full((self.n, self.n), 1.0 / self.n)
        self.rigid = []
        for i, control in enumerate(self.controls):
            compliance = contact.rigid_compliance(self.count)[i]
            softest = np.min((symbols[i, i] * self.n)[1:])
            # the stiffness that belongs to the compliance of one component alone
            if (0, 1) in symbols:
                softest = 1.0 / np.max(contact.operator(self.count).blocks[i, i][1:] * self.n)
            if control == DISPLACEMENT and compliance == 0.0:
                self.rigid.append(i)
                continue
            self.stiffness[i, :, i] += mean * (0.0 if control == FORCE else 1.0 / compliance)
            self.mass[i, :, i] += mean * softest
        size = self.count * self.n
        self.stiffness, self.mass = self.stiffness.reshape(size,
                                                           size), self.mass.reshape(size, size)

    def traction(self, unknown):
        gap = unknown.reshape(self.count, -1).copy()
        gap[0] += self.contact.initial_gap.reshape(-1)
        return self.contact.law.traction(gap).reshape(-1)

    def tangent(self):
        gap, tangent = self.unknown.copy(), np.zeros((self.count, self.count, self.n))
        gap[0] += self.contact.initial_gap.reshape(-1)
        self.contact.law.evaluate(gap, np.empty_like(gap), tangent)
        return np.block([[np.diag(tangent[i, j]) for j in range(self.count)]
                         for i in range(self.count)])

    def within(self, matrix):
        """A matrix of displacements without means, where means cannot move: a reflection takes the
        mean to the first node, which is left out. (Products of matrices would take longer than
        their eigenvalues.)"""
        mirror = np.eye(1, self.n)[0] - self.n ** -0.5
        mirror /= np.linalg.norm(mirror)
        for i in self.rigid:
            part, matrix = slice(i * self.n, (i + 1) * self.n), matrix.copy()
            matrix[part] -= np.outer(2.0 * mirror, mirror @ matrix[part])
            matrix[:, part] -= np.outer(matrix[:, part] @ mirror, 2.0 * mirror)
        kept = np.delete(np.arange(len(matrix)), np.multiply(self.rigid, self.n).astype(int))
        return matrix[np.ix_(kept, kept)]

    def eigenvalues(self):
        """All of M^-1 (K + D), in the order of their real parts."""
        left, mass = self.within(self.stiffness + self.tangent()), self.within(self.mass)
        # A skew part counts by its square; this takes a tenth of the time.
        if np.allclose(left, left.T, rtol=0.0, atol=1e-7 * np.max(np.abs(left))):
            return linalg.eigvalsh(0.5 * (left + left.T), mass)
        values = linalg.eigvals(left, mass)
        return values[np.argsort(values.real)]

    def rate(self, unknown):
        """u' of overdamped motion, near the point."""
        change = unknown - self.unknown.reshape(-1)
        force = self.stiffness @ change + self.traction(unknown) - self.traction(self.unknown)
        return -self.mobility @ force

    @cached_property
    def basis(self):
        """Where means cannot move, displacements without them, as columns."""
        return linalg.block_diag(*[
            linalg.helmert(self.n).T if i in self.rigid else np.eye(self.n)
            for i in range(self.count)])

    @cached_property
    def mobility(self):
        """M^-1 where means can move, and of displacements without means elsewhere."""
        return self.basis @ np.linalg.inv(self.basis.T @ self.mass @ self.basis) @ self.basis.T
