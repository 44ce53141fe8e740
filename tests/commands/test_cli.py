"""The commands in processes of their own, as a user meets them: exit statuses, sentences, files."""

import dataclasses
import fcntl
import os
import pty
import signal
import struct
import subprocess
import sys
import termios
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from processes import COMMAND, ENVIRONMENT, call, refused, run

from contactsnes.commands import cli
from contactsnes.continuation.points import NotConverged, new_points, unfinished_fold
from contactsnes.output import reading
from contactsnes.scene.settings import OPTION_CLASSES

SMALL = ["-scene_points", "512", "-scene_period", "40", "-scene_normal_maugis", "3"]
PRESSED = [*SMALL, "-load_path", "normal_displacement=1"]
# one cheap point
STILL = [*SMALL, "-load_start", "normal_displacement=-3", "-load_path", "normal_displacement=-3"]
SHEARED = [*SMALL, "-scene_residual_friction", "0.5", "-scene_height", "250",
           "-load_path", "normal_force=2; tangential_displacement=90"]
"""A path whose shear reaches a fold, beyond which the contact slides."""


SIGNALLED = """
import os, runpy, sys
from contactsnes.output.archive import Archive

append, number, points = Archive.append, int(sys.argv[1]), int(sys.argv[2])

def signalled(archive, *values, **fields):
    append(archive, *values, **fields)
    if archive.points == points:
        os.kill(os.getpid(), number)

Archive.append = signalled
sys.argv[1:] = sys.argv[3:]
runpy.run_module("contactsnes", run_name="__main__", alter_sys=True)
"""


def signalled(number, *arguments, folder, points):
    """A finished process of the command that gets a signal when it has archived some points."""
    (folder / "signalled.py").write_text(SIGNALLED, encoding="utf-8")
    return run(folder / "signalled.py", int(number), points, *arguments, folder=folder)


def ends(path):
    """Leg -> row at its end, without what it cost."""
    record = reading.read(path)
    last = {int(leg): place for place, leg in enumerate(record["leg"])}
    costs = ("iterations", "evaluations", "transforms", "time", "residual_norm", "event",
             "fold_kind", "jump_balance")
    return {leg: {name: record[name][place] for name in record if not name.endswith(costs)}
            for leg, place in last.items()}


def assert_same_ends(path, other):
    """Assert that two archives have the same end of each leg to 1e-7 of each number, or of the unit
    where that is smaller."""
    first, second = ends(path), ends(other)
    assert first.keys() == second.keys()
    for leg, row in first.items():
        np.testing.assert_allclose(list(row.values()), list(second[leg].values()), rtol=1e-7,
                                   atol=1e-7)


# The command word


def test_help_and_version(capsys):
    for word in ("--help", "-h"):
        assert cli.main([word]) == 0
        shown = capsys.readouterr().out
        assert all(f"contactsnes {command}" in shown for command in cli.COMMANDS)
    assert cli.main(["--version"]) == 0 and capsys.readouterr().out.startswith("contactsnes ")


def test_no_command_shows_the_help(tmp_path):
    done = call(folder=tmp_path)
    assert done.returncode == 2 and "contactsnes run" in done.stderr and not done.stdout


@pytest.mark.parametrize("word, guess", [("rum", "did you mean run"), ("Plot", "plot"),
                                         ("scene.opts", "commands are run, plot")])
def test_wrong_command_names_the_nearest(capsys, word, guess):
    assert cli.main([word]) == 2
    shown = capsys.readouterr().err
    assert word in shown and guess in shown


# Bad input


