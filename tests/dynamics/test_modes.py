"""Modes of smallest real part against all eigenvalues of dense matrices: complex, far, close and
equal ones."""

import numpy as np
import pytest

from contactsnes.continuation.points import NotConverged
from contactsnes.dynamics.modes import NEUTRAL, _loose, leading_modes, oriented
from contactsnes.dynamics.projection import Modes, Space, joined, projected
from contactsnes.grid.contours import first_largest
from contactsnes.kernels import library


class Dense:
    """The identity plus a matrix of low rank with given eigenvalues (complex ones: with their
    conjugates), and a rough inverse."""

    def __init__(self, values, size=160, seed=0, rough=0.3):
        rng = np.random.default_rng(seed)
        blocks = np.eye(size)
        place = 0
        for value in values:
            if np.imag(value):
                blocks[place:place + 2, place:place + 2] = [[value.real, value.imag],
                                                            [-value.imag, value.real]]
            else:
                blocks[place, place] = np.real(value)
            place += 2 if np.imag(value) else 1
        basis = np.linalg.qr(rng.standard_normal((size, size)))[0] + 0.2 * rng.standard_normal(
            (size, size)) / np.sqrt(size)
        self.size, self.products = size, 0
        self.matrix = basis @ blocks @ np.linalg.inv(basis)
        # What a preconditioner knows: the large ones, roughly.
        large = np.abs(np.diag(blocks)) > 5.0
        inverse = np.where(large, (1.0 + rough * rng.uniform(-1, 1, size))
                           / np.abs(np.diag(blocks)), 1.0)
        self.inverse = basis @ np.diag(inverse) @ np.linalg.inv(basis)

    def apply(self, vector):
        self.products += 1
        return self.matrix @ vector

    def precondition(self, vector):
        return self.inverse @ vector

    def all(self):
        values = np.linalg.eigvals(self.matrix)
        return values[np.argsort(values.real)]


LARGE = [300.0, 80.0, 20.0, 6.0, 0.7, 0.8]


@pytest.mark.parametrize("leading", [[0.07], [0.07, 0.071], [-0.2], [-0.2, 0.05],
                                     [-0.3, -0.29, -0.01, 0.4], [-300.0, 0.2],
                                     [-2.0, -1.0, -0.5, 0.1], [0.1 + 0.5j], [-0.1 + 0.5j],
                                     [-0.1 + 3.0j, 0.02], [-0.2, -0.1 + 0.2j, 0.3], [0.2, 0.2],
                                     [-0.2, -0.2]])
@pytest.mark.parametrize("seed", [0, 1])
def test_leading_modes_are_those_of_dense_matrices(leading, seed):
    operator = Dense(leading + LARGE, seed=seed)
    expected = operator.all()
    modes = joined(leading_modes(operator, accurate=1e-6))
    assert modes.unstable == np.sum(expected.real < -NEUTRAL)
    assert (abs(modes.leading.real - expected[0].real) < 1e-5
            and abs(modes.leading.imag - abs(expected[0].imag)) < 1e-5)
    assert modes.residuals[0] < 1e-6
    vector = modes.vectors[0]
    np.testing.assert_allclose(operator.matrix @ vector, modes.leading * vector, atol=2e-6)


def test_few_modes_are_told_apart_by_their_symmetry_where_one_has_none():
    """Of a window of few nodes all are found at once; of one node none is odd."""
    class Parted(Dense):
        lengths = [2, 3, 1]
        occupied = np.array([True] * 5 + [False])

        def parts(self, vector):
            return np.split(vector, [2, 5])

        def whole(self, number, rows):
            found = np.zeros((*rows.shape[:-1], 6))
            self.parts(found.T)[number][...] = rows.T
            return found

    operator = Parted([0.5] * 6, size=6)
    operator.matrix = np.diag([0.4, -0.2, 0.3, -0.1, 0.6, np.nan])
    found = leading_modes(operator)
    assert [part.values[0] for part in found] == pytest.approx([-0.2, -0.1])
    assert joined(found).unstable == 2
    assert [np.argmax(np.abs(part.vectors[0])) for part in found] == [1, 3]


@pytest.mark.parametrize("size", [20, 160])
def test_all_modes_up_to_one_that_is_asked_for_are_told(size):
    """However many of them are stable: where several change in a step, each of these is."""
    operator = Dense([-0.3, -0.2, 0.05, 0.1, 0.15, 0.25, 0.35] + LARGE, size=size)
    for number in range(7):
        modes = joined(leading_modes(operator, accurate=1e-6, number=number))
        assert modes.real_parts()[:number + 1] == pytest.approx(operator.all()[:number + 1].real,
                                                                abs=1e-5)


def test_modes_nearby_are_a_good_beginning():
    """Signs need less than a leading mode, and both less than from noise."""
    operator = Dense([0.07, 0.1] + LARGE)
    cold = operator.products, leading_modes(operator), operator.products
    rng, spent = np.random.default_rng(5), {}
    near = [vector.real + 0.02 * rng.standard_normal(operator.size) / 20.0
            for vector in joined(cold[1]).vectors[:2]]
    for accurate in (None, 3e-4):
        before = operator.products
        modes = joined(leading_modes(operator, start=near, accurate=accurate))
        spent[accurate] = operator.products - before
        assert modes.unstable == 0
    assert spent[None] <= spent[3e-4] < cold[2] - cold[0]


