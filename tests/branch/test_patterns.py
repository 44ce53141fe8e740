"""Patterns of an egg-box, whose equal spots are all alike in what loads move: modes that no load
excites are told of, without certificates."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from contactsnes import Branch, Load, Scene  # noqa: E402
from contactsnes.contact import states  # noqa: E402
from contactsnes.dynamics import jumps  # noqa: E402
from contactsnes.scene.settings import Steps  # noqa: E402
from contactsnes.solvers import ritz  # noqa: E402

POINTS, PERIOD, PITCH = 64, 12.0, 3.0
STABLE, UNSTABLE = 0.0, -0.5


def branch_of(file, said, start=STABLE, end=UNSTABLE):
    """The branch of sixteen equal spots, pulled; their slope is 1, so that they attract each other
    over the gaps between them."""
    wave = 2 * np.pi / PITCH * np.arange(POINTS) * PERIOD / POINTS
    np.save(file, PITCH / (2 * np.pi) * (np.cos(wave)[:, None] + np.cos(wave)))
    scene = Scene(dimension=2, geometry="file", geometry_file=str(file), points=POINTS,
                  period=PERIOD, normal_maugis=2.0)
    return Branch(scene, Load(start=f"normal_displacement={start}",
                              path=f"normal_displacement={end}"),
                  steps=Steps(initial_step=0.1, largest_step=0.1), log=said.append)


@pytest.fixture(params=[True, False])
def pulled(request, tmp_path, monkeypatch):
    """Whether solves are stirred, a branch that has lost its stability to a pattern, its points,
    and what it said."""
    if not request.param:
        monkeypatch.setattr(ritz, "STIRRED", 0.0)
    said = []
    branch = branch_of(tmp_path / "heights.npy", said)
    return request.param, branch, list(branch), said


def test_a_pattern_is_told_of_where_solves_are_stirred(pulled):
    stirred, _, points, said = pulled
    assert any(sentence.startswith("the branch is not stable") or "points beyond are not stable"
               in sentence for sentence in said) == stirred
    assert any(sentence.startswith("the end of leg 1") for sentence in said) != stirred
    assert (points[-1].softest < 0.0) == stirred
    assert points[0].softest > 0.0 and points[-1].load[0] == UNSTABLE


@pytest.mark.parametrize("told", (True, False))
def test_patterns_of_equal_spots_of_a_line_are_told_of(told, monkeypatch):
    """Four of them lose two at once, which a load that moves all alike does not excite: between the
    same points as where all modes are looked for."""
    if not told:
        monkeypatch.setattr(ritz, "STIRRED", 0.0)
    said, load = [], Load(start="normal_displacement=-1.5", path="normal_displacement=-2.3")

    def branch(stability):
        return list(Branch(Scene(geometry="flat", points=384, period=48.0, normal_maugis=1.0), load,
                           Steps(initial_step=0.2, largest_step=0.2, stability=stability),
                           geometry=lambda x: 1.5 * (1 - np.cos(np.pi * x / 6)), log=said.append))

    sentence = "2 modes of the branch change their sign between normal_displacement -1.7 and " \
        "normal_displacement -1.9:"
    plain = branch("off")
    assert any(words.startswith(sentence) for words in said) == told
    certified = branch("sign")
    assert [point.load[0] for point in certified if point.event == "bifurcation"] == pytest.approx(
        [-1.71478], abs=1e-4)
    assert plain[-1].forces[0] == pytest.approx(certified[-1].forces[0], rel=1e-6)


@pytest.mark.parametrize("told", (True, False))
def test_patterns_of_a_body_that_couples_components_are_told_of(told, monkeypatch):
    """As above, where tangential displacements are odd about the apex as long as a state is even:
    what vanishes there may not be stirred."""
    if not told:
        monkeypatch.setattr(ritz, "STIRRED", 0.0)
    said, load = [], Load(start="normal_displacement=-1.5", path="normal_displacement=-2.1")

    def branch(stability):
        return list(Branch(Scene(geometry="flat", points=288, period=48.0, normal_maugis=1.0,
                                 poisson=0.3, height="inf"), load,
                           Steps(initial_step=0.2, largest_step=0.2, stability=stability),
                           geometry=lambda x: 1.5 * (1 - np.cos(np.pi * x / 6)), log=said.append))

    plain = branch("off")
    assert any(words.startswith("2 modes of the branch change their sign between "
                                "normal_displacement -1.7, tangential_displacement 0 and "
                                "normal_displacement -1.9, ") for words in said) == told
    certified = branch("sign")
    assert [point.load[0] for point in certified if point.event == "bifurcation"] == pytest.approx(
        [-1.76294], abs=1e-4)
    assert plain[-1].forces[0] == pytest.approx(certified[-1].forces[0], rel=1e-6)


def test_motion_leaves_the_state_to_a_pattern(pulled):
    """With inertia, from beside it by a wave as long as the cell: what is told is true."""
    _, branch, points, _ = pulled
    wave = 0.2 * np.cos(2 * np.pi * np.arange(POINTS) / POINTS)[:, None] * np.ones(POINTS)
    for point, leaves in ((points[0], False), (points[-1], True)):
        state = states.State(point.state.window, point.state.displacement
                             + point.state.window.take(wave)[None], point.state.means)
        end = jumps.by_inertia(branch.corrector, state, point.controls, point.load, "here")
        moved = states.missed(branch.contact, point.state, end.state, largest=True)
        assert moved > 1.0 if leaves else moved < 1e-4


def test_a_first_point_that_is_not_stable_is_told_of(tmp_path):
    said = []
    point = next(iter(branch_of(tmp_path / "heights.npy", said, UNSTABLE, STABLE)))
    assert point.softest < 0.0
    assert any("the first point" in sentence and "not stable: 4 modes" in sentence
               for sentence in said)
