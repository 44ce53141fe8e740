"""The processes of MPI that a command was started in: one, or several that share out one scene.

Of several, the first one speaks and writes files. All do the same in step; one that fails where the
others go on would leave them waiting for ever, so that whoever ends for a reason waits a moment for
the others to end, too, and else ends them.
"""

import math
import os
import signal
import sys
import time
from contextlib import suppress
from functools import cache
from importlib.util import find_spec

import numpy as np

LAUNCHED = (("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"), ("PMI_SIZE", "PMI_RANK"),
            ("SLURM_STEP_NUM_TASKS", "SLURM_PROCID"), ("MV2_COMM_WORLD_SIZE",
                                                       "MV2_COMM_WORLD_RANK"),
            ("PALS_SIZE", "PALS_RANKID"), ("ALPS_APP_PES", "ALPS_APP_PE"))
"""Variables in which launchers (mpirun, mpiexec, srun, aprun) tell each process how many there are,
and which it is."""

TOLD = ("OMPI_", "PMI", "SLURM_", "MV2_COMM_", "PALS_", "ALPS_")
"""How names of all their variables begin."""

OVERLOOKED = ("PETSC_OPTIONS", "PETSC_OPTIONS_YAML")
"""Variables from which PETSc takes options: those of the first process, for all."""

NEEDED = ("mpi4py",)
"""Packages without which no scene can be shared out."""

PATIENCE = 5.0
"""Seconds that a process which has failed waits for the others to fail as well."""

GRACE = 2.0
"""Seconds in which whoever ends all processes has spoken, and done so."""

SHORT = 0.3
"""The same as `PATIENCE` after an interrupt: the launcher kills all processes a second after it."""


def launched():
    """How many processes a launcher says that it has started, and which this one is; (1, 0) without
    one."""
    for names in LAUNCHED:
        size, rank = (_count(name) for name in names)
        if size > 1:
            return size, rank
    return 1, 0


def unlaunched():
    """The environment without what a launcher has told this process: for a program that this one
    starts, which would take itself for one of those that were launched."""
    return {name: value for name, value in os.environ.items() if not name.startswith(TOLD)}


def overlooked():
    """Options of this process's environment that PETSc asks the first one for: name -> value."""
    return {name: os.environ[name] for name in OVERLOOKED if os.environ.get(name)}


def difference(processes):
    """What the first of processes that is not as the first one has otherwise: (its number from 1,
    name, there, in the first); None where all are alike. One that has nothing of what is
    `overlooked` gets that of the first.

    Parameters
    ----------
    processes : of each, a mapping from names to values
    """
    first, *others = processes
    return next(((rank, name, other.get(name, "not given"), first.get(name, "not given"))
                 for rank, other in enumerate(others, start=2) for name in {**first, **other}
                 if first.get(name) != other.get(name)
                 and (name not in OVERLOOKED or name in other)), None)


def _count(name):
    """The number in a variable of the environment, 0 where there is none."""
    text = os.environ.get(name, "")
    return int(text) if text.isascii() and text.isdigit() else 0


def missing():
    """The packages of `NEEDED` that are not there."""
    return [name for name in NEEDED if find_spec(name) is None]


class Noted:
    """Standard error that remembers what was said; of any process but the first, it says nothing.

    Parameters
    ----------
    stream : text stream
    speaks : bool
    """

    def __init__(self, stream, speaks):
        self._stream, self._speaks, self.lines = stream, speaks, [""]

    def write(self, text):
        """Note, and write where this process speaks."""
        *ended, rest = (self.lines.pop() + text).split("\n")
        self.lines += [*ended, rest]
        return self._stream.write(text) if self._speaks else len(text)

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def errors(self):
        """The lines that are no warnings."""
        return [line for line in self.lines if line and ": warning: " not in line]