def test_where_nothing_softens_modes_need_not_be_told_from_each_other():
    """Hundreds of eigenvalues next to 1, as those of a body that slides in full contact: it is
    stable, and the leading one is known to a hundredth."""
    class Crowded(Dense):
        def __init__(self, least):
            self.size, self.products = 3000, 0
            self.diagonal = np.r_[least, np.linspace(0.995, 1.0, 999), np.linspace(1.0, 3.0, 2000)]

        def apply(self, vector):
            self.products += 1
            return self.diagonal * vector

        def precondition(self, vector):
            return vector / np.where(self.diagonal < 2.0, 1.0, self.diagonal)

    operator = Crowded(0.995)
    modes = joined(leading_modes(operator))
    assert modes.unstable == 0 and modes.leading.real == pytest.approx(0.995, abs=0.01)
    assert operator.products < 200
    for least in (0.7, 0.05, -0.1):  # what softens is found, as accurately as elsewhere
        modes = joined(leading_modes(Crowded(least)))
        assert modes.leading.real == pytest.approx(least, abs=1e-5)


def test_small_problems_are_dense():
    operator = Dense([-0.5, 0.2, 7.0], size=20)
    modes = joined(leading_modes(operator))
    assert modes.unstable == 1 and modes.leading == pytest.approx(-0.5)


def test_what_is_not_found_is_said():
    """Without a preconditioner, and with eigenvalues of any size next to each other, nothing
    certain is known."""
    class Hopeless(Dense):
        def __init__(self):
            self.size, self.products = 5000, 0
            self.diagonal = np.append(np.linspace(-1e-3, 1e-3, 2500), np.geomspace(1.0, 1e8, 2500))

        def apply(self, vector):
            return self.diagonal * vector

        def precondition(self, vector):
            return vector

    with pytest.raises(NotConverged, match="modes of the point were not found"):
        leading_modes(Hopeless())


@pytest.mark.parametrize("turn", [1.0, -1.0, 1j, np.exp(2.1j)])
def test_sign_and_phase_of_a_mode_do_not_hang_on_what_finds_it(turn):
    """Nor on the last bits where peaks are as large on either side; a real mode comes back
    whole."""
    x = np.linspace(-1.0, 1.0, 41)
    noise = 1.0 + 1e-15 * np.random.default_rng(3).standard_normal(41)
    for mode in (np.sin(3.0 * x), np.cos(2.0 * x) - 0.3, np.sin(3.0 * x) + 0.2j * np.cos(x)):
        reference = oriented(mode)
        np.testing.assert_allclose(oriented(turn * mode * noise), reference, atol=1e-12)
        assert reference[first_largest(reference)] > 0.0
        if not np.iscomplexobj(mode):
            np.testing.assert_allclose(np.abs(reference), np.abs(mode), atol=1e-14)


class Clustered:
    """A diagonal operator with nearly all eigenvalues near one, as where the law acts everywhere
    alike."""

    size = 50
    values = 1.0 - 0.08 / np.arange(1.0, 51.0)

    def apply(self, vector):
        return self.values * vector

    def precondition(self, vector):
        return vector / 0.95


def test_images_of_nearly_dependent_vectors_stay_accurate():
    """Vectors of Krylov sequences as they come, of which each is hardly new beside those before
    it: rounding grows from one to the next."""
    operator, random = Clustered(), np.random.default_rng(1)
    space, vector = Space(operator), random.standard_normal(operator.size)
    for _ in range(3):
        space.run(0.9, vector.copy(), 12)
        vector += 0.01 * random.standard_normal(operator.size)
    assert space.largest > 12
    basis, images = space._sectors[0]._rows[:, :space.largest]
    np.testing.assert_allclose(images, operator.values * basis, atol=1e-7)
    found = joined(space.modes())
    for value, mode, defect in zip(found.values, found.vectors, found.defects):
        assert operator.apply(mode) - value * mode == pytest.approx(defect, abs=1e-7)


@pytest.mark.skipif(library.reason() is not None, reason=str(library.reason()))
@pytest.mark.parametrize("size, count", [(2500, 1), (2500, 7), (30, 8)])
def test_modes_that_the_library_sums_are_numpys(size, count):
    random = np.random.default_rng(3)
    basis = np.linalg.qr(random.standard_normal((size, count)))[0].T.copy()
    images = basis * np.linspace(-0.5, 2.0, size)
    found, expected = (projected(basis, images, basis @ images.T, 2, compiled=compiled)
                       for compiled in (True, False))
    np.testing.assert_array_equal(found.values, expected.values)
    np.testing.assert_allclose(found.vectors, expected.vectors, rtol=0, atol=1e-14)
    np.testing.assert_allclose(found.defects, expected.defects, rtol=0, atol=1e-14)


@pytest.mark.parametrize("error, imaginary", [(1e-4, 0.0), (1e-6, 2e-5)])
def test_an_imaginary_part_within_the_residual_is_none(error, imaginary):
    """Two eigenvalues that are one look like a pair where vectors are not quite their modes."""
    values = np.array([0.5 + 2e-5j, 0.7])
    defects = np.array([[error, 0.0], [0.0, error]], dtype=complex)
    modes = Modes(values, np.eye(2, dtype=complex), defects, np.array([True, True]))
    assert modes.told(0) == complex(0.5, imaginary) and modes.told(1) == 0.7


@pytest.mark.parametrize("value, residual, loose", [
    (0.2154 + 0.119j, 0.0786, True), (0.2878 + 0.0443j, 0.0152, False),
    (0.2154, 0.0786, False), (0.2154, 0.12, True)])
def test_a_pair_of_a_projection_says_stable_only_with_a_small_residual(value, residual, loose):
    """A body of Poisson ratio 0 that slips: the first pair was what a space that was too small
    showed of an eigenvalue of -0.012 and another one, and its point was called stable."""
    defects = np.array([[residual, 0.0], [0.05, 0.0]])
    modes = Modes(np.array([value, 0.5466]), np.eye(2, dtype=complex), defects,
                  np.array([True, True]))
    assert bool(_loose({0: modes}, None, 0, NEUTRAL)) is loose
