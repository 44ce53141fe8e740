"""Tables, figures and page of the contact-mechanics challenge, from the columns of its runs."""

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.lines import Line2D

from contactsnes import reference
from contactsnes.grid.counter import weighed
from contactsnes.output.figures.printed import PRINTED, lettered, panels, save
from contactsnes.output.figures.style import GREY, colours
from contactsnes.output.tables import markdown, measured, write_between

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "rough.md"
FIGURE = ROOT / "scripts" / "rough.png"
SHEAR_FIGURE = ROOT / "scripts" / "rough-shear.png"
BEGIN = "<!-- scripts/rough writes from here -->\n"
END = "<!-- scripts/rough: as far as here -->\n"
AREA, LENGTH, FORCE = 1e-8, 1e-4, 2.5e-3
"""Of the cell, m^2; its period, m; the largest normal force, N."""


OTHERS = {"fine": ", waves of 128²"}
"""Waves of runs that have not those of their grid, in words."""


def runs_of(found, kind):
    """Name without the kind -> columns of the runs of a kind."""
    return {name.removeprefix(f"{kind}-"): run for name, run in found.items()
            if name.startswith(kind)}


def of_the_grid(found):
    """The runs without shear whose surface has the waves of their grid, or all where none has."""
    every = runs_of(found, "pressed")
    return {name: run for name, run in every.items() if not name.endswith(tuple(OTHERS))} or every


def told(name):
    """A run's name in words."""
    points, seed, *waves = name.split("-")
    return f"{points}², seed {seed}{OTHERS[waves[0]] if waves else ''}"


def full(run):
    """Index of the point at 250 kPa: the last of the second leg."""
    return int(np.flatnonzero(run["leg"] == 2)[-1])


def at(run, force, leg):
    """Contact area at a normal force on loading (1, with the second leg) or unloading (3)."""
    part = run["leg"] == 3 if leg == 3 else run["leg"] <= 2
    order = np.argsort(run["normal_force"][part], kind="stable")
    return float(np.interp(force, run["normal_force"][part][order],
                           run["contact_area"][part][order]))


def tables(found):
    """All tables of the page, lines of Markdown."""
    pressed, sheared = runs_of(found, "pressed"), runs_of(found, "sheared")
    return [*_pressed(pressed), "", *_loops(pressed), "", *_sheared(sheared)]


def _pressed(pressed):
    """One row a run: what there is at 250 kPa."""
    heading = ["grid", "D (µm)", "area (%)", "counted, edges corrected (%)", "spots",
               "largest spot (µm²)", "mean spot (µm²)", "mean gap (nm)", "dW/dD (kN/m)"]
    rows = []
    for name, run in pressed.items():
        value = {column: run[column][full(run)] for column in (
            "normal_displacement", "contact_area", "corrected_area", "spots", "largest_spot",
            "mean_spot", "mean_gap", "stiffness")}
        rows.append([told(name), f"{1e6 * value['normal_displacement']:.4f}",
                     *(f"{100 * value[column] / AREA:.3f}" for column in ("contact_area",
                                                                          "corrected_area")),
                     f"{value['spots']}", f"{1e12 * value['largest_spot']:.1f}",
                     f"{1e12 * value['mean_spot']:.2f}", f"{1e9 * value['mean_gap']:.1f}",
                     f"{1e-3 * value['stiffness']:.3f}"])
    return markdown(heading, rows)


def _loops(pressed):
    """One row a run: what differs between loading and unloading, and what the path took."""
    heading = ["grid", "largest attraction (µN)", "area at 2.5 kPa, pressed (%)", "pulled (%)",
               "lost in jumps (fJ)", "imbalance of energies (fJ)", "jumps", "points",
               "rejected steps", "transforms", "time (s)"]
    rows = []
    for name, run in pressed.items():
        jumps = np.count_nonzero(run["event"] == "jump")
        rows.append([told(name), f"{-1e6 * run['normal_force'].min():.3f}",
                     *(f"{100 * at(run, 0.01 * FORCE, leg) / AREA:.4f}" for leg in (1, 3)),
                     *(f"{1e15 * run[column][-1]:.3g}" for column in ("dissipated_work",
                                                                      "energy_imbalance")),
                     str(jumps),
                     str(len(run["leg"])), str(run["rejected"][0]),
                     f"{weighed(run).sum():.0f}", f"{run['wall_time'].sum():.0f}"])
    return markdown(heading, rows)


