"""Random ways out of archives: tables, figures, reports, movies and exports with random options,
good ones and some that nobody should give."""

import csv
import io
import random

import h5py
import numpy as np

from . import judge, scenes, surfaces

COMMANDS = {
    "table": {"columns": ("normal_force,contact_area", "point,normal_displacement", "nothing_such"),
              "rows": ("all", "last", "event", "fold", "some"), "units": ("true", "maybe"),
              "format": ("csv", "parquet", "xls")},
    "plot": {"plot_format": ("png", "svg", "pdf", "png,svg", "bmp"), "plot_points": ("0,-1", "x"),
             "plot_columns": ("normal_displacement,normal_force", "normal_force,none_such"),
             "plot_size": ("6", "12,9", "-1", "nan"), "plot_style": ("ggplot", "no-such-style"),
             "plot_together": ("both",), "plot_with": ("measured.csv", "missing.csv")},
    "report": {"points": ("5", "1", "0", "many"), "nodes": ("16", "64", "3")},
    "movie": {"format": ("gif", "avi"), "frames": ("2", "3", "1"), "seconds": ("1", "0", "inf"),
              "width": ("6", "1000"), "style": ("ggplot", "no-such-style")},
    "export": {"points": ("0,-1", "100000", "x"), "precision": ("single", "double", "half")},
}
"""Command -> its options and their values."""

BAD = {"nothing_such", "some", "maybe", "xls", "bmp", "x", "normal_force,none_such", "-1", "nan",
       "no-such-style", "missing.csv", "0", "many", "3", "avi", "1", "inf", "1000", "100000",
       "half"}
"""Values that are refused, by all options that have them but those of `ALLOWED`."""

ALLOWED = {("points", "1"), ("seconds", "1"), ("frames", "3")}
"""Option and value of `BAD` that are good."""

BESIDE = {"maybe"}
"""Values of a flag that are taken for one more archive, which is named; of the others there is a
table."""

FIELDS = ("report", "movie", "export")
"""Commands that may refuse an archive without fields, by its name."""


def create(seed, number, folder):
    """(scene, options of its archive, [(command, its options, whether they are all good), ...]) of
    a number, the same for a seed; the file of measured points is written."""
    draw = random.Random(f"{seed} ways out {number}")
    kept = {"archive_fields": draw.choice(("all", "all", "last", "none")),
            "archive_precision": draw.choice(("double", "single"))}
    (folder / "measured.csv").write_text("normal_displacement,normal_force,normal_force_error\n"
                                         "0.1,0.2,0.05\n0.5,1,0.1\n", encoding="utf-8")
    asked = []
    for command in draw.sample(list(COMMANDS), 4):
        options = {name: draw.choice(values) for name, values in COMMANDS[command].items()
                   if draw.random() < 0.4}
        asked.append((command, options, all(value not in BAD or (name, value) in ALLOWED
                                            for name, value in options.items())))
    return scenes.create(seed, number), kept, asked


def judged(seed, number, worker, folder, seconds):
    """(`judge.Verdict`, command line): what is asked for well is written and says what the archive
    says; what is not is refused in a sentence, and nothing is written."""
    scene, kept, asked = create(seed, number, folder)
    archive, verdict = folder / "run.h5", judge.Verdict()
    archive.unlink(missing_ok=True)
    words = scene.words(folder, archive_file=archive, **kept)
    done = worker.run(["run", *words], folder / "run", seconds)
    verdict.runs, verdict.seconds = 1, done.seconds
    if done.crashed or done.status not in (0, 1) or not archive.exists():
        verdict.add("crashed" if done.crashed else "refused" if done.status == 2 else "time", "run",
                    done.reason)
        return verdict, judge.command(["run", *words])
    for each in asked:
        _judge(verdict, worker, each, archive, kept, seconds)
    surfaces.judged(verdict, seed, number, worker, folder, seconds)
    return verdict, judge.command(["run", *words])


