"""Files and disks that fail: without a crash, and in words."""

import contextlib
import faulthandler
import hashlib
import io
import os
import re
import resource
import select
import signal

from .streams import Waiting, legible


class Lenient(io.FileIO):
    """A new file that keeps to itself what its disk does not take: HDF5 crashes when it closes what
    it could not write. So it does when it is interrupted while it calls Python: within a ``with``
    of this file, signals wait."""

    def __init__(self, path):
        super().__init__(path, "w+")
        self._failure, self._waiting = None, Waiting()

    def __enter__(self):
        self._waiting.__enter__()
        return super().__enter__()

    def __exit__(self, kind, error, traceback):
        try:
            super().__exit__(kind, error, traceback)
        finally:
            self._waiting.__exit__(kind, error, traceback)
        if isinstance(error, Exception):
            self.check()  # what HDF5 complains of is that it reads other bytes than it has written

    def write(self, data):
        """Write everything; after a failure, nothing."""
        data = memoryview(data).cast("B")
        done = 0
        while done < len(data) and not self._failure:
            try:
                done += super().write(data[done:])
            except OSError as error:
                self._failure = error
        return len(data)

    def truncate(self, size=None):
        """Change the length, unless writing has failed."""
        try:
            return size if self._failure else super().truncate(size)
        except OSError as error:
            self._failure = error
            return size

    def check(self):
        """Raise what has gone wrong."""
        if self._failure:
            raise self._failure


def reason(error):
    """Why a file cannot be used: the system's words, where HDF5 has put its own around them."""
    number = error.errno if isinstance(error, OSError) else None
    inner = re.search(r"error message = '([^']*)'", str(error))
    return inner[1] if inner else os.strerror(number) if number else str(error)


def ending(status):
    """How a process ended, from the status that ``subprocess`` tells; an empty text of success."""
    if status == -signal.SIGKILL:
        return "killed by SIGKILL: by somebody, or by a system that lacked memory"
    known = {number.value: number.name for number in signal.Signals}
    if status < 0:
        return f"killed by {known.get(-status, f'signal {-status}')}"
    if status - 128 in known:  # commands end so where a signal interrupts them
        return f"interrupted by {known[status - 128]}"
    return f"exit status {status}" if status else ""


def failure(read, patience=120.0, work=100):
    """Why a function that reads a file fails, in words; an empty text where it does not.

    It is tried in a child process, since damaged files crash HDF5 or keep it busy for ever. (What
    is compressed may be a thousand times as long as its file: that bounds no time.)

    Parameters
    ----------
    read : function without arguments
    patience : float, seconds that it may take
    work : int, seconds of the processor that it may take
    """
    if not hasattr(os, "fork"):
        return ""
    ours, theirs = os.pipe()
    child = os.fork()
    if not child:
        os.close(ours)
        _try(read, theirs, work)
    os.close(theirs)
    try:
        ready, _, _ = select.select([ours], [], [], patience)
        told = (b"".join(iter(lambda: os.read(ours, 65536), b"")).decode("utf-8", "replace")
                if ready else ENDLESS)
    finally:
        os.close(ours)
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    if not told:
        worked = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
        return ENDLESS if worked else "reading it crashes"
    return "" if told == _DONE else told


_DONE, ENDLESS = "done", "reading it does not end"


def _try(read, pipe, work):
    """In the child: read, tell how it went, and end."""
    told = "it takes too much memory"
    try:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)
        for limit, wanted in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_CPU, work)):
            most = resource.getrlimit(limit)[1]  # which nobody may raise
            resource.setrlimit(limit, (wanted if most == resource.RLIM_INFINITY
                                       else min(wanted, most), most))
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        faulthandler.disable()
        read()
        told = _DONE
    except MemoryError:
        pass
    except BaseException as error:
        told = f"{type(error).__name__}: {error}"
    finally:
        # nobody may wait any more: where the program was killed, this copy of it must not go on
        try:
            os.write(pipe, legible(told).encode("utf-8", "replace")[:4096])
        finally:
            os._exit(0)


def checksum(path):
    """A short text that files of other content do not have in common."""
    found = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            found.update(block)
    return found.hexdigest()[:16]
