"""Numbers of a point, found again from its fields by other means."""

import math

import numpy as np
import pytest

from contactsnes import Branch, Load, Scene
from contactsnes.observables import Measurement

LINE = {"points": 256, "period": 30.0, "normal_maugis": 3.0, "height": 50.0}
PLANE = {"dimension": 2, "geometry": "sphere", "points": 32, "period": 8.0, "normal_maugis": 2.0, "height": 5.0}


def rows_with_fields(scene, **load):
    """(point, its numbers, gap, displacement, traction over the cell) of a path, in scaled units."""
    branch = Branch(Scene(**scene), Load(**load))
    for point in branch:
        displacement, traction = Measurement(branch.contact, point).fields()[:2]
        gap = displacement[0] + branch.contact.initial_gap / branch.scene.normal_maugis
        yield point, branch.observe(point), gap, displacement, traction


@pytest.mark.parametrize("scene, start, end", [(LINE, 4.0, -2.5), (PLANE, 0.5, -0.9)])
def test_largest_pressure_is_compressive(scene, start, end):
    """A contact that is pulled has a larger attraction than pressure, and in the end no pressure at all."""
    pulled = []
    for _, row, _, _, traction in rows_with_fields(scene, start=f"normal_displacement={start}", path=f"normal_displacement={end}"):
        assert row["maximum_pressure"] == pytest.approx(max(0.0, -traction[0].min()), abs=1e-12)
        pulled.append(traction[0].max() > 2.0 * row["maximum_pressure"])
    assert pulled[-1] and not pulled[0]


@pytest.mark.parametrize("scene, press, shear", [
    ({**LINE, "residual_friction": 0.5}, "normal_force=1", "tangential_displacement=40"),
    ({**LINE, "law": "mcgarry"}, "normal_displacement=1", "tangential_displacement=20"),
    ({**PLANE, "residual_friction": 0.8}, "normal_displacement=0.5", "tangential_displacement_x=4, tangential_displacement_y=-3")])
def test_gross_sliding_is_when_every_node_in_contact_has_passed_the_peak(scene, press, shear):
    """|g_t| > delta_t / sqrt 2 wherever the gap is below the threshold; `gross_sliding` is the first such point."""
    found = []
    for point, row, gap, displacement, _ in rows_with_fields(scene, path=f"{press}; {shear}"):
        touching = gap < math.e / scene["normal_maugis"] * (1.0 - 1e-9)
        slid = np.linalg.norm(displacement[1:], axis=0) > math.sqrt(0.5)  # tangential Maugis parameter 1
        sliding = bool(touching.any() and slid[touching].all())
        assert point.sliding == sliding
        found.append((sliding, row["event"], tuple(point.load)))
    begins = [n for n, (sliding, *_) in enumerate(found) if sliding and not found[n - 1][0]]
    told = [n for n, (_, event, _) in enumerate(found) if event == "gross_sliding"]
    assert len(begins) == len(told) == 1
    # A jump into sliding is told as a jump first, and as the event once more.
    assert found[told[0]][2] == found[begins[0]][2] and told[0] - begins[0] == int(found[begins[0]][1] == "jump")
