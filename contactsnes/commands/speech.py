"""What the commands say, on standard output and standard error."""

import re
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
