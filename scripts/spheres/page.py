"""Tables, figure and page of sheared spheres, from the columns of their runs."""

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.lines import Line2D

from contactsnes import reference
from contactsnes.output.figures.printed import PRINTED, lettered, panels, save
from contactsnes.output.figures.style import colours
from contactsnes.output.tables import markdown, measured, write_between

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "sphere.md"
FIGURE = ROOT / "scripts" / "sphere.png"
BEGIN = "<!-- scripts/sphere writes from here -->\n"
END = "<!-- scripts/sphere: as far as here -->\n"
BESIDE = {"grid": "finest", "cell": "grid", "steps": "grid"}
"""What is coarser in a run -> the run that it differs from in that alone."""
FRICTION = float(reference.peak_tangential_traction(1.0))
"""Strength of the friction over the tangential Maugis parameter, E* u_t,r/beta."""


class Runs:
    """The runs of a kind: values -> {what is coarser: columns}, `finest` among them."""

    def __init__(self, found, kind):
        self.of = {}
        for name, columns in found.items():
            first, *values, way = name.split("-")
            if first == kind:
                self.of.setdefault(tuple(map(float, values)), {})[way] = columns

    def numbers(self, function):
        """Values -> (number of the finest run, its error)."""
        return {values: _with_error({way: function(run) for way, run in runs.items()})
                for values, runs in sorted(self.of.items())}


def _with_error(numbers):
    """The finest number, and the sum of what grid, cell and steps change."""
    return numbers["finest"], sum(abs(number - numbers[BESIDE[way]])
                                  for way, number in numbers.items() if way in BESIDE)


def told(pair, digits=3):
    """A number with its error."""
    value, error = pair
    return f"{value:.{digits}g} ± {error:.1g}"


# What is read from a path


def area_at_rest(run):
    """Contact area before shear."""
    return run["contact_area"][0]


def largest_force(run):
    """Largest tangential force of the path, that of a parabola through three points."""
    return -_least(-run["tangential_force_x"])


def friction_stress(run):
    """Tangential force over the area at the onset of gliding."""
    return run["tangential_force_x"][-1] / run["contact_area"][-1]


def lost(run):
    """Part of the area that is lost at the onset of gliding."""
    return 1.0 - run["contact_area"][-1] / run["contact_area"][0]


def coefficient(run, part=0.1):
    """k of A = A_0 - k T^2 by least squares until a part of the area is lost."""
    fallen = run["contact_area"][0] - run["contact_area"]
    early = slice(0, max(3, int(np.argmax(fallen > part * run["contact_area"][0]))))
    square = run["tangential_force_x"][early] ** 2
    return float(square @ fallen[early] / (square @ square))


def curvature(run, part=0.8):
    """Largest distance from A_0 - k T^2, over the area lost up to a part of the largest force."""
    force = run["tangential_force_x"]
    early = slice(0, max(4, int(np.argmax(force > part * force.max()))))
    fallen = run["contact_area"][0] - run["contact_area"][early]
    square = force[early] ** 2
    fit = square * (square @ fallen) / (square @ square)
    return float(np.max(np.abs(fit - fallen)) / fallen[-1])


def elongation(run):
    """Largest half axis along the force over that across, less 1."""
    return float(np.max(run["half_axis_x"] / run["half_axis_y"])) - 1.0


def pull_off(run):
    """Least normal force of a retraction, that of a parabola through three points."""
    return _least(run["normal_force"])


def _least(values):
    """Least value, by a parabola through the least of the points and its neighbours."""
    place = int(np.argmin(values))
    if not 0 < place < len(values) - 1:
        return float(values[place])
    before, here, after = values[place - 1:place + 2]
    bend = before - 2 * here + after
    return float(here - (after - before) ** 2 / (8 * bend)) if bend > 0 else float(here)


# Theory


def griffith_coefficient(force):
    """k of A = A_0 - k T^2 of Savkoor and Briggs's contact."""
    small = 0.02 * float(reference.savkoor_briggs_sphere_strength(force)[1])
    radii = (float(reference.savkoor_briggs_sphere_radius(force, shear)) for shear in (0.0, small))
    first, second = (np.pi * radius ** 2 for radius in radii)
    return (first - second) / small ** 2


