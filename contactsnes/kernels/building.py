"""C that is compiled when it is first met, and kept in a folder by a checksum of all that it
depends on."""

import ctypes
import hashlib
import os
import platform
import shlex
import shutil
import subprocess
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from .library import Unavailable

FLAGS = ("-std=gnu99", "-O3", "-shared", "-fPIC", "-fno-math-errno", "-fno-trapping-math",
         "-ffp-contract=off")
"""No fast-math: it would change how the whole process treats small numbers."""

MARK = 'const char *built_from = "{}";\n'


@lru_cache(maxsize=1)
def compiler():
    """(command, version) of the C compiler, that of ``CC`` or the system's; Unavailable where there
    is none that runs."""
    named = os.environ.get("CC")
    command = shlex.split(named) if named else [
        found for found in map(shutil.which, ("cc", "gcc", "clang")) if found][:1]
    if not command:
        raise Unavailable("there is no C compiler (cc, gcc or clang)")
    try:
        done = subprocess.run([*command, "--version"], capture_output=True, text=True, timeout=60,
                              check=True)
    except (OSError, subprocess.SubprocessError) as error:
        raise Unavailable(f"the C compiler {shlex.join(command)} does not run ({error})") from error
    return command, done.stdout


def compiled(text, cache):
    """The library of a C source: the one that is kept, or a new one.

    Parameters
    ----------
    text : str
    cache : Path, the folder where libraries are kept

    Raises
    ------
    Unavailable : where there is no compiler, it fails, or the folder cannot be written
    """
    command, version = compiler()
    told = "\0".join((text, version, *command, *FLAGS, platform.machine(), platform.platform()))
    checksum = hashlib.sha256(told.encode()).hexdigest()[:32]
    file = Path(cache) / f"law-{checksum}.so"
    try:
        return _loaded(file, checksum)
    except (OSError, ValueError):
        # none, or one that was cut off or is another's: made anew in its place
        _build(command, text + MARK.format(checksum), file)
    try:
        return _loaded(file, checksum)
    except (OSError, ValueError) as error:
        raise Unavailable(f"{file} cannot be loaded ({error})") from error


def _seal(content):
    """What stands behind the content of a library in its file: a damaged one would end the process,
    or compute something else."""
    return b"\n" + hashlib.sha256(content).hexdigest().encode()


def _loaded(file, checksum):
    """The library of a file; ValueError unless it is this user's, whole, and made from what its
    name says."""
    if hasattr(os, "getuid") and file.stat().st_uid not in (os.getuid(), 0):
        raise ValueError("it belongs to another user")
    content = file.read_bytes()
    end = len(content) - len(_seal(b""))
    if content[end:] != _seal(content[:end]):
        raise ValueError("it is damaged")
    if checksum.encode() not in content:
        raise ValueError("it was made from something else")
    library = ctypes.CDLL(str(file))
    if ctypes.c_char_p.in_dll(library, "built_from").value != checksum.encode():
        raise ValueError("it was made from something else")
    return library


def _build(command, text, file):
    """Compile a source into a file, which appears whole or not at all, whoever builds it, too."""
    part = file.with_name(f"{file.name}.{os.getpid()}.part")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        done = subprocess.run([*command, *FLAGS, "-x", "c", "-", "-o", str(part), "-lm"],
                              input=text, capture_output=True, text=True, timeout=120)
        if done.returncode:
            raise Unavailable(f"the C compiler {shlex.join(command)} fails: "
                              f"{(done.stderr.strip() or 'without a word').splitlines()[-1]}")
        content = part.read_bytes()
        with part.open("ab") as end:
            end.write(_seal(content))
        os.replace(part, file)
    except (OSError, subprocess.SubprocessError) as error:
        raise Unavailable(f"{file} cannot be made ({error}); another folder: -contact_cache"
                          ) from error
    finally:
        with suppress(OSError):
            part.unlink()