BAD = {"misspelt option": (["-scene_poison", "0.3"],
                           ["-scene_poison", "did you mean -scene_poisson"]),
       "misspelt option of a solver": (["-pc_core_treshold", "0.2"],
                                       ["-pc_core_treshold", "-pc_core_threshold"]),
       "two dashes": (["--scene_poisson", "0.3"], ["--scene_poisson", "one"]),
       "Poisson ratio": (["-scene_poisson", "0.6"], ["-scene_poisson", "0.6", "at most 0.5"]),
       "Maugis parameter": (["-scene_normal_maugis", "-2"], ["-scene_normal_maugis", "-2",
                                                             "above 0"]),
       "odd points": (["-scene_points", "513"], ["-scene_points", "513", "even"]),
       "tiny points": (["-scene_points", "8"], ["-scene_points", "8", "at least 16"]),
       "points in words": (["-scene_points", "many"], ["-scene_points", "many", "number"]),
       "small period": (["-scene_period", "2"], ["-scene_period", "cylinder", "smallest period"]),
       "no load path": (["-load_path", "  "], ["-load_path"]),
       "unknown quantity": (["-load_path", "normal_fore=2"],
                            ["-load_path", "normal_fore", "did you mean normal_force"]),
       "no number": (["-load_path", "normal_force=two"], ["-load_path", "normal_force=two",
                                                          "number"]),
       "a number of Python's": (["-load_path", "normal_force=1_0"],
                                ["-load_path", "normal_force=1_0", "number"]),
       "other digits": (["-load_path", "normal_force=\u0661"], ["-load_path", "number"]),
       "points of Python's": (["-scene_points", "1_024"],
                              ["-scene_points", "1_024", "even number"]),
       "empty leg": (["-load_path", "normal_force=2;"], ["-load_path", "empty leg"]),
       "shear without tangential unknowns": (["-scene_tangential", "off", "-load_path",
                                              "tangential_force=1"],
                                             ["-scene_tangential", "tangential_force=1", "auto"]),
       "value of a solver's option": (["-pc_core_threshold", "3"],
                                      ["-pc_core_threshold", "below 1"]),
       "unknown type": (["-pc_type", "lou"], ["-pc_type", "lou", "did you mean lu"]),
       "unknown method": (["-npc_snes_type", "newtonl"], ["-npc_snes_type", "newtonls"]),
       "long method": (["-snes_type", 300 * "a"], ["-snes_type", "PETSc has not"]),
       "no method at all": (["-ksp_type", "xyz"], ["-ksp_type", "'xyz'", "leave it out"]),
       "a type without a name": (["-snes_type"], ["-snes_type has no value"]),
       "a method as a type": (["-snes_type", "fire"], ["-snes_type is 'fire'", "file fire.opts"]),
       "unknown class": (["-snes_type", "python", "-snes_python_type",
                          "contactsnes.solvers.snes.Vorlet"], ["contactsnes.solvers.snes.Vorlet"]),
       "a class that is not named": (["-snes_type", "python"], ["needs -snes_python_type: "]),
       "a class of ksp that is not named": (["-ksp_type", "python"], ["needs -ksp_python_type: "]),
       "unknown module": (["-snes_type", "python", "-snes_python_type", "nowhere.Solver"],
                          ["nowhere"]), "no factorisation": (["-pc_type", "lu"], ["PETSc", "LU"]),
       "no parts of a solver": (["-pc_type", "composite"], ["PETSc", "-pc_type is 'composite'"]),
       "a file that PETSc opens as it starts": (["-history", "absent/told"], ["-history is '"]),
       "no such file": (["absent.opts"], ["absent.opts"]),
       "an archive as options": (["cell.h5"], ["cell.h5", "archives are for contactsnes plot"]),
       "blanks without quotes": (["-load_path", "normal_force", "=", "1"], ["'='", "blanks in"]),
       "no such heights": (["-scene_geometry", "file", "-scene_geometry_file", "absent.npy"],
                           ["absent.npy"]),
       "heights of another shape": (["-scene_geometry", "file", "-scene_geometry_file",
                                     "short.npy"], ["short.npy", "shape"]),
       "heights with a hole": (["-scene_geometry", "file", "-scene_geometry_file", "hole.npy"],
                               ["hole.npy", "finite"]),
       "archive in no folder": (["-archive_file", "absent/run.h5"], ["absent", "-archive_file"]),
       "archive below a file": (["-archive_file", "short.npy/run.h5"],
                                ["short.npy", "-archive_file"]),}


