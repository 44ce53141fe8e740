"""The core of a contact in patches of nodes: against dense operators, against every node for
itself, and in paths."""

import math

import numpy as np
import pytest

from contactsnes import Branch, Contact, Form, Load, Scene, Steps
from contactsnes.contact.forms import DisplacementForm
from contactsnes.contact.problem import DISPLACEMENT
from contactsnes.grid import patches
from contactsnes.grid.slab_transform import shares
from contactsnes.solvers.core_blocks import Core, PatchedBlock

POINTS = 16, 24
ONE_NODE = {1: math.inf}


@pytest.fixture
def taken(monkeypatch):
    """Sets which patches are taken up to which C D."""
    return lambda limits: monkeypatch.setattr(patches, "PATCHES", limits)


def block_on(box=None, stiffness=3.0, **changes):
    """A block whose core is all of a box of the cell, (start, shape), with weights between 0 and 1;
    its weights."""
    contact = Contact(Scene(**{"dimension": 2, "points": POINTS, "period": (8.0, 12.0),
                               "geometry": "sphere", "normal_maugis": 2.0, **changes}))
    window = contact.grid.box(*box) if box else contact.grid.whole
    form = DisplacementForm(contact, window, (DISPLACEMENT,))
    weight = np.random.default_rng(3).uniform(0.1, 1.0, window.size)
    core = Core(None, weight[None], np.array([stiffness]))
    return PatchedBlock(form, 0, core, 1.0), weight


def matrix(block, size):
    """Matrix of a block."""
    def column(unit):
        block.apply(unit)
        return unit

    return np.array([column(unit) for unit in np.eye(size)]).T