def exponent(sheared, maugis):
    """n of k ~ A_0^-n over the normal forces at a tangential Maugis parameter, with its error."""
    paths = [runs for (_, parameter), runs in sorted(sheared.of.items()) if parameter == maugis]
    if len(paths) < 2:
        return np.nan, np.nan
    return _with_error({way: -np.polyfit(
        np.log([area_at_rest(runs[way]) for runs in paths]),
        np.log([coefficient(runs[way]) for runs in paths]), 1)[0] for way in paths[0]})


# Tables


def tables(found):
    """All tables of the page, lines of Markdown."""
    sheared, pulled = Runs(found, "sheared"), Runs(found, "pulled")
    return [*_paths(sheared), "", *_laws(sheared), "", *_ranges(sheared), "", *_pulls(pulled)]


def _paths(sheared):
    """One row a path: forces, areas, shape."""
    columns = [sheared.numbers(function) for function in (area_at_rest, largest_force, lost,
                                                          friction_stress, elongation)]
    heading = ["normal force", "lambda_t", "A_0", "largest T", "area lost at gliding",
               "T/A there, over tau_max", "longest over width, less 1"]
    rows = []
    for force, maugis in columns[0]:
        area, largest, less, stress, longer = (column[force, maugis] for column in columns)
        rows.append([f"{force:g}", f"{maugis:g}", told(area, 4), told(largest, 4), told(less),
                     told([part / (FRICTION * maugis) for part in stress]), told(longer)])
    return markdown(heading, rows)


def _laws(sheared):
    """Area lost as the square of the force: coefficient beside theory, and how far it holds."""
    found, misfit = sheared.numbers(coefficient), sheared.numbers(curvature)
    rows = [[f"{force:g}", f"{maugis:g}", told(found[force, maugis]),
             f"{griffith_coefficient(force):.3g}",
             f"{found[force, maugis][0] / griffith_coefficient(force):.3g}",
             told(misfit[force, maugis], 2)] for force, maugis in found]
    parameters = sorted({maugis for _, maugis in found})
    several = [maugis for maugis in parameters if np.isfinite(exponent(sheared, maugis)[0])]
    forces = sorted({force for force, _ in found})
    theory = -np.polyfit(np.log([np.pi * float(reference.jkr_sphere_radius(force)) ** 2
                                 for force in forces]),
                         np.log([griffith_coefficient(force) for force in forces]), 1)[0] \
        if len(forces) > 1 else np.nan
    sentence = "; ".join(f"n = {told(exponent(sheared, maugis))} at lambda_t = {maugis:g}"
                         for maugis in several)
    return [*markdown(["normal force", "lambda_t", "k", "k of Savkoor and Briggs", "ratio",
                       "misfit up to 0.8 of the largest force"], rows), "",
            f"k ~ A_0^-n: {sentence or 'one force only'}; Savkoor and Briggs's has n = "
            f"{theory:.3g}."]


def _ranges(sheared):
    """What a longer range of slip changes, at fixed work and at fixed strength."""
    held = sorted({force for force, maugis in sheared.of if maugis not in (1.0, 2.0)}
                  or {force for force, _ in sheared.of})[:1]
    force, less, k = (sheared.numbers(function) for function in (largest_force, lost, coefficient))
    rows = []
    for key in [key for key in force if key[0] in held]:
        maugis = key[1]
        length = 1.0 / (FRICTION * maugis) ** 2
        rows.append([f"{maugis:g}", f"{length:.3g}", told(force[key], 4),
                     told([part / (FRICTION * maugis) for part in force[key]], 4),
                     told(less[key]), told(k[key]), told([part * maugis ** 2 for part in k[key]])])
    return markdown(["lambda_t", "cohesive length", "largest T, fixed work",
                     "fixed strength: over tau_max", "area lost at gliding", "k, fixed work",
                     "fixed strength: k lambda_t^2"], rows)


def _pulls(pulled):
    """Pull-off after shear, over that without."""
    found = pulled.numbers(pull_off)
    parameters = sorted({maugis for _, maugis in found})
    shares = sorted({share for share, _ in found})
    rows = []
    for share in shares:
        cells = []
        for maugis in parameters:
            whole, part = found[0.0, maugis], found[share, maugis]
            ratio = part[0] / whole[0]
            cells.append(told((ratio, (part[1] + abs(ratio) * whole[1]) / abs(whole[0]))))
        rows.append([f"{share:g}", *cells])
    return markdown(["sheared by, of what slides", *(f"pull-off over that without, lambda_t = "
                                                     f"{maugis:g}" for maugis in parameters)], rows)


