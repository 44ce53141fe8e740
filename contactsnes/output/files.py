"""Files of archives: which of them can be made, opened and read, and what is said where they
cannot."""

import os
import time
from contextlib import suppress
from pathlib import Path

from ..options.arguments import a_path
from ..options.fields import InputError, nearest
from ..system.devices import failure, reason

FORMAT = "contactsnes 1"
WRITTEN = "name one that contactsnes run has written"
PATIENCE = 1.0
"""Seconds to wait for another program that is just reading or writing the file."""

HDF5 = b"\x89HDF\r\n\x1a\n"
"""How files of HDF5 begin."""

FIELDS = (".vtkhdf", ".hdf")
"""Endings of those that are made of archives."""

SAFE = {"libver": "earliest", "alignment_threshold": 3000, "alignment_interval": 4096}
"""How HDF5 writes: the oldest format has no mark of being open that a kill would leave behind, and
a kill may cut what is written between pages, over which no node of an index (3136 bytes) reaches.
"""


class ArchiveError(ValueError):
    """An archive that cannot be written, read or continued; the message is one sentence for the
    user."""


class WriteError(ArchiveError):
    """An archive that its disk does not take."""


def shared(path):
    """The error to raise where two programs write one archive."""
    return ArchiveError(f"{path} has been changed by another program, which may still be running: "
                        "wait for its end, or name another -archive_file.")


def opened(path, mode):
    """Open an HDF5 file; wait a moment for other programs. Chunks pass by the cache: a row writes
    itself only."""
    from ..system.hdf5 import h5py  # runs without an archive need not import it

    patience = time.monotonic() + PATIENCE
    while True:
        try:
            return h5py.File(path, mode, rdcc_nbytes=0, **SAFE)
        except OSError as error:
            if "unable to lock" not in str(error) or time.monotonic() > patience:
                raise
        time.sleep(0.01)


def open_archive(path):
    """Open an archive for reading; raise if there is none."""
    if resolved(path).exists() and not resolved(path).is_file():
        raise ArchiveError(f"{path} is a folder or a device, no archive; {WRITTEN}")
    if not resolved(path).is_file():
        beside = {other.stem: other for other in resolved(path).parent.glob("*.h5")
                  if other.is_file()}
        guess = beside.get(nearest(resolved(path).stem, beside, cutoff=0.6))
        raise ArchiveError(f"{path}: there is no such file; " + (
            f"did you mean {guess.name}?" if guess else WRITTEN))
    try:
        file = opened(path, "r")
    except OSError as error:
        if "unable to lock" in str(error):
            raise ArchiveError(f"{path} cannot be locked: another program is "
                               "writing it, or its file system knows no "
                               "locks (then set the environment's "
                               "HDF5_USE_FILE_LOCKING=FALSE).") from error
        raise ArchiveError(f"{path} cannot be read as an HDF5 file: {reason(error)}; {WRITTEN}"
                           ) from error
    found = file.attrs.get("format")
    if found != FORMAT:
        file.close()
        raise ArchiveError(
            f"{path} is an archive of another version of this program (format {found!r}, and here "
            f"{FORMAT!r}): read it with that one, or run its options again."
            if str(found).startswith(FORMAT.split()[0])
            else f"{path} is an HDF5 file, but no archive of this program (attribute format = "
            f"{FORMAT!r}).")
    return file


def safely(path, take):
    """What a function takes from the archive at a path; ArchiveError where it is damaged, tried in
    another process before."""
    def taken():
        with open_archive(path) as file:
            return take(file)

    why = failure(taken)
    if why.startswith("ArchiveError: "):
        raise ArchiveError(why.removeprefix("ArchiveError: "))
    try:
        if not why:
            return taken()
    except (ArithmeticError, LookupError, OSError, RuntimeError, TypeError, AttributeError,
            UnicodeError) as error:
        why = f"{type(error).__name__}: {error}"
    raise ArchiveError(f"{path} is damaged ({why}): what it holds cannot be read.")


def checked(path, take):
    """Raise ArchiveError where a function cannot take what it wants from the archive at a path:
    tried in another process."""
    def taken():
        with open_archive(path) as file:
            take(file)

    why = failure(taken)
    if why:
        raise ArchiveError(why.removeprefix("ArchiveError: ") if why.startswith("ArchiveError: ")
                           else f"{path} is damaged ({why}): what it holds cannot be read.")


