"""Windows on which the law acts of several processes against those of one, node by node."""

import pytest
from ranks import SIZES, say, together

PROGRAM = """
import numpy as np
from mpi4py import MPI
from contactsnes.contact.problem import Contact
from contactsnes.contact.scattered import on_nodes
from contactsnes.contact.states import State
from contactsnes.grid.active import some
from contactsnes.grid.slabs import Slabs
from contactsnes.scene.settings import Scene

shape = (46, 32)
scene = Scene(points=shape, period=(12.0, 9.0), dimension=2, geometry="flat", gap_offset=80.0)
shared = Contact(scene, grid=Slabs(shape, scene.periods, MPI.COMM_WORLD))
alone = Contact(scene)
number, row = np.arange(shape[0] * shape[1]).reshape(shape), np.arange(shape[0])[:, None]
near = 0.5 * alone.law.range - alone.initial_gap


def numbers(contact, known, acting):
    # of the window of a state of known nodes, in some of which the law acts
    grid = contact.grid
    window = some(grid.whole, np.flatnonzero(grid.part_of(known)))
    values = window.take(grid.part_of(np.where(acting, near, 0.0)))[None]
    state = State(window, values, np.zeros(1))
    fitted = on_nodes(contact, state)
    return fitted is state, np.concatenate(grid.comm.allgather(fitted.window.node_numbers())
                                           if grid.shared else [fitted.window.node_numbers()])


# rows that all processes have as many of, or the first one most
for known in (np.broadcast_to(number % 3 > 0, shape), (row < 12) & (number % 3 > 0)):
    for every, kept in ((1, True), (2, False), (4, False)):
        acting = known & (number % every == 0)
        here, there = numbers(shared, known, acting), numbers(alone, known, acting)
        assert here[0] == there[0] == kept, (every, here[0], there[0])
        assert np.array_equal(here[1], there[1]), every
        assert kept or np.array_equal(here[1], np.flatnonzero(acting)), every
print("alike")
"""


@together
@pytest.mark.parametrize("size", SIZES)
def test_windows_of_several_processes_shrink_as_those_of_one(size, tmp_path):
    say(size, PROGRAM, tmp_path)


CARRIED = """
import numpy as np
from mpi4py import MPI
from contactsnes.contact.edges import carried
from contactsnes.contact.problem import Contact
from contactsnes.contact.states import State
from contactsnes.grid.active import some
from contactsnes.grid.slabs import Slabs
from contactsnes.scene.settings import Scene

shape = (64, 48)
scene = Scene(points=shape, period=(8.0, 6.0), dimension=2, geometry="sphere", normal_maugis=4.0)
shared, alone = (Contact(scene, **more)
                 for more in ({"grid": Slabs(shape, scene.periods, MPI.COMM_WORLD)}, {}))
x, y = np.meshgrid(*alone.grid.coordinates(), indexing="ij")
distance = np.hypot(x, y)


def found(contact, scattered):
    # what cos(r/a) is carried to, where the radius a of a spot grows from 1.2 to 1.4
    grid, states, changes = contact.grid, [], []
    for radius in (1.2, 1.4):
        gap = np.e + 8.0 * ((distance / radius) ** 2 - 1.0)
        window = (some(grid.whole, np.flatnonzero(grid.part_of(gap < contact.law.range)))
                  if scattered else grid.whole)
        fields = [window.take(grid.part_of(field)) for field in (gap, np.cos(distance / radius))]
        states.append(State(window, fields[:1] - window.take(contact.initial_gap), np.zeros(1)))
        changes.append(State(window, fields[1][None], np.ones(1)))
    (moved,) = carried(contact, changes[:1], *states)
    cell = contact.extended(moved)[0]
    return np.concatenate(grid.comm.allgather(cell)) if grid.shared else cell


wanted = found(alone, False)
within = distance < 1.3
assert np.max(np.abs(wanted - np.cos(distance / 1.4))[within]) < 1e-5
assert np.allclose(found(shared, False), wanted, rtol=0.0, atol=1e-8)
for contact in (shared, alone):
    assert np.allclose(found(contact, True)[within], wanted[within], rtol=0.0, atol=1e-8)
print("alike")
"""


@together
@pytest.mark.parametrize("size", SIZES)
def test_changes_are_carried_with_the_edges_by_several_processes_too(size, tmp_path):
    say(size, CARRIED, tmp_path)
