"""Isolated contacts: against closed forms, against cells of growing period, their order in the
spacing, and what they refuse."""

import math
from dataclasses import replace

import h5py
import numpy as np
import processes
import pytest

import contactsnes
from contactsnes import reference
from contactsnes.branch.branch import Branch
from contactsnes.contact.isolated import OutOfBox, half_width, lay_out
from contactsnes.continuation.points import NoEquilibrium
from contactsnes.options.fields import InputError
from contactsnes.output.report import certificates
from contactsnes.scene.isolation import largest_force
from contactsnes.scene.load import Load
from contactsnes.scene.settings import Form, Scene, Steps

LINE = Scene(period=math.inf, height=math.inf, normal_maugis=5.0)
SPHERE = Scene(dimension=2, geometry="sphere", period=math.inf, height=math.inf, normal_maugis=2.0)


def still(force):
    return Load(start=f"normal_force={force}", path=f"normal_force={force}")


def followed(scene, load, **steps):
    """The branch, and its points up to where no equilibrium exists."""
    branch, points = Branch(scene, load, Steps(**steps)), []
    try:
        points.extend(branch)
    except NoEquilibrium:
        pass
    return branch, points


def numbers(scene, load):
    """What the last point tells."""
    branch = Branch(scene, load)
    return branch.observe(list(branch)[-1])


# Mechanics


def test_line_is_the_limit_of_growing_periods():
    alone, changes = numbers(replace(LINE, spacing=0.04), still(2)), []
    for points in (2048, 4096, 8192):
        cell = numbers(replace(LINE, period=0.04 * points, points=points), still(2))
        changes.append([cell[name] - alone[name] for name in ("contact_area", "minimum_gap",
                                                              "maximum_pressure")])
    # The images of a line act like a curvature that falls with the square of the period.
    assert np.divide(changes[0], changes[1]) == pytest.approx([4.0] * 3, rel=0.03)
    assert np.divide(changes[1], changes[2]) == pytest.approx([4.0] * 3, rel=0.03)
    period = 0.04 * 8192
    brittle = 2 * (reference.jkr_line_half_width(2.0, period) - reference.jkr_line_half_width(2.0))
    assert changes[2][0] == pytest.approx(brittle, rel=0.15)


def test_coupled_line_is_the_limit_of_growing_periods():
    scene = replace(LINE, poisson=0.3, spacing=0.05)
    load = Load(start="normal_force=2, tangential_force=0",
                path="normal_force=2, tangential_force=0.5")
    alone, changes = numbers(scene, load), []
    for points in (4096, 16384):
        cell = numbers(replace(scene, spacing=None, period=0.05 * points, points=points), load)
        changes.append([cell[name] - alone[name] for name in ("contact_area",
                                                              "maximum_tangential_gap")])
    # A force in a cell stretches all of it, by what falls with the period.
    assert np.divide(changes[0], changes[1]) == pytest.approx([4.0, 4.0], rel=0.1)


def test_layer_forgets_its_images():
    scene = replace(LINE, poisson=0.3, height=4.0, normal_maugis=4.0, spacing=0.05)
    load = Load(start="normal_force=2, tangential_force=0",
                path="normal_force=2, tangential_force=0.5")
    alone = numbers(scene, load)
    cell = numbers(replace(scene, spacing=None, period=102.4, points=2048), load)
    for name in ("normal_displacement", "tangential_displacement", "contact_area", "minimum_gap",
                 "maximum_tangential_gap"):
        assert cell[name] == pytest.approx(alone[name], rel=1e-7)


def test_sphere_is_the_limit_of_growing_periods():
    alone, changes = numbers(replace(SPHERE, spacing=0.25), still(3)), []
    for points in (96, 192):
        cell = numbers(replace(SPHERE, period=0.25 * points, points=points), still(3))
        changes.append(cell["contact_area"] - alone["contact_area"])
    assert changes[0] / changes[1] == pytest.approx(8.0, rel=0.1)


def test_error_falls_faster_than_any_power_of_the_spacing():
    scene = replace(LINE, height=30.0, normal_maugis=3.0, tangential="off")
    values = [numbers(replace(scene, spacing=spacing), still(2))["normal_displacement"]
              for spacing in (0.03, 0.06, 0.12, 0.24)]
    fine, middle, coarse = np.abs(np.array(values[1:]) - values[0])
    assert fine < 1e-7 and math.log2(coarse / middle) > 6 and math.log2(middle / fine) > 9


