"""What tests share: PETSc's options, which are one database for the whole process."""

import pytest


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
def kept_options():
    """PETSc's options as they were, after a test."""
    from contactsnes.options import database, install

    before = database()
    yield
    install(before)