@pytest.mark.parametrize("arguments, words", BAD.values(), ids=BAD)
def test_bad_input_is_one_sentence(tmp_path, arguments, words):
    np.save(tmp_path / "short.npy", np.zeros(16))
    (tmp_path / "cell.h5").write_bytes(b"\x89HDF\r\n\x1a\n\0\xff")
    np.save(tmp_path / "hole.npy", np.where(np.arange(512) == 7, np.nan, 0.0))
    refused(call("run", *PRESSED, "-archive_file", "run.h5", *arguments, folder=tmp_path), *words)
    assert not (tmp_path / "run.h5").exists()


def test_run_without_load_path(tmp_path):
    refused(call("run", *SMALL, folder=tmp_path), "-load_path is empty")


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    """Folder with the archive run.h5 of a path that was followed to its end, and the process that
    made it."""
    folder = tmp_path_factory.mktemp("pressed")
    done = call("run", *PRESSED, "-archive_file", "run.h5", "-archive_fields", "all", folder=folder)
    return folder, done


def test_archive_that_is_in_the_way(pressed):
    folder, _ = pressed
    other = [*SMALL, "-scene_poisson", "0.4", "-load_path", "normal_displacement=1",
             "-archive_file", "run.h5"]
    refused(call("run", *PRESSED, "-archive_file", "run.h5", folder=folder), "run.h5 exists",
            "-archive_overwrite")
    refused(call("run", *other, "-archive_fields", "all", "-archive_resume", folder=folder),
            "poisson", "0.4", "0.5")


def test_bad_input_leaves_an_archive_that_was_to_be_replaced(tmp_path):
    """Found by PETSc as it begins to solve, when the archive is open."""
    call("run", *STILL, "-archive_file", "run.h5", folder=tmp_path)
    before = (tmp_path / "run.h5").read_bytes()
    refused(call("run", *STILL, "-archive_file", "run.h5", "-archive_overwrite", "-pc_type", "lu",
                 folder=tmp_path), "PETSc", "LU")
    assert (tmp_path / "run.h5").read_bytes() == before


# Runs


def test_run_to_the_end(pressed):
    folder, done = pressed
    record = reading.read(folder / "run.h5")
    assert done.returncode == 0 and not done.stderr
    assert (record.complete and record["normal_displacement"][[0, -1]].tolist() == [0, 1]
            and record.warnings == [])
    assert record.field_points == list(range(record.points))
    assert f"points        {record.points}" in done.stdout and "run.h5" in done.stdout
    assert "no tangential unknowns" in done.stdout and "window has" in done.stdout
    lines = [line.split() for line in done.stdout.splitlines() if line.strip()[:1] in "01"
             and "." in line]
    np.testing.assert_allclose([float(line[2]) for line in lines], record["normal_force"],
                               rtol=1e-5)
    assert "-scene_points 512" in record.options and set(record.versions) == {
        "contactsnes", "petsc", "petsc4py", "numpy", "pyfftw", "h5py", "python"}


def test_complete_archive_is_left_as_it_is(pressed):
    folder, _ = pressed
    before = (folder / "run.h5").read_bytes()
    done = call("run", *PRESSED, "-archive_file", "run.h5", "-archive_fields", "all",
                "-archive_resume", folder=folder)
    assert done.returncode == 0 and "complete" in done.stdout and not done.stderr and (
        folder / "run.h5").read_bytes() == before


def test_what_a_complete_archive_lacks_is_told(tmp_path):
    call("run", *STILL, "-archive_file", "run.h5", folder=tmp_path)
    before = (tmp_path / "run.h5").read_bytes()
    done = call("run", *STILL, "-archive_file", "run.h5", "-archive_fields", "last",
                "-archive_stiffness", "-archive_resume", folder=tmp_path)
    assert done.returncode == 0 and (tmp_path / "run.h5").read_bytes() == before
    assert ("run.h5 is complete without what -archive_fields last keeps and the columns stiffness "
            "tell: it is made anew by -archive_overwrite") in done.stderr


