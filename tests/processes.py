"""The command in processes of its own, for tests of any room."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COMMAND = [sys.executable, "-m", "contactsnes"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}


def call(*arguments, folder, env=ENVIRONMENT):
    """A finished process of the command."""
    return subprocess.run([*COMMAND, *map(str, arguments)], cwd=folder, env=env,
                          capture_output=True, text=True, timeout=600, check=False)


def refused(done, *words):
    """Assert that bad input was answered by one sentence with these words."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stderr.startswith("contactsnes: error: ") and len(done.stderr.splitlines()) == 1
    assert all(word in done.stderr for word in words), done.stderr
