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
