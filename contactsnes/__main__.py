"""``python -m contactsnes`` is the command ``contactsnes``."""

import gc
import os
import signal
import sys


def main():
    """Run the command; a signal before it has begun, or after its end, ends the program at once and
    without a word."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number and signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, lambda number, frame: os._exit(128 + number))
    # What is imported stays to the end: collections that look through it again and again would take
    # a fifth of the start. `session.settled` ends that.
    gc.disable()
    try:
        from .commands.cli import main as command
    except Exception as error:
        from .system.misfits import misfit

        if not (why := misfit(error)):
            raise
        sys.stderr.write(f"contactsnes: error: {why}\n")
        sys.exit(2)
    status = command()
    # Where an interrupt has left a text that Python executed, as those are of which it makes
    # dataclasses, `python -m` ends by SIGINT itself, not by the status; another text undoes that.
    exec("")
    sys.exit(status)


if __name__ == "__main__":
    main()
