"""Tables of scripts/compare."""

from pathlib import Path

import pytest
from programs import load

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def program():
    return load(ROOT / "scripts" / "compare")


def record(rows):
    """A comparison of one stage, with what tables take of each method."""
    table = [{"stage": "cold start", "method": name, "found": 2, "points": 2, "failed_at": "",
              "transforms": double, "transforms_single": single, "time": 0.004,
              "transforms_ratio": 3.0, "time_ratio": 2.0, "time_ratio_low": 1.0,
              "time_ratio_high": 4.0} for name, double, single in rows]
    names = [name for name, *_ in rows]
    return {"table": {key: [row[key] for row in table] for key in table[0]},
            "methods": {"name": names, "options": [""] * len(names),
                        "family": ["Newton" if name == "newton" else "dynamic relaxation"
                                   for name in names]}}


def test_transforms_in_single_precision_count_as_half(program):
    text = program.report({"sphere": record([("newton", 8.0, 36.0), ("fire", 90.0, 0.0),
                                             ("verlet", 80.0, 40.0)])})
    assert "| newton | 26 / 4 |" in text and "| verlet | 100 / 4 |" in text
    assert "| the best relaxation, transforms | 3 (fire) |" in text