def test_pressed_sphere_is_that_of_maugis_and_dugdale():
    found = numbers(replace(SPHERE, normal_maugis=3.0), still(50))
    inner, outer, approach = reference.maugis_sphere(50.0, 3.0 / math.e)
    assert found["normal_displacement"] == found["approach"] == pytest.approx(approach, rel=0.01)
    assert inner < math.sqrt(found["contact_area"] / math.pi) < 1.02 * outer
    assert found["normal_force"] == 50.0


@pytest.mark.parametrize("maugis, pull_off", [(0.05, 2.0), (2.0, None)])
def test_pull_off_of_a_sphere(maugis, pull_off):
    branch, points = followed(replace(SPHERE, normal_maugis=maugis),
                              Load(start="normal_force=1", path="normal_force=-7"), at_fold="stop")
    force = branch.observe(points[-1])["normal_force"] / math.pi
    expected = -pull_off if pull_off else reference.maugis_sphere_pull_off(
        maugis / math.e)[0] / math.pi
    assert points[-1].event == "fold" and points[-1].fold_kind == "pull_off"
    assert force == pytest.approx(expected, rel=0.002 if pull_off else 0.05) and -2.0 < force < -1.5


def test_line_pull_off_is_that_of_johnson_kendall_and_roberts():
    branch, points = followed(replace(LINE, normal_maugis=6.0),
                              Load(start="normal_force=0.5", path="normal_force=-3"))
    assert points[-1].event == "fold"
    assert points[-1].forces[0] == pytest.approx(reference.jkr_line_pull_off()[1], rel=0.01)


# Paths


def test_path_without_a_force_begins_far_away_and_jumps_in():
    branch, points = followed(LINE, Load(path="normal_force=0.5; normal_force=-3"))
    first, fold, jumped = points[:3]
    assert not first.in_contact and branch.observe(first)["minimum_gap"] * 5.0 > 37
    assert (fold.event, fold.fold_kind, jumped.event) == ("fold", "jump_in", "jump")
    assert jumped.in_contact and jumped.forces[0] == 0.0
    direct, points = followed(LINE, Load(start="normal_force=0.5", path="normal_force=0"))
    assert branch.observe(jumped)["contact_area"] == pytest.approx(
        direct.observe(points[-1])["contact_area"], rel=1e-6)


def test_displacement_of_a_half_plane_is_none_and_of_all_others_a_number():
    assert (np.isnan(numbers(LINE, still(1))["normal_displacement"])
            and np.isnan(numbers(LINE, still(1))["approach"]))
    assert np.isfinite(numbers(replace(LINE, height=50.0), still(1))["normal_displacement"])
    assert numbers(replace(SPHERE, spacing=0.25), still(1))["normal_displacement"] > 0


@pytest.mark.parametrize("path, start", [("normal_force=1; normal_force=-0.2", "normal_force=0.5"),
                                         ("tangential_force=1", "normal_force=1")])
def test_what_has_no_displacement_does_not_go_against_its_force(path, start):
    """Points of a half-plane counted as unstable where nobody asks, though certificates call them
    stable."""
    said, scene = [], Scene(period=math.inf, height=math.inf, normal_maugis=2.0, spacing=0.2,
                            tangential_maugis=0.5)
    points = {stability: list(Branch(scene, Load(start=start, path=path),
                                     Steps(stability=stability), log=said.append))
              for stability in ("off", "sign")}
    assert {point.stable for point in points["off"]} == {-1}
    assert {point.stable for point in points["sign"]} == {1}
    assert not any("unstable" in sentence or "goes against" in sentence for sentence in said)


def test_what_is_missing_in_the_energies_of_a_half_plane_is_told_of_the_work_on_the_interface(
        tmp_path):
    """That of its loads is not known: of "at most 0" energies some were missing always."""
    run = ["run", "-scene_period", "inf", "-scene_height", "inf", "-scene_normal_maugis", "2",
           "-scene_spacing", "0.2", "-load_start", "normal_force=0.5", "-archive_file",
           str(tmp_path / "run.h5"), "-load_path", "normal_force=1"]
    done = processes.call(*run, folder=tmp_path)
    assert done.returncode == 0 and "is missing in the balance" not in done.stdout
    record = contactsnes.read(tmp_path / "run.h5")
    told = dict(row[:2] for row in certificates.rows(record))["missing in the balance of energies"]
    largest = np.abs(record["interface_work"]).max()
    assert float(told.split()[2]) == pytest.approx(largest, rel=1e-2) and largest > 0.0


def test_offset_of_the_gap_is_one_of_the_approach():
    scene = replace(LINE, height=30.0, spacing=0.1)
    near, far = (numbers(replace(scene, gap_offset=offset), still(1)) for offset in (0.0, 1.5))
    assert far["normal_displacement"] - near["normal_displacement"] == pytest.approx(1.5, abs=1e-7)
    assert far["contact_area"] == pytest.approx(near["contact_area"], rel=1e-8)


