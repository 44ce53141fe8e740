"""The noise that solves of spots begin with."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes import Contact, Scene  # noqa: E402
from contactsnes.contact.forms import DisplacementForm  # noqa: E402
from contactsnes.contact.problem import DISPLACEMENT  # noqa: E402
from contactsnes.solvers import ritz  # noqa: E402


def noise(first, count):
    """Noise of consecutive nodes, an array."""
    return np.concatenate([values for _, values in ritz._noise(first, count)])


def test_noise_is_the_same_on_any_number_of_processes():
    """Each takes that of its own nodes, by their numbers, wherever they are parted."""
    every = noise(0, 3 * ritz.PART + 5)
    parts = [0, 100, ritz.PART, 2 * ritz.PART + 7, len(every)]
    assert np.array_equal(every, np.concatenate([
        noise(first, last - first) for first, last in zip(parts, parts[1:])]))
    assert np.mean(every ** 2) == pytest.approx(1.0 / 12.0, rel=0.02)


def test_every_wave_has_a_part():
    """Of a plane of 16 parts, as random numbers have it: parts that are shifted to each other by
    the same number of nodes would leave most waves out."""
    spectrum = np.abs(np.fft.rfft2(noise(0, 512 ** 2).reshape(512, 512))) / 512.0 * np.sqrt(12.0)
    assert np.quantile(spectrum, 0.01) > 0.05 and np.max(spectrum) < 8.0
    assert np.min(spectrum[:8, :8].reshape(-1)[1:]) > 0.01


def test_deep_overlap_is_not_stirred():
    """Where it is, modes do not lose their stability; all other nodes of two bumps are."""
    scene = Scene(dimension=2, points=64, period=12.0, geometry="flat", normal_maugis=2.0)
    x = 2.0 * np.pi * np.arange(64) / 64
    contact = Contact(scene, gap=3.0 * (np.cos(2.0 * x)[:, None] + np.cos(x)))
    form = DisplacementForm(contact, contact.grid.whole, (DISPLACEMENT,))
    field = np.linspace(-0.5, 0.5, form.nodes)[None]
    before = form.pack(field, [])
    change = form.displacement(ritz.stirred(form, before.copy(), False) - before)
    overlap = field + form.initial_gap <= 0.0
    assert np.all(change[overlap] == 0.0) and np.all(change[~overlap] != 0.0)
    assert np.sqrt(np.mean(change ** 2)) == pytest.approx(ritz.STIRRED, rel=1e-6)