def test_fields_cost_no_transforms(pressed, tmp_path):
    folder, _ = pressed
    call("run", *PRESSED, "-archive_file", "run.h5", folder=tmp_path)
    np.testing.assert_allclose(reading.read(tmp_path / "run.h5")["transforms"],
                               reading.read(folder / "run.h5")["transforms"])


def test_options_without_effect_and_without_use(tmp_path):
    done = call("run", *STILL, "-scene_amplitude", "3", "-ksp_gmres_rstart", "9", folder=tmp_path)
    assert done.returncode == 0
    assert done.stdout.count("-scene_amplitude has no effect: the geometry is cylinder") == 1
    assert ("warning: -ksp_gmres_rstart is not used" in done.stderr and "never" not in done.stderr
            and "-scene_amplitude" not in done.stderr)


def test_coarse_grid_is_a_warning(tmp_path):
    done = call("run", *STILL, "-scene_points", "64", "-archive_file", "run.h5", folder=tmp_path)
    assert done.returncode == 0
    assert ("warning" in done.stderr and "64 points" in done.stderr
            and "-scene_points 512" in done.stderr)
    with h5py.File(tmp_path / "run.h5", "r") as file:
        assert "-scene_points 512" in file.attrs["warnings"]


@pytest.mark.parametrize("arguments, texts", [(["-snes_type", "anderson"], ["type: anderson"]),
                                              (["-ksp_type", "bcgs", "-pc_type", "none",
                                                "-snes_monitor"],
                                               ["type: newtonls", "type: bcgs", "type: none",
                                                "0 SNES Function norm"])])
def test_types_of_petsc_take_effect(tmp_path, arguments, texts):
    done = call("run", *STILL, *arguments, "-snes_view", folder=tmp_path)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert all(text in done.stdout for text in texts)


def test_stop_that_was_asked_for(tmp_path):
    done = call("run", *SMALL, "-load_path", "normal_displacement=1; normal_displacement=-5",
                "-load_stop", "pull_off", "-continuation_at_fold", "stop", "-archive_file",
                "run.h5", folder=tmp_path)
    record = reading.read(tmp_path / "run.h5")
    assert done.returncode == 0 and record.complete and record["normal_displacement"][-1] > -5
    assert (record["event"][-1] in ("fold", "pull_off")
            and f"event         {record['event'][-1]}" in done.stdout)


LONG = [*SMALL, "-continuation_largest_step", "0.05,0.5", "-load_path",
        "normal_displacement=1; tangential_displacement=5", "-archive_file", "run.h5"]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_interrupted_run_keeps_its_points(tmp_path, number):
    """`test_faults` sends signals from elsewhere, at any moment."""
    done = signalled(number, "run", *LONG, folder=tmp_path, points=2)
    record = reading.read(tmp_path / "run.h5")
    assert done.returncode == 128 + number and record.points >= 2 and not record.complete
    assert f"{record.points} points are in" in done.stderr
    assert "-archive_resume goes on" in done.stderr and len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("points", [4, 25])
def test_killed_run_resumes_to_the_same_result(tmp_path, points):
    """In the first leg, and in the second one."""
    done = signalled(signal.SIGKILL, "run", *LONG, folder=tmp_path, points=points)
    kept = reading.read(tmp_path / "run.h5")
    assert done.returncode == -signal.SIGKILL and kept.points == points and not kept.complete
    assert kept["leg"][-1] == 1 + (points > 20)
    done = call("run", *LONG, "-archive_resume", folder=tmp_path)
    assert done.returncode == 0 and f"after point {kept.points}" in done.stdout
    assert call("run", *LONG, "-archive_file", "once.h5", folder=tmp_path).returncode == 0
    assert_same_ends(tmp_path / "run.h5", tmp_path / "once.h5")
    assert reading.read(tmp_path / "run.h5").points == reading.read(tmp_path / "once.h5").points