def test_spacings_of_two_directions():
    even, uneven = (numbers(replace(SPHERE, normal_maugis=1.0, spacing=spacing), still(2))
                    for spacing in (0.4, (0.3, 0.4)))
    assert uneven["normal_displacement"] == pytest.approx(even["normal_displacement"], rel=1e-5)
    assert uneven["contact_area"] == pytest.approx(even["contact_area"], rel=2e-3)


def test_displacements_do_not_depend_on_the_box():
    scene = replace(LINE, height=30.0, spacing=0.1)
    small, large = (numbers(scene, Load(start="normal_force=1", path=path))
                    for path in ("normal_force=1", "normal_force=20; normal_force=1"))
    for name in ("normal_displacement", "contact_area", "minimum_gap"):
        assert small[name] == pytest.approx(large[name], rel=1e-7)


def test_transforms_are_those_of_the_window():
    branch = Branch(replace(LINE, spacing=0.04), Load(start="normal_force=2",
                                                      path="normal_force=2.2"),
                    form=Form(symmetry="off"))
    points = list(branch)
    assert branch.contact.grid.counter.size == points[-1].state.window.size
    # Two circles of about twice the window for each product with the compliance.
    spent = points[-1].spent
    products = spent["function_evaluations"] + spent["jacobian_products"]
    assert 4.0 * products <= spent["transforms"] <= 9.0 * products


def test_a_contact_beyond_its_box_is_an_error():
    contact = Branch(LINE, still(1)).contact
    with pytest.raises(OutOfBox, match="spreads beyond"):
        contact.window(np.zeros(contact.grid.shape))


@pytest.mark.parametrize("scene", [LINE, replace(LINE, normal_maugis=0.3), SPHERE])
@pytest.mark.parametrize("force", [0.0, 30.0])
def test_box_has_room_for_the_window(scene, force):
    branch = Branch(scene, still(force + 1e-3))
    point = list(branch)[-1]
    extent = max(n * h for n, h in zip(point.state.window.shape, scene.spacings))
    assert extent < 2.3 * half_width(scene, force) + 4 * scene.spacings[0]
    assert extent <= 0.55 * min(lay_out(scene, force).periods)


# What is refused


@pytest.mark.parametrize("scene, words", [(dict(period=math.inf, points=512), "-scene_spacing"),
                                          (dict(spacing=0.1), "-scene_period inf"),
                                          (dict(period=(math.inf, 12.0), dimension=2,
                                                geometry="sphere"), "every direction"),
                                          (dict(period=math.inf, dimension=2), "sphere"),
                                          (dict(period=math.inf, geometry="sinusoid"), "cylinder"),
                                          (dict(period=math.inf, geometry="flat"), "cylinder"),
                                          (dict(period=math.inf, spacing=0.0), "above 0")])
def test_scenes_that_are_refused(scene, words):
    with pytest.raises(InputError, match=words):
        Scene(**scene)


def test_contact_that_may_end_beyond_the_nodes_laid_out_is_refused():
    with pytest.raises(InputError, match="-scene_contact_threshold is '40': .* at most 30"):
        list(Branch(replace(LINE, contact_threshold=40.0), still(2)))


@pytest.mark.parametrize("load", [Load(path="normal_displacement=1"),
                                  Load(path="normal_displacement=hold"),
                                  Load(start="normal_displacement=0", path="normal_force=1"),
                                  Load(path="normal_force=1; tangential_displacement=3")])
def test_displacements_cannot_be_prescribed(load):
    with pytest.raises(InputError, match="prescribe (normal|tangential)_force instead"):
        Branch(LINE, load)


@pytest.mark.parametrize("form", [Form(form="force"), Form(first="relaxation")])
def test_forms_that_need_a_cell_are_refused(form):
    with pytest.raises(InputError, match="needs a cell"):
        Branch(LINE, still(1), form=form)


def test_window_off_solves_on_the_whole_box():
    scene = replace(LINE, spacing=0.05)
    branch = Branch(scene, still(1), form=Form(window="off"))
    found = branch.observe(list(branch)[-1])
    assert found["contact_area"] == pytest.approx(numbers(scene, still(1))["contact_area"],
                                                  rel=1e-6)


def test_largest_force():
    assert largest_force(LINE,
                         Load(
        path="normal_force=3; normal_force=hold, tangential_force=9; normal_force=-4")) == 3.0
    assert largest_force(LINE, Load(path="normal_force=-4")) == 0.0


# Commands

