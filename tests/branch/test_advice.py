"""What is known before a scene is solved: theory, cohesive lengths, costs, the layer's share, and
what resolves a law that is out of reach."""

import math
from dataclasses import replace

import petsc4py
import pytest

petsc4py.init([])

from contactsnes.branch import advice, reach, theory  # noqa: E402
from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.branch.grid_choice import on  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.resolution import resolution  # noqa: E402
from contactsnes.scene.settings import Output, Scene, Steps  # noqa: E402

SPHERE = Scene(dimension=2, geometry="sphere", normal_maugis=40.0, tangential_maugis=2.0,
               period=12.0, points=512)
SHEARED = Load(path="normal_force=5; tangential_displacement_x=20")


def told(value, unit, digits):
    return f"{value:.{digits}g} {unit}"


def test_theory_of_a_sharp_law_is_that_of_jkr():
    """a^3 = (3/4) (W + 3 pi + sqrt(6 pi W + 9 pi^2)), pull-off at -3 pi/2."""
    found = theory.theory(SPHERE, 5.0)
    radius = (0.75 * (5 + 3 * math.pi + math.sqrt(30 * math.pi + 9 * math.pi ** 2))) ** (1 / 3)
    assert found.radius == pytest.approx(radius, rel=2e-3)
    assert found.pull_off == pytest.approx(-1.5 * math.pi, rel=1e-3)
    line = theory.theory(Scene(normal_maugis=40.0), 0.0)
    assert line.radius == pytest.approx((32 / math.pi) ** (1 / 3), rel=2e-3)
    assert line.pull_off == pytest.approx(-1.743671, rel=1e-3)
    assert theory.theory(Scene(geometry="sinusoid"), 0.0) is None


def test_cohesive_lengths_are_modulus_times_work_over_strength_squared():
    scene = Scene.typed(units="si", radius=0.01, contact_modulus=2e6, work_of_adhesion_normal=0.03,
                        work_of_adhesion_tangential=0.05, adhesive_strength=4e4,
                        shear_strength=3e5)
    length = scene.scale("beta")[0]
    normal, tangential = (length * value for value in theory.cohesive_lengths(scene))
    assert normal == pytest.approx(2e6 * 0.03 / 4e4 ** 2, rel=1e-12)
    assert tangential == pytest.approx(2e6 * 0.05 / 3e5 ** 2, rel=1e-12)


def test_the_share_of_the_layer_is_that_of_a_solved_branch():
    """U = mean slip + T H/(G A) with G = E*/4 at Poisson ratio 1/2: from theory, and solved."""
    scene = Scene(normal_maugis=3.0, tangential_maugis=0.5, points=1024, period=40.0, height=100.0)
    layer, contact = theory.layer_share(scene, theory.theory(scene, 5.0))
    branch = Branch(scene, Load(path="normal_force=5; tangential_displacement=200",
                                stop="gross_sliding"))
    last = branch.observe(list(branch)[-1])
    force, displacement = last["tangential_force"], last["tangential_displacement"]
    assert (displacement - last["mean_tangential_displacement"]
            == pytest.approx(force * 100 / (0.25 * 40), rel=1e-9))
    solved = force * 10 / displacement
    assert layer / (layer + contact) == pytest.approx(solved, abs=0.05)


def test_lines_tell_all_of_it():
    scene = replace(SPHERE, height=12.0)
    lines = advice.advice(scene, SHEARED, Output(file="x.h5", fields="all"), told, Steps())
    text = "\n".join(lines)
    for words in ("contact by theory", "pull-off at", "cohesive length", "cost, about", "of disk",
                  "% of the displacement of its top", "out of reach", "-scene_normal_maugis"):
        assert words in text
    assert "out of reach" not in "\n".join(advice.advice(replace(scene, normal_maugis=3.0), SHEARED,
                                                         Output(), told))


def test_the_ring_of_attraction_is_what_counts_as_contact():
    """Its area by theory, and contact_area of a solved branch."""
    scene = Scene(dimension=2, geometry="sphere", normal_maugis=3.0, tangential_maugis=1.5,
                  residual_friction=1.0, height=math.inf, points=128, period=16.0)
    load = Load(path="normal_force=4; tangential_displacement_x=40", stop="gross_sliding")
    found = theory.theory(scene, 4.0)
    branch = Branch(scene, load, Steps(largest_step=(3.0, 0.5), initial_step=(1.0, 0.25)))
    rows = [branch.observe(point) for point in branch]
    pressed = [row for row in rows if row["leg"] == 1][-1]
    assert math.pi * found.outer ** 2 == pytest.approx(pressed["contact_area"], rel=0.05)
    assert 0.8 * found.outer < found.radius < found.outer
    lines = advice.advice(scene, load, Output(), told)
    assert any(line.startswith("with the ring of attraction") for line in lines)
    # friction over all of it, and what is left of it once slip has taken the adhesion away
    slides = theory.contact_displacement(scene, found)
    assert 0.5 * slides < rows[-1]["tangential_displacement_x"] < 1.1 * slides


def test_long_and_short_paths_are_told():
    scene = replace(SPHERE, normal_maugis=3.0, height=math.inf)
    slides = theory.contact_displacement(scene, theory.theory(scene, 5.0))
    for part, words in ((0.5, "the path ends at 0.5 of that"), (2.0, ""),
                        (20.0, "the path goes 20 times as far, and steps are parts of its leg")):
        load = Load(path=f"normal_force=5; tangential_displacement_x={part * slides}")
        lines = advice.advice(scene, load, Output(), told)
        assert any(line.startswith("all of it slips at") for line in lines)
        assert words in "\n".join(lines)
        assert ("the path" in "\n".join(lines)) == bool(words)


def test_contacts_that_are_too_large_are_told():
    """For their cell, and for the sphere: a Young's modulus typed in MPa."""
    scene = replace(SPHERE, normal_maugis=3.0, period=7.0)
    text = "\n".join(advice.advice(scene, SHEARED, Output(), told))
    assert "of the cell's width, neighbours matter: -scene_period" in text
    soft = Scene.typed(units="si", dimension=2, geometry="sphere", radius=9.42e-3,
                       young_modulus=1.5, work_of_adhesion_normal=0.027,
                       work_of_adhesion_tangential=0.027, adhesive_strength=2e4,
                       shear_strength=3e4)
    text = "\n".join(advice.advice(soft, Load(path="normal_force=1e-3"), Output(), told))
    assert "of the radius of curvature: strains are not small" in text
    fits = replace(SPHERE, normal_maugis=3.0, period=16.0)
    assert "neighbours" not in "\n".join(advice.advice(fits, SHEARED, Output(), told))


def test_softer_laws_are_resolved():
    for scene in (SPHERE, replace(SPHERE, normal_maugis=4.0, tangential_maugis=30.0)):
        fits = on(scene, (256, 256))
        normal, tangential = reach.softened(fits, True)
        softer = replace(fits, normal_maugis=normal, tangential_maugis=tangential)
        assert 0.9 < max(resolution(softer, True)) <= 1.0
