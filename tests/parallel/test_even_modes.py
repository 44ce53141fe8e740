"""Modes of even and odd fields of several processes against those of one: J, its preconditioner,
and what certificates are made of."""

import pytest
from ranks import FEW, say, together

PARTED = """
import numpy as np
import petsc4py
petsc4py.init()
from mpi4py import MPI
from contactsnes.contact.problem import Contact
from contactsnes.contact.states import State
from contactsnes.dynamics.linearised import symmetries
from contactsnes.dynamics.modes import leading_modes, oriented
from contactsnes.dynamics.parted import Parted
from contactsnes.dynamics.projection import joined
from contactsnes.grid.slabs import Slabs
from contactsnes.kernels.choice import chosen
from contactsnes.scene.settings import Scene

shape = (30, 22)
scene = Scene(points=shape, period=(12.0, 9.0), dimension=2, geometry="sphere", poisson=0.2,
              normal_maugis=2.0, tangential_maugis=2.0, residual_friction=0.5)
shared = Contact(scene, grid=Slabs(shape, scene.periods, MPI.COMM_WORLD))
alone = Contact(scene, kernels=chosen(False))
whole = Slabs(shape, scene.periods, MPI.COMM_SELF).noise(2, 7)
assert np.array_equal(shared.grid.noise(2, 7), shared.grid.part_of(whole))
assert len(np.unique(whole)) == whole.size
x, y = alone.grid.coordinates()
pressed = -1.2 * np.exp(-alone.initial_gap / 3.0)
# (the body is coupled: what a mirror stands across is odd)
fields = np.array([pressed, *(0.1 * pressed * np.sin(2.0 * np.pi * along / period)
                              for along, period in zip((x, y), scene.periods))])
lump = np.random.default_rng(4).normal(size=(3, *shape))


def made(contact, start, extents, controls, along):
    window = contact.grid.box(start, extents)
    slipped = fields.copy()
    if along:  # slip that is even where the mirror across the other direction makes it odd
        slipped[along] += 0.2 * pressed
    values, mode = (window.take(contact.grid.part_of(field[:len(controls)]))
                    for field in (slipped, lump))
    means = np.arange(1.0, len(controls) + 1.0)
    state = State(window, values, means)
    axes = symmetries(contact, state)
    operator = Parted(contact, window, controls, axes)
    operator.linearise(state)
    vector = operator.vector(State(window, mode, means))
    back = operator.state(vector)
    assert np.allclose(back.displacement, mode, rtol=0.0, atol=1e-12)
    found = [operator.state(image) for image in (operator.apply(vector),
                                                 operator.precondition(vector))]
    modes = joined(leading_modes(operator, (), 1e-6))
    leading = oriented(modes.vectors[0], operator)
    states = [(state.displacement, state.means)
              for state in (back, *found, operator.state(leading))]
    return axes, modes.values, modes.unstable, states


THREE = ["displacement", "force", "displacement"]
for (start, extents), controls, along in (
        (((0, 0), shape), ["force"], 0), (((8, 4), (15, 15)), ["displacement"], 0),
        (((10, 0), (11, 22)), THREE, 0), (((10, 0), (11, 22)), THREE, 1),
        (((0, 4), (30, 15)), THREE, 2)):
    window, everything = (contact.grid.box(start, extents) for contact in (shared, alone))
    axes, values, unstable, ours = made(shared, start, extents, controls, along)
    # (those of one process are found by one, for all)
    its, wanted, known, theirs = MPI.COMM_WORLD.bcast(
        made(alone, start, extents, controls, along) if MPI.COMM_WORLD.rank == 0 else None)
    assert axes == its and len(axes) == (1 if along else 2)
    assert np.isclose(values[0], wanted[0], rtol=0.0, atol=1e-5)
    assert unstable == known
    for number, ((here, means), (there, its_means)) in enumerate(zip(ours, theirs)):
        cell = np.zeros((len(there), *shape))
        everything.put(there, cell)
        close = (1e-12, 1e-11, 1e-6, 3e-3)[number] * np.max(np.abs(cell))
        assert np.max(np.abs(here - window.take(shared.grid.part_of(cell))),
                      initial=0.0) <= close, (extents, controls, along, number)
        assert np.allclose(means, its_means, rtol=3e-3, atol=close)
print("alike")
"""


@together
@pytest.mark.parametrize("size", FEW)
def test_modes_apart_of_several_processes_are_those_of_one(size, tmp_path):
    say(size, PARTED, tmp_path)
