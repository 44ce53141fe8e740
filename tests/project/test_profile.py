"""Where the time of a run goes: the layers of scripts/benchmark --profile."""

from pathlib import Path

import pytest
from programs import load

from contactsnes.kernels import library

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
TINY = ["-scene_points", "128", "-scene_period", "10", "-scene_normal_maugis", "2", "-load_path",
        "normal_displacement=0.5; tangential_displacement=0.2"]


@pytest.fixture(scope="module")
def layers():
    return load(SCRIPTS / "layers.py")


def test_time_is_that_of_the_innermost_function(layers):
    now = [0.0]
    found = layers.Layers("outside", clock=lambda: now[0])

    def passes(seconds, *inner):
        now[0] += seconds
        for function in inner:
            function()

    leaf = found.wrapped(lambda: passes(4.0), "leaf")
    failing = found.wrapped(lambda: 1 / 0, "leaf")
    tree = found.wrapped(lambda: passes(2.0, leaf, leaf, lambda: passes(1.0)), "tree")
    passes(0.5, tree, leaf)
    with pytest.raises(ZeroDivisionError):
        failing()
    found.change("end")
    passes(8.0)
    found.mark()
    assert found.seconds == {"outside": 0.5, "tree": 3.0, "leaf": 12.0, "end": 8.0}
    assert found.calls == {"tree": 1, "leaf": 4}


def test_a_profile_tells_of_every_layer_that_a_run_has(layers):
    benchmark = load(SCRIPTS / "benchmark")
    found = benchmark.profiled(TINY, repeats=1)
    assert set(found) <= {layers.IMPORTS, layers.REST, *layers.EARLY, *layers.LAYERS,
                          "start: PETSc"}
    assert {"law", "transforms", "PETSc, solves", "predictor", "observables", "archive",
            "start: PETSc"} <= set(found)
    # compiled kernels do these within PETSc
    assert library.reason() is None or {"product", "preconditioner"} <= set(found)
    assert all(seconds >= 0.0 for seconds, _ in found.values())
    assert found["law"][1] > 10
    benchmark.profiled = lambda arguments: found
    heading, _, *rows, total = benchmark.profile({"tiny": TINY})
    assert heading.startswith("| layer | tiny, ms | calls |") and len(rows) == len(found)
    assert float(total.split("|")[2]) == pytest.approx(1e3 * sum(s for s, _ in found.values()),
                                                       abs=0.1)
