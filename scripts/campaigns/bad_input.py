"""Random bad input: what a user may type, and what files may hold, that cannot be solved."""

import os
import random

import numpy as np

from . import judge

GOOD = {"scene_points": "64", "scene_period": "15", "scene_normal_maugis": "2",
        "scene_height": "50", "load_path": "normal_displacement=1"}

NUMBERS = ("nan", "inf", "-inf", "1e300", "-1e300", "1e-320", "0", "-1", "abc", "1,2,3", "", "1e",
           "0x10", "1 2", "--3", "½", "1_000")
WORDS = ("", "yes", "Cylinder", "none,none", "jump;stop", "\n", "a" * 5000, "ünïcödé", "$HOME",
         "%s%s%n", "../..", "-", "=")

NUMERIC = ("scene_points", "scene_period", "scene_normal_maugis", "scene_tangential_maugis",
           "scene_residual_friction", "scene_poisson", "scene_height", "scene_amplitude",
           "scene_gap_offset", "scene_work_ratio", "scene_contact_threshold", "scene_spacing",
           "scene_dimension", "scene_residual_adhesion", "scene_rough_slope", "scene_rough_seed",
           "continuation_initial_step", "continuation_largest_step", "continuation_smallest_step",
           "snes_atol", "contact_first_tolerance", "scene_radius", "scene_young_modulus",
           "scene_heights_size")
NAMED = ("scene_geometry", "scene_law", "scene_units", "scene_tangential", "contact_form",
         "contact_window", "contact_symmetry", "contact_first", "continuation_type",
         "continuation_at_fold", "continuation_predictor", "continuation_stability",
         "continuation_at_bifurcation", "load_stop", "archive_fields", "snes_type", "ksp_type",
         "pc_type")
PATHS = ("", ";", "normal_displacement", "normal_displacement=",
         "normal_displacement=1;;normal_force=2", "normal_displacement=1,normal_force=2", "up=1",
         "normal_force=hold", "tangential_displacement_x=1", "normal_displacement=inf",
         "normal_displacement=1e300", "=1", "normal_displacement=1=2", "normal_displacement:1",
         "normal_displacement=1,", "normal_displacement=nan", "normal_displacement==1")


def create(seed, number, folder):
    """Words of a command (behind ``contactsnes``) of a number, the same for a seed; files that it
    names are written."""
    draw = random.Random(f"{seed} {number}")
    options, extra = dict(GOOD), []
    kind = draw.choice(("number", "number", "name", "path", "typo", "file", "heights", "archive",
                        "clash", "command"))
    if kind == "number":
        options[draw.choice(NUMERIC)] = draw.choice(NUMBERS)
    elif kind == "name":
        options[draw.choice(NAMED)] = draw.choice(WORDS)
    elif kind == "path":
        options[draw.choice(("load_path", "load_path", "load_start"))] = draw.choice(PATHS)
    elif kind == "typo":
        name = draw.choice((*NUMERIC, *NAMED))
        place = draw.randrange(1, len(name))
        options[name[:place] + draw.choice("xqz_") + name[place + 1:]] = "1"
    elif kind == "file":
        extra = [_options_file(draw, folder)]
    elif kind == "heights":
        options |= {"scene_geometry": "file", "scene_geometry_file": _heights(draw, folder)}
    elif kind == "archive":
        options["archive_file"] = _archive(draw, folder)
        options[draw.choice(("archive_resume", "archive_overwrite",
                             "archive_fields"))] = draw.choice(("", "all"))
    elif kind == "clash":
        options |= draw.choice(CLASHES)
    else:
        return draw.choice(([], ["ruN"], ["plot"], ["plot", "missing.h5"], ["plot", "/dev/null"],
                            ["run"], ["info"], ["compare"], ["run", "missing.opts"],
                            ["run", str(folder)], ["run", "-load_path"], ["table", "x"],
                            ["run", "--load_path", "1"], ["compare", "missing.opts"],
                            ["info", "-scene_period", "inf", "-scene_points", "64"]))
    words = [word for name, value in options.items() for word in ((f"-{name}", value) if value != ""
                                                                  or kind != "archive"
                                                                  else (f"-{name}",))]
    return [draw.choice(("run", "run", "run", "info")), *extra, *words]