def test_failed_solve_keeps_its_points(tmp_path):
    arguments = [*PRESSED, "-archive_file", "run.h5"]
    # No step can be smaller than the first one, and none can be solved in one iteration.
    done = call("run", *arguments, "-load_start", "normal_displacement=-3", "-snes_max_it", "1",
                "-continuation_smallest_step", "0.1", folder=tmp_path)
    record = reading.read(tmp_path / "run.h5")
    assert done.returncode == 1 and "Traceback" not in done.stderr, done.stderr
    assert record.points >= 1 and not record.complete and "-archive_resume goes on" in done.stderr


def test_tension_beyond_pull_off_has_no_equilibrium(tmp_path):
    done = call("run", *SMALL, "-load_path", "normal_force=-4", "-archive_file", "run.h5",
                folder=tmp_path)
    record = reading.read(tmp_path / "run.h5")
    assert (done.returncode == 1 and "no equilibrium" in done.stderr
            and "Traceback" not in done.stderr), done.stderr
    # where it would end again
    assert done.stderr.endswith("run.h5\n") and "-archive_resume" not in done.stderr
    assert (record["event"][-1] == "fold" and record["fold_kind"][-1] == "pull_off"
            and not record.complete)


def test_shear_beyond_what_sliding_carries_has_no_equilibrium(tmp_path):
    done = call("run", *SHEARED, "-load_path", "normal_force=2; tangential_force=6",
                "-archive_file", "run.h5", folder=tmp_path)
    record = reading.read(tmp_path / "run.h5")
    assert (done.returncode == 1 and "no equilibrium" in done.stderr
            and "Traceback" not in done.stderr), done.stderr
    assert (record["event"][-1] == "fold" and record["fold_kind"][-1] == "sliding"
            and not record.complete)


def test_run_that_was_killed_during_its_jump(tmp_path):
    assert call("run", *SHEARED, "-archive_file", "once.h5", folder=tmp_path).returncode == 0
    call("run", *SHEARED, "-continuation_at_fold", "stop", "-archive_file", "run.h5",
         folder=tmp_path)
    with h5py.File(tmp_path / "run.h5", "r+") as file:
        file.attrs["complete"] = False
    done = call("run", *SHEARED, "-archive_file", "run.h5", "-archive_resume", folder=tmp_path)
    events = reading.read(tmp_path / "run.h5")["event"].tolist()
    assert done.returncode == 0 and events == reading.read(tmp_path / "once.h5")["event"].tolist()
    assert events.count("fold") == events.count("jump") == 1
    assert_same_ends(tmp_path / "run.h5", tmp_path / "once.h5")


@pytest.mark.parametrize("events, unfinished", [([], 0), (["none"], 0), (["none", "fold"], 1),
                                                (["none", "fold", "gross_sliding"], 2),
                                                (["none", "fold", "jump"], 0),
                                                (["fold", "jump", "none"], 0),
                                                (["fold", "jump", "none", "fold"], 1),
                                                (["jump", "none", "fold", "pull_off"], 2)])
def test_fold_without_its_jump_is_found_again(events, unfinished):
    history = [met(event) for event in events]
    assert unfinished_fold(history) == unfinished
    kept, tail = history[:len(history) - unfinished], history[len(history) - unfinished:]
    again = [*([met(None)] if tail else []), *tail, met("jump"), met("fold")]
    assert [point.event for point in new_points(again, tail)] == ["jump", "fold"]
    if unfinished:
        with pytest.raises(NotConverged, match="not found again"):
            list(new_points(again[:1], tail))
    assert all(point.event != "fold" or "jump" in events for point in kept)


def met(event, load=2.0, leg=1, precision=0.0):
    """What of a point decides whether a fold is found again."""
    return SimpleNamespace(event=event, leg=leg, load=np.array([1.0, load]),
                           fold_precision=precision)


