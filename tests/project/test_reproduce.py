"""The pieces of scripts/reproduce on small runs: what is read off them, figures, and the table of
statements."""

import sys
import time
from pathlib import Path

import numpy as np
import pytest

from contactsnes import Load, Scene, reference
from contactsnes.scene.settings import Steps, check

HERE = Path(__file__).resolve().parents[2] / "scripts" / "paper"

pytestmark = pytest.mark.study


@pytest.fixture(scope="module", autouse=True)
def modules():
    """The folder of the scripts on the path, without bytecode in it."""
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    sys.path.insert(0, str(HERE))
    yield
    sys.path.remove(str(HERE))
    sys.dont_write_bytecode = before


@pytest.fixture(scope="module")
def results(modules, tmp_path_factory):
    """Two small sheared runs under the names of the large ones; law -> archive is
    `results[name]`."""
    import runs

    found = runs.Results(tmp_path_factory.mktemp("paper"))
    small = {"points": 512, "normal_maugis": 2.0, "period": 60.0}
    runs_of = [runs.sheared(law, 1, 0.8, fields="all", **small) for law in ("half", "full")]
    lines = []
    found.make_all(runs_of, 1, lines.append)
    assert len(lines) == 2 and all("transforms" in line for line in lines)
    assert all(found.done(run) for run in runs_of)
    found.make_all(runs_of, 1, lines.append)
    assert len(lines) == 2
    return found


def test_an_archive_of_other_steps_is_not_taken_for_a_run(tmp_path):
    import runs

    made = runs.Results(tmp_path)
    points = []
    for step in ("0.25", "0.125"):
        run = runs.Run("small", {"scene_points": 256, "scene_period": 30, "scene_normal_maugis": 3,
                                 "load_start": "normal_displacement=1",
                                 "load_path": "normal_displacement=2",
                                 "continuation_initial_step": step,
                                 "continuation_largest_step": step})
        made.make_all([run], 1, lambda line: None)
        assert made.done(run)
        points.append(made["small"].points)
    assert points[1] > points[0]


def test_each_command_has_a_process_of_its_own_that_tells_its_end_and_its_time(tmp_path):
    from starter import Starter

    script = tmp_path / "spend.py"
    script.write_text("import sys, time\nprint(sys.argv[1:], __name__)\n"
                      "while time.process_time() < float(sys.argv[1]): pass\nsys.exit(3)\n")
    starter, said = Starter(), tmp_path / "said"
    status, used = starter.run([str(script), "0.2"], said)
    assert status == 3 and 0.1 < used < 5.0
    assert said.read_text() == "['0.2'] __main__\n"
    assert starter.run(["-m", "contactsnes", "--version"], said)[0] == 0
    assert "contactsnes 0" in said.read_text()
    there = tmp_path / "there"
    there.mkdir()
    script.write_text("import os, sys, time\nprint(os.getcwd(), flush=True)\n"
                      "print('no', end='', file=sys.stderr, flush=True)\ntime.sleep(600)\n")
    for seconds in (0.5, 5.0, 50.0):  # a busy machine may not have begun it
        texts = [tmp_path / f"{name} {seconds:g}" for name in ("out", "errors")]
        assert starter.run([str(script)], *texts, there, seconds)[0] == -9
        if texts[1].read_text():
            break
    assert [text.read_text() for text in texts] == [f"{there}\n", "no"]
    assert starter.run(["-m", "contactsnes", "--version"], said)[0] == 0
    starter.end()


def test_a_command_may_have_ended_before_its_begin_is_read(tmp_path, monkeypatch):
    """Both answers come together then, as on a busy machine, where the second was waited for until
    the time was up, or for ever."""
    import starter

    (tmp_path / "quick.py").write_text(
        "import os, sys\nfor line in sys.stdin:\n    child = os.fork()\n"
        "    if not child:\n        os._exit(0)\n    os.waitpid(child, 0)\n"
        "    os.write(1, f'{child}\\n[0, {child}]\\n'.encode())\n")
    monkeypatch.setattr(starter, "__file__", str(tmp_path / "quick.py"))
    quick = starter.Starter()
    for _ in range(2):
        assert quick.run(["program"], tmp_path / "said", seconds=5.0)[0] == 0
    quick.end()