def _words(command, options, archive, folder):
    """Command line, and the suffix of the file that is to be written."""
    end = {"report": "html", "export": "vtkhdf", "movie": "gif",
           "table": options.get("format", "csv")}.get(command)
    where = (("-plot_output", str(folder)) if command == "plot"
             else ("-output", str(folder / f"made.{end}")))
    asked = options if command != "movie" else {"format": "gif", **options}
    return [command, str(archive), *where,
            *(word for name, value in asked.items()
              for word in (f"-{name}", str(archive.parent / value) if name == "plot_with"
                           else value))], end


def _judge(verdict, worker, asked, archive, kept, seconds):
    """Take down what is wrong with what a command made of an archive."""
    command, options, good = asked
    folder = archive.parent / command
    folder.mkdir(exist_ok=True)
    for file in folder.iterdir():
        file.unlink()
    words, end = _words(command, options, archive, folder)
    done = worker.run(words, archive.parent / f"{command}-said", seconds)
    verdict.runs += 1
    verdict.seconds += done.seconds
    made = [file for file in folder.iterdir() if file.stat().st_size > 0]
    errors = [line for line in done.err.splitlines() if "error: " in line]
    said = f"{' '.join(words[1:])}: status {done.status}: {done.reason}"
    if done.crashed:
        verdict.add("crashed", command, said)
    elif done.status < 0:
        verdict.add("time", command, said)
    elif done.status == 0 and (not good or not made):
        verdict.add("silent", command, f"{said}, {len(made)} files of {options}")
    elif done.status != 0 and (len(errors) != 1
                               or made and options.get("units") not in BESIDE):
        verdict.add("silent", command, f"{said}, {len(errors)} sentences, {len(made)} files")
    elif done.status != 0 and good and not _may_refuse(command, options, archive, kept, errors[0]):
        verdict.add("silent", command, f"refused: {said}")
    elif command == "table" and done.status == 0 and end == "csv":
        judge_table(verdict, made[0], archive, options)
    elif command == "export" and done.status == 0 and "points" not in options:
        _judge_export(verdict, made[0], archive, kept)


def _may_refuse(command, options, archive, kept, text):
    """Whether a reason is one: an extra that is not installed, no fields, no such event, fewer
    points than asked for."""
    with h5py.File(archive, "r") as file:
        few = int(file.attrs["points"]) < 2
    return ("pip install" in text or few
            or ((command in FIELDS or "plot_points" in options)
                and kept["archive_fields"] != "all")
            or options.get("rows") in ("event", "fold") or "plot_with" in options)


def judge_table(verdict, path, archive, options):
    """Take down where a table has not the archive's numbers, to the last digit."""
    rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
    with h5py.File(archive, "r") as file:
        count = int(file.attrs["points"])
        if options.get("rows", "all") == "all" and len(rows) != count:
            verdict.add("silent", "table", f"{len(rows)} rows of {count} points")
        for heading in (name for row in rows[:1] for name in row
                        if name.split(" [")[0] in file["branch"]):
            column = file["branch"][heading.split(" [")[0]]
            if "names" in column.attrs or options.get("rows", "all") not in ("all", "last"):
                continue
            told = np.array([float(row[heading] or "nan") for row in rows])
            if not np.array_equal(told, column[count - len(told):count], equal_nan=True):
                verdict.add("silent", "table", f"{heading} is not the archive's")


def _judge_export(verdict, path, archive, kept):
    """Take down where an export has not a step for each point with fields; one is an image."""
    with h5py.File(archive, "r") as file, h5py.File(path, "r") as made:
        count = {"all": int(file.attrs["points"]), "last": 1, "none": 0}[kept["archive_fields"]]
        image = made["VTKHDF"]
        found = int(image["Steps"].attrs["NSteps"]) if "Steps" in image else 1
    if found != count:
        verdict.add("silent", "export", f"{found} steps of {count} points")
