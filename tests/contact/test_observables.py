"""Numbers of a point, found again from its fields by other means."""

import math

import numpy as np
import pytest

from contactsnes import Branch, Contact, Load, Scene, Steps
from contactsnes.contact.observables import Measurement
from contactsnes.grid.boxes import Spots
from contactsnes.grid.cell import Grid

LINE = {"points": 256, "period": 30.0, "normal_maugis": 3.0, "height": 50.0}
PLANE = {"dimension": 2, "geometry": "sphere", "points": 32, "period": 8.0, "normal_maugis": 2.0,
         "height": 5.0}


def rows_with_fields(scene, **load):
    """(point, its numbers, gap, displacement, traction over the cell) of a path, in scaled
    units."""
    branch = Branch(Scene(**scene), Load(**load))
    for point in branch:
        displacement, traction = Measurement(branch.contact, point).fields()[:2]
        gap = displacement[0] + branch.contact.initial_gap / branch.scene.normal_maugis
        yield point, branch.observe(point), gap, displacement, traction


@pytest.mark.parametrize("scene, start, end", [(LINE, 4.0, -2.5), (PLANE, 0.5, -0.9)])
def test_largest_pressure_is_compressive(scene, start, end):
    """A contact that is pulled has a larger attraction than pressure, and in the end no pressure at
    all."""
    pulled = []
    for _, row, _, _, traction in rows_with_fields(scene, start=f"normal_displacement={start}",
                                                   path=f"normal_displacement={end}"):
        assert row["maximum_pressure"] == pytest.approx(max(0.0, -traction[0].min()), abs=1e-12)
        pulled.append(traction[0].max() > 2.0 * row["maximum_pressure"])
    assert pulled[-1] and not pulled[0]


@pytest.mark.parametrize("scene, press, shear", [({**LINE, "residual_friction": 0.5},
                                                  "normal_force=1", "tangential_displacement=40"),
                                                 ({**LINE, "law": "mcgarry"},
                                                  "normal_displacement=1",
                                                  "tangential_displacement=20"),
                                                 ({**PLANE, "residual_friction": 0.8},
                                                  "normal_displacement=0.5",
                                                  "tangential_displacement_x=4, "
                                                  "tangential_displacement_y=-3")])
def test_gross_sliding_is_when_every_node_in_contact_has_passed_the_peak(scene, press, shear):
    """|g_t| > delta_t / sqrt 2 wherever the gap is below the threshold; `gross_sliding` is the
    first such point."""
    found = []
    for point, row, gap, displacement, _ in rows_with_fields(scene, path=f"{press}; {shear}"):
        touching = gap < math.e / scene["normal_maugis"] * (1.0 - 1e-9)
        # tangential Maugis parameter 1
        slid = np.linalg.norm(displacement[1:], axis=0) > math.sqrt(0.5)
        sliding = bool(touching.any() and slid[touching].all())
        assert point.sliding == sliding
        found.append((sliding, row["event"], tuple(point.load)))
    begins = [n for n, (sliding, *_) in enumerate(found) if sliding and not found[n - 1][0]]
    told = [n for n, (_, event, _) in enumerate(found) if event == "gross_sliding"]
    assert len(begins) == len(told) == 1
    # A jump into sliding is told as a jump first, and as the event once more.
    assert (found[told[0]][2] == found[begins[0]][2]
            and told[0] - begins[0] == int(found[begins[0]][1] == "jump"))


def test_a_flat_slides_where_its_slip_passes_the_peak_and_not_a_tenth_before():
    scene = Scene(points=16, period=10.0, height=math.inf, geometry="flat", residual_friction=1.0)
    for part, sliding in ((0.95, False), (1.01, True)):
        end = part * math.sqrt(0.5)
        *_, point = Branch(scene, Load(path=f"tangential_displacement={end}"))
        assert (np.abs(point.state.displacement[1]) == pytest.approx(end, rel=1e-7)
                and point.sliding == sliding)


def test_one_node_that_sticks_is_no_gross_sliding():
    scene = Scene(points=32, period=20.0, height=math.inf, normal_maugis=0.3, residual_friction=1.0)
    *_, point = Branch(scene, Load(start="normal_displacement=-9.14",
                                   path="tangential_displacement=0.01"))
    gap = point.state.displacement[0] + point.state.window.take(Contact(scene).initial_gap)
    assert np.count_nonzero(gap < math.e) == 1 and point.in_contact and not point.sliding


@pytest.mark.parametrize("scene, path",
                         [({**LINE, "poisson": 0.3, "height": 8.0, "tangential_maugis": 1.7},
                           "normal_force=2, tangential_displacement=4"),
                          ({**PLANE, "poisson": 0.2, "tangential_maugis": 0.6},
                           "normal_displacement=0.4, tangential_force_x=0.1, "
                           "tangential_force_y=0.2")])
