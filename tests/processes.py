"""The command in processes of its own, for tests of any room."""

import atexit
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from programs import load

ROOT = Path(__file__).resolve().parents[1]
COMMAND = [sys.executable, "-m", "contactsnes"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}
SECONDS = 600.0
MODULES = ("commands.showing", "branch.advice", "branch.costs", "output.figures")
"""What some commands import besides, here or later."""

_starter = load(ROOT / "scripts" / "paper" / "starter.py")
_STARTER = _starter.Starter(
    {name: value for name, value in ENVIRONMENT.items() if name != "MPLBACKEND"},
    (*_starter.MODULES, *(f"contactsnes.{name}" for name in MODULES)))
atexit.register(_STARTER.end)


def call(*arguments, folder, env=None):
    """A finished process of the command: a fork of one that has imported what commands import,
    where the system has cheap ones and the environment is the usual one."""
    return run(*COMMAND[1:], *arguments, folder=folder, env=env)


def run(*arguments, folder, env=None):
    """As `call`, of Python with some arguments: a program's path and its own."""
    words = list(map(str, arguments))
    if env is not None or sys.platform != "linux":
        return subprocess.run([sys.executable, *words], cwd=folder, env=env or ENVIRONMENT,
                              capture_output=True, text=True, timeout=SECONDS, check=False)
    with tempfile.TemporaryDirectory() as apart:
        texts = [Path(apart) / name for name in ("said", "complaints")]
        status, _ = _STARTER.run(words, *texts, folder, SECONDS)
        return subprocess.CompletedProcess(words, status, *(text.read_text() for text in texts))


def refused(done, *words):
    """Assert that bad input was answered by one sentence with these words."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stderr.startswith("contactsnes: error: ") and len(done.stderr.splitlines()) == 1
    assert all(word in done.stderr for word in words), done.stderr
