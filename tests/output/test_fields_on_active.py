"""Fields on active nodes: the cell's that are made of them are those that the cell would have
kept."""

import h5py
import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.contact.observables import Measurement, compliance, frame, table  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.output.archive import Archive  # noqa: E402
from contactsnes.output.columns import Column  # noqa: E402
from contactsnes.output.files import ArchiveError  # noqa: E402
from contactsnes.output.reading import read  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Scene, Steps  # noqa: E402

PLANE = {"dimension": 2, "geometry": "sphere", "normal_maugis": 2.0, "points": 32, "period": 12.0}
LINE = {"normal_maugis": 3.0, "points": 256, "period": 40.0}
SI = {"units": "si", "work_of_adhesion_normal": 0.03, "work_of_adhesion_tangential": 0.03,
      "contact_modulus": 2e6, "radius": 0.01, "range_normal": 1e-6, "range_tangential": 1e-6}
pytestmark = pytest.mark.usefixtures("read_here")


def written(folder, scene, path, *kinds, load_start=None, steps=Steps()):
    """The branch of a path, and a Record of all its points of each kind of archive.

    Parameters
    ----------
    folder : pathlib.Path
    scene : Scene
    path, load_start : str
    kinds : str, 'cell' or 'active', and a precision if it is not double
    steps : Steps
    """
    branch = Branch(scene, Load(start=load_start, path=path), steps)
    rows, archives = table(scene), {}
    for kind in kinds:
        on, _, precision = kind.partition(" ")
        kept = {"compliance": compliance(branch.contact)} if on == "active" else {}
        archives[kind] = Archive.create(
            folder / f"{kind}.h5", scene=branch.attributes(), options=f'-load_path "{path}"',
            versions={}, columns={name: Column(row.unit, row.kind, row.names)
                                  for name, row in rows.items()},
            fields="all", components=scene.components,
            precision=precision or "double", **frame(branch.contact), **kept)
    for point in branch:
        measured = Measurement(branch.contact, point)
        row, state = ({name: row.function(measured) for name, row in rows.items()},
                      branch.packed(point))
        for kind, archive in archives.items():
            fields, active = ((measured.fields(), {}) if kind == "cell"
                              else ((), measured.active_fields()))
            archive.append(row, state, *fields, **active)
    for archive in archives.values():
        archive.finish()
    return branch, *(read(archive.path) for archive in archives.values())


@pytest.mark.parametrize("scene, path, start", [
    ({**LINE}, "normal_displacement=1", None),
    ({**LINE, "poisson": 0.3}, "normal_displacement=1; tangential_displacement=2", None),
    ({**LINE, "period": np.inf, "spacing": 0.1, "points": "auto"}, "normal_force=2", None),
    ({**PLANE}, "normal_displacement=1", None),
    ({**PLANE, "tangential_maugis": 2.0}, "normal_displacement=1; tangential_displacement_x=2",
     None),
    ({**PLANE, "tangential_maugis": 2.0, "poisson": 0.3},
     "normal_displacement=1; tangential_displacement_y=2", None),
    ({**LINE, "poisson": 0.2, "tangential": "off"}, "normal_force=1", None),
], ids=["line", "coupled line", "isolated", "plane", "sheared plane", "coupled plane",
        "coupled line that is held along the flat"])
