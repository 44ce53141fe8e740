"""The parts of a campaign: what is drawn, run and judged, row by row into a table that is never
lost."""

import concurrent.futures
import csv
import functools
import queue
import shutil
import threading
import time

from . import bad_input, faults, judge, kills, planted, scenes, ways_out

COLUMNS = ("part", "number", "seed", "outcome", "points", "runs", "left_out", "seconds", "found",
           "command")

KEPT = (*judge.FORBIDDEN, "failed", "some", "time")
"""Outcomes whose archives are kept."""


class Table:
    """Rows of a part in a CSV file, each written as soon as it is known.

    Parameters
    ----------
    path : of the file
    resume : whether rows that are there already stay
    """

    def __init__(self, path, resume):
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self.lock = threading.Lock()
        self.known = set()
        if resume and path.is_file():
            with open(path, newline="", encoding="utf-8") as file:
                self.known = {int(row["number"]) for row in csv.DictReader(file)}
        else:
            self._put([COLUMNS], "w")

    def _put(self, rows, mode="a"):
        with open(self.path, mode, newline="", encoding="utf-8") as file:
            csv.writer(file).writerows(rows)

    def add(self, row):
        """Write a row (name -> value)."""
        with self.lock:
            self._put([[row.get(name, "") for name in COLUMNS]])


def run(asked, end, name, count, judged):
    """Judge numbers 0 to ``count`` of a part, until the time is over.

    Parameters
    ----------
    asked : options of the command line
    end : time.monotonic() at which no further one is begun, or None
    name : of the part and its table
    count : how many
    judged : function (number, worker, folder) -> (`judge.Verdict`, command line)
    """
    numbers = asked.scene if asked.scene is not None else range(count)
    table = Table(asked.results / f"campaign-{name}.csv", asked.resume or asked.scene is not None)
    numbers = [number for number in numbers if asked.scene is not None or number not in table.known]
    workers = queue.SimpleQueue()
    begin = time.monotonic()
    done = []
    for _ in range(asked.jobs):
        workers.put(judge.Worker())

    def one(number):
        if end is not None and time.monotonic() > end:
            return
        worker, folder = workers.get(), asked.results / "campaign" / f"{name}-{asked.seed}-{number}"
        folder.mkdir(parents=True, exist_ok=True)
        try:
            verdict, command = judged(number, worker, folder)
        # a defect of the campaign, or an archive that breaks its reader: a row like the others
        except Exception as error:
            verdict, command = judge.Verdict(), ""
            verdict.add("silent", "campaign", f"{type(error).__name__}: {error}")
        finally:
            workers.put(worker)
        row = {"part": name, "number": number, "seed": asked.seed, "outcome": verdict.outcome,
               "points": verdict.points, "runs": verdict.runs, "left_out": verdict.left_out,
               "seconds": f"{verdict.seconds:.2f}", "command": command,
               "found": " | ".join(f"{kind}: {variant}: {text}"
                                   for kind, variant, text in verdict.found)}
        table.add(row)
        done.append(verdict)
        if verdict.outcome not in KEPT:
            shutil.rmtree(folder, ignore_errors=True)
        print(f"{name} {number:5d} {verdict.outcome:10} {verdict.runs:3d} runs "
              f"{verdict.points:5d} points {verdict.seconds:6.1f} s  "
              f"{row['found'][:200]}", flush=True)

    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        list(pool.map(one, numbers))
    while not workers.empty():
        workers.get().close()
    if numbers:
        print(f"{name}: {len(done)} of {len(numbers)} in {(time.monotonic() - begin) / 60:.1f} min",
              flush=True)


def scene_part(asked, end, name="scenes"):
    """Random scenes and their variants; as 'laws' those with laws besides the paper's."""
    def judged(number, worker, folder):
        scene = scenes.create(asked.seed, number, laws=name == "laws")
        verdict = judge.judged(scene, worker, folder, asked.seconds, asked.budget)
        return verdict, judge.command(["run", *scene.words(folder)])

    run(asked, end, name, getattr(asked, name), judged)