def test_processor_time_is_summed_from_what_runs_said(tmp_path):
    import runs

    found = runs.Results(tmp_path)
    some = [runs.Run("one", {}), runs.Run("two", {}), runs.Run("missing", {})]
    (tmp_path / "one.log").write_text("x\n1.50 s of processor time\nexit status 0\n")
    (tmp_path / "two.log").write_text("2.25 s of processor time\n1.00 s of processor time\n")
    assert found.used(some) == 4.75


def test_an_interrupted_run_goes_on_and_those_behind_it_do_not_begin(tmp_path, monkeypatch):
    import runs

    made = runs.Results(tmp_path)
    asked = []
    ends = iter([130, 0])
    run = runs.Run("small", {"scene_points": 256}, finer=False)

    def command(path, arguments, said):
        path.touch()
        asked.append(arguments[-1])
        return next(ends)

    monkeypatch.setattr(made, "_command", command)
    made.make(run)
    assert not made.done(run)
    made.make(run)
    assert made.done(run) and asked == ["-archive_overwrite", "-archive_resume"]

    def interrupted(line):
        raise KeyboardInterrupt

    begun = []

    def slow(run):
        begun.append(run.name)
        # long enough for a busy machine to stop the others
        time.sleep(0.0 if len(begun) == 1 else 0.5)
        return 1, 0.05

    monkeypatch.setattr(made, "make", slow)
    with pytest.raises(KeyboardInterrupt):
        made.make_all([run._replace(name=str(number)) for number in range(40)], 1, interrupted)
    assert len(begun) < 5


def test_catalogue_is_of_valid_scenes_and_loads():
    import cost
    import runs

    found = runs.catalogue()
    for run in [*found.values(), *cost.NEEDED]:
        options = {name: value for name, value in run.options.items()}
        scene = Scene(**{name[6:]: value for name, value in options.items()
                         if name.startswith("scene_")})
        sizes = {name: tuple(map(float, options[f"continuation_{name}"].split(",")))
                 for name in ("initial_step", "largest_step") if f"continuation_{name}" in options}
        check(scene, Load(start=options["load_start"], path=options["load_path"]), Steps(**sizes))
    needed = {run.name for number in range(2, 8) for run in __import__(f"figure{number}").NEEDED}
    assert needed <= set(found)
    for number in range(2, 8):
        for run in __import__(f"figure{number}").NEEDED:
            assert run == found[run.name]


def test_functions_are_called_in_processes_that_hold_what_this_one_does():
    import os

    from forked import called

    held = object()  # which no process could be sent
    found = list(called([lambda number=number: (number, os.getpid(), id(held))
                         for number in range(6)], 2))
    assert [number for number, _, _ in found] == list(range(6))
    assert {there for _, _, there in found} == {id(held)}
    assert os.getpid() not in {process for _, process, _ in found}


def test_archives_read_in_several_processes_are_read_once_and_the_same(results, monkeypatch):
    import runs

    names = ["half-t1-w0.8", "full-t1-w0.8", "missing"]
    again = runs.Results(results.folder)
    again.read_all(names, 2)
    monkeypatch.setattr(runs, "open_archive", None)
    for name in names[:2]:
        assert list(again[name]) == list(results[name])
        for column in again[name]:
            np.testing.assert_array_equal(again[name][column], results[name][column])
    assert "missing" not in again
    again.read_all(names, 2)


def test_power_law_finds_its_exponent():
    from observed import power_law

    forces = np.linspace(0, 3, 40)
    fit = power_law(forces, 12.0 - 0.05 * forces ** 1.9)
    assert fit.exponent == pytest.approx(1.9, abs=1e-6) and fit.interval < 1e-5
    assert fit(2.0) == pytest.approx(12.0 - 0.05 * 2.0 ** 1.9)
    with pytest.raises(ValueError, match="four points"):
        power_law(forces[:4], 12.0 - forces[:4] ** 2)


def test_width_below_a_threshold_is_interpolated():
    from observed import width_below

    x = np.linspace(-2, 2, 257)
    assert width_below(x, x ** 2, 1.3) == pytest.approx(2 * np.sqrt(1.3), rel=1e-4)
    assert width_below(x, x ** 2, -1.0) == 0.0


