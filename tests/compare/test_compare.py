"""Methods compared: counts, errors, failures, other branches, files, figure, exit statuses; and
PETSc's database in between."""

import csv
import errno
import signal
from pathlib import Path

import matplotlib
import numpy as np
import petsc4py
import processes
import pytest
from programs import load

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.branch.first_points import cold  # noqa: E402
from contactsnes.commands import cli
from contactsnes.compare import comparison as compare
from contactsnes.compare import figure as comparison_figure
from contactsnes.compare import methods
from contactsnes.compare import table as comparison_table
from contactsnes.compare.methods import CompareOptions, Method  # noqa: E402
from contactsnes.compare.recorder import History  # noqa: E402
from contactsnes.grid.counter import Counter
from contactsnes.options import database as options
from contactsnes.output import tables  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Scene, Steps  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
OPTIONS = ROOT / "options"
SCRIPT = ROOT / "scripts" / "compare"
SMALL = {"points": 256, "period": 24.0, "normal_maugis": 2.0, "height": 250.0,
         "residual_friction": 0.5}
ROUGH = {"dimension": 2, "points": 32, "period": 12.0, "normal_maugis": 1.0, "geometry": "rough",
         "rough_on": "flat", "rough_hurst": 0.8, "rough_longest": 6.0, "rough_shortest": 1.5,
         "rough_slope": 1.0}
PATH = "normal_displacement=1; normal_displacement=hold, tangential_displacement=12"
STEPS = {"initial_step": (0.5, 6.0), "largest_step": (0.5, 6.0)}

NEWTON = Method("newton", {})
WHOLE = Method("newton (whole cell)", {"contact_window": "off"})
FIRE = Method("fire", {"contact_form": "force", "snes_type": "python",
                       "snes_python_type": "contactsnes.solvers.relaxation.Fire",
                       "snes_max_it": "100000"})
FORCE = Method("newton in force form", {"contact_form": "force"})
HASTY = Method("hasty", {"snes_max_it": "1"})
UNKNOWN = Method("unknown", {"snes_type": "lou"})
MISFIT = Method("misfit", {name: value for name, value in FIRE.entries.items()
                           if name != "contact_form"})


pytestmark = pytest.mark.usefixtures("kept_options")


def compared(*several, path=PATH, start="normal_displacement=0", saved=lambda: None, scene=SMALL,
             **settings):
    """A comparison that has been run, and the sentences of its log."""
    said = []
    branch = Branch(Scene(**scene), Load(start=start, path=path),
                    Steps(**(STEPS if path == PATH else {})))
    comparison = compare.Comparison("small", branch, list(several), options.database(),
                                    CompareOptions(**{"repeats": 1, **settings}), said.append)
    comparison.run(lambda: saved() if saved.__code__.co_argcount == 0 else saved(comparison))
    return comparison, said


@pytest.fixture(scope="module")
def plain():
    """A comparison of methods that all find the whole path."""
    before = options.database()
    comparison, _ = compared(NEWTON, WHOLE, FIRE, FORCE, repeats=3)
    options.install(before)
    return comparison


def outcomes(comparison, method):
    return [result.outcome for result in comparison.results[method.name]]


# What is measured


def test_every_method_gets_every_point(plain):
    assert [len(places) for places in plain.stages()] == [1, 2, 2] and len(plain.targets) == 5
    for method in plain.methods:
        assert outcomes(plain, method) == ["converged"] * 5 and plain.finished(method)


def test_reference_is_solved_to_rounding(plain):
    assert max(target.point.residual_norm for target in plain.targets) < 1e-12
    assert [target.point.load[0] for target in plain.targets] == [0, 0.5, 1, 1, 1]
    assert [target.point.load[-1] for target in plain.targets[3:]] == [6, 12]


def test_errors_are_true_and_small(plain):
    for results in plain.results.values():
        for result in results:
            assert result.residual_norm <= 1e-8
            # a solve may hit the reference's digits; an error of zero everywhere would be no
            # measurement
            assert all(0.0 <= error < 1e-6 for error in result.errors)
        assert max(result.errors[0] for result in results) > 1e-13


def test_errors_follow_the_tolerance():
    def worst(tolerance):
        comparison, _ = compared(Method("newton", {"snes_atol": tolerance}),
                                 path="normal_displacement=hold")
        return comparison.results["newton"][0]

    coarse, fine = worst("1e-2"), worst("1e-11")
    assert (coarse.outcome == fine.outcome == "converged"
            and fine.residual_norm < 1e-11 < coarse.residual_norm)
    assert coarse.errors[0] > 1e4 * fine.errors[0]


