"""One-line faults planted in the sources, to see whether the tests find them.

Each is a line of the package changed as a slip of the pen would: a sign, a factor, a bound, a guard
left out or ten times looser. It is planted in a copy of the tree, and the tests named beside it run
there until one fails. A fault that no test finds shows what the tests do not see.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 600.0
"""Time after which the tests of a fault are stopped: a run without end counts as found."""


class Fault(NamedTuple):
    """A fault: what it is about, its file of the package, the text that stands there once, what
    takes its place, and the tests."""

    area: str
    file: str
    text: str
    fault: str
    tests: str


def read_faults(path=Path(__file__).with_suffix(".txt")):
    """The faults of a text file.

    A block for each, with a line of dashes after it: '@ file: tests', the text, a line '=>', and
    what takes its place. Tests are files without test_ and .py, or single ones as file::test_name.
    A line '# area' before a block tells what it and the next ones are about.
    """
    found, area = [], ""
    for block in path.read_text(encoding="utf-8").split("\n----\n"):
        head, _, body = block.strip("\n").partition("\n")
        if head.startswith("# "):
            area = head[2:]
            head, _, body = body.partition("\n")
        if head.startswith("@ "):
            file, _, tests = head[2:].partition(":")
            text, _, fault = body.partition("\n=>\n")
            found.append(Fault(area, file.strip(), text, fault.rstrip("\n"), tests.strip()))
    return found


def stale(faults):
    """Faults whose text does not stand in its file exactly once, with the number of places: a list
    of (fault, places)."""
    def content(file):
        return (ROOT / "contactsnes" / file).read_text(encoding="utf-8")

    return [(fault, count) for fault in faults
            if (count := len(_pattern(fault.text).findall(content(fault.file)))) != 1]


def _pattern(text):
    """What finds a text in a source however its words are spread over lines."""
    words = re.findall(r"\w+|[^\w\s]", text)
    return re.compile(r"\s*".join(map(re.escape, words)))


def arguments(fault):
    """The tests of a fault as pytest's arguments."""
    files = (name.partition("::") for name in fault.tests.split())
    return [f"tests/test_{file}.py{colons}{test}" for file, colons, test in files]


def plant(fault, folder):
    """Plant a fault in the copy of the tree in a folder."""
    path = Path(folder, "contactsnes", fault.file)
    content = path.read_text(encoding="utf-8")
    path.write_text(_pattern(fault.text).sub(lambda found: fault.fault.strip(), content, count=1),
                    encoding="utf-8")


def copied(folder):
    """Copy what tests need of the tree into a folder."""
    ignore = shutil.ignore_patterns("__pycache__", "*.png", ".pytest_cache")
    for name in ("contactsnes", "docs", "examples", "tests", "options", "scripts", "setup.cfg",
                 "README.md", "pyproject.toml"):
        source, target = ROOT / name, Path(folder, name)
        shutil.copytree(source, target, ignore=ignore) if source.is_dir() else shutil.copy(source,
                                                                                           target)


def tried(fault):
    """(what found a fault or '', seconds) of the fault planted in a copy of the tree of its own."""
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        copied(folder)
        plant(fault, folder)
        return _first_failure(fault, folder), time.perf_counter() - began


def _first_failure(fault, folder):
    """The test of a fault that fails first in a copy of the tree, 'time' where they do not end; ''
    where none fails."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1",
                   "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-p",
               "no:xdist", *arguments(fault)]
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True,
                              timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "time"
    if done.returncode == 0:
        return ""
    failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    if not failed:
        raise RuntimeError(f"pytest ended with status {done.returncode}: {done.stdout[-300:]}")
    return failed[0].split(" - ")[0].split(" ", 1)[1]
