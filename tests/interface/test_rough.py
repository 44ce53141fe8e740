"""Self-affine roughness: its spectrum, its slope, and that it is the same surface on every grid;
contacts on it."""


import numpy as np
import petsc4py
import pytest
from processes import call

petsc4py.init([])

from contactsnes.branch.accuracy import Estimator, finer_contact  # noqa: E402
from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.branch.grid_choice import chosen  # noqa: E402
from contactsnes.contact.problem import Contact  # noqa: E402
from contactsnes.grid.cell import Grid  # noqa: E402
from contactsnes.interface import shapes  # noqa: E402
from contactsnes.interface.roughness import surface  # noqa: E402
from contactsnes.options.fields import InputError  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Scene, Steps, attributes, check, ineffective  # noqa: E402

LINE = ((100.0,), 0.7, 0.4, 50.0, 0.5, 3)
PLANE = ((20.0, 20.0), 0.6, 0.3, 10.0, 0.5, 3)
UNEQUAL = ((20.0, 30.0), 0.6, 0.3, 15.0, 0.9, 3)
CASES = ((LINE, (1024,)), (PLANE, (256, 256)), (UNEQUAL, (128, 256)))
ROUGH = dict(geometry="rough", rough_slope=0.4, rough_longest=20.0, rough_shortest=1.0,
             normal_maugis=2.0, period=40.0, points=512)

every_surface = pytest.mark.parametrize("given, points", CASES)


class Waves:
    """All waves of a surface: arrays of their whole numbers (directions, waves), amplitudes,
    phases."""

    def __init__(self, found):
        blocks = list(found.blocks())
        self.periods = found.periods
        self.numbers = np.concatenate([numbers for numbers, _, _ in blocks], axis=1)
        self.amplitudes, self.phases = (np.concatenate(parts)
                                        for parts in list(zip(*blocks))[1:])

    @property
    def wavevectors(self):
        return 2 * np.pi * self.numbers / np.array(self.periods)[:, None]


def heights_of(given, points, *more):
    """Heights of the surface of some arguments on a grid of its cell."""
    return surface(*given, *more).heights(Grid(points, given[0]))


def waves(heights, periods):
    """Wave number and |amplitude| of all waves of a field, each once: NumPy's own transform."""
    spectrum = np.fft.fftn(heights) / heights.size
    q = np.meshgrid(*(2 * np.pi * np.fft.fftfreq(n, length / n)
                      for n, length in zip(heights.shape, periods)), indexing="ij")
    return np.sqrt(sum(component ** 2 for component in q)), q, np.abs(spectrum)


def summed(found, x):
    """h at places (directions, places), wave by wave, as the module's docstring has it."""
    angles = found.wavevectors.T @ (x + np.array(found.periods)[:, None] / 2) + found.phases[:,
                                                                                             None]
    return found.amplitudes @ np.cos(angles)


