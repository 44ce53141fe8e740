"""Compiled forms of several processes against NumPy's of one, row by row."""

import pytest
from ranks import Started, say, together

from contactsnes.kernels import library
from contactsnes.output.reading import read

PROGRAM = """
import itertools
import numpy as np
from mpi4py import MPI
from contactsnes.contact.balance import asked
from contactsnes.contact.bordered import ArcLength
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import Contact
from contactsnes.grid.active import some
from contactsnes.grid.slabs import Slabs
from contactsnes.kernels.choice import chosen
from contactsnes.kernels.zones import answers
from contactsnes.scene.settings import Scene

comm, random = MPI.COMM_WORLD, np.random.default_rng(3)
shape, last = (62, 46), MPI.COMM_WORLD.rank == MPI.COMM_WORLD.size - 1
scene = Scene(points=shape, period=(12.0, 9.0), dimension=2, geometry="sphere", poisson=0.2,
              normal_maugis=2.0, tangential_maugis=2.0, residual_friction=0.5)
shared = Contact(scene, kernels=chosen(True), grid=Slabs(shape, scene.periods, comm))
alone = Contact(scene, kernels=chosen(False))
masks = {"cell": np.ones(shape, dtype=bool), "nodes": random.random(shape) < 0.5,
         # of which a process has none, and a pair of rows between others
         "rows": np.isin(np.arange(shape[0])[:, None] // 2, (0, 3, 4, 8))
         & (random.random(shape) < 0.5),
         "box": None}


def form_of(contact, part, controls, arc):
    window = contact.grid.whole if part != "box" else contact.grid.box((17, 9), (31, 26))
    if part in ("nodes", "rows"):
        window = some(window, np.flatnonzero(contact.grid.part_of(masks[part])))
    form = DisplacementForm(contact, window, controls)
    form.set_load([1.5, 0.3, -0.2][:len(controls)])
    if not arc:
        return form
    numbers = np.random.default_rng(7)
    start, direction = numbers.normal(size=(2, form.components))
    anchor, tangent = (mine(form, part, *fields) for fields in numbers_of(form, numbers, 2))
    return ArcLength(form, start, direction, 0.01 * anchor, tangent, 0.3, 0.7)


def numbers_of(form, numbers, count):
    scalars = len(form.forced) if isinstance(form, DisplacementForm) else 1 + len(form.form.forced)
    return [(numbers.normal(size=(form.components, *shape)), numbers.normal(size=scalars))
            for _ in range(count)]


def mine(form, part, field, scalars):
    # nodes that are here, and scalars if they are
    window = getattr(form, "form", form).window
    return np.append(window.take(form.grid.part_of(field)), form.grid.held(scalars))


def pressed(form, part):
    field, scalars = numbers_of(form, np.random.default_rng(5), 1)[0]
    field *= 0.02
    field -= 1.2 * np.exp(-alone.initial_gap / 3.0) / form.root
    return mine(form, part, field, 0.02 * scalars)


def results(form, part, single):
    unknown = pressed(form, part)
    vector = mine(form, part, *numbers_of(form, np.random.default_rng(6), 1)[0])
    new = lambda: np.empty(form.size)
    found = {"residual": form.residual(unknown, new())}
    form.linearise(unknown)
    how = () if isinstance(form, ArcLength) else (single,)
    found["product"] = form.apply_jacobian(vector, new(), *how)
    found["transposed"] = form.apply_transpose(vector, new(), *how)
    found["after"] = form.residual(unknown, new())
    return found


def answered(form, part):
    # sums of what the law answers to fields
    fields = mine(form, part, *numbers_of(form, np.random.default_rng(6), 1)[0])
    fields = fields[:form.count].reshape(form.shape)
    sums = (answers(form.kernel, fields) if form.kernel
            else np.sum(form.stiffen(fields, np.empty(form.shape)), axis=1))
    return form.grid.together(sums)


def on_cell(form, values):
    # fields over this process's rows; scalars follow, where they are
    inner = getattr(form, "form", form)
    fields = np.zeros((form.components, *form.grid.local_shape))
    inner.window.put(values[:form.count].reshape(form.shape), fields)
    return fields, values[form.count:]


for part, controls, arc, single in itertools.product(
        masks, (["displacement"], ["force"], ["displacement", "force", "displacement"]),
        (False, True), (False, True)):
    if arc and single:
        continue
    here, whole = (form_of(contact, part, controls, arc) for contact in (shared, alone))
    inner = getattr(here, "form", here)
    assert inner.kernel is not None and getattr(whole, "form", whole).kernel is None
    expected = results(whole, part, single)
    for name, values in results(here, part, single).items():
        fields, scalars = on_cell(here, values)
        others, tail = on_cell(whole, expected[name])
        others = np.stack([shared.grid.part_of(field) for field in others])
        case = part, controls, arc, single, name
        close = 3e-6 if single and name in ("product", "transposed") else 1e-12
        most = np.max(np.abs(expected[name]))
        assert np.max(np.abs(fields - others), initial=0.0) < close * most, case
        assert not last or np.allclose(scalars, tail, rtol=close, atol=close * most), case
        assert last or not scalars.size, case
    assert inner.evaluations == 2 and inner.products == 2
    response = inner.kernel.structure.response.contents
    assert comm.size > 1 or bool(response.pairs) is (part in ("rows", "box"))
    if not arc:
        one, other = (answered(form, part) for form in (here, whole))
        assert np.allclose(one, other, rtol=1e-11), (part, controls, one, other)
        one, other = (asked(form, form.state(pressed(form, part)), 60.0) for form in (here, whole))
        assert np.allclose(one, other, rtol=1e-12) and 0.0 < one[1], (part, controls, one, other)
    if part in ("nodes", "rows") and not arc:
        # what is closest is in a row without nodes
        for form in (here, whole):
            form.residual(pressed(form, part), np.empty(form.size))
        one, other = (form.closest_beyond(-20.0) for form in (here, whole))
        assert np.isclose(one, other, rtol=1e-12), (part, controls, one, other)
print("alike")
"""