CLASHES = ({"scene_period": "inf"}, {"scene_spacing": "0.1"}, {"scene_units": "si"},
           {"scene_radius": "0.01"}, {"scene_dimension": "2"}, {"scene_geometry": "file"},
           {"scene_geometry": "rough"}, {"scene_tangential": "off",
                                         "load_path": "tangential_force=1"},
           {"continuation_at_bifurcation": "stop"}, {"continuation_initial_step": "2",
                                                     "continuation_largest_step": "1"},
           {"continuation_initial_step": "1,2,3"}, {"contact_form": "force",
                                                    "contact_symmetry": "even"},
           {"scene_period": "1.5"}, {"archive_resume": "", "archive_overwrite": "",
                                     "archive_file": "x.h5"}, {"scene_points": "1000000000000"},
           {"scene_points": "2147483648"}, {"scene_period": "inf",
                                            "load_path": "normal_displacement=1",
                                            "scene_points": "auto"},
           {"scene_geometry": "sphere", "scene_poisson": "0.6"}, {"continuation_type": "arclength",
                                                                  "snes_type": "nrichardson"},
           {"scene_rough_slope": "1", "scene_geometry": "rough", "scene_rough_shortest": "100"},
           {"scene_rough_slope": "1", "scene_geometry": "rough", "scene_rough_shortest": "3",
            "scene_rough_on": "flat", "scene_rough_rolloff": "1000"},
           {"scene_shear_strength": "1e5"}, {"scene_units": "si", "scene_young_modulus": "1e6",
                                             "scene_contact_modulus": "1e6"},
           {"scene_units": "si", "scene_range_normal": "1e-7", "scene_adhesive_strength": "1e5"},
           {"scene_geometry": "file", "scene_geometry_file": "none.csv", "scene_heights_size": "3"})


def _options_file(draw, folder):
    """A file of options that is none, or a bad one."""
    path = folder / "bad.opts"
    path.write_bytes(draw.choice((b"\x00\x01\x02", b"-scene_points", b"scene_points 64\n",
                                  b"-scene_points 64 64\n", b"-scene_points \"64\n",
                                  bytes(range(256)), f"-options_file {path}\n".encode(),
                                  b"-prefix_push x_\n", b"\xff\xfe-scene_points 64\n",
                                  b"-scene_points ten\n", b"--scene_points 64\n",
                                  b"-load_path normal_displacement=1; normal_force=2\n")))
    return str(path)


def _heights(draw, folder):
    """A file of heights that are none."""
    kind = draw.choice(("missing", "shape", "nan", "complex", "words", "empty", "truncated",
                        "suffix", "dataset", "huge", "folder", "object"))
    path = folder / "heights.npy"
    values = {"shape": np.zeros(63), "nan": np.full(64, np.nan), "complex": np.zeros(64, complex),
              "huge": np.linspace(-1.7e308, 1.7e308, 64)}
    if kind in values:
        np.save(path, values[kind])
    elif kind == "words":
        path = folder / "heights.txt"
        path.write_text("one two\nthree\n")
    elif kind == "empty":
        path.write_bytes(b"")
    elif kind == "truncated":
        np.save(path, np.zeros(64))
        path.write_bytes(path.read_bytes()[:200])
    elif kind == "suffix":
        path = folder / "heights.unknown"
        path.write_text("1,2\n")
    elif kind == "dataset":
        path = folder / "heights.h5"
        path.write_bytes(b"\x89HDF\r\n\x1a\n" + os.urandom(64))
        return f"{path}:height"
    elif kind == "folder":
        path.mkdir(exist_ok=True)
    elif kind == "object":
        np.save(path, np.array([{}], dtype=object), allow_pickle=True)
    return str(path)


def _archive(draw, folder):
    """A name that no archive can have, or a file that is none."""
    path = folder / draw.choice(("missing/run.h5", "x" * 300, "note.h5", "a\nb.h5", "folder",
                                 "ü.h5"))
    if path.name == "note.h5":
        path.write_bytes(draw.choice((b"no archive", b"", b"\x89HDF\r\n\x1a\n" + bytes(100))))
    if path.name == "folder":
        path.mkdir(exist_ok=True)
    return str(path)


def judged(seed, number, worker, folder, seconds):
    """(`judge.Verdict`, command line): no traceback, no end by a signal, and a sentence where the
    status is not 0."""
    words = create(seed, number, folder)
    done, verdict = worker.run(words, folder / "output", seconds), judge.Verdict(runs=1)
    command = words[0] if words else ""
    verdict.seconds = done.seconds
    errors = [line for line in done.err.splitlines() if "error: " in line]
    if done.crashed or (done.status not in (0, 1, 2) and done.status != -9):
        verdict.add("crashed", command, f"status {done.status}: {done.reason}")
    elif done.status == -9:
        verdict.add("time", command, f"after {done.seconds:.0f} s")
    elif done.status in (1, 2) and len(errors) != 1 and command in ("run", "info"):
        verdict.add("silent", command,
                    f"status {done.status} with {len(errors)} sentences on an error")
    elif done.status == 1:
        verdict.add("said", command, done.reason)
    return verdict, judge.command(words)
