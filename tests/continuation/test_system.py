"""The contract between continuation and what it continues: the contact's system, and the toys of
the tests, have all of it."""

import inspect
import typing

import petsc4py
import pytest

petsc4py.init([])

from test_bifurcations import Dense, Seeing  # noqa: E402
from test_continuation import System as Toy  # noqa: E402
from test_continuation import cubic  # noqa: E402

from contactsnes.branch.corrector import Corrector  # noqa: E402
from contactsnes.branch.tracing import Tracer  # noqa: E402
from contactsnes.contact.problem import Contact  # noqa: E402
from contactsnes.continuation import system  # noqa: E402
from contactsnes.dynamics.stability import Stability  # noqa: E402
from contactsnes.scene.settings import Form, Scene  # noqa: E402

PARTS = (system.States, system.Solves, system.Limits, system.Motion)


def tracer():
    """The system of a contact."""
    return Tracer(Contact(Scene(points=64, normal_maugis=1.0, period=20.0)), Form())


def methods(protocol):
    """Name -> function of what a protocol asks for."""
    return {name: value for part in protocol.__mro__ for name, value in vars(part).items()
            if inspect.isfunction(value) and value.__module__ == system.__name__
            and (not name.startswith("_") or name == "__call__")}


@pytest.mark.parametrize("make", [tracer, lambda: Toy(cubic()), lambda: Seeing(cubic())],
                         ids=["contact", "toy", "seeing toy"])
def test_systems_have_all_that_continuation_asks(make):
    made = make()
    assert isinstance(made, system.System)
    for name, asked in methods(system.System).items():
        # what is asked by position has to be accepted by position
        inspect.signature(getattr(made, name)).bind(*list(inspect.signature(asked).parameters)[1:])


@pytest.mark.parametrize("make", [lambda: Stability(tracer(), "sign"),
                                  lambda: Dense(Toy(cubic()))], ids=["contact", "toy"])
def test_certificates_have_all_that_continuation_asks(make):
    assert isinstance(make(), system.Stability)


def test_a_corrector_alone_is_no_system():
    made = Corrector(Contact(Scene(points=64, normal_maugis=1.0, period=20.0)), Form())
    assert not isinstance(made, system.System) and not isinstance(made, system.Motion)


def test_the_contract_is_written_down():
    """Every method says what it is, and what it takes and returns."""
    assert len(methods(system.System)) == sum(len(methods(part)) for part in PARTS)
    for protocol in (*PARTS, system.Stability):
        assert inspect.getdoc(protocol)
        for function in methods(protocol).values():
            named = typing.get_type_hints(function)
            assert inspect.getdoc(function) and "return" in named
            assert set(inspect.signature(function).parameters) - {"self"} <= set(named)
