"""The map of how sliding begins: what is read off a run, and the boundaries of theory."""

import sys
from pathlib import Path

import numpy as np
import pytest

from contactsnes import reference

HERE = Path(__file__).resolve().parents[2] / "scripts" / "paper"
before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
sys.path.insert(0, str(HERE))
import observed  # noqa: E402
import regimes  # noqa: E402
import runs  # noqa: E402
import statements_residual  # noqa: E402

sys.path.remove(str(HERE))
sys.dont_write_bytecode = before

WIDTH = 11.5

pytestmark = pytest.mark.study


class Sliding:
    """In the place of results: a contact that slides over a width, with nothing else known."""

    def __getitem__(self, name):
        peak = reference.peak_tangential_traction(0.1)
        return {"tangential_force": np.array([0.5 * peak * WIDTH]), "contact_area": np.array([12.])}


class Record(dict):
    """Columns in the place of an archive."""

    points = property(lambda self: len(self["tangential_force"]))


def driven(mean, force):
    """A record of a path of the force over the mean displacement of the surface."""
    mean, force = np.array(mean, float), np.array(force, float)
    return Record(mean_tangential_displacement=mean, tangential_force=force,
                  tangential_displacement=reference.driven_displacement(mean, force, 100.0, 2000.0))


def test_map_has_eight_by_eleven_onsets_at_both_loads():
    assert len(regimes.CASES) == 8 * 11 * 2 == len(set(regimes.CASES))
    names = [run.name for run in regimes.NEEDED]
    assert len(set(names)) == len(names)
    assert runs.mapped(0, 10, 0.8).options["scene_points"] % 8192 == 0


def test_boundaries_of_theory_are_those_of_a_crack():
    results, half = Sliding(), 0.5 * WIDTH
    stiff = regimes.stiff_from(results, 25)
    peak = reference.peak_tangential_traction(stiff)
    angle = np.tan(np.pi * half / runs.PERIOD)
    crack = np.sqrt(2 * runs.PERIOD * angle * reference.front_work(0.0))
    assert 2 * half * peak == pytest.approx(crack, rel=1e-9)
    for maugis in (2.0, 10.0):
        rho = regimes.residual_boundary(results, maugis, 25, False)
        peak = reference.peak_tangential_traction(maugis)
        work = reference.front_work(rho)
        assert 2 * half * rho * peak == pytest.approx(np.sqrt(2 * runs.PERIOD * angle * work),
                                                      rel=1e-6)
        # A front needs less residual friction to be a tenth above the crack.
        early = regimes.residual_boundary(results, maugis, 25, True)
        force = max(reference.front_force(half, s, early * peak, reference.front_work(early),
                                          runs.PERIOD) for s in np.linspace(0.01, half, 4001))
        ratio = force / np.sqrt(2 * runs.PERIOD * angle * reference.front_work(early))
        assert early < rho and ratio == pytest.approx(1.1, rel=1e-4)


def test_force_at_which_a_traction_is_reached_lies_between_points():
    forces = np.array([0.0, 1.0, 2.0, 3.0])
    assert regimes.crossed(np.array([0.0, 0.5, 0.9, 0.7]), forces, 0.7) == pytest.approx(1.5)
    assert regimes.crossed(np.array([0.0, 0.5, 0.6, 0.65]), forces, 0.7) == 3.0


def test_least_height_is_that_of_the_steepest_fall():
    mean = np.linspace(0, 3, 301)
    force = np.sin(mean)
    # The steepest fall of the sine is 1, at pi.
    assert regimes.least_height(driven(np.linspace(0, 5, 501), np.sin(np.linspace(0, 5, 501)))
                                ) == pytest.approx(0.25, rel=1e-4)
    assert regimes.least_height(driven(mean, mean)) == np.inf
    turning = np.concatenate([mean, mean[::-1]])
    assert regimes.least_height(driven(turning, np.concatenate([force, force[::-1]]))) == 0.0


def test_a_crack_around_a_small_contact_turns_back_under_any_layer():
    # Stable under a low layer where the half width exceeds L/(pi e^2), nearly, as of a half-plane.
    class Small(Sliding):
        def __getitem__(self, name):
            return {"tangential_force": super().__getitem__(name)["tangential_force"] * 0.2}

    assert regimes.crack_height(Small(), 0.8) == 0.0
    assert 0.0 < regimes.crack_height(Sliding(), 25) < 0.2


def test_places_on_a_map_are_those_of_its_cells():
    assert regimes.place([0.1, 10.0], regimes.MAPPED, log=True) == pytest.approx([0, 9])
    assert regimes.place(0.05, regimes.RESIDUALS) == 2 and np.isnan(
        regimes.place(100.0, regimes.MAPPED, log=True))


def test_misfit_of_a_power_law_is_nothing_and_that_of_a_tail_positive():
    forces = np.linspace(0, 3, 60)
    power = Record(tangential_force=forces, contact_area=10.0 - 0.3 * forces ** 2,
                   tangential_displacement=80 * forces, event=np.full(60, "none"),
                   fold_kind=np.full(60, ""))
    tail = Record({**power, "contact_area": 10.0 - 2 * np.tanh(0.3 * forces ** 2)})
    fast = Record({**power, "contact_area": 10.0 - np.sinh(0.3 * forces ** 2)})
    assert abs(statements_residual.misfit(power)) < 1e-4
    assert statements_residual.misfit(tail) > 0.1 > -0.1 > statements_residual.misfit(fast)


def test_a_fold_at_which_all_slides_is_the_onset():
    events = np.array(["none", "none", "fold", "gross_sliding"])
    record = Record(tangential_force=np.array([0.0, 1.0, 1.5, 1.5]), event=events,
                    fold_kind=np.array(["", "", "sliding", ""]), contact_area=np.ones(4),
                    tangential_displacement=np.array([0.0, 80.0, 120.0, 120.0]))
    found = observed.onset(record)
    assert found.unstable and found.point == 2 and found.force == 1.5