@pytest.mark.parametrize("found, same", [({"load": 2.0 + 1e-8}, True), ({"load": 2.008}, False),
                                         ({"load": 2.008, "precision": 0.01}, True),
                                         ({"leg": 2}, False)])
def test_another_fold_is_not_taken_for_the_one_at_the_end_of_the_archive(found, same):
    again = new_points([met(None), met("fold", **found), met("jump")], [met("fold")])
    if same:
        assert [point.event for point in again] == ["jump"]
    else:
        with pytest.raises(NotConverged, match="not found again"):
            list(again)


def test_bar_on_a_terminal(tmp_path):
    screen, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 160, 0, 0))
    process = subprocess.Popen([*COMMAND, "run", *PRESSED], cwd=tmp_path, env=ENVIRONMENT,
                               stdout=terminal, stderr=terminal)
    os.close(terminal)
    text = b""
    try:
        while part := os.read(screen, 65536):
            text += part
    except OSError:  # how Linux tells of a terminal's end
        pass
    os.close(screen)
    assert process.wait() == 0
    assert b"/1 legs" in text and b"transforms" in text and b"Traceback" not in text


# Help and info


def option_names():
    """Names of all our options."""
    return ["-" + cls.prefix + field.name for cls in (*OPTION_CLASSES, *cli.solver_options())
            for field in dataclasses.fields(cls)]


def test_help_shows_every_option(tmp_path):
    done = call("run", "-help", folder=tmp_path)
    words = done.stdout.split()
    assert done.returncode == 0 and not [name for name in option_names() if name not in words]
    assert "residual_norm" in done.stdout
    text = " ".join(done.stdout.split())
    assert ("residual_norm = sqrt( sum over the window's nodes" in text
            and "-snes_atol (default 1e-8" in text)


def test_info_shows_what_would_be_solved(tmp_path):
    done = call("info", *SHEARED, "-scene_points", "128", "-scene_amplitude", "2", folder=tmp_path)
    assert done.returncode == 0 and len(done.stdout.splitlines()) < 55
    for text in ("-scene_amplitude 2\n", "-scene_points 128\n", "others have their defaults",
                 "leg 1: normal_force goes to 2 w_n,r",
                 "leg 2: tangential_displacement goes to 90 u_t,r", "MB", "leg 2: 2 x",
                 "before leg 2", "-scene_amplitude: the geometry is cylinder", "SNES newtonls"):
        assert text in done.stdout
    assert "warning" in done.stderr and "-scene_points 512" in done.stderr


def test_a_surface_is_drawn_before_it_is_solved(tmp_path):
    """A measured map, and a shape; a map without size is refused by name."""
    x = np.arange(32) / 32
    np.savetxt(tmp_path / "map.csv", np.cos(4 * np.pi * x)[:, None] + x, delimiter=",")
    (tmp_path / "mine.opts").write_text("""-scene_units si
-scene_geometry file
-scene_geometry_file map.csv
-scene_heights_unit um
-scene_contact_modulus 2e6
-scene_work_of_adhesion_normal 0.03
-scene_work_of_adhesion_tangential 0.03
-scene_range_normal 1e-7
-scene_range_tangential 1e-7
""")
    done = call("plot", "mine.opts", "-scene_heights_size", "1e-4", folder=tmp_path)
    assert done.returncode == 0 and done.stdout == "mine-surface.png\n"
    assert "the heights are not periodic: along y" in done.stderr
    assert (tmp_path / "mine-surface.png").stat().st_size > 10000
    done = call("plot", "mine.opts", folder=tmp_path)
    assert done.returncode == 2 and "a map without size" in done.stderr
    (tmp_path / "figures").mkdir()
    done = call("plot", "-plot_format", "svg,pdf", "-scene_geometry", "sphere", "-scene_dimension",
                "2", "-scene_points", "32", "-plot_size", "12", "-output", "figures",
                folder=tmp_path)
    assert done.stdout == "figures/sphere-surface.svg\nfigures/sphere-surface.pdf\n", done.stderr
    assert "<svg" in (tmp_path / "figures" / "sphere-surface.svg").read_text()
    done = call("plot", "mine.opts", "-plot_fromat", "svg", folder=tmp_path)
    assert done.returncode == 2 and "did you mean -plot_format" in done.stderr