class World:
    """The processes of this command; one, until `join`.

    Attributes
    ----------
    size : int, how many
    rank : int, which one this is; 0 is the first
    neighbours : int, how many of them are on this machine
    """

    def __init__(self):
        self.size, self.rank, self.neighbours = 1, 0, 1
        self._world = self._talk = self._ends = self._last = self._said = None

    def join(self):
        """Be one of the processes that MPI knows of (mpi4py); all but the first fall silent."""
        import mpi4py

        mpi4py.rc.threads = False  # nothing here needs them, and some networks are slower with them
        from mpi4py import MPI

        self._world = MPI.COMM_WORLD
        self.size, self.rank = self._world.size, self._world.rank
        machine = self._world.Split_type(MPI.COMM_TYPE_SHARED)
        self.neighbours = machine.size
        machine.Free()
        # Their own: what somebody has left unfinished in another one is not in the way.
        self._talk, self._ends, self._last = (self._world.Dup() for _ in range(3))
        self._said = sys.stderr = Noted(sys.stderr, not self.rank)
        if self.rank:
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, 1)  # PETSc writes there as well
            os.close(null)

    def first(self, act):
        """What a function of no arguments returns or raises in the first process, in all of them;
        the others do not call it."""
        if self.size == 1:
            return act()
        result = error = None
        if not self.rank:
            try:
                result = act()
            except Exception as raised:
                error = raised
        result, error = self._talk.bcast((result, error))
        if error is not None:
            raise error
        return result

    def everywhere(self, value):
        """The values that all processes have, in their order: a list."""
        return [value] if self.size == 1 else self._talk.allgather(value)

    def meet(self, stage, status, patience=PATIENCE, speak=lambda: None):
        """Wait for all processes at the same stage of their end; end them all where some do not
        come in time.

        Parameters
        ----------
        stage : int
        status : int, exit status of this process; 0 waits for ever
        patience : float, seconds
        speak : function that says why this process has failed, before it ends all
        """
        if self.size == 1:
            return
        stages, until = np.empty(self.size, dtype="i8"), time.monotonic() + patience
        request = self._ends.Iallgather(np.array([stage], dtype="i8"), stages)
        try:
            while not request.Test():
                if status and time.monotonic() > until:
                    self._give_up(status, speak)
                time.sleep(0.002)
        except KeyboardInterrupt as interrupt:  # of the user, or where another process ends all
            self._give_up(status, speak, 128 + interrupt.args[0])
        if (stages != stage).any():
            self._give_up(status, speak)
        if status:  # of what was under way, some may have done more than others
            self._talk = self._last

    def _give_up(self, status, speak, silent=1):
        """End all processes, after words of the first of those that have failed: another one waits
        until it is ended.

        Parameters
        ----------
        status, speak : as of `meet`
        silent : int, exit status of one that has not failed
        """
        with suppress(KeyboardInterrupt):
            until = time.monotonic() + min(0.05 * self.rank, 0.5)
            while not (spoken := self._ends.Iprobe()) and time.monotonic() < until:
                time.sleep(0.002)
            if status and not spoken:
                for other in set(range(self.size)) - {self.rank}:
                    self._ends.Isend(np.zeros(1), other)  # which tells that one speaks
                speak()
                self._abort(status)
            time.sleep(GRACE)
        os._exit(status or silent)

    def _abort(self, status):
        """End all processes, after the last words of this one."""
        sys.stdout.flush()
        try:
            if self.rank:  # (names of files may have letters that its locale lacks)
                told = [f"{line} (process {self.rank + 1} of {self.size})\n"
                        for line in self._said.errors()]
                os.write(2, "".join(told).encode(errors="backslashreplace"))
            sys.stderr.flush()
        finally:
            _end_all(self._world, status)

    def over(self, status):
        """The exit status of all processes, when they have come to their end; the first one says
        what others have met with alone."""
        if self.size == 1:
            return status
        self.meet(2, status, SHORT if status > 128 else PATIENCE)
        ends = self._last.allgather((status, self._said.errors()))
        if not self.rank:
            sys.stderr.write("".join(
                f"{line} (process {rank} of {self.size})\n" for rank, line in _left(ends)))
            sys.stderr.flush()
        return max(status for status, _ in ends)


def _left(ends):
    """(number of a process, line) that the first process has not said, of the ends of all: (status,
    lines of errors) each. Of those that have failed the first one speaks."""
    failed = [rank for rank, (status, _) in enumerate(ends, start=1) if status]
    speak = failed[:1] or range(1, len(ends) + 1)
    return [(rank, line) for rank in speak for line in ends[rank - 1][1]
            if line not in ends[0][1]]


def _end_all(processes, status):
    """End all of some processes, at least this one.

    Parameters
    ----------
    processes : MPI's communicator
    status : int, exit status
    """
    if hasattr(signal, "alarm"):
        # where the launcher has been killed, Open MPI would wait for it for ever
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(math.ceil(2.0 * GRACE))
    processes.Abort(status)


@cache
def end_together():
    """From now on an exception that ends the program of one process ends those of all: the
    others would wait for it for ever. (What ends a command is told by its `World`.)"""
    before = sys.excepthook

    def ended(kind, error, traceback):
        before(kind, error, traceback)
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        if missing():
            return
        import mpi4py

        mpi4py.rc.initialize = False  # nobody waits where MPI has not begun
        from mpi4py import MPI

        if MPI.Is_initialized() and MPI.COMM_WORLD.size > 1:
            _end_all(MPI.COMM_WORLD, 1)

    sys.excepthook = ended


world = World()
"""Those of this program: MPI itself has one world."""