@together
@pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))
@pytest.mark.parametrize("size", (1, pytest.param(2, marks=pytest.mark.study), 4))
def test_compiled_forms_of_several_processes_are_numpys_of_one(size, tmp_path):
    say(size, PROGRAM, tmp_path)


GARBAGE = """
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import Contact
from contactsnes.grid.slabs import Slabs
from contactsnes.scene.settings import Scene
from contactsnes.solvers.vectors import collect, create_vector
from mpi4py import MPI

scene = Scene(points=(16, 16), period=8.0, dimension=2, geometry="sphere")
contact = Contact(scene, grid=Slabs(scene.shape, scene.periods, MPI.COMM_WORLD))
vector = create_vector(DisplacementForm(contact, contact.grid.whole, ("normal_displacement",)))
if MPI.COMM_WORLD.rank:
    vector.destroy()
collect()
print("goes on")
"""


@together
def test_processes_need_not_lose_an_object_at_the_same_time(tmp_path):
    done = Started(2, ["-c", GARBAGE], tmp_path, fresh=True).ended(60.0)
    assert (done.returncode, done.stdout.count("goes on")) == (0, 2), done.stderr


LAW = """
import numpy as np
from contactsnes import Law

class Plain(Law):
    gap_corners = (0.0,)

    def tractions(self, a, b):
        return a * np.exp(-a), 2.0 * np.exp(-b ** 2 - np.maximum(a, 0.0))
"""
MIXED = """
import os, sys
from contactsnes.kernels import building, library
from contactsnes.system.processes import launched
rank = str(launched()[1])
if {name!r} == "CC":  # a law of one's own, which nobody has compiled
    os.environ["XDG_CACHE_HOME"] = rank
if rank == "1":
    os.environ[{name!r}] = {value!r}
    library.shared.cache_clear()  # of the process that this one is a fork of
    building.compiler.cache_clear()
from contactsnes.commands.cli import main
sys.exit(main(["run", "-scene_dimension", "2", "-scene_points", "32", "-scene_period", "12",
               "-scene_geometry", "sphere", "-scene_normal_maugis", "1", "-load_path",
               "normal_displacement=0.2", "-contact_symmetry", {symmetry!r}, "-scene_law",
               {law!r}, "-archive_file", "run.h5"]))
"""


@together
@pytest.mark.parametrize("name, value, symmetry, law", [
    ("CONTACTSNES_KERNELS", "off", "auto", "modified"),
    ("CC", "/bin/false", "off", "law.py:Plain")])
def test_a_process_that_has_no_kernels_or_compiler_hinders_nobody(name, value, symmetry, law,
                                                                  tmp_path):
    """C and NumPy ask other processes for different things: these waited for ever."""
    (tmp_path / "law.py").write_text(LAW)
    text = MIXED.format(name=name, value=value, symmetry=symmetry, law=law)
    done = Started(2, ["-c", text], tmp_path).ended(60.0)
    assert done.returncode == 0, done
    assert read(tmp_path / "run.h5").complete
    if name == "CC" and library.reason() is None:
        assert "the law is evaluated by NumPy: the C compiler /bin/false" in done.stdout
        assert "(process 2 of 2)" in done.stdout