def planted_part(asked, end):
    """Tests of the program switched off in turn: the outcome is that of seeing it, and of seeing
    nothing where nothing is."""
    def judged(number, worker, folder):
        name = list(planted.FAULTS)[number]
        scene, fault = planted.scene(name), planted.FAULTS[name]
        sound = judge.judged(scene, worker, folder, asked.seconds, only=fault.variants)
        verdict = judge.judged(scene, worker, folder, asked.seconds, only=fault.variants,
                               fault=name, planted_in=("scene",))
        seen = verdict.outcome == "silent" and sound.outcome == "agreed"
        result = judge.Verdict([], sound.points, sound.seconds + verdict.seconds,
                               sound.runs + verdict.runs)
        for kind, variant, text in [*sound.found, *verdict.found] if not seen else ():
            result.add("silent", f"{name}, {variant}", f"{kind}: {text}")
        if not seen:
            result.add("silent", name, "not seen")
        return result, name + (f": {verdict.found[0][2]}" if seen else "")

    run(asked, end, "planted", len(planted.FAULTS), judged)


def bad_input_part(asked, end):
    """Random bad input."""
    def judged(number, worker, folder):
        return bad_input.judged(asked.seed, number, worker, folder, asked.seconds)

    run(asked, end, "bad-input", asked.bad_inputs, judged)


def kills_part(asked, end):
    """Kills and other faults from outside."""
    def judged(number, worker, folder):
        return kills.judged(asked.seed, number, worker, folder, asked.seconds)

    run(asked, end, "kills", asked.kills, judged)


def ways_out_part(asked, end):
    """Random tables, figures, reports, movies and exports of archives."""
    def judged(number, worker, folder):
        return ways_out.judged(asked.seed, number, worker, folder, asked.seconds)

    run(asked, end, "ways-out", asked.ways_out, judged)


ROUNDINGS = {"two threads": {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"},
             "another kernel of OpenBLAS": {"OPENBLAS_CORETYPE": "Nehalem"},
             "no vector instructions": {
    "NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3 AVX512F AVX512CD AVX512_SKX",
    "OPENBLAS_CORETYPE": "Prescott"},}
"""Name -> variables of an environment in which sums are added up in another order."""


def roundings_part(asked, end):
    """Scenes again under other roundings."""
    def judged(number, worker, folder):
        scene, verdict = scenes.create(asked.seed, number), judge.Verdict()
        base, done = judge.alone(verdict, "scene", scene, worker, folder, asked.seconds,
                                 {"archive_fields": "all"})
        others = {name: worker.beside(environment) for name, environment in ROUNDINGS.items()}
        if asked.python:
            others["another PETSc"] = worker.beside({}, asked.python)
        statuses = {"scene": done.status}
        for name, other in others.items():
            story, again = judge.alone(verdict, name, scene, other, folder, asked.seconds, {})
            statuses[name] = again.status
            judge.compared(verdict, name, base, story, done.status == 0 == again.status)
        verdict.differ(statuses)
        return verdict, judge.command(["run", *scene.words(folder)])

    run(asked, end, "roundings", asked.roundings, judged)


def faults_part(asked, end):
    """One-line faults in the sources: the outcome is that of a test that finds it, and of none."""
    listed = faults.read_faults()

    def judged(number, worker, folder):
        fault, verdict = listed[number], judge.Verdict(runs=1)
        for _, count in faults.stale([fault]):
            raise ValueError(f"in {fault.file} this stands {count} times: {fault.text.strip()}")
        finder, verdict.seconds = faults.tried(fault)
        if not finder:
            verdict.add("silent", fault.file, f"not found by {fault.tests}")
        return verdict, f"{fault.file}: {fault.text.strip()} => {fault.fault.strip()}" + (
            f": {finder}" if finder else "")

    run(asked, end, "faults", len(listed), judged)


PARTS = {"scenes": scene_part, "laws": functools.partial(scene_part, name="laws"),
         "bad-input": bad_input_part, "ways-out": ways_out_part, "kills": kills_part,
         "roundings": roundings_part, "planted": planted_part, "faults": faults_part}
