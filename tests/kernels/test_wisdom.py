"""What FFTW learned about plans, kept between runs."""

import os
from pathlib import Path

import pytest

from contactsnes.kernels import fftw


@pytest.mark.parametrize("whole", (False, True))
def test_it_is_kept_whole_or_not_at_all(whole, tmp_path, monkeypatch):
    """A write that fails, as on a full disk, leaves nothing behind."""
    class Library:
        """FFTW that writes a file, and says whether that is all."""

        def fftw_export_wisdom_to_filename(self, name):
            """Write."""
            Path(os.fsdecode(name)).write_text("a part at least", encoding="utf-8")
            return int(whole)

    monkeypatch.setattr(fftw, "_calls", Library)
    monkeypatch.setattr(fftw, "_state", {"file": tmp_path / "kept", "made": 2, "read": 0})
    fftw._keep()
    assert [file.name for file in tmp_path.iterdir()] == ["kept"] * whole