def resolved(path):
    """The file behind a path, since a rename would replace a symbolic link instead of it;
    ArchiveError for what names none."""
    try:
        found = Path(path).resolve()
        with suppress(FileNotFoundError, NotADirectoryError):
            found.stat()  # Python 3.13 resolves a loop of links to itself
    # too long, a loop of links, letters that no file system knows
    except (OSError, RuntimeError, ValueError) as error:
        raise ArchiveError(f"the archive is '{path}', which cannot be the name of a file: "
                           f"{reason(error)}.") from None
    return found


def wanting(folder):
    """What is to be done about a path that is no folder, in words that go on with "or"."""
    return "is a file: move it away" if folder.exists() else "does not exist: create it"


def check_output(path):
    """InputError if no file can be made at a path that -output names."""
    if path.is_dir():
        raise InputError(f"-output is '{path}', a folder: name a file")
    if not path.parent.is_dir():
        raise InputError(f"-output is '{path}', whose folder {wanting(path.parent)}, or name "
                         "another")


def is_archive(target, paths):
    """Whether a file to write is there as one of some archives, or as another."""
    try:
        if not target.is_file():  # a pipe would wait for a writer
            return False
        with target.open("rb") as file:
            begins = file.read(len(HDF5))
        return begins == HDF5 and (target.suffix not in FIELDS
                                   or any(target.samefile(path) for path in paths))
    except (OSError, ValueError):  # what cannot be read is told where it is to be written
        return False


def target_beside(path, ending):
    """The file beside an archive that is made of it where -output names none; InputError where an
    archive lies there, which may have any name."""
    target = Path(path).with_suffix(ending)
    if is_archive(target, [path]):
        raise InputError(f"what is made of {path} would replace {target}, an archive: name another "
                         "file by -output")
    return target


def refuse_shared(paths, folder, what, instead):
    """InputError where what is made of one archive would replace that of another.

    Parameters
    ----------
    paths : of archives
    folder : where all of it is written, or an empty text: beside each archive
    what : str, what is made, in the plural
    instead : str, what to do
    """
    found = {}
    for path in (Path(a_path("the archive", path, "the path of one")).absolute() for path in paths):
        other = found.setdefault(Path(folder or path.parent, path.stem), path)
        if other != path:
            raise InputError(f"{path} would have {what} of the names that those of {other} have: "
                             f"{instead}")


def check_ending(path, what, endings):
    """InputError where the ending of a path that -output names is that of another kind of file.

    Parameters
    ----------
    path : path of the file; one without an ending may hold anything
    what : str, what is in the file, as the error calls it
    endings : tuple of str, those of such files, in lower case
    """
    if path.suffix and path.suffix.lower() not in endings:
        raise InputError(f"-output is '{path}': the name of {what} ends in "
                         f"{' or '.join(endings)}")


def check_folder(path):
    """Raise if no file can be made beside `path`."""
    if not path.parent.is_dir():
        raise ArchiveError(f"The folder of the archive {path} {wanting(path.parent)} or name "
                           "another -archive_file.")
    if not os.access(path.parent, os.W_OK):
        raise ArchiveError(
            f"The folder of the archive {path} cannot be written: name another -archive_file.")


def check_unprotected(path):
    """Raise for a file that is protected against being written: in a folder that is not, another
    one would take its place."""
    if path.exists() and not os.access(path, os.W_OK):
        raise ArchiveError(f"{path} is protected against being written: take that away (chmod u+w "
                           "does where it is yours), or name another -archive_file.")


def check_new(path, overwrite):
    """Raise if no archive can be made at `path`, or only in place of what is not to be replaced."""
    check_folder(path)
    if not path.exists():
        return
    if not path.is_file():
        raise ArchiveError(f"{path} is a folder or a device; name another -archive_file.")
    if not overwrite:
        raise ArchiveError(f"{path} exists: -archive_resume goes on from "
                           "it, -archive_overwrite replaces it, another "
                           "-archive_file leaves it alone.")
    check_unprotected(path)
    open_archive(path).close()  # what is no archive is not ours to destroy