SMALL = ["-scene_period", "inf", "-scene_height", "inf", "-scene_normal_maugis", "3",
         "-scene_spacing", "0.15"]


def call(folder, *arguments):
    return processes.call(*arguments, folder=folder)


@pytest.mark.parametrize("spacing, more", [
    (0.15, []), (0.3, ["-scene_dimension", "2", "-scene_geometry", "sphere"])])
def test_archive_has_the_box_and_can_be_resumed_and_plotted(tmp_path, spacing, more):
    words = ["run", *SMALL, *more, "-scene_spacing", str(spacing), "-load_start",
             "normal_force=1", "-archive_file", "run.h5",
             "-archive_fields", "all", "-load_path", "normal_force=2; normal_force=3",
             "-continuation_initial_step", "0.5", "-continuation_largest_step", "0.5"]
    done = call(tmp_path, *words)
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "run.h5") as file:
        scene, x = dict(file["scene"].attrs), file["fields/x"][:]
        assert np.isinf(scene["period"]).all() and np.allclose(scene["spacing"],
                                                               spacing) and "points" not in scene
    record = contactsnes.read(tmp_path / "run.h5")
    traction, displacement = (record.field(name, record.points - 1)[0]
                              for name in ("traction", "displacement"))
    assert (np.allclose(np.diff(x), spacing) and x[len(x) // 2] == 0
            and traction.shape == (len(x),) * traction.ndim)
    force = -traction.sum() * spacing ** traction.ndim * 3.0
    assert force == pytest.approx(3.0, rel=1e-6)
    assert np.isfinite(displacement).all()
    again = call(tmp_path, *words, "-archive_resume")
    assert again.returncode == 0 and "complete" in again.stdout
    plotted = call(tmp_path, "plot", "run.h5")
    assert plotted.returncode == 0, plotted.stderr


def test_info_tells_of_the_isolated_contact(tmp_path):
    done = call(tmp_path, "info", *SMALL)
    assert done.returncode == 0, done.stderr
    assert ("isolated contact, spacing 0.15 beta" in done.stdout and "(nan)" in done.stdout
            and "room for" in done.stdout)


def test_comparison_refuses_relaxation_with_a_reason(tmp_path):
    (tmp_path / "scene.opts").write_text("\n".join(f"{a} {b}"
                                                   for a, b in zip(SMALL[::2], SMALL[1::2]))
                                         + "\n-load_start \"normal_force=1\"\n-load_path "
                                         "\"normal_force=1.2\"\n")
    (tmp_path / "fire.opts").write_text("-contact_form force\n-snes_type "
                                        "python\n-snes_python_type "
                                        "contactsnes.solvers.relaxation.Fire\n")
    (tmp_path / "newton.opts").write_text("-snes_type newtonls\n")
    done = call(tmp_path, "compare", "scene.opts", "newton.opts", "fire.opts", "-compare_repeats",
                "1")
    assert done.returncode == 0, done.stderr
    assert "need a cell" in done.stdout and "newton: " in done.stdout


@pytest.mark.parametrize("more", [["-scene_height", "inf"], ["-scene_poisson", "0.3"]])
def test_automatic_spacing_and_its_errors(tmp_path, more):
    words = ["-scene_period", "inf", "-scene_normal_maugis", "4", *more, "-load_start",
             "normal_force=2", "-load_path", "normal_force=2.2", "-continuation_initial_step",
             "0.2", "-continuation_largest_step", "0.2"]
    done = call(tmp_path, "run", *words, "-scene_points", "auto", "-scene_accuracy", "1e-5",
                "-archive_file", "auto.h5")
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "auto.h5") as file:
        spacing = file["scene"].attrs["spacing"]
        area, error = (file["branch"][name][-1] for name in ("contact_area", "error_contact_area"))
    body = {"height": math.inf} if "inf" in more else {"poisson": 0.3}
    exact = numbers(Scene(period=math.inf, normal_maugis=4.0, spacing=float(spacing) / 6, **body),
                    Load(start="normal_force=2", path="normal_force=2.2"))["contact_area"]
    assert error < 1e-5 and abs(area / exact - 1) < max(3 * error, 1e-7)
    again = call(tmp_path, "run", *words, "-scene_points", "auto", "-archive_file", "auto.h5",
                 "-archive_resume")
    assert again.returncode == 0 and "complete" in again.stdout, again.stderr


def test_the_mass_of_a_mean_is_that_of_a_cell():
    """In overdamped motion on a line, the stiffness of a cell's softest wave over its length: pi E*
    for any cell."""
    contact = Branch(LINE, still(5.0)).contact
    np.testing.assert_allclose(contact.mean_mass(1), contact.periodic.mean_mass(1), rtol=1e-12)
