"""What tests share: PETSc's options, which are one database for the whole process, and how MPI
begins in the processes that they start."""

import gc

import pytest

from contactsnes.commands.starting import stay_alone

stay_alone()  # so do the processes that tests start, hundreds, each a third of a second sooner


@pytest.hookimpl(trylast=True)
def pytest_collection_finish():
    """Thousands of tests and what they import stay to the end: each collection of garbage, of which
    the command's end asks for one, would look through all of it for a tenth of a second."""
    gc.collect()
    gc.freeze()


@pytest.fixture
def options():
    """A function that sets options (a value of None: none) until the end of the test."""
    from petsc4py import PETSc

    database, given = PETSc.Options(), []

    def give(**values):
        for name, value in values.items():
            database.setValue(name, value)
            given.append(name)

    yield give
    for name in given:
        database.delValue(name)


@pytest.fixture
def read_here(monkeypatch):
    """Archives, which are whole, are read without another process that tries it first."""
    monkeypatch.setattr("contactsnes.output.files.failure", lambda read: "")


@pytest.fixture
def kept_options():
    """PETSc's options as they were, after a test."""
    from contactsnes.options.database import database, install

    before = database()
    yield
    install(before)


@pytest.fixture(scope="session")
def self_affine():
    """A function that makes self-affine periodic heights, the same waves on every grid."""
    import numpy as np

    def heights(points, period, longest, shortest, slope, seed, hurst=0.8, dimension=1):
        most = int(np.ceil(period / shortest))
        numbers = np.array(np.meshgrid(*[np.arange(-most, most + 1)] * dimension, indexing="ij"))
        wavenumber = np.linalg.norm(numbers, axis=0) / period
        kept = (wavenumber > 0) & (wavenumber * longest >= 1) & (wavenumber * shortest <= 1)
        amplitude = kept * np.where(kept, wavenumber, 1.0) ** -(hurst + dimension / 2)
        phases = np.random.default_rng(seed).random(wavenumber.shape)
        waves = amplitude * np.exp(2j * np.pi * phases)
        spectrum = np.zeros((points,) * dimension, complex)
        spectrum[tuple(numbers % points)] = waves
        whole = [np.fft.fftfreq(points, 1 / points)] * dimension
        spectra = [spectrum] + [spectrum * 2j * np.pi / period * frequency
                                for frequency in np.meshgrid(*whole, indexing="ij")]
        field, *slopes = (np.fft.ifftn(each).real for each in spectra)
        return field * slope / np.sqrt(np.mean(np.sum(np.square(slopes), axis=0)))

    return heights
