"""scripts/parallel: its model of large planes, and what it writes on its page."""

import importlib.machinery
import importlib.util
import sys
from pathlib import Path

import pytest

from contactsnes.branch.memory import memory_of_solve

PATH = Path(__file__).resolve().parents[2] / "scripts" / "parallel"


@pytest.fixture(scope="module")
def script():
    """The program as a module."""
    loader = importlib.machinery.SourceFileLoader("parallel_script", str(PATH))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    loader.exec_module(module)
    sys.dont_write_bytecode = before
    return module


def test_the_page_has_the_model_of_the_program(script):
    _, inside, _ = script.between(script.PAGE.read_text(encoding="utf-8"), "model")
    assert inside.split("\n")[1:-2] == script.model()


def test_memory_of_large_planes_is_that_of_a_solve(script):
    """`contactsnes info` estimates the same."""
    for points, machines in script.LARGE:
        row = script.modelled(points, machines)
        assert row["memory"] * 1e9 * machines == pytest.approx(memory_of_solve(points ** 2,
                                                                              points ** 2))


def test_exchanges_and_bytes_scale_as_those_of_slabs(script):
    one, four = (script.modelled(4096, machines) for machines in (1, 4))
    assert one["exchanges"] == 0.0
    assert one["transforms"] == pytest.approx(4 * four["transforms"])
    # Each of four machines sends three quarters of its quarter of a field, each transform.
    sent = four["exchanges"] * script.NETWORK / script.STEP["transforms"]
    assert sent == pytest.approx(0.75 * 8 * 4096 ** 2 / 4)
    larger = script.modelled(8192, 4)
    assert larger["step"] == pytest.approx(4 * four["step"])


def test_parts_of_the_page_are_replaced_alone(script, tmp_path, monkeypatch):
    page = tmp_path / "parallel.md"
    page.write_text("".join(f"{part}\n{begin}old\n{end}" for part, (begin, end)
                            in script.MARKS.items()) + "end\n")
    monkeypatch.setattr(script, "PAGE", page)
    script.write("model", ["new"])
    text = page.read_text()
    assert text.count("old") == 1 and "\nnew\n" in text and text.endswith("end\n")
    assert text.index("old") < text.index("new")