def test_onset_of_sliding_with_and_without_a_fold(results):
    from observed import onset, peel

    half, full = (results[f"{law}-t1-w0.8"] for law in ("half", "full"))
    assert half.complete and full.complete
    begun = onset(half)
    assert begun.unstable and half["event"][begun.point] == "fold"
    assert half["tangential_force"][-1] < 0.8 * begun.force
    # Nothing carries more than the peak of the law over the contact.
    assert begun.force < reference.peak_tangential_traction(1.0) * half["contact_area"][0]
    forces, areas = peel(half)
    assert forces[0] == 0 and areas[0] == areas.max() and forces[-1] == begun.force
    assert onset(full).force >= begun.force


def test_profiles_end_at_the_edge(results):
    from observed import onset, profile, width_below

    record = results["half-t1-w0.8"]
    x, gap, slip, normal, tangential = profile(record, onset(record).point)
    assert width_below(x, gap, np.e) == pytest.approx(record["contact_area"][onset(record).point],
                                                      rel=2e-3)
    assert np.max(tangential) == pytest.approx(record["maximum_tangential_traction"][onset(
        record).point])
    largest = record["maximum_tangential_gap"][onset(record).point]
    right = x >= 0.0
    assert np.interp(np.e, gap[right], np.abs(slip)[right]) == pytest.approx(largest, rel=2e-3)
    assert np.sum(-normal) * (x[1] - x[0]) * 2.0 == pytest.approx(
        record["normal_force"][onset(record).point], rel=1e-6)


def test_figure_without_runs_is_drawn(tmp_path):
    import figure2
    import style

    style.save(figure2.draw(None), "figure2", tmp_path, tmp_path)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".pdf", ".png"]


def test_a_figure_whose_run_is_missing_or_too_short_says_which(results, monkeypatch):
    import errors
    import figure7
    import runs
    import statement

    figure, why = statement.evaluated(figure7.draw, results)
    assert (figure is None and why.startswith("the run mcgarry-t0.1-w")
            and why.endswith("is missing"))
    # A run that stopped beside its fold has no onset.
    log = results.path("half-t1-w0.8").with_suffix(".log")
    log.write_text(log.read_text() + "contactsnes: SNES DIVERGED_DTOL\nexit status 1\n")
    monkeypatch.setattr(figure7, "onset", lambda record: None)
    _, why = statement.evaluated(lambda results: figure7.onset(results["half-t1-w0.8"]).force,
                                 results)
    assert why == "the run half-t1-w0.8 is too short: SNES DIVERGED_DTOL"
    assert errors.movement(why, figure7.draw, runs.Finer(results))[0] == f"not known: {why}"
    told, _ = errors.movement(figure7, figure7.draw, runs.Finer(results))
    assert told.startswith("not known: the run mcgarry-t0.1-w") and told.endswith("is missing")
    with pytest.raises(TypeError, match="int"):
        statement.evaluated(lambda results: len(3), results)


def test_statements_without_runs_are_open_or_analytic(modules, tmp_path):
    import pages
    import runs
    import statement
    import statements_more

    empty = runs.Results(tmp_path / "empty")
    rows = [statement.row(one, empty, runs.Finer(empty)) for one in statement.in_order()]
    assert len(rows) == len(statement.ALL) > 20
    closed = [row for row in rows if row.verdict != "open"]
    words = [row for row in closed if "confirmed" not in row.verdict]
    assert len(closed) == 6 and len(words) == 2
    assert words == [statements_more.misprints(empty), statements_more.experiments(empty)]
    assert len(pages.statement_table(rows)) == len(rows) + 2