def test_info_advises_on_a_scene_out_of_reach(tmp_path):
    """PDMS on glass: a range of 58 nm takes 16384 squared, which no memory here holds."""
    done = call("info", "-scene_units", "si", "-scene_dimension", "2", "-scene_geometry", "sphere",
                "-scene_radius", "9.42e-3", "-scene_young_modulus", "1.5e6",
                "-scene_work_of_adhesion_normal", "0.027", "-scene_work_of_adhesion_tangential",
                "0.027", "-scene_adhesive_strength", "1e5", "-scene_shear_strength", "0.4e6",
                "-scene_period", "1.5e-3", "-scene_height", "3e-3", "-scene_points", "auto",
                "-load_path", "normal_force=0.01; tangential_displacement_x=1e-3", folder=tmp_path)
    assert done.returncode == 2 and "-scene_accuracy is '1e-06': that takes" in done.stderr
    for words in ("contact by theory", "the law takes 16384 x 16384 points", "at fixed work: the "
                  "strength is free, -scene_shear_strength", "at fixed strength: the work is free, "
                  "-scene_work_of_adhesion_tangential", "% of the displacement of its top"):
        assert words in done.stdout


def test_info_advises_on_grids_only_that_are_too_large(tmp_path):
    np.save(tmp_path / "short.npy", np.zeros(16))
    done = call("info", *SMALL, "-scene_geometry", "file", "-scene_geometry_file", "short.npy",
                folder=tmp_path)
    refused(done, "short.npy", "shape")
    assert not done.stdout


@pytest.mark.parametrize("arguments, text", [(SMALL, "no legs"),
                                             (["-scene_dimension", "2", "-scene_points", "32",
                                               "-scene_geometry", "sphere", "-scene_normal_maugis",
                                               "1", "-scene_period", "20"], "32 x 32"),
                                             ([*SMALL, "-load_path", "normal_force=1",
                                               "-contact_form", "force"], "force form"),
                                             ([*SMALL, "-load_path",
                                               "normal_displacement=hold, tangential_force=1",
                                               "-scene_poisson", "0.3"],
                                              "normal_displacement is held")])
def test_info_of_other_scenes(tmp_path, arguments, text):
    done = call("info", *arguments, folder=tmp_path)
    assert done.returncode == 0 and not done.stderr and text in done.stdout


# plot


def test_plot_makes_files_without_petsc(pressed, tmp_path):
    folder, _ = pressed
    code = ("import sys; from contactsnes.commands.cli import main; status = main(sys.argv[1:]); "
            "sys.exit(99 if 'petsc4py.PETSc' in sys.modules else status)")
    done = subprocess.run([sys.executable, "-c", code, "plot", str(folder / "run.h5"), "--pdf",
                           "--output", str(tmp_path), "--points", "-1,0"], env=ENVIRONMENT,
                          capture_output=True, text=True, check=False)
    made = {path.name for path in tmp_path.iterdir()}
    assert done.returncode == 0, done.stdout + done.stderr
    assert {"run-approach.png", "run-approach.pdf",
            "run-profiles.png"} <= made and all(name in done.stdout for name in made)
    assert "no figure shear" in done.stdout


@pytest.mark.parametrize("arguments, word", [(["absent.h5"], "absent.h5"),
                                             (["run.h5", "--points", "9999"], "9999"),
                                             (["run.h5", "--output", "absent"], "absent")])
def test_plot_refuses(pressed, monkeypatch, capsys, arguments, word):
    monkeypatch.chdir(pressed[0])
    assert cli.main(["plot", *arguments]) == 2
    shown = capsys.readouterr().err
    assert shown.startswith("contactsnes: error: ") and word in shown