def test_displacements_of_the_top_are_those_of_the_mean_surface_and_of_the_layer(scene, path):
    """D = mean(-u_n) + W/(A k_0n) and U = mean(u_t) + T/(A k_0t), k_0n = (1 - nu)^2/((1 - 2 nu) H),
    k_0t = (1 - nu)/(2 H)."""
    poisson = scene["poisson"]
    height = scene["height"]
    area = scene["period"] ** scene.get("dimension", 1)
    stiffness = (1 - poisson) ** 2 / ((1 - 2 * poisson) * height), (1 - poisson) / (2 * height)
    for _, row, _, displacement, traction in rows_with_fields(scene, path=path):
        means = displacement.reshape(len(displacement), -1).mean(axis=1)
        forces = area * traction.reshape(len(traction), -1).mean(axis=1)
        forces *= [-scene["normal_maugis"],
                   *[scene.get("tangential_maugis", 1.0)] * (len(means) - 1)]
        ends = ("_x", "_y") if len(means) == 3 else ("",)
        names = ["normal", *(f"tangential{end}" for end in ends)]
        for name, mean, force, stiff in zip(names, means * [-1, *[1] * len(ends)], forces,
                                            [stiffness[0], *[stiffness[1]] * len(ends)]):
            kind, _, end = name.partition("_")
            end = f"_{end}" if end else ""
            assert row[f"{kind}_force{end}"] == pytest.approx(force, rel=1e-6, abs=1e-6)
            assert row[f"{kind}_displacement{end}"] == pytest.approx(mean + force / (area * stiff),
                                                                     rel=1e-6, abs=1e-6)
            told = (row["approach"] if kind == "normal"
                    else row[f"mean_tangential_displacement{end}"])
            assert told == pytest.approx(mean, rel=1e-7, abs=1e-7)


SHEARED = {"period": 30.0, "normal_maugis": 2.0, "tangential_maugis": 2.0, "height": 50.0,
           "residual_friction": 0.5}


@pytest.mark.parametrize("scene, path, coarse, fine, precision",
                         [(SHEARED, "normal_force=2; tangential_displacement=3", 256, 2048,
                           5e-4), (SHEARED, "normal_force=2; tangential_displacement=3", 320,
                                   2560, 2e-4), ({"dimension": 2, "geometry": "sphere",
                                                  "period": 8.0, "normal_maugis": 1.5,
                                                  "height": 5.0}, "normal_displacement=1, "
                                                 "tangential_displacement_x=1, "
                                                 "tangential_displacement_y=0.5", 32, 128, 2e-3)])
def test_largest_slip_is_that_of_the_edge_between_the_nodes(scene, path, coarse, fine, precision):
    """Before anything slides the slip grows up to the edge: the last node's is low by a part of a
    spacing."""
    found = []
    for points in (coarse, fine):
        branch = Branch(Scene(points=points, **scene), Load(path=path),
                        Steps(initial_step=0.5, largest_step=1.5))
        found.append(branch.observe(list(branch)[-1])["maximum_tangential_gap"])
    assert found[0] == pytest.approx(found[1], rel=precision)


@pytest.mark.parametrize("shape", [(96,), (96, 80)])
def test_fields_at_the_edge_are_cubic_in_boxes_in_several_and_around_the_border(shape):
    """Along each line of nodes: of a sum of waves at a level of another one, to the fourth order of
    the spacing."""
    grid = Grid(shape, [2.0 * np.pi] * len(shape))
    x, y = grid.coordinates() if len(shape) == 2 else (*grid.coordinates(), 0.0)
    gap = np.cos(2.0 * x + 0.3) + 0.2 * np.sin(y)
    fields = np.array([gap + 2.0, np.sin(x) - 0.3 * gap + 0.0 * y]).reshape(2, -1)
    two = [[n // 2 - n // 3 + k * n // 2 if axis == 0 else 0 for axis, n in enumerate(shape)]
           for k in (0, 1)]
    box = [n // 2 if axis == 0 else n for axis, n in enumerate(shape)]
    windows = [grid.whole, Spots(grid, two, [n - 2 * (axis == 0) for axis, n in enumerate(box)])]
    counts = []
    for window in windows:
        inside = [window.take(field.reshape(shape)) for field in (gap, *fields)]
        found = window.at_level(inside[0], 0.1, np.array(inside[1:]))
        np.testing.assert_allclose(found[0], 2.1, atol=1e-14)
        counts.append(found.shape[1])
        if len(shape) == 1:
            turn = 0.5 * (np.arccos(0.1) * np.array([1, -1, 1, -1])
                          - 0.3) + np.array([0, 0, np.pi, -np.pi])
            turn = (turn + np.pi) % (2.0 * np.pi) - np.pi
            np.testing.assert_allclose(np.sort(found[1]), np.sort(np.sin(turn) - 0.03), atol=1e-6)
    assert counts[0] >= counts[1] > 0


@pytest.mark.parametrize("scene", [
    {**LINE, "contact_threshold": 60.0},
    {**LINE, "law": "dugdale", "dugdale_width": 0.01, "normal_maugis": 0.8, "points": 4096},
    {**PLANE, "period": 20.0, "contact_threshold": 60.0},
    {**PLANE, "geometry": "sinusoid", "amplitude": 20.0, "contact_threshold": 50.0},
    {**PLANE, "geometry": "rough", "rough_slope": 16.0, "rough_shortest": 2.0, "rough_seed": 3,
     "rough_on": "flat", "normal_maugis": 1.5, "contact_threshold": 45.0}])
def test_contact_may_go_beyond_the_range_of_the_law(scene):
    """Its size is that of all nodes below the threshold, to half of those at its edge."""
    reached = False
    for _, row, gap, *_ in rows_with_fields(scene, start="normal_displacement=0.5",
                                            path="normal_displacement=0.6"):
        touching = gap < scene.get("contact_threshold", math.e) / scene["normal_maugis"]
        node = np.prod(Contact(Scene(**scene)).grid.spacings)
        steps = sum(np.count_nonzero(touching != np.roll(touching, 1, axis))
                    for axis in range(touching.ndim))
        assert not touching.all()
        assert row["contact_area"] == pytest.approx(node * np.count_nonzero(touching),
                                                    abs=0.51 * node * steps)
        reached = True
    assert reached