def test_the_cell_is_rebuilt(tmp_path, scene, path, start):
    if scene["period"] == np.inf:
        scene = {name: value for name, value in scene.items() if name != "points"}
    scene, steps = Scene(**scene), Steps(initial_step=0.2)
    _, cell, active = written(tmp_path, scene, path, "cell", "active", load_start=start,
                              steps=steps)
    assert active.on_active and not cell.on_active and active.units["traction"]
    points = (0, active.points // 2, active.points - 1)
    for point, there, here in zip(points, cell.each(points), active.each(points)):
        assert 0 < len(active.active(point)["nodes"]) < there[1][0].size
        # what is left of a point's balance, and no more
        np.testing.assert_allclose(here[0], there[0], atol=1e-6)
        np.testing.assert_allclose(here[1], there[1], atol=1e-13)


def test_what_is_not_kept_is_said_and_nothing_else_given(tmp_path):
    """A name that is none gave another field of an archive on active nodes, and was taken for
    damage elsewhere."""
    scene = Scene(**LINE)
    _, *records = written(tmp_path, scene, "normal_displacement=0.5", "cell", "active")
    for on, record in zip(("cell", "active"), records):
        np.testing.assert_array_equal(record.field("traction", -1),
                                      record.field("traction", record.points - 1))
        (traction,), (again,) = record.each([0, np.int64(-record.points)], ["traction"])
        np.testing.assert_array_equal(traction, again)
        for name, point, told in (("displacment", 0, "no field 'displacment': it has displacement"),
                                  ("mode", 0, "-continuation_stability eigenvalue"),
                                  ("gap", -1, "no field 'gap'"),
                                  ("traction", record.points, f"of 0 to {record.points - 1}"),
                                  ("traction", -record.points - 1, "keeps no fields")):
            with pytest.raises(ArchiveError, match=told):
                record.field(name, point)
        if on == "cell":
            with pytest.raises(ArchiveError, match="-archive_fields_on active"):
                record.active(0)
        else:
            with h5py.File(record.path) as file:
                last = file["fields/active/offsets"][-2:]
                np.testing.assert_array_equal(record.active(-1)["traction"],
                                              file["fields/active/traction"][:, slice(*last)])


def test_fields_in_si_and_in_single_precision(tmp_path):
    scene = Scene.typed(**SI, dimension=2, geometry="sphere", period=6e-4, points=32)
    path = "normal_displacement=1e-6; tangential_displacement_x=2e-6"
    _, cell, active, single = written(tmp_path, scene, path, "cell", "active", "active single")
    last = cell.points - 1
    for name in ("displacement", "traction"):
        expected = cell.field(name, last)
        assert single.field(name, last).dtype == np.float32
        for found, digits in ((active, 1e-6), (single, 1e-5)):
            np.testing.assert_allclose(found.field(name, last), expected,
                                       atol=digits * np.max(np.abs(expected)))
    assert len(single.active(last)["nodes"]) <= len(active.active(last)["nodes"])
    assert active.units["displacement"] == cell.units["displacement"]


def test_mirror_images_are_kept_once(tmp_path):
    """By compression: in the order of the archive they repeat what is before them."""
    scene = Scene(**PLANE | {"points": 64}, tangential_maugis=2.0, height=np.inf)
    _, record = written(tmp_path, scene, "normal_displacement=1; tangential_displacement_x=2",
                        "active")
    with h5py.File(record.path) as file:
        active = file["fields/active"]
        nodes, offsets = active["nodes"][:], active["offsets"][:]
        told = active["traction"].id.get_storage_size() / (8 * active["traction"].size)
    for begin, end in zip(offsets, offsets[1:]):
        assert len(np.unique(nodes[begin:end])) == end - begin
    assert told < 0.2
    x, y = np.unravel_index(nodes[:offsets[1]], (64, 64))
    assert np.all(np.diff(np.abs(x - 32)) >= 0)  # rows by their distance from the middle


def test_an_isolated_contact_goes_on_from_any_point(tmp_path):
    scene = Scene(normal_maugis=3.0, period=np.inf, spacing=0.1)
    _, cell, record = written(tmp_path, scene, "normal_force=4", "cell", "active")
    assert record.points == cell.points > 6
    with pytest.raises(InputError, match="-archive_fields_on active keeps it"):
        Branch.restart(cell, "normal_force=0", 1)
    again = Branch.restart(record, f"normal_force={record['normal_force'][8]}", 4)
    first, *_, last = again
    assert first.residual_norm < 1e-8
    for point, place in ((first, 4), (last, 8)):
        assert again.observe(point)["contact_area"] == pytest.approx(
            record["contact_area"][place], rel=1e-7)
