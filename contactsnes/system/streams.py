"""Standard streams that may be closed, full or of few letters, and signals that end a command."""

import contextlib
import os
import re
import signal
import sys

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP")
                if hasattr(signal, name))
"""Signals that end a command with 128 + their number."""


def legible(text):
    """A text that any encoding of Unicode has letters for: bytes of names of files that are no text
    in this environment's encoding are, where they can be, those of UTF-8, else ``\\xfc``.

    Parameters
    ----------
    text : str
    """
    return re.sub("[\udc80-\udcff]+", lambda found: found[0].encode(
        "utf-8", "surrogateescape").decode("utf-8", "backslashreplace"), text)


class Stream:
    """A text stream that drops what its device does not take any more. Nothing is raised, since
    PETSc writes here, too.

    Attributes
    ----------
    failure : str, why nothing is written any more, or an empty text
    left : bool, whether nobody reads on
    """

    def __init__(self, stream):
        self.failure, self.left = "" if stream else "it is closed", False
        self._stream = stream or open(os.devnull, "w", encoding="utf-8")
        if hasattr(self._stream, "reconfigure"):
            self._stream.reconfigure(errors="backslashreplace")  # letters that the encoding lacks

    def write(self, text):
        """Write, or drop what cannot be written."""
        self._tried(self._stream.write, legible(text))
        return len(text)

    def flush(self):
        """Write what waits, or drop it."""
        self._tried(self._stream.flush)

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def _tried(self, act, *arguments):
        try:
            act(*arguments)
        except OSError as error:
            self.failure, self.left = error.strerror, isinstance(error, BrokenPipeError)
            self._silence()

    def _silence(self):
        """Let nothing reach the device any more, not even the interpreter's last flush."""
        with contextlib.suppress(OSError, ValueError):  # a stream without a number
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, self._stream.fileno())
            os.close(null)


@contextlib.contextmanager
def standard_streams():
    """Within it, sys.stdout and sys.stderr are `Stream`; no file that is opened gets the number of
    a closed one."""
    with contextlib.suppress(OSError):
        while (number := os.open(os.devnull, os.O_RDWR)) < 3:
            pass
        os.close(number)
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = map(Stream, before)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


class Waiting:
    """Within it, signals of `SIGNALS` wait, if it is Python that handles them."""

    def __init__(self):
        self._handlers, self._signals = {}, []

    def __enter__(self):
        with contextlib.suppress(ValueError):  # signals are the main thread's
            for number in filter(lambda number: callable(signal.getsignal(number)), SIGNALS):
                self._handlers[number] = signal.signal(number, self._wait)
        return self

    def _wait(self, number, frame):
        self._signals.append(number)

    def __exit__(self, *_):
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        for number in self._signals[:1]:
            self._handlers[number](number, None)


class Interrupts:
    """Within it, a signal of `SIGNALS` raises KeyboardInterrupt with its number; those that are
    ignored stay so.

    Attributes
    ----------
    number : of the last signal, 0 before: what PETSc's callbacks may have swallowed
    """

    def __init__(self):
        self.number, self._before, self._over = 0, {}, False

    def __enter__(self):
        # A shell's background job ignores SIGINT, one of nohup SIGHUP, and is to go on doing so.
        self._before = {number: handler for number in SIGNALS
                        if (handler := signal.getsignal(number)) != signal.SIG_IGN}
        try:
            for number in self._before:
                signal.signal(number, self._interrupt)
        except ValueError:  # signals are the main thread's
            self._before = {}
        except KeyboardInterrupt:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self._over = True
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _interrupt(self, number, frame):
        self.number = number
        if self._over:  # all handlers are to be put back
            return
        # Raised in a finaliser, it is printed and ignored; a run then ends with the next point.
        sys.unraisablehook = lambda unraisable: None
        raise KeyboardInterrupt(number)