def test_runs_on_twice_the_points_tell_the_errors_of_the_grid(results):
    import runs
    from observed import onset
    from statement import Number, told

    run = runs.sheared("half", 1, 0.8, fields="all", points=512, normal_maugis=2.0, period=60.0)
    again = results.finer(run)
    assert (again.options["scene_points"] == 1024 and again.options["continuation_stability"]
            == "off")
    assert {name for name in run.options if run.options[name] != again.options[name]} == {
        "scene_points", "continuation_stability"}
    results.make_all([again], 1, lambda line: None)
    finer = runs.Finer(results)
    assert run.name in finer and "full-t1-w0.8" not in finer
    forces = [onset(one[run.name]).force for one in (results, finer)]
    assert 0 < abs(forces[0] - forces[1]) < 1e-3 * forces[1]
    text = told([Number("onset", forces[0])], [Number("onset", forces[1])])
    assert (text.startswith("onset: ")
            and float(text.split(" ± ")[1]) == pytest.approx(abs(forces[0] - forces[1]), rel=0.5))
    assert runs.Finer(results, [run.name])[run.name] is results[run.name]


@pytest.mark.parametrize("value, error, unit, text", [(12.5905123, 2e-5, "", "12.5905 ± 2e-5"),
                                                      (0.027, 1e-4, "%", "2.70 ± 0.01 %"),
                                                      (2.2, 0.01, "", "2.20 ± 0.01"),
                                                      (303, 0.0, "", "303"),
                                                      (0.0001, 0.003, "", "0.0001 ± 0.003"),
                                                      (4116.3, 12.0, "", "4116 ± 1e+01"),
                                                      (1 / 3, 0.0, "%", "33.33 %"),
                                                      (0.0, 0.0, "", "0")])
def test_numbers_have_the_digits_their_errors_leave(value, error, unit, text):
    from statement import with_error

    assert with_error(value, error, unit) == text


def test_a_point_at_a_fold_is_told_from_one_whose_mode_was_not_found():
    import pages

    record = {"event": np.array(["none", "fold", "gross_sliding", "none", "none", "none"]),
              "tangential_displacement": np.array([50.0, 100.0, 100.0, 100.00005, 90.0, 70.0]),
              "stable": np.array([1, 0, 0, 0, 0, 0]),
              "unstable_modes": np.array([0, 0, 0, 0, 0, 1])}
    assert list(pages.kinds(record)) == ["stable", "fold", "beside", "beside", "unknown",
                                         "unstable"]


def test_profiles_of_a_fast_front_are_at_displacements_that_finer_runs_have_too():
    import runs

    run = runs.sheared("half", 10, 25, fields="all")
    ends = [float(leg.rpartition("=")[2]) for leg in run.options["load_path"].split(";")[1:]]
    assert ends == sorted(ends) and set(runs.PROFILED["half", 10, 25]) < set(ends)
    assert len(run.options["continuation_largest_step"].split(",")) == len(ends) + 1
    assert not set(runs.PROFILED["half", 10, 25]) & {
        float(leg.rpartition("=")[2])
        for leg in runs.sheared("half", 10, 25).options["load_path"].split(";")}


def test_numbers_without_an_error_say_so():
    from statement import Number, told

    assert told([Number("a", 1.0)]) == "a: 1 ± ?"
    assert told([Number("a", 1.0, exact=True)]) == "a: 1"
    assert told([("W = 1", [Number("", 1.0, spread=0.1)])],
                [("W = 1", [Number("", 1.3)])]) == "W = 1: 1.0 ± 0.3"


def test_movement_of_a_drawing_is_measured_in_points():
    from errors import distance, drawn_distance
    from style import panels

    def drawing(shift):
        figure, ((axes,),) = panels(1, 1)
        x = np.linspace(0, 1, 50)
        axes.plot(x, x ** 2 + shift)
        axes.plot(0.5, 0.25, "o", markersize=4)
        axes.axhline(0.1)
        axes.set(xlim=(0, 1), ylim=(0, 1))
        return figure

    figure = drawing(0.0)
    figure.draw_without_rendering()
    moved, width = drawn_distance(figure, drawing(0.01))
    height = figure.axes[0].get_window_extent().height * 72 / figure.dpi
    assert 0.3 * 0.01 * height < moved <= 1.001 * 0.01 * height and width == 1.2
    assert drawn_distance(figure, drawing(0.0))[0] < 1e-9
    assert distance(np.array([[0.0, 1.0]]), np.array([[-1.0, 0.0], [1.0, 0.0]])) == 1.0
    with pytest.raises(ValueError, match="different curves"):
        drawn_distance(figure, panels(1, 1)[0])
