"""Systems on two grids, and cores in patches, of several processes against NumPy's of one: with
circles of which every process has all points, and with those that are shared out."""

import pytest
from ranks import say, together

PROGRAM = """
import itertools
import numpy as np
from mpi4py import MPI
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import DISPLACEMENT, Contact
from contactsnes.grid import slabs
from contactsnes.grid.active import some
from contactsnes.kernels.choice import chosen
from contactsnes.scene.settings import Scene
from contactsnes.solvers import patch_systems
from contactsnes.solvers.core_blocks import Core, PatchedBlock
from contactsnes.solvers.patch_systems import Patches

comm, random, shape = MPI.COMM_WORLD, np.random.default_rng(3), (48, 24)
scene = Scene(points=shape, period=(12.0, 6.0), dimension=2, geometry="sphere", normal_maugis=2.0)
kernels = chosen(KERNELS)
assert kernels.compiled == KERNELS or kernels.reason
alone = Contact(scene, kernels=chosen(False))
tangent, weight, field = random.random((3, *shape))
tangent *= 2.0 / patch_systems.compliance_between(alone, 0, 4)
masks = {"cell": np.ones(shape, dtype=bool), "nodes": random.random(shape) < 0.5,
         # of which a process has none
         "rows": (np.arange(shape[0])[:, None] < 9) & (random.random(shape) < 0.5)}


def made(contact, part, kind, single):
    grid = contact.grid
    window = grid.whole if part == "cell" else some(
        grid.whole, np.flatnonzero(grid.part_of(masks[part])))
    form = DisplacementForm(contact, window, (DISPLACEMENT,))
    mine = lambda values: window.take(grid.part_of(values)[None]).reshape(-1).copy()
    if kind is Patches:
        block = Patches(form, 0, 1.25, single)
        block.take(mine(tangent))
        assert bool(block.library) == contact.kernels.compiled
    else:
        block = PatchedBlock(form, 0, Core(None, mine(weight)[None], np.array([1.0])), 1.25)
    out = mine(field)
    block.apply(out, single)
    found = np.zeros((1, *grid.local_shape))
    window.put(out[None], found)
    return found[0], getattr(block, "softest", 0.0)


for slabs.GATHERED in (0, 2 ** 14):
    shared = Contact(scene, kernels=kernels, grid=slabs.Slabs(shape, scene.periods, comm))
    for part, kind, single in itertools.product(masks, (Patches, PatchedBlock), (False, True)):
        # as far as rounding allows
        patch_systems.LEFT = 1e-5 if single else 1e-12
        (here, softest), (whole, other) = (made(contact, part, kind, single)
                                           for contact in (shared, alone))
        case = part, kind, single, slabs.GATHERED
        assert np.allclose(here, shared.grid.part_of(whole), rtol=0.0,
                           atol=2e-5 if single else 1e-12), case
        assert np.isclose(softest, other, rtol=1e-3), case
print("alike")
"""


@together
@pytest.mark.parametrize("kernels", (True, False), ids=("library", "numpy"))
@pytest.mark.parametrize("size", (2, 3))
def test_patches_of_several_processes_are_numpys_of_one(size, kernels, tmp_path):
    say(size, PROGRAM.replace("KERNELS", str(kernels)), tmp_path)