def test_methods_that_stop_elsewhere_are_told_of():
    loose = Method("loose", {"snes_atol": "1e-3"})
    _, said = compared(NEWTON, loose, path="normal_displacement=hold")
    assert "terms are not equal: newton stops at -snes_atol 1e-08, loose at 0.001" in said
    assert not any("not equal" in sentence
                   for sentence in compared(NEWTON, WHOLE, path="normal_displacement=hold")[1])


def test_counts(plain):
    """Where relations between counts are known, they hold: products and residuals cost what the
    forms say."""
    for result, target in zip(plain.results["fire"], plain.targets):
        counts, components = result.counts, len(target.point.load)
        assert counts["jacobian_products"] == counts["linear_iterations"] == 0
        assert counts["function_evaluations"] >= counts["nonlinear_iterations"] > 10
        assert counts["transforms"] == pytest.approx(2 * components
                                                     * counts["function_evaluations"],
                                                     abs=16 * components)
    for result in plain.results["newton"]:
        counts = result.counts
        assert (0 < counts["nonlinear_iterations"] <= counts["linear_iterations"]
                <= counts["jacobian_products"])
    for small, large in zip(plain.results["newton"], plain.results["newton (whole cell)"]):
        assert large.counts["transforms"] >= small.counts["transforms"] * 0.999


def test_times_are_taken_in_every_pass(plain):
    assert plain.passes == 3
    assert all(len(result.times) == 3 and min(result.times) > 0
               for results in plain.results.values() for result in results)


def test_starts_are_the_same_for_all():
    """The solve from the reference's prediction with the reference's own method needs what a run's
    step needs."""
    comparison, _ = compared(NEWTON)
    branch = Branch(Scene(**SMALL), Load(path=PATH), Steps(**STEPS))
    ran = [point.spent["nonlinear_iterations"] for point in branch]
    counted = [result.counts["nonlinear_iterations"] for result in comparison.results["newton"]]
    assert len(ran) == len(counted) and all(abs(first - second) <= 1
                                            for first, second in zip(ran, counted))


def test_histories_are_those_of_solves(plain):
    assert [plain.targets[place].stage for place in plain.watched] == [0, 1, 2]
    for method in plain.methods:
        for place in plain.watched:
            result = plain.results[method.name][place]
            transforms, seconds, norms = result.history().T
            assert (np.diff(transforms) >= 0).all() and (np.diff(seconds) >= 0).all()
            assert transforms[-1] <= result.counts["transforms"] * 1.001
            # a cold start iterates on coarser grids, too
            assert len(norms) > (result.counts["nonlinear_iterations"]
                                 if plain.targets[place].stage else 1)
            # what relaxation reports is an upper bound; the last norm passed the test
            assert result.residual_norm * 0.99 <= norms[-1] <= 1e-8


@pytest.mark.parametrize("scene", [SMALL, ROUGH])
def test_force_form_records_the_norm_of_its_own_test(scene):
    """PETSc's norm of the force form is another number than the imbalance of displacements."""
    comparison, _ = compared(FORCE, path="normal_displacement=hold", scene=scene)
    result = comparison.results[FORCE.name][0]
    # An upper bound that is told without a transform: not below the true norm, and what the solve
    # was stopped by.
    assert 0.99 * result.residual_norm <= result.history()[-1, 2] <= 1e-8


# Failures


def test_failures_are_told_with_reason_and_load():
    comparison, said = compared(NEWTON, HASTY, UNKNOWN, MISFIT)
    assert comparison.finished(NEWTON)
    for method, words in ((HASTY, "DIVERGED_MAX_IT"), (UNKNOWN, "lou"),
                          (MISFIT, "-contact_form force")):
        assert not comparison.finished(method)
        assert (comparison.results[method.name][0].outcome == "failed"
                and words in comparison.results[method.name][0].reason)
        line, = (sentence for sentence in said if sentence.startswith(method.name + ":"))
        assert "first at normal_displacement 0" in line and words in line
    text = "\n".join(comparison_table.lines(comparison))
    assert "1 of 4 methods finished the path: newton" in text and "DIVERGED_MAX_IT" in text


