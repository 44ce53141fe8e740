"""What a run says of its points: handy units, and no rounding."""

import numpy as np

from contactsnes.commands.progress import Progress
from contactsnes.scene.load import Load
from contactsnes.scene.settings import Scene

SI = dict(units="si", work_of_adhesion_normal=0.03, work_of_adhesion_tangential=0.03,
          contact_modulus=2e6, radius=0.01, range_normal=4e-7, range_tangential=6e-7)


def told(scene, load, **values):
    """The lines of one point."""
    lines = []
    progress = Progress(scene, load, lines.append, live=False)
    row = dict.fromkeys((*progress.columns, "transforms_single", "function_evaluations",
                         "energy_imbalance", "external_work", "dissipated_work"), 0)
    row |= {name: 0.0 for name in row if name.startswith(("normal", "tangential", "contact"))
            and name.endswith(("force", "displacement", "area", "_x", "_y"))}
    progress.point({**row, "event": "jump", "fold_kind": "", "stable": -1, **values}, 0.5)
    return lines, progress.summary(0)


def test_a_line_has_handy_units_in_its_heading():
    load = Load(path="normal_force=65.5; tangential_displacement=1.5e-3")
    lines, summary = told(Scene.typed(**SI), load, normal_displacement=46.6e-6, normal_force=65.5,
                          tangential_displacement=1.386e-3, contact_area=1.412e-3,
                          tangential_force=33.9, dissipated_work=4.9e-4)
    heading, line = map(str.split, lines)
    assert heading[:6] == ["leg", "D/µm", "W/N/m", "U/mm", "T/N/m", "area/µm"]
    assert line[:6] == ["0", "46.6", "65.5", "1.386", "33.9", "1412"]
    assert "jump at D 46.6 µm, W 65.5 N/m, U 1.386 mm, T 33.9 N/m" in summary
    assert "490 µJ/m in jumps" in summary


def test_forces_and_slips_stand_in_one_unit_beside_each_other():
    """Those that the load names none of are told in that of the others, no scale of the scene."""
    load = Load(path="normal_force=4e-3; tangential_displacement_x=2e-9")
    lines, _ = told(Scene.typed(dimension=2, geometry="sphere", points=32, **SI), load)
    assert lines[0].split()[1:7] == ["D/µm", "W/mN", "U_x/nm", "T_x/mN", "U_y/nm", "T_y/mN"]


def test_points_whose_stability_is_not_known_count_as_neither():
    load = Load(path="normal_displacement=1")
    assert "stable" not in told(Scene(), load)[1]
    assert "  stable        0 points, 1 not\n" in told(Scene(), load, stable=0)[1]
    progress = Progress(Scene(), load, print, live=False)
    progress.stable = {1: 2, 0: 1, -1: 24}
    assert "  stable        2 points, 1 not, 24 not asked\n" in progress.summary(0)


def test_rounding_is_shown_as_nothing():
    scene = Scene(dimension=2, points=32)
    load = Load(path="normal_displacement=1; tangential_displacement_x=200")
    lines, summary = told(scene, load, tangential_force_x=3.58, tangential_force_y=4.4e-23,
                          tangential_displacement_y=4.28e-74, normal_force=-1e-10)
    cells = dict(zip(lines[0].split(), lines[1].split()))
    assert cells["T_x"] == "3.58" and cells["T_y"] == cells["U_y"] == "0"
    assert cells["W"] == "-1e-10"  # small, and none of rounding
    assert "e-" not in summary.replace("-1e-10", "") and np.isfinite(float(cells["D"]))
