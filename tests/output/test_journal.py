"""The journal of an archive: whole entries only, of its archive only."""

import io

import numpy as np
import pytest

from contactsnes.output import journal, stored
from contactsnes.output.files import ArchiveError

KEY = "0123456789abcdef"


def arrays(point):
    return {"force": np.float64(point), "event": np.array("fold"), "leg": np.int8(2),
            "field": np.arange(6.0).reshape(2, 3) * point, "none": np.zeros((0, 4))}


def written(path, points):
    found = journal.Journal(path, KEY)
    for point in points:
        found.append(point, arrays(point))
    return found


def same(found, wanted):
    return set(found) == set(wanted) and all(
        np.array_equal(found[name], wanted[name]) and found[name].dtype == wanted[name].dtype
        for name in wanted)


def test_entries_are_what_was_written(tmp_path):
    path = journal.beside(tmp_path / "run.h5")
    written(path, range(4, 7))
    assert path.name == "run.h5.journal"
    for first in (4, 5, 6):
        found = journal.entries(path, KEY, first)
        assert len(found) == 7 - first
        assert all(same(entry, arrays(first + i)) for i, entry in enumerate(found))
    assert journal.entries(path, KEY, 7) == journal.entries(path, KEY, 2) == []


def test_a_journal_of_another_archive_has_no_entries(tmp_path):
    path = tmp_path / "run.h5.journal"
    assert journal.entries(path, KEY, 1) == []
    written(path, [1])
    assert journal.entries(path, KEY[::-1], 1) == [] and len(journal.entries(path, KEY, 1)) == 1


def test_what_is_torn_or_damaged_is_no_entry_nor_what_comes_after_it(tmp_path):
    path = tmp_path / "run.h5.journal"
    written(path, [1, 2, 3])
    content = path.read_bytes()
    size = (len(content) - len(f"{journal.HEADING}{KEY}\n")) // 3
    for kept in range(len(content) - size, len(content)):
        path.write_bytes(content[:kept])
        assert len(journal.entries(path, KEY, 1)) == 2
    for place in range(len(content) - 2 * size, len(content) - size, 7):
        damaged = bytearray(content)
        damaged[place] ^= 4
        path.write_bytes(damaged)
        assert len(journal.entries(path, KEY, 1)) == 1


def test_a_removed_journal_begins_anew(tmp_path):
    path = tmp_path / "run.h5.journal"
    found = written(path, [1, 2])
    assert found.size == path.stat().st_size
    found.remove()
    assert not path.exists() and found.size == 0
    found.append(3, arrays(3))
    assert len(journal.entries(path, KEY, 3)) == 1


def test_a_journal_that_a_disk_did_not_take_begins_with_its_heading(tmp_path, monkeypatch):
    made, write = journal.Journal(tmp_path / "run.h5.journal", KEY), journal.os.write

    def full(file, data):
        if data[20:]:
            return write(file, data[:20])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(journal.os, "write", full)
    with pytest.raises(OSError):
        made.append(1, arrays(1))
    monkeypatch.setattr(journal.os, "write", write)
    made.append(1, arrays(1))
    assert same(journal.entries(made.path, KEY, 1)[0], arrays(1))


def test_objects_are_refused(tmp_path):
    with pytest.raises(ArchiveError, match="'bad' is neither"):
        journal.encoded(1, {"bad": np.array([object()])})


def test_states_are_what_was_packed():
    """In an archive: by itself, and by older programs; one that was changed since is refused."""
    packed = stored.pack(7, arrays(7))
    assert packed.dtype == "u1" and list(packed[:16].view("<i8")) == [7, packed.size]
    older = io.BytesIO()
    np.savez(older, **arrays(7))
    zipped = np.concatenate([packed[:16], np.frombuffer(older.getvalue(), "u1")])
    for found in (stored.unpack(packed), stored.unpack(zipped)):
        assert found["event"] == "fold" and found["leg"] == 2 and found["force"] == 7.0
        assert same({name: np.asarray(found[name]) for name in ("field", "none")},
                    {name: arrays(7)[name] for name in ("field", "none")})
    for place in (16, 24, 40, packed.size - 1):
        wrong = packed.copy()
        wrong[place] ^= 1
        if place == 16:  # (the number of the point, which stands before them, too)
            assert stored.unpack(wrong)["leg"] == 2
            continue
        with pytest.raises(ArchiveError, match="checksum"):
            stored.unpack(wrong)
    with pytest.raises(ArchiveError, match="checksum"):
        stored.unpack(packed[:40])
    with pytest.raises(ArchiveError, match="neither an array"):
        stored.pack(1, {"state": object()})
