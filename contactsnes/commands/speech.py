"""What the commands say, on standard output and standard error."""

import re
import signal
import sys


def told(*lines):
    """Print what a command is for: exit status 1 where that cannot be written."""
    print(*lines, sep="\n", end="\n" if lines else "", flush=True)
    return int(bool(sys.stdout.failure))


def complain(kind, text):
    """A sentence on standard error: one line, whatever names it holds."""
    sys.stdout.flush()
    line = re.sub(r"[\x00-\x1f\x7f]", lambda match: ascii(match.group())[1:-1], str(text))
    print(f"contactsnes: {kind}: {line}", file=sys.stderr, flush=True)


def interrupted(interrupt, more=""):
    """Say which signal a KeyboardInterrupt is about, and more; the exit status."""
    number = signal.Signals(interrupt.args[0] if interrupt.args else signal.SIGINT)
    complain("error", f"interrupted by {number.name}{more}")
    return 128 + number
