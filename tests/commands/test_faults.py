"""What can go wrong around a run: outputs, signals, launchers, files and disks. One sentence each,
and nothing is lost."""

import dataclasses
import errno
import io
import math
import multiprocessing
import os
import pwd
import shlex
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from height_maps import read_heights
from processes import call

from contactsnes.branch import memory, too_large
from contactsnes.branch.branch import Branch
from contactsnes.commands import cli
from contactsnes.interface import seams
from contactsnes.kernels.choice import default_cache
from contactsnes.options import database as options
from contactsnes.options import files
from contactsnes.options.fields import InputError
from contactsnes.output.archive import Archive
from contactsnes.output.files import ArchiveError
from contactsnes.output.layout import Column
from contactsnes.output.reading import read
from contactsnes.scene import digits
from contactsnes.scene.load import Load
from contactsnes.scene.settings import OPTION_CLASSES, Form, Scene
from contactsnes.system import devices, processes, streams

ROOT = Path(__file__).resolve().parents[2]
ENVIRONMENT = {
    name: value
    for name, value in os.environ.items()
    if not name.startswith(("OMPI_", "PMI", "SLURM"))
} | {"PYTHONPATH": str(ROOT), "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
COMMAND = shlex.join([sys.executable, "-m", "contactsnes"])
STILL = ("-scene_points 128 -scene_period 20 -scene_normal_maugis 1 -load_start "
         "normal_displacement=-5 -load_path normal_displacement=hold")
"""One cheap point."""


def shell(line, folder, **environment):
    """A finished shell command, in which CONTACTSNES stands for the program and STILL for one cheap
    point."""
    line = line.replace("CONTACTSNES", COMMAND).replace("STILL", STILL)
    return subprocess.run(["bash", "-c", line], cwd=folder, env=ENVIRONMENT | environment,
                          capture_output=True, text=True, timeout=600, check=False)


def one_sentence(done, status, *words):
    """Assert a status, and one sentence on standard error with some words."""
    assert done.returncode == status, done.stdout + done.stderr
    assert (done.stderr.startswith("contactsnes: ")
            and len(done.stderr.splitlines()) == 1), done.stderr
    assert all(word in done.stderr for word in words), done.stderr


# Standard output


def test_readers_that_leave_early(tmp_path):
    for line in ("run -help", "run STILL -snes_monitor -archive_file run.h5"):
        done = shell(f"CONTACTSNES {line} | head -1; exit ${{PIPESTATUS[0]}}", tmp_path)
        # What fits into the pipe before its reader leaves is written without harm.
        assert done.returncode in (0, 128 + signal.SIGPIPE), (line, done.stderr)
        assert len(done.stderr.splitlines()) == done.stderr.count("nobody reads"), done.stderr


def test_closed_and_full_outputs_lose_no_points(tmp_path):
    for number, (target, status) in enumerate(((">&-", 0), ("<&- > /dev/full", 0),
                                               ("<&- >&- 2>&-", 0))):
        done = shell(f"CONTACTSNES run STILL -archive_file {number}.h5 {target}", tmp_path)
        assert done.returncode == status and "Traceback" not in done.stderr
        assert ("standard output cannot be written" in done.stderr) == ("2>" not in target)
        assert read(tmp_path / f"{number}.h5").complete
    one_sentence(shell("CONTACTSNES --help > /dev/full", tmp_path), 1, "No space left")


def test_letters_that_a_stream_lacks_are_written_in_others():
    device = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    stream = streams.Stream(device)
    stream.write("3 µm")
    stream.flush()
    assert device.buffer.getvalue() == b"3 \\xb5m"


@pytest.mark.parametrize("encoding, name, written", [
    ("ascii", b"f\xc3\xbcr \xfc", b"f\\xfcr \\xfc"), ("utf-8", b"f\xfcr", b"f\\xfcr"),
    ("utf-8", "f\u00fcr".encode(), "f\u00fcr".encode())])
def test_bytes_of_names_are_written_as_letters(encoding, name, written):
    """That are no text in this environment's encoding, and stand in texts by halves of letters."""
    device = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    stream = streams.Stream(device)
    stream.write(name.decode(encoding, "surrogateescape"))
    stream.flush()
    assert device.buffer.getvalue() == written


def test_an_unknown_backend_does_not_matter(tmp_path):
    assert shell("CONTACTSNES plot absent.h5", tmp_path,
                 MPLBACKEND="junk").stderr.endswith("absent.h5: there is no such file; name one "
                                                    "that contactsnes run has written\n")


# Several processes


def test_one_process_has_no_folder_of_open_mpi(tmp_path):
    """It would be one of all that run, which those that end take away from those that begin."""
    (tmp_path / "file").write_text("")
    done = shell("CONTACTSNES run STILL", tmp_path, TMPDIR=tmp_path / "file")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("size, rank", processes.LAUNCHED)
def test_several_processes_are_refused(monkeypatch, capsys, size, rank):
    monkeypatch.setenv(size, "2")
    monkeypatch.setenv(rank, "0")
    assert cli.main(["run", *STILL.split()]) == 2
    shown = capsys.readouterr().err
    assert "2 processes" in shown and len(shown.splitlines()) == 1
    monkeypatch.setenv(rank, "1")
    with pytest.raises(SystemExit) as stop:
        cli.main(["run", *STILL.split()])
    assert stop.value.code == 0 and not capsys.readouterr().err


def test_one_process_of_a_launcher_runs(tmp_path):
    variables = {name: "1" for name, _ in processes.LAUNCHED if not name.startswith("PMI")}
    assert shell("CONTACTSNES run STILL", tmp_path, **variables, SLURM_NTASKS="8",
                 SLURM_PROCID="0").returncode == 0


@pytest.mark.skipif(subprocess.run(["which", "mpirun"], capture_output=True,
                                   check=False).returncode != 0, reason="no mpirun here")
def test_mpirun(tmp_path):
    """A line is solved by one process, with mpi4py or without."""
    done = shell("mpirun --oversubscribe -n 2 CONTACTSNES run STILL -archive_file run.h5", tmp_path)
    assert done.returncode == 2 and done.stderr.count(
        "contactsnes: error: started as 2 processes") == 1
    assert not list(tmp_path.iterdir())


# Signals


def catches(process, number):
    """Whether a process has a handler for a signal."""
    status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
    return int(status.split("SigCgt:")[1].split()[0], 16) >> (number - 1) & 1


@pytest.fixture
def default_signals():
    """Signals with their usual handlers: those that a job in the background ignores, too."""
    before = {number: signal.signal(number, signal.SIG_DFL) for number in streams.SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("moment", [1, 2, 4, 5])
def test_a_signal_while_handlers_are_set_or_put_back_ends_a_command_with_its_number(
        moment, monkeypatch, default_signals):
    before, calls, set_handler = list(map(signal.getsignal, streams.SIGNALS)), [], signal.signal

    def watched(number, handler):
        """Sets a handler; the call of that moment is followed by a signal that has one."""
        found = set_handler(number, handler)
        calls.append(number)
        if len(calls) == moment:
            os.kill(os.getpid(), signal.SIGINT if moment < 3 else signal.SIGHUP)
        return found

    monkeypatch.setattr(streams.signal, "signal", watched)
    assert cli.main(["--version"]) == 128 + (signal.SIGINT if moment < 3 else signal.SIGHUP)
    assert list(map(signal.getsignal, streams.SIGNALS)) == before


def test_a_signal_waits_until_a_library_is_there(tmp_path):
    """HDF5 called an interpreter that had ended where h5py had not said what to undo."""
    (tmp_path / "h5py.py").write_text("""import os, signal
os.kill(os.getpid(), signal.SIGTERM)
for _ in range(1000):
    pass
whole = True
""")
    program = """import sys
from contactsnes.system.streams import Interrupts
with Interrupts():
    try:
        from contactsnes.system.hdf5 import h5py
    except KeyboardInterrupt as error:
        print(error, sys.modules["h5py"].whole)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True,
                          check=False, env={**ENVIRONMENT, "PYTHONPATH": os.pathsep.join(
                              [str(tmp_path), *sys.path])})
    assert done.stdout == f"{int(signal.SIGTERM)} True\n", done.stderr


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="nothing tells of handlers here")
def test_signals_at_any_moment_end_a_run_with_their_numbers(tmp_path):
    for number, wait in ((signal.SIGHUP, 0.0), (signal.SIGINT, 0.2), (signal.SIGTERM, 0.4),
                         (signal.SIGHUP, 1.0)):
        process = subprocess.Popen([*shlex.split(COMMAND), "run", *STILL.split(), "-load_path",
                                    "normal_displacement=40", "-continuation_largest_step", "0.01",
                                    "-archive_file", f"{wait}.h5"], cwd=tmp_path, env=ENVIRONMENT,
                                   text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   preexec_fn=lambda: [signal.signal(number, signal.SIG_DFL)
                                                       for number in streams.SIGNALS])
        while not catches(process, signal.SIGHUP):  # the interpreter's own beginning
            time.sleep(0.01)
        time.sleep(wait)
        process.send_signal(number)
        shown = process.communicate(timeout=600)[1]
        assert (process.returncode == 128 + number and "Traceback" not in shown
                and len(shown.splitlines()) <= 1), shown
        if (tmp_path / f"{wait}.h5").exists():
            read(tmp_path / f"{wait}.h5")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_before_the_first_point_is_told(number, monkeypatch, capsys, default_signals):
    """While a contact was set up it ended a run without a word."""
    monkeypatch.setattr("contactsnes.commands.run.create_branch",
                        lambda *_: os.kill(os.getpid(), number))
    assert cli.main(["run", *STILL.split()]) == 128 + number
    assert capsys.readouterr().err == f"contactsnes: error: interrupted by {number.name}\n"


def test_an_interrupt_in_a_text_that_is_executed_ends_with_its_number(tmp_path):
    """As Python executes texts to make dataclasses, of modules that are imported on the way."""
    (tmp_path / "program.py").write_text(
        "from contactsnes import __main__\nfrom contactsnes.commands import cli\n\n"
        "def interrupted():\n    try:\n        exec('raise KeyboardInterrupt')\n"
        "    except KeyboardInterrupt:\n        return 130\n\n"
        "cli.main = interrupted\n__main__.main()\n")
    done = subprocess.run([sys.executable, "-m", "program"], env=ENVIRONMENT, cwd=tmp_path,
                          capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (130, "")


CHANGED = "ValueError('numpy.dtype size changed, may indicate binary incompatibility.')"
NOT_THERE = "ImportError('numpy.core.multiarray failed to import (auto-generated)')"


@pytest.mark.parametrize("name, program, error", [
    (*package, error) if kind == other else pytest.param(*package, error, marks=pytest.mark.study)
    for kind, package in enumerate((("pyfftw", "raise {}"),
                                    ("petsc4py", "def init(arguments):\n    raise {}")))
    for other, error in enumerate((CHANGED, NOT_THERE))])
def test_a_package_that_was_compiled_for_another_numpy_is_told(name, program, error, tmp_path):
    """As it is imported with the program, and later; it ended in a traceback."""
    (tmp_path / f"{name}.py").write_text(program.format(error))
    done = shell("CONTACTSNES info STILL", tmp_path,
                 PYTHONPATH=os.pathsep.join([str(tmp_path), str(ROOT)]))
    one_sentence(done, 2, f"{name} was compiled for another NumPy than {np.__version__}",
                 error.split("'")[1])


# Files of options, names and folders


def test_a_user_without_a_folder_of_its_own_computes(tmp_path, monkeypatch):
    """As containers start programs: under a number that no list of users has."""
    def unknown(number):
        raise KeyError(number)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(pwd, "getpwuid", unknown)
    for name in ("HOME", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    assert default_cache().is_absolute()
    assert cli.main(["info", *STILL.split()]) == 0
    assert os.environ["HOME"] == "/"  # of Matplotlib, which does not start without one


def test_the_folder_of_another_user_is_passed_over(tmp_path, monkeypatch):
    """As PETSc does it; what is in the working folder is named."""
    def closed(path, **how):
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    (tmp_path / ".petscrc").write_text("-snes_max_it 9", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with monkeypatch.context() as change:
        change.setattr(Path, "read_text", closed)
        with pytest.raises(InputError, match="petscrc' cannot be read .Permission denied.: give"):
            files.refuse_circles("")
    (tmp_path / ".petscrc").unlink()
    monkeypatch.setenv("HOME", str(tmp_path / "closed"))
    monkeypatch.setattr(Path, "stat", closed)
    files.refuse_circles("")


def test_a_file_that_includes_itself_is_refused(tmp_path, monkeypatch):
    first, second = tmp_path / "first.opts", tmp_path / "second.opts"
    first.write_text(f"-a 1\n-options_file {second}\n-c 3\n")
    second.write_text("\ufeff-b 2\r\n", encoding="utf-8")
    assert options.petsc_arguments([str(first)])[1:] == ["-a", "1", "-b", "2", "-c", "3"]
    assert options.petsc_arguments(["-x", "-options_file", str(second), "-y"])[1:] == ["-x", "-b",
                                                                                       "2", "-y"]
    second.write_text(f"-Options_File {first}")
    (tmp_path / "third.opts").write_text(f"-options_file {first}")  # outside of the circle
    for arguments in ([str(first)], ["-options_file", str(second)], [str(tmp_path / "third.opts")]):
        with pytest.raises(InputError, match="includes itself"):
            options.petsc_arguments(arguments)
    (tmp_path / ".petscrc").write_text("-options_file .petscrc")
    monkeypatch.chdir(tmp_path)
    for text in (f"-a 1 -options_file {first}", ""):
        with pytest.raises(InputError, match="includes itself"):
            files.refuse_circles(text)


@pytest.mark.parametrize("file, words", [
    ("cylinder.opts", "'cylinder.opts', which PETSc looks for in the working folder alone: name .+ "
     "there, or give cylinder.opts to the command"),
    ("cylindr.opts", "'cylindr.opts' cannot be read .*: did you mean cylinder.opts")])
def test_files_that_petsc_does_not_find_are_told(file, words, tmp_path, monkeypatch):
    """PETSc told of its own functions; files that come with the package are the command line's."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=words):
        files.refuse_circles(f"-a 1 -options_file {file}")
    (tmp_path / file).write_text("-a 1\n")
    files.refuse_circles(f"-options_file {file} -options_file $HOME/absent.opts")


@pytest.mark.parametrize("arguments, words", [(["-options_file", "absent"], "absent"),
                                              (["-options_file"], "no value"),
                                              (["-options_file", "absent.yaml"], "absent.yaml"),
                                              (["-archive_file", "a\nb.h5"], "line break"),
                                              (["-archive_file", "\udcfc.h5"], "encoding"),
                                              (["-prefix_pop"], "-prefix_push")])
def test_arguments_that_petsc_cannot_take(arguments, words):
    with pytest.raises(InputError, match=words):
        options.petsc_arguments(arguments)


def test_names_that_no_file_can_have(tmp_path):
    loop, fifo = tmp_path / "loop.h5", tmp_path / "fifo.h5"
    loop.symlink_to(loop)
    os.mkfifo(fifo)
    for path in (loop, fifo, tmp_path, Path(os.devnull), tmp_path / ("a" * 300), Path("a\0b")):
        with pytest.raises(ArchiveError):
            read(path)
        for make in (Archive.create, Archive.resume):
            with pytest.raises(ArchiveError):
                make(path, scene={}, options="", versions={}, columns={},
                     **({"overwrite": True} if make == Archive.create else {}))


def test_a_folder_that_is_gone(tmp_path):
    done = shell("mkdir gone; cd gone; rmdir ../gone; CONTACTSNES run STILL", tmp_path)
    one_sentence(done, 2, "working folder")


GOING = """import os, shutil
from contactsnes.interface.laws.modified import Modified

class Going(Modified):
    def evaluate(self, gap, traction, tangent=None):
        if os.path.exists("run.h5.journal"):
            shutil.rmtree(os.getcwd())
        return super().evaluate(gap, traction, tangent)
"""


@pytest.mark.study
def test_a_folder_that_goes_during_a_run(tmp_path):
    """Nothing is said to be in an archive that is not there any more."""
    (tmp_path / "going.py").write_text(GOING)
    (tmp_path / "gone").mkdir()
    done = call("run", *STILL.split(), "-load_path", "normal_displacement=-4", "-scene_law",
                "../going.py:Going", "-archive_file", "run.h5", folder=tmp_path / "gone")
    assert done.returncode == 1 and not (tmp_path / "gone").exists(), done
    assert done.stderr.endswith("is not there any more: it was removed, or moved away\n"), done
    assert "Traceback" not in done.stderr and "  archive  " not in done.stdout


# Disks


def test_a_full_disk_ends_a_run_with_its_points(tmp_path):
    path = ("-load_path normal_displacement=-4 -continuation_largest_step 0.05 "
            "-archive_fields all -archive_file run.h5")
    done = shell(f"ulimit -f 260; CONTACTSNES run STILL {path} > /dev/null", tmp_path)
    one_sentence(done, 1, "cannot be written (File too large)", "-archive_resume goes on")
    points = read(tmp_path / "run.h5").points
    assert (points and f"{points} points are in" in done.stderr
            and set(os.listdir(tmp_path)) <= {"run.h5", "run.h5.journal"})
    done = call("run", *STILL.split(), *path.split(), "-archive_resume", folder=tmp_path)
    assert done.returncode == 0, done
    assert read(tmp_path / "run.h5").complete and os.listdir(tmp_path) == ["run.h5"]


def test_a_device_that_fails_does_not_reach_hdf5(tmp_path):
    with devices.Lenient(tmp_path / "x.h5") as device:
        device.write(b"kept")
        os.dup2(os.open(os.devnull, os.O_RDONLY), device.fileno())
        assert device.write(b"lost") == 4 and device.write(b"lost, too") == 9
        with pytest.raises(OSError):
            device.check()


def test_what_hdf5_cannot_read_back_is_told_by_its_cause(tmp_path):
    """A full disk, of which HDF5 says that something could not be inflated."""
    with pytest.raises(OSError, match="Bad file descriptor"):
        with devices.Lenient(tmp_path / "x.h5") as device:
            os.dup2(os.open(os.devnull, os.O_RDONLY), device.fileno())
            device.write(b"lost")
            raise OSError("inflate() failed")


def test_a_signal_waits_until_hdf5_has_closed_its_file(tmp_path):
    """Raised where HDF5 calls Python, it is not heeded, and the next call crashes."""
    closed = []
    with pytest.raises(KeyboardInterrupt), streams.Interrupts():
        with devices.Lenient(tmp_path / "x.h5") as device, h5py.File(device, "w") as file:
            os.kill(os.getpid(), signal.SIGTERM)
            file["x"] = np.arange(3.0)
            closed.append(file)
        closed.append("not reached")
    assert len(closed) == 1 and not closed[0].id.valid
    with h5py.File(tmp_path / "x.h5") as file:
        assert np.array_equal(file["x"], [0.0, 1.0, 2.0])


# Heights


def test_heights_that_cannot_be_used_are_refused_in_words(tmp_path):
    values = np.linspace(0.0, 1.0, 16)
    arrays = {"huge": values * 1.7e308, "odd": [1.0, -1e308] * 8, "empty": np.zeros(0),
              "complex": values * 1j, "point": np.array(1.0), "texts": np.array(["a"] * 16),
              "nan": values * np.nan, "cube": np.zeros((4, 2, 2))}
    for name, array in arrays.items():
        np.save(tmp_path / f"{name}.npy", array)
    np.savez(tmp_path / "many.npz", values)
    (tmp_path / "many.npz").rename(tmp_path / "many.npy")
    for name, content in (("words", b"one two"), ("blank", b""), ("ragged", b"1 2\n3"),
                          ("binary", bytes(range(256)))):
        (tmp_path / f"{name}.txt").write_bytes(content)
    for path in sorted(tmp_path.iterdir()):
        with pytest.raises(ValueError, match=path.name) as refusal:
            read_heights(path)
        assert (str(refusal.value).startswith("-scene_geometry_file")
                and len(str(refusal.value).splitlines()) <= 2)
    (tmp_path / "good.txt").write_bytes(b"\xef\xbb\xbf1\r\n2\r\n")
    assert read_heights(tmp_path / "good.txt").tolist() == [1.0, 2.0]


def test_heights_that_jump_at_the_seam_are_told(tmp_path):
    x, random = np.arange(64) / 64, np.random.default_rng(3)
    waves = sum(np.cos(2 * np.pi * (number * x + random.random())) / number
                for number in range(1, 20))
    assert seams.seams(waves) == [] and seams.seams(np.where(abs(x - 0.5) < 0.3, 1.0,
                                                                   0.0)) == []
    (axis, jump, typical), = seams.seams(waves[:, None] + (waves + 40 * x)[None])
    tilted = np.diff(waves + 40 * x)
    assert (axis == 1 and jump == pytest.approx(abs((waves + 40 * x)[0] - waves[-1] - 40 * x[-1]))
            and jump > 4 * typical)
    assert typical == pytest.approx(np.sqrt(np.mean(tilted ** 2)))
    np.save(tmp_path / "tilted.npy", 0.05 * x)
    scene = "-scene_geometry file -scene_geometry_file tilted.npy -scene_points 64"
    done = call("run", *STILL.split(), *scene.split(), "-archive_file", "run.h5", folder=tmp_path)
    words = ("along the line they step by 0.04922 u_n,r across the seam "
             "of the cell, 63 times the typical step between "
             "neighbours, 0.0007813")
    assert (words in done.stderr and done.stderr.startswith("contactsnes: warning")
            and words in read(tmp_path / "run.h5").warnings[0])


# Damaged archives


def test_damaged_archives_are_refused_or_read_right(tmp_path):
    """Flipped bits, cut ends and holes: whatever they hit, there is a sentence, or nothing that
    counts has changed."""
    columns = {"leg": Column("", "i8"), "normal_force": Column("w_n,r"),
               "event": Column("", "i1", ("none", "fold"))}
    whole = Archive.create(tmp_path / "run.h5",
                                   scene={"normal_maugis": 1.0, "law": "modified"}, options="-a 1",
                                   versions={}, columns=columns, fields="all",
                                   coordinates=(np.arange(16.0),), initial_gap=np.ones(16))
    for number in range(3):
        field = np.full((1, 16), float(number))
        whole.append({"leg": number, "normal_force": 2.5 * number, "event": "fold"}, {"load": 1.0},
                     field, -field)
    whole.settle()
    content = (tmp_path / "run.h5").read_bytes()
    good = read(tmp_path / "run.h5")
    random = np.random.default_rng(1)
    refused = 0
    for _ in range(15):
        bad, place = bytearray(content), random.integers(len(content))
        kind = random.integers(4)
        if kind == 0:
            bad = bad[:place]
        elif kind == 1:
            bad[place:place + 500] = bytes(len(bad[place:place + 500]))
        else:
            bad[place] ^= 1 << random.integers(8)
        (tmp_path / "bad.h5").write_bytes(bad)
        try:
            found = read(tmp_path / "bad.h5")
            assert found.points == 3 and all(np.array_equal(found[name], good[name])
                                             for name in good) and found.scene == good.scene
            assert np.array_equal(found.field("traction", 1), good.field("traction", 1))
        except ArchiveError as error:
            refused += 1
            assert "bad.h5" in str(error)
    assert 2 < refused < 15


def test_a_number_changed_anywhere_is_damage(tmp_path, read_here):
    """In any column, of any point, in what no point changes, and in fields, which are read for
    themselves."""
    columns = {name: Column("") for name in ("approach", "normal_force", "stable")}
    made = Archive.create(tmp_path / "run.h5", scene={}, options="", versions={},
                                  columns=columns, fields="all", coordinates=(np.arange(4.0),),
                                  initial_gap=np.ones(4))
    for value in (1.0, 2.0):
        made.append(dict.fromkeys(columns, value), {}, np.full((1, 4), value),
                    np.full((1, 4), -value))
    made.settle()
    names = [*(f"branch/{name}" for name in columns), "fields/x", "fields/initial_gap",
             "fields/displacement", "fields/traction", "runs/first"]
    assert read(tmp_path / "run.h5").field("displacement", 1).max() == 2.0
    for name, place in ((name, place) for name in names for place in ((0,) if name == "runs/first"
                                                                      else (0, 1))):
        bad = tmp_path / "bad.h5"
        bad.write_bytes((tmp_path / "run.h5").read_bytes())
        with h5py.File(bad, "r+") as file:
            file[name][place] = 7.0
        with pytest.raises(ArchiveError, match="is damaged"):
            read(bad).field(name[7:] if name in ("fields/displacement", "fields/traction")
                                    else "displacement", place)


def test_a_changed_number_is_damage(tmp_path, read_here):
    columns = {"normal_force": Column("w_n,r"),
               "event": Column("", "i1", ("none", "fold"))}
    for name, change in (("row",
                          lambda file: file["branch/normal_force"].write_direct(np.array([1.0]))),
                         ("frame", lambda file: file["scene"].attrs.modify("poisson", 0.25)),
                         ("unit", lambda file: file["branch/event"].attrs.modify("unit", "m")),
                         ("more points", lambda file: file.attrs.modify("points", 5))):
        path = tmp_path / f"{name}.h5"
        made = Archive.create(path, scene={"poisson": 0.5}, options="", versions={},
                                      columns=columns)
        made.append({"normal_force": 2.0, "event": "none"}, {})
        made.settle()
        read(path)
        with h5py.File(path, "r+") as file:
            change(file)
        for attempt in (read,
                        lambda path: Archive.resume(path, scene={"poisson": 0.5},
                                                            options="", versions={},
                                                            columns=columns)):
            with pytest.raises(ArchiveError, match="is damaged"):
                attempt(path)


def read_and_go_on(folder):
    """A program that may be killed while a file is tried: only itself goes on."""
    def slow():
        (folder / "begun").touch()
        while os.getppid() == parent:
            time.sleep(0.01)

    parent = os.getpid()
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # as Python has it, and PETSc has not
    try:
        devices.failure(slow)
    finally:
        (folder / "went on").touch()


def test_a_file_that_is_tried_for_a_program_that_is_killed_meanwhile_ends_there(tmp_path):
    run = multiprocessing.get_context("fork").Process(target=read_and_go_on, args=(tmp_path,))
    run.start()
    while not (tmp_path / "begun").exists():
        assert run.is_alive()
        time.sleep(0.01)
    run.kill()
    run.join()
    time.sleep(0.2)
    assert os.listdir(tmp_path) == ["begun"]


def test_what_crashes_or_does_not_end_is_told():
    assert devices.failure(lambda: None) == "" and devices.failure(
        lambda: 1 / 0) == "ZeroDivisionError: division by zero"
    assert devices.failure(lambda: os.kill(os.getpid(), signal.SIGSEGV)) == "reading it crashes"
    for endless, limit in ((lambda: time.sleep(60), {"patience": 0.1}),
                           (lambda: sum(iter(int, 1)), {"work": 1})):
        assert devices.failure(endless, **limit) == "reading it does not end"


# Numbers and grids that are too large


@pytest.mark.parametrize("scene, load, words", [(dict(points=2 ** 31), {}, "-scene_points is "
                                                 "'2147483648': the grid of "
                                                 "2.1474836e+09 nodes takes about"),
                                                (dict(points=(200000, 200000), dimension=2), {},
                                                 "200000 x 200000 nodes"),
                                                (dict(points=10 ** 18), {}, "1e+18 nodes"),
                                                (dict(period=math.inf, spacing=1e-9),
                                                 dict(path="normal_force=1"),
                                                 "-scene_spacing is '1e-09'"),
                                                (dict(period=math.inf, normal_maugis=1e3),
                                                 dict(path="normal_force=7e6"),
                                                 "-scene_spacing is not set"),
                                                (dict(geometry="rough", rough_slope=1.0,
                                                      rough_shortest=1e-9, points=2 ** 40,
                                                      period=10.0), {}, "-scene_points")])
def test_grids_beyond_memory_are_refused_before_they_are_made(scene, load, words):
    with pytest.raises(InputError) as refusal:
        Branch(Scene(**scene), Load(**{"path": "normal_displacement=1", **load}))
    assert words in str(refusal.value) and "would fit" in str(refusal.value)


def test_what_is_said_to_fit_does(monkeypatch, options):
    monkeypatch.setattr(too_large, "memory", lambda: 2e8)
    load, form = Load(path="normal_displacement=1"), Form()
    for scene in (Scene(points=2 ** 22), Scene(points=2 ** 11, dimension=2, geometry="sphere")):
        with pytest.raises(InputError, match="would fit") as refusal:
            too_large.refuse_too_large(scene, load, form)
        points = int(str(refusal.value).split("; ")[1].split()[0].split(",")[0])
        too_large.refuse_too_large(replace(scene, points=points), load, form)
        assert 100 * points ** scene.dimension > 2e7
    # a quarter of a sphere's plane is solved, of one that is sheared both ways all of it
    monkeypatch.setattr(too_large, "memory", lambda: 2.5e9)
    sphere = Scene(points=4096, dimension=2, geometry="sphere", normal_maugis=4.0, period=12.0)
    too_large.refuse_too_large(sphere, load, form)
    both = "normal_displacement=1; tangential_displacement_x=1, tangential_displacement_y=1"
    for refused in ((load, Form(symmetry="off")), (Load(path=both), form)):
        with pytest.raises(InputError, match="would fit"):
            too_large.refuse_too_large(sphere, *refused)
    # a method that takes more is believed to
    cell, rough = 1024 ** 2, Scene(points=1024, dimension=2, geometry="rough", rough_slope=1.0,
                             rough_shortest=1.0)
    monkeypatch.setattr(too_large, "memory", lambda: 8 * 70.0 * cell)
    too_large.refuse_too_large(rough, load, Form(window="off"))
    options(ksp_type="fgmres")
    with pytest.raises(InputError, match="would fit"):
        too_large.refuse_too_large(rough, load, Form(window="off"))
    monkeypatch.setattr(too_large, "memory", lambda: 1e15)
    too_large.refuse_too_large(Scene(points=2 ** 31), load, Form())
    with pytest.raises(InputError, match="PETSc counts 2147483647"):
        too_large.refuse_too_large(Scene(points=2 ** 31), load, Form(form="force"))


def test_memory_is_what_limits_leave(monkeypatch):
    assert 0 < memory.memory() <= 0.8 * os.sysconf("SC_PAGE_SIZE") * os.sysconf(
        "SC_PHYS_PAGES")
    monkeypatch.setattr(memory, "_group_limits", lambda: [5e8])
    assert memory.memory() == 4e8


def test_numbers_beyond_computing_are_refused_with_the_option():
    """Every number that an option takes, at sizes whose powers overflow or vanish."""
    for cls in (*OPTION_CLASSES, *cli.solver_options()):
        for field in dataclasses.fields(cls):
            if field.metadata["kind"] == "number" and field.metadata["choices"] is None:
                for value in (1e300, -1e300, 5e-324, math.nan, -math.inf):
                    with pytest.raises(InputError, match=f"-{cls.prefix}{field.name} is "):
                        cls(**{field.name: value})
    for value in ("1e300", "-1e31", "1e-300", "nan", "inf"):
        with pytest.raises(InputError, match="-load_path has no number"):
            Load(path=f"normal_force={value}").legs(1)


@pytest.mark.parametrize("scene, load, words", [
    ({"gap_offset": 1e16}, {}, "-scene_gap_offset is '1e+16': allowed is a size up to 4.5e+08"),
    ({"normal_maugis": 1e20}, {}, "-scene_normal_maugis is '1e+20': allowed is at most 4.5e+09"),
    ({"tangential_maugis": 1e20}, {"path": "tangential_force=1"}, "-scene_tangential_maugis is"),
    ({}, {"path": "normal_force=1; normal_displacement=1e29"},
     "-load_path has normal_displacement=1e+29: allowed is a size up to 4.5e+08"),
    ({}, {"start": "normal_displacement=-1e29"}, "-load_start has normal_displacement=-1e+29"),
    ({}, {"path": "normal_displacement=-1e10"}, "-load_path has normal_displacement=-1"),
    ({}, {"path": "tangential_displacement=1e29"}, "-load_path has tangential_displacement"),
    # mean(g0) is L^2/24, and D compresses a compressible layer, too
    ({"period": 12.0, "normal_maugis": 3.0}, {"path": "normal_displacement=1e5"},
     "-load_path has normal_displacement=100000: allowed is at most 16 u_n,r"),
    ({"period": 12.0, "geometry": "flat"}, {"start": "normal_displacement=3.1"},
     "-load_start has normal_displacement=3.1: allowed is at most 3 u_n,r"),
    ({"geometry": "flat", "poisson": 0.3}, {"path": "normal_displacement=1e18"}, "allowed"),
    ({}, {"path": "normal_force=1e29"}, "-load_path has normal_force=1e+29: allowed is at most"),
    # pi a^2/4 and 4 a^3/3, with a^2/2 of 4.5e9 ranges
    ({"period": np.inf, "points": None}, {"path": "normal_force=7.2e8"}, "at most 7.1e+08 w_n,r"),
    ({"period": np.inf, "points": None}, {"path": "normal_force=1e30"}, "at most 7.1e+08 w_n,r"),
    ({"period": np.inf, "points": None, "dimension": 2, "geometry": "sphere", "normal_maugis": 1.0},
     {"start": "normal_force=1.2e15", "path": "normal_force=1"}, "at most 1.1e+15 R phi_n"),
    ({"dimension": 2, "geometry": "sphere", "points": 32},
     {"path": "tangential_displacement_y=1e20"}, "-load_path has tangential_displacement_y=")])
def test_numbers_that_rounding_leaves_no_range_of_are_refused(scene, load, words):
    with pytest.raises(InputError) as refusal:
        Branch(Scene(**scene), Load(**{"path": "normal_displacement=1", **load}))
    sentence = str(refusal.value)
    assert words in sentence and "allowed" in sentence and "; try " in sentence


def test_numbers_that_rounding_leaves_no_range_of_are_told_in_the_units_of_the_scene():
    si = {"units": "si", "work_of_adhesion_normal": 0.03, "work_of_adhesion_tangential": 0.03,
          "contact_modulus": 2e6, "radius": 0.01, "range_normal": 1e-7, "range_tangential": 1e-6}
    for changes, path, words in (({"range_normal": 1e-25}, "normal_force=1", "the normal range of"),
                                 ({}, "normal_displacement=1e9", r"up to 4\.5e\+02 m")):
        with pytest.raises(InputError, match=words):
            Branch(Scene.typed(**{**si, **changes}), Load(path=path))


def test_an_isolated_contact_bears_what_its_law_bears_below_the_apex(tmp_path):
    """Hertz: pi p^2 for a largest pressure p, lambda_n 2 e^2; on a sphere 4/3 (pi p/2)^3. A coating
    takes some of it."""
    (tmp_path / "shallow.py").write_text(
        "from contactsnes.interface.laws.modified import Modified\n\n\n"
        "class Shallow(Modified):\n    deepest = -2.0\n")
    given = {"period": np.inf, "normal_maugis": 3.0, "law": f"{tmp_path / 'shallow.py'}:Shallow"}
    pressure = 3.0 * 2.0 * math.exp(2.0)
    for shape, most in (({}, math.pi * pressure ** 2),
                        ({"dimension": 2, "geometry": "sphere"},
                         4.0 / 3.0 * (math.pi * pressure / 2.0) ** 3)):
        scene = Scene(**given, **shape)
        digits.check(scene, Load(path=f"normal_force={0.99 * most}"), False)
        with pytest.raises(InputError, match="what the law bears at a gap of -2 ranges; try"):
            digits.check(scene, Load(path=f"normal_force={1.01 * most}"), False)
        coated = Scene(**given, **shape, body="coated", coating_normal=0.1)
        digits.check(coated, Load(path=f"normal_force={1.01 * most}"), False)


def test_what_no_unknown_feels_and_what_is_large_but_known_is_computed_with():
    scene = Scene(points=128, period=40.0, normal_maugis=2.0, gap_offset=1e6,
                  tangential_maugis=1e20)
    for point in Branch(scene, Load(path="normal_displacement=-1e6")):
        assert point.forces[0] == 0.0


def test_an_exponent_is_no_unit():
    with pytest.raises(InputError) as refusal:
        Scene(height=1e300)
    assert "unit" not in str(refusal.value)
    with pytest.raises(InputError, match="typed without its unit"):
        Scene(height="2e3nm")


def test_files_are_read_under_limits_that_nobody_may_raise():
    program = ("import resource; resource.setrlimit(resource.RLIMIT_CPU, (50, 50)); "
               "from contactsnes.system import devices; "
               "print(repr(devices.failure(lambda: None)))")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.strip() == "''", done.stderr