def test_a_method_is_given_up_after_some_failures():
    comparison, _ = compared(NEWTON, UNKNOWN, failures=2)
    assert outcomes(comparison, UNKNOWN) == ["failed"] * 2 + ["not tried"] * 3
    row = next(row for row in comparison_table.rows(comparison) if row["method"] == "unknown"
               and row["stage"].startswith("leg 1"))
    assert (row["points"], row["found"], row["failed"]) == (2, 0, 1)


def test_nothing_goes_on_for_ever():
    slow = Method("slow", {**FIRE.entries, "snes_fire_time_step": "1e-6",
                           "snes_fire_largest_time_step": "1e-6"})
    comparison, _ = compared(NEWTON, slow, transforms=300, failures=1)
    first = comparison.results["slow"][0]
    assert first.reason == "more than 300 transforms" and 300 < first.counts["transforms"] < 310
    assert comparison.finished(NEWTON)


def test_a_failure_leaves_the_next_methods_as_they_are():
    alone, _ = compared(NEWTON)
    among, _ = compared(UNKNOWN, MISFIT, HASTY, NEWTON, transforms=100)
    # Transforms are differences of what was counted from the beginning.
    assert [result.counts for result in alone.results["newton"]] == [pytest.approx(result.counts,
                                                                                   rel=1e-9)
                                                                     for result in among.results[
        "newton"]]


