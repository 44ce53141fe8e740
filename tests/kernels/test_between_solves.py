"""What compiled code is asked between two solves, against NumPy, SciPy and whole windows."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import ndimage

from contactsnes import Contact, Scene
from contactsnes.branch import failures
from contactsnes.contact import acceptance, energies, state, states
from contactsnes.continuation.points import Point
from contactsnes.grid.even import EvenWindow
from contactsnes.grid.parity import parities
from contactsnes.grid.splines import spline
from contactsnes.grid.windows import Window
from contactsnes.kernels import library, splines
from contactsnes.kernels.choice import chosen
from contactsnes.kernels.laws import kernel_of

compiled = pytest.mark.skipif(library.reason() is not None, reason="no compiled library")
EVEN = {"line": (Scene(points=128, period=20.0), (0,), 1),
        "sheared line": (Scene(points=128, period=20.0, poisson=0.3, tangential="on"), (0,), 2),
        "plane": (Scene(dimension=2, points=32, period=12.0, geometry="sphere"), (0,), 1),
        "sheared plane": (Scene(dimension=2, points=32, period=12.0, geometry="sphere",
                                poisson=0.3, tangential="on"), (0,), 3)}
"""Name -> scene, tangential components that are loaded, components."""


@compiled
@pytest.mark.parametrize("shape, axis", [((1, 2), 1), ((1, 3), 1), ((2, 29), 1), ((1, 30), 1),
                                         ((9, 31), 1), ((3, 12, 40), 1), ((3, 40, 12), 2),
                                         ((2, 2, 9), 1), ((1, 500), 1)])
def test_splines(shape, axis):
    """Within the nodes and beyond their ends, where a place counts as theirs."""
    numbers = np.random.default_rng(3)
    values, count = numbers.normal(size=shape), shape[axis]
    places = np.concatenate([numbers.uniform(-1.0, count, size=40), [0.0, count - 1.0, 1.0]])
    given = values.copy()
    found = chosen().spline(values, places, axis)
    np.testing.assert_array_equal(values, given)
    np.testing.assert_allclose(found, spline(values, places, axis), atol=1e-13)
    lines = np.moveaxis(values, axis, -1).reshape(-1, count)
    cut = np.clip(places, 0.0, count - 1.0)
    other = [ndimage.map_coordinates(line, [cut], order=3, mode="mirror") for line in lines]
    np.testing.assert_allclose(np.moveaxis(found, axis, -1).reshape(len(lines), -1), other,
                               atol=1e-12)


@compiled
def test_splines_without_nodes(monkeypatch):
    """A process whose slab has none of the rows asks the library, which needs two, for nothing."""
    monkeypatch.setattr(splines, "shared", None)
    found = chosen().spline(np.empty((3, 0, 12)), np.empty(0), 1)
    assert found.shape == spline(np.empty((3, 0, 12)), np.empty(0), 1).shape == (3, 0, 12)


@compiled
@pytest.mark.parametrize("law", ["modified", "mcgarry", "xu_needleman"])
@pytest.mark.parametrize("components", [1, 2, 3])
def test_works(law, components):
    """What nodes release, in more than one part of the library's, and of no nodes at all."""
    scene = Scene(dimension=2, points=16, law=law, geometry="sphere", work_ratio=0.7)
    numbers = np.random.default_rng(4)
    gap = numbers.uniform(-2.0, 6.0, size=(components, 600))
    change = numbers.normal(size=(components, 600)) * numbers.choice([0.0, 1e-9, 1.0], size=600)
    by_library, by_numpy = Contact(scene), Contact(scene, kernels=chosen(False))
    assert kernel_of(by_library.law) and not kernel_of(by_numpy.law)
    for nodes in (600, 256, 3, 0):
        found, expected = (acceptance._works(contact, gap[:, :nodes], change[:, :nodes])
                           for contact in (by_library, by_numpy))
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)


def even(name, extent=None):
    """(contact, state taken for even, the same state at all nodes) of random fields."""
    scene, loaded, count = EVEN[name]
    contact = Contact(scene)
    signs = parities(contact.operator(count), count, loaded[1:])
    extent = contact.grid.shape if extent is None else extent
    full = Window(contact.grid, [n // 2 - m // 2 for n, m in zip(contact.grid.shape, extent)],
                  extent)
    half = EvenWindow(full, signs)
    fields = np.random.default_rng(len(extent)).normal(size=(count, half.size))
    made = state.spread(half, half.fold(half.unfold(0.5 * fields)), np.zeros(count))
    return contact, made, replace(made, half=None)


def about(contact, of):
    """A point of a state."""
    count = len(of.displacement)
    return Point(of, ("displacement",) * count, *np.zeros((3, count)), True, False, 0.0)


@pytest.mark.parametrize("name, extent", [*((name, None) for name in EVEN), ("line", (41,)),
                                          ("sheared line", (41,)), ("plane", (21, 25)),
                                          ("sheared plane", (21, 25)), ("line", (7,)),
                                          ("plane", (21, 32))])
def test_halves_tell_what_all_nodes_do(name, extent):
    """Numbers that steps are judged by, of even and odd fields."""
    contact, half, whole = even(name, extent)
    once, all_ = about(contact, half), about(contact, whole)
    np.testing.assert_allclose(failures.short_waves(contact, once),
                               failures.short_waves(contact, all_), rtol=1e-12)
    for one, other in zip(contact.survey(half)[2:], contact.survey(whole)[2:]):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(energies.stored(contact, once), energies.stored(contact, all_),
                               rtol=1e-12, atol=1e-12)
    assert states.covers(contact, half) == states.covers(contact, whole)
    other, moved = (state.spread(half.half, factor * half.once, half.means)
                    for factor in (1.3, 0.9))
    plain = [replace(one, half=None) for one in (other, half, moved)]
    for told in (acceptance.strayed, acceptance.doubtful):
        np.testing.assert_allclose(told(contact, other, half, moved), told(contact, *plain),
                                   rtol=1e-12)
    for largest in (False, True):
        np.testing.assert_allclose(states.missed(contact, other, half, largest),
                                   states.missed(contact, *plain[:2], largest), rtol=1e-12)
    ahead = states.combined(contact, [other, half, moved], [1.0, -3.0, 3.0])
    assert ahead.half == half.half
    np.testing.assert_allclose(ahead.displacement,
                               states.combined(contact, plain, [1.0, -3.0, 3.0]).displacement,
                               atol=1e-12)
