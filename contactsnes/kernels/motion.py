"""Damped motion of the force form in the library, on the memory of the Python motion that it is the
twin of."""

import ctypes

import numpy as np

from . import structures
from .forms import call
from .laws import kernel_of
from .structures import address
from .transforms import Compiled

ARRAYS = ("displacement", "velocity", "force", "acceleration", "gap", "mass", "mobility")
"""What is the same memory in a motion and in the structure."""


def twin(motion):
    """A CompiledMotion of a motion, or None where something in it is Python's alone."""
    law = kernel_of(motion.form.contact.law)
    if law is None or not isinstance(motion.waves.transform, Compiled):
        return None
    return CompiledMotion(motion, law)


class CompiledMotion:
    """Steps, energies and norm of a motion, on its memory.

    Parameters
    ----------
    motion : solvers.motion.Motion, complete but for what moves
    law : LawKernel

    Attributes
    ----------
    structure : of the library, with ``stiffening``, ``closest`` and ``within``
    """

    def __init__(self, motion, law):
        waves, form = motion.waves, motion.form
        self.library, self.counter = waves.transform.library, form.grid.counter
        own = self.structure = structures.Motion(
            components=form.components, nodes=motion.gap.shape[1],
            waves=motion.mass[0].size, wide=2 if np.iscomplexobj(motion.force) else 1,
            size=form.grid.size, range=form.contact.law.range, harmless=motion.harmless,
            reference=motion.reference, lightest=motion.lightest, stiffening=1.0)
        weights = getattr(waves.grid, "weights", None)
        self._kept, coupled = [law, waves, weights], False
        for name in ("stiffness", "compliance"):
            for (i, j), symbol in getattr(waves, name).items():
                symbol = np.ascontiguousarray(np.broadcast_to(symbol, motion.mass.shape[1:]))
                self._kept.append(symbol)
                getattr(own, name)[i][j] = address(symbol)
                own.is_complex[i][j] = np.iscomplexobj(symbol)
                coupled = coupled or i != j
        work = np.empty_like(motion.force[0]) if coupled else None
        given = {name: getattr(motion, name) for name in ARRAYS}
        for name, array in {**given, "initial_gap": waves.initial_gap, "node_weight": weights,
                            "weight": waves.weights, "work": work}.items():
            self._kept.append(array)
            setattr(own, name, address(array))
        for name, values in (("mean_stiffness", form.mean_stiffness), ("mobile", motion.mobile),
                             ("target", form.grid.size * motion.target)):
            getattr(own, name)[:form.components] = [float(value) for value in values]
        own.law = ctypes.pointer(law.structure)
        own.transform = ctypes.pointer(waves.transform.structure)
        self._reference, self._sums = ctypes.addressof(own), np.empty(3)
        self._found, self._factors, self._shape = address(self._sums), None, motion.mass.shape

    def evaluate(self):
        """Gap, force and acceleration at the displacement."""
        call(self.library.motion_evaluate, self.counter, self._reference)

    def advance(self, time_step, kept, impulse):
        """As `Motion.advance`.

        Parameters
        ----------
        time_step, kept, impulse : as of that
        """
        if np.ndim(kept) == np.ndim(impulse) == 0:
            factors = None, kept, None, impulse
        else:
            kept, impulse = self._over_waves(kept), self._over_waves(impulse)
            factors = address(kept), 0.0, address(impulse), 0.0
        call(self.library.motion_advance, self.counter, self._reference, time_step, *factors)

    def damped(self, time_step, damping, graded):
        """As `Motion.damped`.

        Parameters
        ----------
        time_step, damping, graded : as of that
        """
        if self._factors is None:
            self._factors = np.empty((2, *self._shape))
        call(self.library.motion_damped, self.counter, self._reference, time_step,
             0.5 * time_step * damping, address(graded), *map(address, self._factors))

    def move(self, time):
        """v += time v', without the force there."""
        self.library.motion_move(self._reference, time)

    def sums(self, before=None):
        """Power of F, or of its change from ``before``, with v', and the squares of velocity and of
        that: as `Motion.changes`."""
        self.library.motion_sums(self._reference, address(before), self._found)
        return self._sums.tolist()

    def squares(self):
        """Sum over the waves of the squares of C F."""
        return self.library.motion_squares(self._reference)

    def _over_waves(self, factor):
        """A factor as an array (components, *waves)."""
        if getattr(factor, "shape", None) == self._shape:
            return factor
        return np.ascontiguousarray(np.broadcast_to(factor, self._shape), dtype=float)
