"""Numbers of contacts of many spots: against their fields, against differences, and what they
cost."""

import numpy as np
import pytest

from contactsnes import Branch, Load, Scene, Steps, observe, table
from contactsnes.contact.measurement import Measurement

ROUGH = {"dimension": 2, "geometry": "rough", "rough_on": "flat", "rough_slope": 8.0,
         "rough_longest": 5.0, "rough_shortest": 1.0, "period": 10.0, "points": 64,
         "normal_maugis": 2.0}
NAMES = {"spots", "largest_spot", "mean_spot", "mean_gap"}


@pytest.fixture(scope="module")
def rough():
    branch = Branch(Scene(**ROUGH), Load(start="normal_displacement=-1", path="normal_force=8"),
                    Steps(initial_step=8.0, largest_step=8.0))
    return branch, list(branch)[-1]


def test_planes_and_lines_have_columns():
    assert NAMES | {"corrected_area"} <= set(table(Scene(dimension=2)))
    assert NAMES <= set(table(Scene())) and "corrected_area" not in table(Scene())
    assert "stiffness" not in table(Scene())


def test_numbers_are_those_of_the_fields(rough):
    branch, point = rough
    found, area = branch.observe(point), branch.contact.grid.node_area
    displacement, _ = Measurement(branch.contact, point).fields()
    gap = displacement[0] + branch.contact.initial_gap / 2.0
    inside = gap < branch.scene.contact_gap
    spots = Measurement(branch.contact, point).spot_map
    np.testing.assert_array_equal(spots > 0, inside)
    counts = np.array([np.count_nonzero(spots == spot) for spot in range(1, spots.max() + 1)])
    assert found["spots"] == len(counts) > 2
    assert found["largest_spot"] == pytest.approx(area * counts.max(), rel=1e-12)
    assert found["mean_spot"] == pytest.approx(area * counts.mean(), rel=1e-12)
    assert found["mean_gap"] == pytest.approx(gap.mean(), rel=1e-9)
    assert counts.sum() * area == pytest.approx(found["contact_area"], rel=0.05)
    assert 0.5 * counts.sum() * area < found["corrected_area"] < counts.sum() * area


def test_shares_fill_the_cell(rough):
    found = rough[0].observe(rough[1])
    assert found["stick_area"] + found["slip_area"] + found["open_area"] == pytest.approx(100.0)


def test_spots_of_a_line_are_counted():
    """Three bumps of a line, pressed until all of them touch."""
    branch = Branch(Scene(points=512, period=60.0, normal_maugis=1.0),
                    Load(path="normal_displacement=0.5"),
                    geometry=lambda x: 3.0 - 3.0 * np.cos(2 * np.pi * x / 20.0))
    found = branch.observe(list(branch)[-1])
    assert found["spots"] == 3
    assert found["largest_spot"] == pytest.approx(found["mean_spot"], abs=2 * 60.0 / 512)
    assert 3 * found["mean_spot"] == pytest.approx(found["contact_area"], abs=4 * 60.0 / 512)


@pytest.mark.parametrize("scene, path", [
    ({"points": 1024, "normal_maugis": 3.0}, "normal_force=20"),
    ({"points": 1024, "normal_maugis": 3.0, "poisson": 0.3, "height": 5.0},
     "normal_force=5; tangential_force=1"),
    ({"points": 1024, "normal_maugis": 3.0, "poisson": 0.3, "height": 5.0,
      "tangential_maugis": 2.0},
     "normal_displacement=1; tangential_displacement=1"),
    (ROUGH | {"poisson": 0.3, "height": 4.0}, "normal_force=5"),
    ({"dimension": 2, "geometry": "sphere", "period": float("inf"), "normal_maugis": 3.0},
     "normal_force=3")])
def test_stiffness_is_the_derivative_of_the_force(scene, path):
    """Against differences of points near it: what else is controlled is held."""
    branch = Branch(Scene(**scene), Load(path=path), Steps(initial_step=1.0, largest_step=10.0))
    point = list(branch)[-1]
    normal = "force" if branch.scene.isolated else "displacement"
    controls, solve = (normal, *point.controls[1:]), branch.corrector.solve
    load = np.array([(point.forces if control == "force" else point.displacements)[i]
                     for i, control in enumerate(controls)])
    step = np.eye(len(load))[0] * 1e-3
    before, after = (solve(point.state, controls, load + sign * step) for sign in (-1, 1))
    expected = ((after.forces[0] - before.forces[0])
                / (after.displacements[0] - before.displacements[0]))
    assert branch.stiffness(point) == pytest.approx(expected, rel=1e-4)
    assert branch.observe(point, ["stiffness"]) == {"stiffness": branch.stiffness(point)}


@pytest.mark.parametrize("scene, expected", [
    (dict(dimension=2, geometry="sphere"), 0.0), (dict(height=5.0, poisson=0.4), 0.0),
    (dict(height=np.inf), np.nan)])  # D of a half-plane is not defined
def test_a_body_out_of_the_range_of_the_law_has_no_stiffness(scene, expected):
    branch = Branch(Scene(period=np.inf, normal_maugis=1.5, **scene), Load(path="normal_force=1"))
    with np.errstate(all="raise"):
        found = branch.stiffness(next(iter(branch)))
    np.testing.assert_equal(found, expected)


def test_stiffness_of_a_scene_in_si_is_in_newtons_per_metre():
    given = {"dimension": 2, "geometry": "sphere", "points": 64}
    plain = Scene(**given, period=10.0, normal_maugis=3.0, tangential_maugis=1.0)
    # beta = 1e-6 and u_n,r = 1e-8: R = beta^2/u_n,r, phi_n = E* beta^3/R^2
    scales = {"contact_modulus": 1e9, "radius": 1e-4, "work_of_adhesion_normal": 0.1,
              "work_of_adhesion_tangential": 0.1}
    si = Scene.typed(**given, **scales, units="si", period=1e-5, range_normal=1e-8 / 3,
                     range_tangential=1e-8)
    found = []
    for scene, load in ((plain, "normal_displacement=1"), (si, "normal_displacement=1e-8")):
        branch = Branch(scene, Load(path=load))
        found.append(branch.stiffness(list(branch)[-1]))
    assert found[1] == pytest.approx(1e9 * 1e-6 * found[0], rel=1e-6)


def test_nobody_pays_for_what_is_not_asked_for(rough, monkeypatch):
    branch, point = rough
    monkeypatch.setattr(Measurement, "spot_map", property(lambda _: pytest.fail("asked for")))
    before = branch.contact.grid.counter.transforms
    observe(branch.contact, point, ["normal_force", "mean_gap"])
    assert branch.contact.grid.counter.transforms == before