def _sheared(sheared):
    """One row a run: from 250 kPa to gliding."""
    heading = ["grid", "T at gliding (mN)", "T/W", "T over area, over tau_max", "U (nm)",
               "area at rest (%)", "at gliding (%)", "points", "rejected steps", "transforms",
               "time (s)"]
    rows = []
    for name, run in sheared.items():
        peak = float(reference.peak_tangential_traction(1.0)) * 0.05 / reach(run)
        force, area = run["tangential_force_x"][-1], run["contact_area"]
        rows.append([told(name), f"{1e3 * force:.4f}", f"{force / FORCE:.4f}",
                     f"{force / area[-1] / peak:.3f}",
                     f"{1e9 * run['tangential_displacement_x'][-1]:.1f}",
                     f"{100 * area[full(run)] / AREA:.3f}", f"{100 * area[-1] / AREA:.3f}",
                     str(len(run["leg"])), str(run["rejected"][0]),
                     f"{weighed(run).sum():.0f}", f"{run['wall_time'].sum():.0f}"])
    return markdown(heading, rows)


def reach(run):
    """Range of the law of a run, m."""
    return float(run["range"][0])


# Figures


def draw(found, path):
    """Force, area, spots and their sizes of the runs that have the waves of their grid."""
    pressed = of_the_grid(found)
    with matplotlib.rc_context(PRINTED):
        figure, drawn = panels(2, 2)
        (force, area), (count, sizes) = drawn
        for run, colour in zip(pressed.values(), colours(len(pressed))):
            _draw_loop(run, colour, force, area, count)
        finest = list(pressed.values())[-1]
        inset = force.inset_axes([0.19, 0.3, 0.42, 0.4])
        for part, line in ((finest["leg"] < 3, "-"), (finest["leg"] == 3, "--")):
            inset.plot(1e6 * finest["normal_displacement"][part],
                       1e6 * finest["normal_force"][part], line, color=colours(len(pressed))[-1])
        lowest = 1e6 * finest["normal_force"].min()
        inset.set(xlim=(-0.12, 0.25), ylim=(1.3 * lowest, -2.5 * lowest), ylabel="$W$ (µN)")
        inset.axhline(0, color=GREY, linewidth=0.4)
        force.set(xlabel="displacement $D$ (µm)", ylabel="pressure $W/L^2$ (kPa)")
        area.set(xlabel="pressure (kPa)", ylabel="contact area over $L^2$ (%)")
        count.set(xlabel="contact area over $L^2$ (%)", ylabel="spots")
        handles = [*(Line2D([], [], color=colour, label=told(name))
                     for name, colour in zip(pressed, colours(len(pressed)))),
                   *(Line2D([], [], color="black", linestyle=line, label=label)
                     for line, label in (("-", "pressed"), ("--", "pulled"),
                                         (":", "counted, corrected")))]
        for axes in (force, count):
            axes.set_ylim(None, 1.45 * axes.get_ylim()[1])
        force.legend(handles=handles[:-1], ncols=2, loc="upper left")
        area.legend(handles=handles, loc="upper left")
        count.legend(handles=handles[:-1], ncols=2, loc="upper left")
        _draw_sizes(finest, sizes)
        lettered(drawn.flat, ("", "", "", told(list(pressed)[-1])))
        return save(figure, path)


