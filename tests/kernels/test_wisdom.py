"""What FFTW learned about plans, kept between runs."""

import os
from pathlib import Path

import numpy as np
import pytest

from contactsnes.kernels import fftw

CALLS = fftw._calls


class Library:
    """FFTW with some functions in the place of its own; the others stay, for plans of earlier tests
    that end meanwhile."""

    def __init__(self, **functions):
        vars(self).update(functions)

    def __getattr__(self, name):
        return getattr(CALLS(), name)


@pytest.mark.parametrize("whole", (False, True))
def test_it_is_kept_whole_or_not_at_all(whole, tmp_path, monkeypatch):
    """A write that fails, as on a full disk, leaves nothing behind."""
    def export(name):
        """Write a file, and say whether that is all."""
        Path(os.fsdecode(name)).write_text("a part at least", encoding="utf-8")
        return int(whole)

    monkeypatch.setattr(fftw, "_calls", lambda: Library(fftw_export_wisdom_to_filename=export))
    monkeypatch.setattr(fftw, "_state", {"file": tmp_path / "kept", "taken": None, "made": 2,
                                        "read": 0})
    fftw._keep()
    assert [file.name for file in tmp_path.iterdir()] == ["kept"] * whole


def test_only_what_is_new_is_worth_a_write(monkeypatch):
    """Plans that FFTW knows how to make, from this run or earlier ones, are no reason for one."""
    monkeypatch.setattr(fftw, "_state", {"file": None, "taken": None, "made": 0, "read": 0})
    fftw._calls().fftw_forget_wisdom()  # an earlier run of this test may have been told
    row, waves = np.zeros(2018), np.zeros(1010, complex)
    made = []
    for single in (False, False, True):
        plans = fftw.Plans((2018,), 1, row.ctypes.data, waves.ctypes.data, single)
        made.append(fftw._state["made"])
        assert plans.to_half and plans.to_row
    assert made == [2, 2, 2]


def test_a_long_memory_is_begun_anew(tmp_path, monkeypatch):
    monkeypatch.setattr(fftw, "_state", {"file": None, "taken": None, "made": 0, "read": 0})
    monkeypatch.setattr(fftw.atexit, "register", lambda function: None)
    read = []
    monkeypatch.setattr(fftw, "_calls", lambda: Library(
        fftw_import_wisdom_from_filename=read.append))
    for name, size in (("short", fftw.MOST - 1), ("long", fftw.MOST)):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "fftw.wisdom").write_bytes(bytes(size))
        fftw.remember(folder)
    assert read == [os.fsencode(tmp_path / "short" / "fftw.wisdom")]


def test_what_others_learned_meanwhile_is_kept_too(tmp_path, monkeypatch):
    """A run takes a file in once, again where another one has written it: before it writes, too."""
    monkeypatch.setattr(fftw, "_state", {"file": None, "taken": None, "made": 0, "read": 0})
    monkeypatch.setattr(fftw.atexit, "register", lambda function: None)
    file, calls = tmp_path / "fftw.wisdom", []

    def export(name):
        calls.append("written")
        Path(os.fsdecode(name)).write_text("all", encoding="utf-8")
        return 1

    monkeypatch.setattr(fftw, "_calls", lambda: Library(
        fftw_import_wisdom_from_filename=lambda name: calls.append(file.read_text("utf-8")),
        fftw_export_wisdom_to_filename=export))
    fftw.remember(tmp_path)
    file.write_text("first", encoding="utf-8")
    for _ in range(2):
        fftw.remember(tmp_path)
    fftw._state["made"] += 2
    file.write_text("of another run", encoding="utf-8")
    fftw._keep()
    assert calls == ["first", "of another run", "written"]
    assert file.read_text("utf-8") == "all"