@every_surface
def test_heights_are_the_sum_of_the_waves(given, points):
    found = Waves(surface(*given))
    grid = [(np.arange(n) - n // 2) * length / n for n, length in zip(points, given[0])]
    places = np.random.default_rng(1).integers(0, points, (20, len(points)))
    x = np.array([axis[index] for axis, index in zip(grid, places.T)])
    np.testing.assert_allclose(heights_of(given, points)[tuple(places.T)], summed(found, x),
                               atol=1e-13)


@every_surface
def test_slope_is_exact_on_the_grid(given, points):
    """Root mean square of the gradient of the waves through the nodes."""
    heights = heights_of(given, points)
    spectrum, axes = np.fft.fftn(heights), waves(heights, given[0])[1]
    gradient = [np.fft.ifftn(1j * q * spectrum).real for q in axes]
    assert np.sqrt(np.mean(sum(slope ** 2 for slope in gradient))) == pytest.approx(given[2],
                                                                                    rel=1e-12)
    assert abs(np.mean(heights)) < 1e-15


@every_surface
def test_spectrum_falls_as_a_power_between_its_ends(given, points):
    periods, hurst, _, longest, shortest, _ = given
    q, _, amplitude = waves(heights_of(given, points), periods)
    inside = (q >= 2 * np.pi / longest * (1 - 1e-6)) & (q < 2 * np.pi / shortest * (1 - 1e-6))
    assert np.all(amplitude[~inside] < 1e-14) and np.all(amplitude[inside] > 1e-9)
    slope, _ = np.polyfit(np.log(q[inside]), 2 * np.log(amplitude[inside]), 1)
    assert slope == pytest.approx(-(2 * hurst + len(periods)), rel=1e-6)


@every_surface
def test_a_finer_grid_has_the_same_surface(given, points):
    heights = heights_of(given, points)
    finer = heights_of(given, tuple(2 * n for n in points))
    np.testing.assert_allclose(finer[(slice(None, None, 2),) * len(points)], heights, atol=1e-13)
    coarse = heights_of(given, tuple(n // 16 for n in points))  # too coarse for most waves
    np.testing.assert_allclose(coarse, heights[(slice(None, None, 16),) * len(points)],
                               atol=1e-13)


def test_shorter_waves_are_added_to_those_that_are_there():
    for given in (LINE, PLANE, UNEQUAL):
        longer, shorter = (Waves(surface(*given[:4], shortest, 3)) for shortest in (2.0, 0.7))
        phases = {tuple(number): phase for number, phase in zip(shorter.numbers.T, shorter.phases)}
        assert len(phases) == len(shorter.phases) > 2 * len(longer.phases)
        assert all(phases[tuple(number)] == phase for number, phase in zip(longer.numbers.T,
                                                                           longer.phases))


def test_waves_come_once():
    for given in (LINE, PLANE, UNEQUAL):
        numbers = {tuple(number) for number in Waves(surface(*given)).numbers.T}
        assert not numbers & {tuple(-np.array(number)) for number in numbers}


def test_the_plane_has_no_direction():
    """On a square its waves come with their mirror images: slopes along x and y are equal, and so
    are those along diagonals."""
    found = Waves(surface(*PLANE))
    q, squares = found.wavevectors, found.amplitudes ** 2
    assert np.sum(squares * q[0] ** 2) == pytest.approx(np.sum(squares * q[1] ** 2), rel=1e-12)
    assert abs(np.sum(squares * q[0] * q[1])) < 1e-12 * np.sum(squares * q[0] ** 2)
    angle = (np.arctan2(q[1], q[0]) + 0.1) % np.pi  # no limit of a class where there are many waves
    classes, _ = np.histogram(angle, bins=8, range=(0, np.pi),
                              weights=squares * np.sum(q ** 2, axis=0))
    assert np.ptp(classes) < 0.15 * classes.mean()
    assert surface(*PLANE).rms(1, 0) == pytest.approx(PLANE[2] / np.sqrt(2), rel=1e-12)


def test_phases_are_random_and_belong_to_the_seed():
    phases = [Waves(surface(*LINE[:5], seed)).phases for seed in range(5)]
    assert all(np.max(np.abs(one - other)) > 1 for one, other in zip(phases, phases[1:]))
    together = np.concatenate(phases) / (2 * np.pi)
    assert 0 <= together.min() and together.max() < 1
    assert together.mean() == pytest.approx(0.5, abs=4 * np.sqrt(1 / 12 / together.size))
    # Heights of many waves are close to normal: no fourth cumulant.
    heights = heights_of(((100.0,), 0.0, 1.0, 100.0, 0.1, 5), (8192,))
    assert np.mean(heights ** 4) / np.mean(heights ** 2) ** 2 == pytest.approx(3, abs=0.5)


def test_roots_of_mean_squares():
    found = surface(*LINE)
    heights, (q,) = heights_of(LINE, (2048,)), (2 * np.pi * np.fft.fftfreq(2048, 100 / 2048),)
    assert (found.rms(0) == pytest.approx(np.std(heights), rel=1e-12)
            and found.rms(1) == pytest.approx(0.4, rel=1e-12))
    curvature = np.fft.ifft(-q ** 2 * np.fft.fft(heights)).real
    assert found.rms(2) == pytest.approx(np.std(curvature), rel=1e-12)


@pytest.mark.parametrize("given, points", ((LINE, (2 ** 17,)), (PLANE, (2048, 2048)),
                                           (LINE[:2] + (4.0,) + LINE[3:], (2 ** 17,))))
def test_the_lowest_place_lies_between_nodes(given, points):
    """A fine grid comes as near to it as the curvature lets it, from above."""
    found, grid = surface(*given), Grid(points, given[0])
    above = found.gap(grid).min() - found.lowest(grid)
    step = np.array(given[0]) / points
    assert -1e-12 < above < 0.125 * np.sum(step ** 2) * (1 + 6 * found.rms(2))


@pytest.mark.parametrize("dimension", (1, 2))
def test_the_gap_is_a_parabola_with_roughness(dimension):
    scene = Scene(**{**ROUGH, "points": 128, "rough_seed": 2, "gap_offset": -0.3},
                  dimension=dimension)
    contact = Contact(scene)
    found = surface(scene.periods, 0.8, 0.4, 20.0, 1.0, 2)
    lowest = found.lowest(contact.grid)
    parabola = sum(x ** 2 for x in contact.grid.coordinates()) / 2
    np.testing.assert_allclose(contact.initial_gap / 2.0, parabola
                               - found.heights(contact.grid) - lowest - 0.3, atol=1e-12)
    assert -0.3 <= contact.initial_gap.min() / 2.0 < -0.2


def test_coarser_and_finer_contacts_have_the_same_surface():
    contact = Contact(Scene(**ROUGH))
    coarse, finer = contact.coarse(1.25), finer_contact(contact, 4)
    np.testing.assert_allclose(coarse.initial_gap * contact.ranges[0] / coarse.ranges[0],
                               contact.initial_gap[::2], rtol=1e-13)
    np.testing.assert_allclose(finer.initial_gap[::4], contact.initial_gap, atol=1e-11)
    while coarse.grid.size > 16:  # coarser than its waves
        coarse = coarse.coarse(1.25)


def test_what_is_too_coarse_or_has_no_wave_is_refused():
    load = Load(path="normal_force=1")
    for points, fits in ((80, True), (78, False), ("auto", True)):
        scene = Scene(**{**ROUGH, "points": points})
        if fits:
            check(scene, load)
            continue
        with pytest.raises(InputError, match="-scene_rough_shortest is '1': allowed is "
                           "at least two spacings of the grid, 1.02564"):
            check(scene, load)
    with pytest.raises(InputError, match="leave no wave"):
        Contact(Scene(**{**ROUGH, "rough_longest": 1.2, "rough_shortest": 1.19}))
    with pytest.raises(InputError, match="-scene_period is '40': the rough body "
                       "would be in contact up to the edge"):
        Branch(Scene(**ROUGH, gap_offset=-220.0), load)


@pytest.mark.parametrize("dimension", (1, 2))
def test_a_flat_is_rough_without_a_parabola(dimension):
    scene = Scene(**{**ROUGH, "points": 128, "rough_seed": 2, "rough_on": "flat"},
                  dimension=dimension)
    contact = Contact(scene)
    found = surface(scene.periods, 0.8, 0.4, 20.0, 1.0, 2, curvature=0.0)
    lowest = found.lowest(contact.grid)
    np.testing.assert_allclose(contact.initial_gap / 2.0, -found.heights(contact.grid) - lowest,
                               atol=1e-12)
    assert abs(np.mean(contact.initial_gap) / 2.0 + lowest) < 1e-12  # roughness has no mean
    finest = -found.heights(Grid((2048,) * dimension, scene.periods)).max()
    assert contact.initial_gap.min() >= 0.0 and -1e-9 < finest - lowest < 2e-3
    finer = finer_contact(contact, 2).initial_gap
    np.testing.assert_allclose(finer[(slice(None, None, 2),) * dimension], contact.initial_gap,
                               atol=1e-11)


def test_a_rough_flat_touches_up_to_the_edge_of_its_cell():
    scene = Scene(**{**ROUGH, "points": 256, "rough_on": "flat", "gap_offset": -3.0})
    point = list(Branch(scene, Load(path="normal_displacement=0.5")))[-1]
    assert point.residual_norm < 1e-8 and point.in_contact


@every_surface
def test_the_spectrum_is_flat_beyond_the_roll_off(given, points):
    periods, hurst, slope, longest, shortest, _ = given
    rolloff = 0.4 * longest
    heights = heights_of(given, points, rolloff)
    q, axes, amplitude = waves(heights, periods)
    inside = (q >= 2 * np.pi / longest * (1 - 1e-6)) & (q < 2 * np.pi / shortest * (1 - 1e-6))
    long = inside & (q < 2 * np.pi / rolloff)
    assert long.any() and np.ptp(amplitude[long]) < 1e-9 * amplitude[long].max()
    power, level = np.polyfit(np.log(q[inside & ~long]), 2 * np.log(amplitude[inside & ~long]), 1)
    assert power == pytest.approx(-(2 * hurst + len(periods)), rel=1e-6)
    assert 2 * np.log(amplitude[long].mean()) == pytest.approx(
        power * np.log(2 * np.pi / rolloff) + level, rel=1e-9)
    spectrum = np.fft.fftn(heights)
    gradient = [np.fft.ifftn(1j * wave * spectrum).real for wave in axes]
    assert np.sqrt(np.mean(sum(part ** 2 for part in gradient))) == pytest.approx(slope, rel=1e-9)


def test_a_roll_off_longer_than_the_longest_wave_is_refused():
    with pytest.raises(InputError, match="-scene_rough_rolloff is '30': allowed is at most the "
                       "longest wave, 20"):
        check(Scene(**ROUGH, rough_rolloff=30.0), Load())


def test_a_rough_flat_in_si_needs_no_radius():
    typed = dict(units="si", work_of_adhesion_normal=0.05, work_of_adhesion_tangential=0.05,
                 contact_modulus=25e6, range_normal=60e-9, range_tangential=60e-9)
    scene = Scene.typed(**typed, geometry="rough", rough_on="flat", dimension=2, period=1e-4,
                        rough_slope=1.0, rough_longest=2e-5, rough_shortest=4e-6, points=64)
    found = Contact(scene).initial_gap * 60e-9
    spectrum, q = np.fft.fft2(found), 2j * np.pi * np.fft.fftfreq(64, 1e-4 / 64)
    squares = sum(np.mean(np.fft.ifft2(wave * spectrum).real ** 2) for wave in (q[:, None], q))
    assert np.sqrt(squares) == pytest.approx(1.0, rel=1e-9)


def test_options_have_effect_on_rough_geometries_only():
    scene, load = Scene(**ROUGH), Load()
    names = [f"scene_rough_{name}" for name in ("on", "hurst", "slope", "longest", "shortest",
                                                  "rolloff", "seed")]
    assert (not ineffective(scene, load, names)
            and [name for name, _ in ineffective(Scene(), load, names)] == names)
    told = attributes(Scene(**{**ROUGH, "rough_longest": None}))
    assert told["rough_longest"] == told["rough_rolloff"] == 40.0
    assert not [name for name in attributes(Scene()) if name.startswith("rough")]


def test_si_converts_waves_and_slope():
    typed = dict(units="si", work_of_adhesion_normal=0.03, work_of_adhesion_tangential=0.03,
                 contact_modulus=2e6, radius=0.01, range_normal=0.6e-6, range_tangential=1e-6)
    scene = Scene.typed(**typed, geometry="rough", period=4e-3, rough_slope=5e-3,
                        rough_longest=2e-3, rough_shortest=2e-4, points=256)
    beta = (0.01 ** 2 * 0.03 / 2e6) ** (1 / 3)
    scaled = (0.8, 5e-3 * 0.01 / beta, 2e-3 / beta, 2e-4 / beta, 0, 2e-3 / beta, 1.0)
    assert shapes.of(scene).roughness(scene) == pytest.approx(scaled, rel=1e-12)
    assert attributes(scene)["rough_slope"] == 5e-3 and attributes(scene)["rough_shortest"] == 2e-4
    heights = Contact(scene).initial_gap * 0.6e-6 - ((np.arange(256) - 128) * 4e-3
                                                     / 256) ** 2 / 0.02
    slope = np.fft.ifft(2j * np.pi * np.fft.fftfreq(256, 4e-3 / 256) * np.fft.fft(heights)).real
    assert np.sqrt(np.mean(slope ** 2)) == pytest.approx(5e-3, rel=1e-9)


# Contacts


def test_errors_of_a_rough_contact_fall_with_the_spacing():
    """The surface does not change: the force converges as for a smooth body, and estimates see its
    errors."""
    forces, estimates = [], []
    for points in (256, 512, 2048):
        branch = Branch(Scene(**{**ROUGH, "points": points}), Load(path="normal_displacement=3"),
                        Steps(initial_step=3.0, largest_step=3.0))
        last = list(branch)[-1]
        assert last.residual_norm < 1e-8 and last.in_contact
        forces.append(last.forces[0])
        estimates.append(Estimator(branch.contact)(last))
    errors = np.abs(np.array(forces[:2]) / forces[2] - 1)
    assert errors[1] < 0.02 * errors[0] < 1e-3
    assert estimates[0].normal_force == pytest.approx(errors[0], rel=0.2)


def test_a_plane_with_roughness_is_pressed_and_sheared():
    scene = Scene(geometry="rough", dimension=2, rough_slope=0.4, rough_shortest=1.0,
                  rough_longest=6.0, normal_maugis=2.0, period=12.0, points=64)
    smooth = Scene(geometry="sphere", dimension=2, normal_maugis=2.0, period=12.0, points=64)
    load = Load(path="normal_displacement=2; tangential_displacement_x=20")
    steps = Steps(largest_step=(1.0, 20.0), initial_step=(1.0, 20.0))
    rough, plain = ([branch.observe(point) for point in branch][-1]
                    for branch in (Branch(scene, load, steps), Branch(smooth, load, steps)))
    assert rough["residual_norm"] < 1e-8 and rough["contact_area"] < plain["contact_area"]
    # no symmetry
    assert rough["tangential_force_x"] > 0 and abs(rough["tangential_force_y"]) > 1e-9


def test_chosen_points_resolve_the_waves():
    scene = chosen(Scene(**{**ROUGH, "points": "auto", "accuracy": 1e-3, "rough_shortest": 0.05}),
                   Load(path="normal_force=1"))
    assert scene.spacings[0] <= 0.025
    smooth = chosen(Scene(**{**ROUGH, "points": "auto", "geometry": "cylinder", "accuracy": 1e-3}),
                    Load(path="normal_force=1"))
    assert smooth.spacings[0] > 0.1


def test_the_command_line_takes_roughness(tmp_path):
    words = ("-scene_geometry rough -scene_rough_slope 0.3 -scene_rough_shortest 1 "
             "-scene_rough_seed 7 -scene_period 40 -scene_points 256 "
             "-scene_normal_maugis 2 -load_path normal_force=1")
    told_by = lambda command, *more: call(command, *words.split(), *more, folder=tmp_path)
    told = told_by("info")
    assert (told.returncode == 0 and "roughness: Hurst exponent 0.8, 39 waves "
            "shorter than 40 beta and longer than 1 "
            "beta, seed 7" in told.stdout)
    assert "no symmetry is used: the initial gap is not even about the apex" in told.stdout
    assert told_by("run", "-archive_file", "run.h5", "-archive_fields", "last").returncode == 0
    refused = told_by("run", "-scene_rough_hurst", "2")
    assert refused.returncode == 2 and "-scene_rough_hurst is '2'" in refused.stderr