def _draw_loop(run, colour, force, area, count):
    """Draw the path of a run on three axes, what is pulled dashed."""
    pressure = 1e-3 * run["normal_force"] / AREA
    share = 100 * run["contact_area"] / AREA
    for part, line in ((run["leg"] < 3, "-"), (run["leg"] == 3, "--")):
        look = {"color": colour, "linestyle": line}
        force.plot(1e6 * run["normal_displacement"][part], pressure[part], **look)
        area.plot(pressure[part], share[part], **look)
        count.plot(share[part], run["spots"][part], **look)
    part = run["leg"] < 3
    area.plot(pressure[part], 100 * run["corrected_area"][part] / AREA, ":", color=colour)


def _draw_sizes(run, axes):
    """Draw how many spots are not smaller than each size, at several pressures."""
    names = sorted((name for name in run if name.startswith("areas_")),
                   key=lambda name: float(name.removeprefix("areas_")))
    for name, colour in zip(names, colours(len(names))):
        sizes = np.sort(1e12 * run[name])[::-1]
        pressure = 250 * float(name.removeprefix("areas_"))
        axes.step(sizes, np.arange(1, len(sizes) + 1), where="pre", color=colour,
                  label=f"{pressure:g} kPa")
    axes.set(xscale="log", yscale="log", xlabel="size of a spot (µm²)", ylabel="spots not smaller")
    axes.legend()


def draw_shear(found, path):
    """The spots at 250 kPa, and forces and shares of the contact under shear."""
    run, spots = (list(runs.values())[-1] for runs in (runs_of(found, "sheared"),
                                                       of_the_grid(found)))
    with matplotlib.rc_context(PRINTED):
        figure, ((chart, shear),) = panels(1, 2)
        half = 0.5e6 * LENGTH
        pressure = 1e-6 * np.ma.masked_where(spots["map"] == 0, spots["pressure"])
        image = chart.imshow(pressure.T, origin="lower", extent=(-half, half, -half, half),
                             cmap="RdBu_r", norm=matplotlib.colors.TwoSlopeNorm(
                                 0.0, pressure.min(), pressure.max()))
        chart.set(xlabel="$x$ (µm)", ylabel="$y$ (µm)")
        ends = pressure.min(), 0.5 * pressure.min(), 0.0, 0.5 * pressure.max(), pressure.max()
        figure.colorbar(image, ax=chart, label="pressure in contact (MPa)", shrink=0.85).set_ticks(
            ends, labels=[f"{end:.2g}" for end in ends])
        part = slice(full(run), None)
        moved = 1e9 * run["tangential_displacement_x"][part]
        shear.plot(moved, 1e3 * run["tangential_force_x"][part], color="C0")
        shear.set(xlabel="tangential displacement $U$ (nm)", ylabel="tangential force $T$ (mN)",
                  ylim=(0, None), xlim=(0, None))
        shares = shear.twinx()
        for column, colour, line in (("stick_area", "C2", "--"), ("slip_area", "C1", ":")):
            shares.plot(moved, 100 * run[column][part] / AREA, linestyle=line, color=colour)
        shares.set(ylabel="part of $L^2$ (%)", ylim=(0, None))
        shear.legend(handles=[Line2D([], [], color="C0", label="force"),
                              Line2D([], [], color="C2", linestyle="--", label="sticks"),
                              Line2D([], [], color="C1", linestyle=":", label="slips")],
                     loc="center right")
        lettered((chart, shear))
        return save(figure, path)


def write(found, path):
    """The figures, and the tables between the marks of the page."""
    draw(found, FIGURE)
    draw_shear(found, SHEAR_FIGURE)
    pressed, sheared = runs_of(found, "pressed"), runs_of(found, "sheared")
    text = [measured(path), "", "### At 250 kPa", "", *_pressed(pressed), "",
            "### Pressed and pulled", "", *_loops(pressed), "", "### Sheared to gliding", "",
            *_sheared(sheared), ""]
    write_between(PAGE, BEGIN, END, "\n".join(text) + "\n")
