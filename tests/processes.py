"""The command in processes of its own, for tests of any room."""

import atexit
import os
import subprocess
import sys
from pathlib import Path

from forks import Forks

ROOT = Path(__file__).resolve().parents[1]
COMMAND = [sys.executable, "-m", "contactsnes"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}
SECONDS = 600.0
_FORKS = Forks({name: value for name, value in ENVIRONMENT.items() if name != "MPLBACKEND"})
atexit.register(_FORKS.end)


def call(*arguments, folder, env=None):
    """A finished process of the command: a fork where the system has cheap ones and the environment
    is the usual one."""
    words = [str(argument) for argument in arguments]
    if env is None and sys.platform == "linux":
        return _FORKS.call(words, folder, SECONDS)
    return subprocess.run([*COMMAND, *words], cwd=folder, env=env or ENVIRONMENT,
                          capture_output=True, text=True, timeout=SECONDS, check=False)


def refused(done, *words):
    """Assert that bad input was answered by one sentence with these words."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stderr.startswith("contactsnes: error: ") and len(done.stderr.splitlines()) == 1
    assert all(word in done.stderr for word in words), done.stderr