@pytest.mark.parametrize("command, arguments, word", [
    ("plot", [], "usage: contactsnes plot RUN.h5"),
    ("plot", ["run.h5", "--points", "first"], "whole numbers"),
    ("plot", ["--nonsense", "run.h5"], "--nonsense is no option here"),
    ("table", ["run.h5", "-colums", "a"], "did you mean -columns"),
    ("table", ["run.h5", "-format", "xls"], "one of csv, parquet"),
    ("export", ["a.h5", "b.h5", "-output", "c"], "2 archives are named")])
def test_commands_on_archives_say_how_they_are_used(capsys, command, arguments, word):
    assert cli.main([command, *arguments]) == 2 and word in capsys.readouterr().err
    assert cli.main([command, "-help"]) == 0
    assert f"usage: contactsnes {command} RUN.h5" in capsys.readouterr().out


def test_a_table_goes_to_standard_output(pressed, capsys, monkeypatch):
    monkeypatch.chdir(pressed[0])
    assert cli.main(["table", "run.h5", "-columns", "point,normal_force", "-rows", "last"]) == 0
    heading, row = capsys.readouterr().out.splitlines()
    record = reading.read("run.h5")
    assert heading == "point,normal_force"
    assert row == f"{record.points - 1},{record['normal_force'][-1]}"
    assert cli.main(["table", "absent.h5", "run.h5", "-columns", "archive", "-rows", "last"]) == 2
    told = capsys.readouterr()
    assert told.out.splitlines() == ["archive", "run.h5"]
    assert "error: absent.h5: there is no such file" in told.err


def test_events_of_ours_stand_in_the_log_of_petsc(tmp_path):
    done = call("run", *STILL, "-contact_kernels", "off", "-log_view", ":log.txt", folder=tmp_path)
    counts = {line.split()[0]: int(line.split()[1])
              for line in (tmp_path / "log.txt").read_text().splitlines()
              if line.startswith("Contact")}
    assert done.returncode == 0 and counts["ContactLaw"] > 1 and counts["ContactTransform"] > 1
    assert call("run", *STILL, "-log_view", ":log.txt", folder=tmp_path).returncode == 0


def test_petsc_may_say_what_it_does(tmp_path):
    """It prints within calls of the library, by a function of petsc4py that needs Python's lock."""
    done = call("run", *STILL, "-info", folder=tmp_path)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert "<sys> PetscFinalize()" in done.stdout


def test_options_that_nobody_asks_for_are_told_before_the_solve(tmp_path):
    words = ["-snes_monitor", "-snes_view", "-ksp_monitor", "-snes_converged_reason",
             "-snes_linesearch_monitor", "-snes_atoll", "3"]
    done = call("run", *STILL, *words, folder=tmp_path)
    assert done.stderr.count("not used") == 1 and "-snes_atoll is not used" in done.stderr


def test_a_report_without_its_library_says_how_to_get_it(pressed, capsys, monkeypatch):
    monkeypatch.chdir(pressed[0])
    for name in ("plotly", "plotly.io", "plotly.subplots", "plotly.graph_objects"):
        monkeypatch.setitem(sys.modules, name, None)
    assert cli.main(["report", "run.h5"]) == 2
    assert "pip install plotly, or contactsnes[report]" in capsys.readouterr().err
    assert not (pressed[0] / "run.html").exists()


def test_commands_on_archives_name_what_they_wrote(pressed, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(pressed[0])
    monkeypatch.setattr("contactsnes.output.figures.movie.DOTS", 50)
    for command, name, *more in (("movie", "run.gif", "-frames", "2"), ("export", "run.vtkhdf")):
        path = tmp_path / name
        assert cli.main([command, "run.h5", "-output", str(path), *more]) == 0
        assert capsys.readouterr().out.strip() == str(path) and path.stat().st_size > 1000
    assert cli.main(["table", "run.h5", "-output", str(tmp_path / "absent/run.csv")]) == 2
    assert "create it" in capsys.readouterr().err
