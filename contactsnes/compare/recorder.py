"""A corrector whose solves leave a history."""

import time

import numpy as np

from ..branch.corrector import Corrector
from ..solvers.convergence import measured_apart


class History:
    """Transforms, seconds and residual norm at the iterations of solves: numbers appended to a
    list, which cost a method nothing.

    It knows of no SNES, for a SNES whose monitor knew it in turn would never be freed.
    """

    def __init__(self, counter):
        self.counter = counter
        self.restart()

    def restart(self):
        """Forget everything: time and transforms begin at zero."""
        self._rows, self._tested = [], set()
        self._before, self._began = self.counter.weighed, time.perf_counter()

    def rows(self):
        """Array (iterations, 3), oldest first."""
        rows = [row for row, solver, tested in self._rows if tested == (solver in self._tested)]
        return np.array(rows or np.empty((0, 3)), dtype=float)

    def watch(self, snes):
        """Record a SNES by a monitor and, where its test finds a norm that PETSc has not, by
        that."""
        snes.setMonitor(lambda snes, iteration, norm: self._add(snes, norm))
        form, test = snes.appctx, snes.getConvergenceTest()
        if test is None or not measured_apart(snes, form):
            return
        tests, arguments = test[:2]

        def recording(snes, iteration, norms):
            reason = tests(snes, iteration, norms, *arguments)
            self._tested.add(snes.handle)
            self._add(snes, form.last_norm, True)
            return reason

        snes.setConvergenceTest(recording)

    def _add(self, snes, norm, tested=False):
        row = (self.counter.weighed - self._before, time.perf_counter() - self._began, norm)
        self._rows.append((row, snes.handle, tested))


class Recorder(Corrector):
    """A corrector that keeps the history of its solves."""

    def __init__(self, contact, settings):
        super().__init__(contact, settings)
        self.history = History(contact.grid.counter)

    def run(self, form, unknown, most_iterations, snes=None):
        """As `Corrector.run`, the SNES watched."""
        snes = self.snes if snes is None else snes
        if snes.getAttr("recorded") is None:
            snes.setAttr("recorded", True)
            self.history.watch(snes)
        return super().run(form, unknown, most_iterations, snes)