def test_interruption_is_no_failure(monkeypatch):
    def interrupted(self, *arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(compare, "cold", interrupted)
    with pytest.raises(KeyboardInterrupt):
        compared(NEWTON)


def test_path_without_an_end():
    """Beyond pull-off there is no equilibrium: the points before it are compared, and no method has
    finished."""
    comparison, said = compared(NEWTON, path="normal_force=-5")
    assert "no equilibrium" in comparison.path_failure and len(comparison.targets) > 3
    assert set(outcomes(comparison, NEWTON)) == {"converged"} and not comparison.finished(NEWTON)
    assert ("no equilibrium" in said[0]
            and "The path has no end" in "\n".join(comparison_table.lines(comparison)))


def test_scene_without_a_solution(tmp_path):
    comparison, said = compared(NEWTON, FIRE, start="normal_force=-50", path="normal_force=hold")
    assert not comparison.targets and "0 points" in said[0] and not comparison.finished(NEWTON)
    comparison_table.save(comparison, tmp_path / "none", {})
    text = "\n".join(comparison_table.lines(comparison))
    assert ("0 of 2 methods finished" in text and "The path has no end" in text
            and (tmp_path / "none.csv").exists())


def test_a_reference_that_is_not_stable_is_told():
    """Under a force that falls where the displacement has passed the largest one."""
    _, said = compared(NEWTON, start="normal_displacement=-2.5", path="normal_force=-0.25")
    assert any("are not stable" in sentence for sentence in said)
    _, said = compared(NEWTON, start="normal_displacement=0", path="normal_force=-0.7")
    assert not any("are not stable" in sentence for sentence in said)


# Another branch


def test_another_branch_is_marked(monkeypatch):
    """Near jump-in the body may or may not be in contact; a solve from the one state counts nothing
    for the other."""
    scene = {**SMALL, "points": 1024, "normal_maugis": 5.0}
    apart, _ = compared(NEWTON, path="normal_displacement=hold", start="normal_displacement=-2",
                        scene=scene)
    target = apart.targets[0]
    assert not target.point.in_contact
    branch = Branch(Scene(**scene), Load(path="normal_displacement=-2"))
    *_, touching = branch
    assert touching.in_contact and touching.load[0] == target.point.load[0]

    def elsewhere(self, controls, load):
        return (self.solve(touching.state, controls, load) if self.settings.window == "off"
                else cold(self, controls, load))

    monkeypatch.setattr(compare, "cold", elsewhere)
    both, said = compared(NEWTON, WHOLE, path="normal_displacement=hold",
                          start="normal_displacement=-2", scene=scene)
    assert outcomes(both, NEWTON) == ["converged"] and outcomes(both, WHOLE) == ["another branch"]
    row = comparison_table.rows(both)[1]
    assert (row["elsewhere"] == 1 and row["found"] == 0 and np.isnan(row["transforms"])
            and row["reason"] == "another branch")
    assert any("another branch" in sentence for sentence in said)


# Times


def test_a_slow_method_is_timed_once():
    """Its times are those of its first pass, and the others' passes go on."""
    comparison, _ = compared(NEWTON, FIRE, repeats=3, seconds=0.0)
    for method in (NEWTON, FIRE):
        results = comparison.results[method.name]
        assert all(result.times == [result.first] and len(result.histories) <= 1
                   for result in results)
    row = comparison_table.rows(comparison)[1]
    assert row["time"] == row["time_low"] == row["time_high"] > 0.0 and row["time_ratio"] > 0.0


# Ratios


def test_ratios_are_over_points_that_both_found(plain):
    for row in comparison_table.rows(plain):
        if row["method"] == "newton":
            assert row["transforms_ratio"] == row["time_ratio"] == row["time_ratio_low"] == 1.0
        assert (row["time_low"] <= row["time"] <= row["time_high"]
                and row["time_ratio_low"] <= row["time_ratio"])
    steps = [row for row in comparison_table.rows(plain) if row["stage"].startswith("leg 1")]
    total = [sum(plain.results[row["method"]][place].counts["transforms"] for place in (1, 2))
             for row in steps]
    np.testing.assert_allclose([row["transforms_ratio"] for row in steps],
                               np.array(total) / total[0])
    np.testing.assert_allclose([row["transforms"] for row in steps], np.array(total) / 2)


# Files


def test_table_is_the_same_everywhere(plain, tmp_path):
    comparison_table.save(plain, tmp_path / "small", {"options": "-x"})
    rows = comparison_table.rows(plain)
    with open(tmp_path / "small.csv", newline="", encoding="utf-8") as file:
        written = list(csv.DictReader(file))
    attributes, content = tables.read_hdf5(tmp_path / "small.h5")
    assert (len(rows) == len(written) == 3 * len(plain.methods) and attributes["options"] == "-x"
            and attributes["base"] == "newton")
    for name in comparison_table.COLUMNS:
        kept = content["table"][name]
        for row, line, value in zip(rows, written, kept):
            same = row[name] == value or np.isnan(row[name]) and np.isnan(value)
            assert same and (line[name] == row[name] if isinstance(value, str)
                             else float(line[name]) == pytest.approx(value, nan_ok=True))
    text = comparison_table.lines(plain)
    for row in rows:
        assert any(row["method"] in line and f"{row['transforms']:.1f}" in line
                   and f"{1e3 * row['time']:.2f}" in line for line in text)
    assert (content["results"]["outcome"].shape == (4, 5) and content["results"]["time"].shape
            == (4, 5, 3))
    assert (list(content["points"]["stage"]) == [0, 1, 1, 2, 2] and list(content["methods"]["name"])
            == list(plain.results))


def test_what_was_measured_is_kept_as_it_comes(tmp_path):
    found = []

    def saved(comparison):
        comparison_table.save(comparison, tmp_path / "part", {})
        _, content = tables.read_hdf5(tmp_path / "part.h5")
        found.append((content["results"]["outcome"] != "not tried").sum())

    compared(NEWTON, FIRE, saved=saved)
    assert found[:2] == [5, 10] and not list(tmp_path.glob("*.partial"))


def test_figure(plain, tmp_path, monkeypatch):
    monkeypatch.setitem(comparison_figure.PRINTED, "savefig.dpi", 70)  # of 200
    comparison_table.save(plain, tmp_path / "small", {})
    failed, _ = compared(NEWTON, HASTY)
    comparison_table.save(failed, tmp_path / "failed", {})
    written = comparison_figure.plot_comparison([tmp_path / "small.h5", tmp_path / "failed.h5"],
                                                tmp_path / "both.png")
    pixels = matplotlib.image.imread(written)
    assert pixels.shape[0] > pixels.shape[1] > 350 and pixels[..., :3].std() > 0.05


def test_long_names_fit_into_the_figure(tmp_path):
    several = [Method(f"a-method-with-quite-a-long-name-{number}", {}) for number in range(12)]
    comparison, _ = compared(NEWTON, *several, path="normal_displacement=hold")
    comparison_table.save(comparison, tmp_path / "long", {})
    pixels = matplotlib.image.imread(comparison_figure.plot_comparison([tmp_path / "long.h5"],
                                                                       tmp_path / "long.png"))
    assert pixels[:, :4, :3].min() > 0.9 and pixels[:, -4:, :3].min() > 0.9


@pytest.mark.parametrize("times", [(4.1e-3, 6.3e-3), (2.2e-3, 8e-3), (0.11, 0.8), (3.1e-4, 4e-4)])
def test_costs_within_a_power_of_ten_have_numbers_at_their_axis(times):
    """And methods that cost the same are seen both, the thin curve on the thick one."""
    history = np.transpose([(20.0, 30.0), times, (1e-3, 1e-9)])
    record = {"name": "small", "histories": {"0": {"0": history, "1": history, "title": "step"}},
              "methods": {"name": ["newton", "other"], "family": ["Newton", "Newton"]},
              "results": {"outcome": np.array([["converged"], ["converged"]])}}
    figure = matplotlib.figure.Figure()
    panels = figure.subplots(1, 2)
    comparison_figure._draw_row(panels, record, "0", comparison_figure._styles([record], None))
    figure.draw_without_rendering()
    for axes in panels:
        low, high = axes.get_xlim()
        ticks = [*axes.xaxis.get_major_ticks(), *axes.xaxis.get_minor_ticks()]
        assert any(tick.label1.get_text() and low <= tick.get_loc() <= high for tick in ticks)
        thick, thin = sorted(axes.lines, key=lambda line: -line.get_linewidth())
        assert thick.get_zorder() < thin.get_zorder()


def test_failed_replacement_leaves_a_file(tmp_path):
    path = tmp_path / "kept.h5"
    tables.write_hdf5(path, {"a": 1}, {"x": ([1.0, 2.0], "s"), "words": ["one", "zwölf", ""]})
    before = path.read_bytes()
    with pytest.raises(TypeError):
        tables.write_hdf5(path, {}, {"x": object()})
    assert path.read_bytes() == before and [file.name for file in tmp_path.iterdir()] == ["kept.h5"]
    attributes, content = tables.read_hdf5(path)
    assert (attributes == {"a": 1} and content["x"].tolist() == [1, 2]
            and content["words"].tolist() == ["one", "zwölf", ""])


# Methods and the database


def test_files_of_methods(tmp_path, monkeypatch):
    names = [path.stem for path in methods.files_at_hand()]
    assert names[0] == "newton" and {"fire", "verlet"} <= set(names) and not {"cylinder",
                                                                              "sphere"} & set(names)
    (tmp_path / "options").mkdir()
    (tmp_path / "options" / "own.opts").write_text("-snes_type qn\n")
    (tmp_path / "options" / "scene.opts").write_text("-scene_points 64\n")
    monkeypatch.chdir(tmp_path)
    assert methods.files_at_hand() == [Path("options/own.opts")]


def test_options_of_files_and_command_line(tmp_path):
    (tmp_path / "one.opts").write_text('-prefix_push npc_\n-snes_type '
                                       'qn\n-prefix_pop\n-SNES_Type '
                                       'anderson\n-snes_monitor\n-pc_x "a b"\n')
    found = methods.entries(options.read_file(tmp_path / "one.opts"))
    assert found == {"npc_snes_type": "qn", "snes_type": "anderson", "snes_monitor": "",
                     "pc_x": "a b"}
    made = methods.read_methods([tmp_path / "one.opts", OPTIONS / "newton.opts"],
                                {"snes_type": "ncg"})
    assert [method.name for method in made] == ["one", "newton", "newton (whole cell)"]
    assert all(method.entries["snes_type"] == "ncg"
               for method in made) and made[2].entries["contact_window"] == "off"
    assert len(methods.read_methods([OPTIONS / "newton.opts"], {"contact_window": "auto"})) == 1


@pytest.mark.parametrize("entries, family", [({}, "Newton"), ({"snes_type": "newtontr"}, "Newton"),
                                             ({"contact_first": "relaxation"},
                                              "Newton after relaxation"),
                                             (FIRE.entries, "dynamic relaxation"),
                                             ({"snes_type": "fas"}, "multigrid"),
                                             ({"snes_type": "qn"}, "quasi-Newton"),
                                             ({"snes_type": "ngmres"}, "nonlinear Krylov"),
                                             ({"snes_type": "composite"}, "compositions"),
                                             ({"snes_type": "ms"}, "others")])
def test_families(entries, family):
    assert Method("any", entries).family == family


def test_database_is_switched_without_a_trace():
    before = options.database()
    options.install({**before, "snes_type": "qn", "snes_monitor": "",
                     "load_path": "normal_force=2; normal_force=3"})
    now = options.database()
    assert now == {**before, "snes_type": "qn", "snes_monitor": "",
                   "load_path": "normal_force=2; normal_force=3"}
    assert PETSc.Options().getBool("snes_monitor") is True
    options.install(before)
    assert options.database() == before


def test_meter_and_history():
    meter = Counter(64)
    history = History(meter)
    meter.add(3.5)
    meter.limit = 4.0
    with pytest.raises(RuntimeError):
        meter.add(1.0)
    assert meter.transforms == 4.5 and history.rows().shape == (0, 3)


# The command


def call(*arguments, folder):
    """A finished process of ``contactsnes compare``."""
    return processes.call("compare", *arguments, folder=folder)


@pytest.fixture
def scene(tmp_path):
    """A folder with the file of a small scene."""
    (tmp_path / "scene.opts").write_text("".join(f"-scene_{name} {value}\n"
                                                 for name, value in SMALL.items()) + '-load_path '
                                         '"normal_displacement=1"\n-continuation_initial_step 0.5\n'
                                         "-continuation_largest_step 0.5\n-compare_repeats 1\n")
    return tmp_path


def test_command(scene):
    (scene / "hasty.opts").write_text("-snes_max_it 1\n")
    done = call("scene.opts", OPTIONS / "newton.opts", "hasty.opts", OPTIONS / "fire.opts",
                "-snes_atol", "1e-7", folder=scene)
    assert done.returncode == 0 and not done.stderr, done.stdout + done.stderr
    assert ("3 of 4 methods finished the path: newton, newton (whole "
            "cell), fire" in done.stdout and "DIVERGED_MAX_IT" in done.stdout)
    assert {"comparison-scene.csv", "comparison-scene.h5",
            "comparison-scene.png"} <= {path.name for path in scene.iterdir()}
    _, content = tables.read_hdf5(scene / "comparison-scene.h5")
    assert all("-snes_atol 1e-7" in text for text in content["methods"]["options"])
    again = call("scene.opts", "hasty.opts", folder=scene)
    assert (again.returncode == 2 and "comparison-scene.csv exists" in again.stderr
            and "-compare_overwrite" in again.stderr)


def test_an_interrupted_command_says_where_its_numbers_are(scene, monkeypatch, capsys):
    follow, passes = compare.Comparison._follow, []

    def interrupted(self, *arguments, **how):
        passes.append(self)
        if len(passes) == 3:
            raise KeyboardInterrupt(signal.SIGTERM)
        return follow(self, *arguments, **how)

    monkeypatch.setattr(compare.Comparison, "_follow", interrupted)
    monkeypatch.chdir(scene)
    words = ["compare", "scene.opts", str(OPTIONS / "newton.opts"), str(OPTIONS / "fire.opts")]
    assert cli.main(words) == 128 + signal.SIGTERM
    assert "what was measured is in comparison-scene.csv" in capsys.readouterr().err
    _, content = tables.read_hdf5(scene / "comparison-scene.h5")
    assert [set(line) for line in content["results"]["outcome"]] == [
        {"converged"}, {"converged"}, {"not tried"}]


def test_a_full_disk_loses_no_numbers(scene, monkeypatch, capsys):
    """What was measured was not shown where it could not be kept."""
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("contactsnes.compare.table.save", full)
    monkeypatch.chdir(scene)
    words = ["compare", "scene.opts", str(OPTIONS / "newton.opts"), str(OPTIONS / "fire.opts")]
    assert cli.main(words) == 1
    out, err = capsys.readouterr()
    assert "3 of 3 methods finished the path" in out and "comparison-scene.csv" not in out
    assert [line.split(": ")[1] for line in err.splitlines()] == ["warning", "error"]
    assert err.count("No space left on device") == 2


def test_files_of_variants_have_names_of_their_own():
    assert methods.variant("options/cylinder.opts", ["-snes_atol", "1e-7"]) == "cylinder"
    words = ["-scene_points", "256", "-load_path", "normal_force=2; normal_force=3"]
    name = methods.variant("cylinder.opts", words)
    assert name == "cylinder-load_path=normal_force=2_normal_force=3-scene_points=256"
    long = [methods.variant("cylinder.opts", [*words, "-scene_height", str(height), "-scene_period",
                                              "123456789.123"]) for height in (1, 2)]
    assert long[0] != long[1] and all(len(name) == methods.LONGEST for name in long)


def test_command_where_all_fail(scene):
    (scene / "options").mkdir()
    (scene / "options" / "hasty.opts").write_text("-snes_max_it 1\n")
    done = call("scene.opts", "-compare_file", "kept", "-ksp_rtoll", "1", folder=scene)
    assert (done.returncode == 1 and "0 of 1 methods finished" in done.stdout
            and "Traceback" not in done.stderr)
    assert "-ksp_rtoll was never used" in done.stderr and len(done.stderr.splitlines()) == 1
    assert (scene / "kept.csv").read_text().count("DIVERGED_MAX_IT") == 2


BAD = {"no scene": ([], ["no scene"]), "missing scene": (["absent.opts"], ["absent.opts"]),
       "method first": (["hasty.opts"], ["hasty.opts", "scene"]),
       "unknown method": (["scene.opts", "absent.opts"], ["absent.opts"]),
       "scene as method": (["scene.opts", "scene.opts"], ["scene.opts", "no method"]),
       "misspelt": (["scene.opts", "wrong.opts"], ["method wrong", "-contact_frm",
                                                   "-contact_form"]),
       "misspelt option": (["scene.opts", "hasty.opts", "-compare_repeat", "2"],
                           ["-compare_repeats"]),
       "bad value": (["scene.opts", "hasty.opts", "-compare_repeats", "0"],
                     ["-compare_repeats", "at least 1"]),
       "no folder": (["scene.opts", "hasty.opts", "-compare_file", "absent/x"],
                     ["absent", "-compare_file"]),
       "ending": (["scene.opts", "hasty.opts", "-compare_file", "kept.csv"],
                  ["-compare_file is 'kept.csv'", "without its ending"]),
       "no path": (["scene.opts", "hasty.opts", "-load_path", " "], ["-load_path"]),}


@pytest.mark.parametrize("arguments, words", BAD.values(), ids=BAD)
def test_bad_input(scene, arguments, words):
    (scene / "hasty.opts").write_text("-snes_max_it 1\n")
    (scene / "wrong.opts").write_text("-contact_frm force\n")
    done = call(*arguments, folder=scene)
    assert (done.returncode == 2 and done.stderr.startswith("contactsnes: error: ")
            and len(done.stderr.splitlines()) == 1), done.stderr
    assert all(word in done.stderr for word in words), done.stderr


def test_help(tmp_path):
    done = call("-help", folder=tmp_path)
    assert (done.returncode == 0 and "-compare_repeats" in done.stdout
            and "-snes_fire_time_step" in done.stdout)


# The script behind the page's figure


def test_script_reports_what_was_measured(tmp_path):
    plain = Method("verlet-plain",
                   {**FIRE.entries, "snes_python_type": "contactsnes.solvers.relaxation.Verlet",
                    "snes_verlet_masses": "equal"})
    comparison, _ = compared(NEWTON, FIRE, plain, HASTY)
    comparison_table.save(comparison, tmp_path / "small", {})
    text = load(SCRIPT).report({"small": tables.read_hdf5(tmp_path / "small.h5")[1]})
    lines = {line.split("|")[1].strip(): line for line in text.splitlines() if line.startswith("|")}
    rows = {row["method"]: row for row in comparison_table.rows(comparison)
            if row["stage"].startswith("leg 2")}
    assert (f"{rows['verlet-plain']['transforms']:.0f} / " in lines["verlet-plain"]
            and lines["hasty"].count("fails") == 3)
    assert f"{rows['verlet-plain']['transforms_ratio']:.3g} (verlet-plain)" in lines[
        "damped Verlet as in the paper, transforms"]
    best = min(rows["fire"]["transforms_ratio"], rows["verlet-plain"]["transforms_ratio"])
    assert f"{best:.3g} (" in lines["the best relaxation, transforms"]
    assert "- hasty: small, cold start, at normal displacement 0: SNES DIVERGED_MAX_IT" in text


def test_the_figure_shows_methods_that_there_are():
    names = {path.stem for path in OPTIONS.glob("*.opts")} | {"newton (whole cell)"}
    assert set(load(SCRIPT).SHOWN) <= names


def test_the_page_has_the_marks_of_the_script():
    module = load(SCRIPT)
    text = module.PAGE.read_text(encoding="utf-8")
    assert (text.count(module.BEGIN) == text.count(module.END) == 1
            and text.index(module.BEGIN) < text.index(module.END))