# Figure and page


def draw(found, path):
    """Area and shape against the force beside theory, and pull-off after shear."""
    sheared, pulled = Runs(found, "sheared"), Runs(found, "pulled")
    with matplotlib.rc_context(PRINTED):
        figure, drawn = panels(2, 2)
        (area, shape), (quadratic, pulls) = drawn
        _draw_paths(sheared, area, shape, quadratic)
        _draw_pulls(pulled, pulls)
        lettered(drawn.flat)
        return save(figure, path)


def _draw_paths(sheared, area, shape, quadratic):
    """Paths of all forces at both parameters."""
    forces = sorted({force for force, _ in sheared.of})
    shades = dict(zip(forces, colours(len(forces))))
    for (force, maugis), runs in sheared.of.items():
        if maugis not in (1.0, 2.0):
            continue
        run, line = runs["finest"], "-" if maugis == 1.0 else "--"
        look = {"color": shades[force], "linestyle": line}
        shear, size = run["tangential_force_x"], run["contact_area"]
        area.plot(shear, size, **look)
        shape.plot(shear / shear.max(), run["half_axis_x"] / run["half_axis_y"], **look)
        quadratic.plot((shear / shear.max()) ** 2, size / size[0], **look)
    for force in forces:
        strength = float(reference.savkoor_briggs_sphere_strength(force)[1])
        shear = np.linspace(0, strength * (1 - 1e-9), 60)
        radius = np.array([float(reference.savkoor_briggs_sphere_radius(force, s)) for s in shear])
        area.plot(shear, np.pi * radius ** 2, color=shades[force], linestyle=":", linewidth=0.9)
        axes = []
        for part in np.linspace(0, 0.97, 20):
            axes.append((part, *reference.mixed_mode_ellipse(force, part * strength)))
        part, along, across = np.array(axes).T
        shape.plot(part, along / across, color=shades[force], linestyle=":", linewidth=0.9)
    area.set(xlabel=r"tangential force $T$ ($R\sqrt{\phi_n\phi_t}$)",
             ylabel=r"contact area $A/\beta^2$", ylim=(0, 45))
    shape.set(xlabel="tangential force over its largest", ylabel="half axis along over across",
              ylim=(0.995, 1.1))
    quadratic.set(xlabel="square of that", ylabel="area over that at rest",
                  ylim=(None, 1.25))
    handles = [Line2D([], [], color=shades[force], label=f"normal force {force:g}")
               for force in forces]
    styles = (("-", "$\\lambda_t=1$"), ("--", "$\\lambda_t=2$"), (":", "bonded (LEFM)"))
    handles += [Line2D([], [], color="black", linestyle=line, label=text) for line, text in styles]
    for axes, lines in ((area, handles), (shape, handles), (quadratic, handles[:-1])):
        axes.legend(handles=lines, ncols=2, loc="upper right" if axes is area else "best")


def _draw_pulls(pulled, axes):
    """Pull-off over that without shear, with error bars."""
    found = pulled.numbers(pull_off)
    for maugis, mark in zip(sorted({maugis for _, maugis in found}), "os^"):
        shares = sorted(share for share, other in found if other == maugis)
        ratio = [found[share, maugis][0] / found[0.0, maugis][0] for share in shares]
        error = [found[share, maugis][1] / abs(found[0.0, maugis][0]) for share in shares]
        axes.errorbar(shares, ratio, error, marker=mark, capsize=2,
                      label=f"$\\lambda_t={maugis:g}$")
    axes.fill_between([0.1, 0.8], 0.10, 0.15, color="0.85", linewidth=0,
                      label="Oliver and others")
    axes.set(xlabel="sheared by, of what slides", ylabel="pull-off over that without",
             ylim=(0, 1.05))
    axes.legend()


def write(found, path):
    """The figure, and the tables between the marks of the page."""
    draw(found, FIGURE)
    sheared, pulled = Runs(found, "sheared"), Runs(found, "pulled")
    parts = (_paths(sheared), _laws(sheared), _ranges(sheared), _pulls(pulled))
    titles = ("### Paths", "### Area lost as the square of the force",
              "### What a longer range changes", "### Pull-off after shear")
    text = [f"{measured(path)}", ""]
    for title, part in zip(titles, parts):
        text += [title, "", *part, ""]
    write_between(PAGE, BEGIN, END, "\n".join(text) + "\n")