def compliances(contact, apart):
    """C_nn of the waves of a cell whose points are so many spacings apart, (2, 2, 2) as of FFTs."""
    shape = [points // apart for points in contact.grid.shape]
    waves = [2.0 * np.pi * np.fft.fftfreq(n, apart * spacing)
             for n, spacing in zip(shape, contact.grid.spacings)]
    wave = np.hypot(waves[0][:, None], waves[1][None])
    symbol = np.divide(1.0, wave, out=np.zeros(shape), where=wave > 0.0)
    scale = contact.operator(1).blocks[0, 0][0, 1] * contact.grid.size * waves[1][1]
    symbol *= scale
    symbol[0, 0] = 2.0 * symbol.max()
    return symbol


@pytest.mark.parametrize("apart", [1, 2, 4])
def test_a_block_is_the_operator_that_it_says(taken, apart):
    """M^-1 = 1 - a (g + P (G - g) R) a, made of dense matrices."""
    taken({apart: math.inf})
    block, weight = block_on()
    contact = Contact(Scene(dimension=2, points=POINTS, period=(8.0, 12.0), geometry="sphere",
                            normal_maugis=2.0))
    compliance = compliances(contact, apart)
    answer = 3.0 * compliance / (1.0 + 3.0 * compliance)
    shortest = 3.0 * max(compliance[0, compliance.shape[1] // 2],
                         compliance[compliance.shape[0] // 2, 0])
    within, count = shortest / (1.0 + shortest), compliance.size
    rows, columns = np.indices(POINTS) // apart
    spread = np.zeros((weight.size, count))
    spread[np.arange(weight.size), (rows * compliance.shape[1] + columns).ravel()] = 1.0
    waves = np.fft.fft2(np.eye(count).reshape(count, *compliance.shape))
    coarse = np.fft.ifft2((answer - within) * waves).real.reshape(count, count).T
    inner = within * np.eye(weight.size) + spread @ coarse @ spread.T / apart ** 2
    root = np.sqrt(weight)
    expected = np.eye(weight.size) - root[:, None] * inner * root
    np.testing.assert_allclose(matrix(block, weight.size), expected, atol=1e-13)


@pytest.mark.parametrize("apart", [1, 2, 4])
@pytest.mark.parametrize("stiffness", [0.01, 1.0, 1e4])
def test_a_block_is_symmetric_and_positive(taken, apart, stiffness):
    """Then a negative Ritz value is an unstable mode of the contact's, whatever the patches."""
    taken({apart: math.inf})
    block, weight = block_on(((3, 5), (11, 14)), stiffness)
    found = matrix(block, weight.size)
    np.testing.assert_allclose(found, found.T, atol=1e-14)
    assert 0.0 < np.linalg.eigvalsh(found).min() and np.linalg.eigvalsh(found).max() <= 1.0


def test_patches_are_those_of_the_cell(taken):
    """A core that begins within a patch has part of it: nodes 3 to 13 and 5 to 18 have patches
    0 to 3 and 1 to 4 of 4 nodes."""
    taken({4: math.inf})
    block, weight = block_on(((3, 5), (11, 14)))
    rows, columns = np.divmod(block._patch.reshape(11, 14), block.transform.shape[1])
    assert [*rows[:, 0]] == [0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3]
    assert [*columns[0]] == [0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3]


def test_stiff_cores_and_odd_cells_have_smaller_patches():
    """C D of the shortest waves decides, and what divides the cell."""
    scene = Scene(dimension=2, points=16, period=8.0, geometry="sphere", normal_maugis=2.0)
    contact = Contact(scene)
    limits = {apart: limit / patches.compliance_between(contact, 0, apart)
              for apart, limit in patches.PATCHES.items()}
    assert [patches.patch(contact, 0, tangent)[0] for tangent in
            (0.99 * limits[4], 1.01 * limits[4], 1.01 * limits[2], math.nan)] == [4, 2, 1, 4]
    found = [dict(patches.shortest(Contact(Scene(dimension=2, points=points, period=8.0,
                                            geometry="sphere", normal_maugis=2.0)), 0))
             for points in (18, (16, 22))]
    assert [[*known] for known in found] == [[2, 1], [2, 1]]


def test_lines_and_even_contacts_have_none():
    line, plane = (Contact(Scene(points=16, period=8.0, **more)) for more in
                   ({}, {"dimension": 2, "geometry": "sphere"}))
    assert not patches.taken(line.grid.whole) and patches.taken(plane.grid.whole)
    assert patches.taken(plane.grid.box((2, 3), (5, 7)))


def test_processes_have_whole_patches():
    """Rows are multiples of four, of two where the cell is, also where these are not enough for
    all."""
    assert shares(64, 3, 4) == [(0, 24), (24, 20), (44, 20)]
    assert shares(18, 2, 4) == [(0, 10), (10, 8)]
    assert shares(8, 3, 4) == [(0, 4), (4, 4), (8, 0)]
    assert shares(8, 3) == [(0, 3), (3, 3), (6, 2)]


def rough(**changes):
    """A rough flat whose law acts almost everywhere."""
    return Scene(**{"dimension": 2, "points": 64, "period": 24.0, "geometry": "rough",
                    "rough_on": "flat", "rough_slope": 4.0, "rough_longest": 6.0,
                    "rough_shortest": 1.5, "normal_maugis": 1.5, **changes})


PATHS = {"pressed": (rough(), Load("normal_displacement=1", "normal_displacement=1.3")),
         "force": (rough(rough_seed=2), Load("normal_force=4", "normal_force=4.3")),
         "sheared": (rough(points=(64, 60), period=(24.0, 22.5), tangential_maugis=1.5,
                           poisson=0.3),
                     Load("normal_displacement=1",
                          "normal_displacement=1.1; tangential_displacement_x=0.2"))}


@pytest.mark.parametrize("kernels", ["auto", "off"])
@pytest.mark.parametrize("name", PATHS)
def test_paths_take_as_many_iterations(taken, name, kernels):
    """And far fewer transforms, to the same points."""
    scene, load = PATHS[name]

    def followed():
        points = list(Branch(scene, load, Steps(initial_step=0.1, largest_step=0.1),
                             form=Form(kernels=kernels)))
        return points, [sum(point.spent[key] for point in points[1:])
                        for key in ("linear_iterations", "transforms", "transforms_single")]

    points, (iterations, *transforms) = followed()
    taken(ONE_NODE)
    others, (expected, *all_transforms) = followed()
    assert [point.event for point in points] == [point.event for point in others]
    np.testing.assert_allclose([point.forces for point in points[-1:]],
                               [point.forces for point in others[-1:]], rtol=1e-6)
    assert iterations < 1.15 * expected and sum(transforms) < 0.8 * sum(all_transforms)
