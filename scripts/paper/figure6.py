"""Figure 6: decay of the contact area with the tangential force, for more tangential parameters and
two residual frictions, with power laws and theory.

(a, b) Contact area at the two loads of the paper with tau_inf = tau_max, (c, d) with tau_inf = 0.05
tau_max, under eq. 5; symbols: onsets, those beyond the axes at its end, with their force. Dotted:
the best power law of each curve, fitted where up to a quarter of the area is lost that is lost
before sliding, drawn up to a half. Thin black: fracture mechanics of a bonded contact with works of
adhesion that are the same in both directions - Savkoor and Briggs (mode parameter 1) and a
mixed-mode function of Hutchinson and Suo - up to the force at which it breaks. Dash-dotted: slip of
the whole contact, for the smallest parameter. (e) Area lost at the larger load with tau_inf =
tau_max, axes logarithmic. (f) Width that sticks, where no slip has passed the peak of the traction,
against the share of the force of gross sliding that theory gives (the width a_inf over which
friction acts then is Hertz's and the range of the law); dashed: the slip zone, which holds for
stiff interfaces.
"""

import functools

import numpy as np
from matplotlib.lines import Line2D
from observed import onset, peel, power_law, profiles, sheared_part, width_below
from runs import LOADS, MORE_TANGENTIAL, PERIOD, mapped, sheared
from style import AREA, FORCE, GREY, below, lettered, panels, shades

from contactsnes import reference
from contactsnes.interface.laws.coupled import SLIP

MODE_PARAMETERS = {1.0: (6, 2), 0.3: (1, 2)}
"""Of the mixed-mode function, 1 being Griffith's criterion, and dashes."""
STUCK = (0.1, 1, 10)
"""Parameters whose fields are kept."""
SHOWN = (0.1, 0.36, 1, 2, 3.6, 10)
"""Tangential parameters that are drawn; the statements have more."""
COLOURS = dict(zip(SHOWN, shades(len(SHOWN))))
RESIDUALS = (1, 0.05)
NEEDED = tuple(sheared("full", maugis, force, fields="all" if maugis in STUCK and force == 25
                       else "none") for maugis in MORE_TANGENTIAL for force in LOADS)
"""The runs with tau_inf = tau_max; the others are those of the map of regimes."""


@functools.cache
def mixed_mode_curve(force, parameter):
    """(tangential forces, contact widths) of bonded contacts at a normal force up to their
    strength."""
    largest = reference.mixed_mode_line_strength(force, parameter, period=PERIOD)[1]
    forces = largest * np.sin(np.linspace(0, np.pi / 2, 40))[:-1]
    return forces, 2 * reference.mixed_mode_line_half_width(force, forces, parameter, period=PERIOD)


@functools.cache
def uniform_slip_curve(force, maugis):
    """(tangential forces, contact widths) of a contact that slips as a whole, up to the peak of the
    law."""
    widths, forces = reference.uniform_slip_state(force, np.linspace(0, SLIP, 60), maugis,
                                                  period=PERIOD)
    return forces, 2 * widths


def slip_zone_curve(force, normal_maugis):
    """(share of the force of gross sliding, widths that stick) of a slip zone, which any strength
    has in common."""
    half_width = reference.sliding_half_width(force, normal_maugis, PERIOD)
    stick = half_width * np.cos(np.linspace(0, np.pi / 2, 100))
    return reference.slip_zone_force(half_width, stick, 1.0, PERIOD) / (2 * half_width), 2 * stick


def stick_widths(record, points):
    """Widths of the contact in which no slip has passed the peak of the tangential traction."""
    areas = record["contact_area"][points]
    return [area if np.max(np.abs(one.slip)) <= SLIP
            else min(width_below(one.x, np.abs(one.slip), SLIP), area)
            for one, area in zip(profiles(record, points), areas)]


def draw_area(axes, results, residual, force):
    """Contact area against the tangential force, with the fits and theory."""
    beyond = []
    end = {25: 12.0, 0.8: 3.6}[force]
    for maugis, colour in COLOURS.items():
        record = results[mapped(residual, maugis, force).name]
        forces, areas = peel(record)
        axes.plot(forces, areas, color=colour)
        begun = onset(record)
        if begun and begun.force > end:
            beyond.append((maugis, begun, colour))
        elif begun:
            axes.plot(begun.force, begun.area, "o", color=colour, markersize=4,
                      markeredgecolor="k", markeredgewidth=0.4, zorder=4)
        fit = power_law(forces, areas, 0.25)
        along = np.linspace(0, (0.5 * (areas[0] - areas.min()) / fit.factor) ** (1 / fit.exponent),
                            60)
        axes.plot(along, fit(along), ":", color=GREY, linewidth=1.0, zorder=3)
    for parameter, dashes in MODE_PARAMETERS.items():
        axes.plot(*mixed_mode_curve(force, parameter), color="k", linewidth=0.7, dashes=dashes)
    axes.plot(*uniform_slip_curve(force, 0.1), "-.", color="C3", linewidth=0.9)
    hertz = 2 * reference.hertz_line_half_width(force, PERIOD)
    axes.axhline(hertz, color="k", linewidth=0.4)
    low, high = hertz - 0.06 * (areas[0] - hertz), areas[0] + 0.06 * (areas[0] - hertz)
    for place, (_, begun, colour) in enumerate(beyond):
        # onsets beyond the axis where no curve ends
        level = low + ((0.6 if force > 1 else 0.12) + 0.09 * place) * (high - low)
        axes.plot(end, level, ">", color=colour, markersize=5, markeredgecolor="k",
                  markeredgewidth=0.4, clip_on=False, zorder=5)
        axes.annotate(f"{begun.force:.3g}", (end, level), xytext=(-5, 0), ha="right", va="center",
                      textcoords="offset points")
    axes.set(xlabel=FORCE, ylabel=AREA, xlim=(0, end), ylim=(low, high))


def draw_loss(axes, results, force):
    """Area lost against the tangential force, both logarithmic."""
    for maugis, colour in COLOURS.items():
        forces, areas = peel(results[f"full-t{maugis:g}-w{force:g}"])
        axes.plot(forces[1:], np.maximum(areas[0] - areas[1:], 1e-9), color=colour)
    for parameter, dashes in MODE_PARAMETERS.items():
        forces, widths = mixed_mode_curve(force, parameter)
        axes.plot(forces[1:], widths[0] - widths[1:], color="k", linewidth=0.7, dashes=dashes)
    forces, widths = uniform_slip_curve(force, 0.1)
    axes.plot(forces[1:], widths[0] - widths[1:], "-.", color="C3", linewidth=0.9)
    along = np.array([0.25, 0.6])
    axes.plot(along, 1.5 * along ** 2, color=GREY, linewidth=0.7)
    axes.text(0.31, 0.3, "2", color=GREY)
    axes.set(xscale="log", yscale="log", xlabel=FORCE, ylabel=r"$(a_r(0) - a_r)/\beta$",
             xlim=(0.2, 30), ylim=(0.005, 3))


def draw_stick(axes, results, force):
    """Width that sticks against the share of the force of gross sliding."""
    for maugis in STUCK:
        record = results[f"full-t{maugis:g}-w{force:g}"]
        part = sheared_part(record)
        points = [point for point in record.field_points if point >= part.start]
        # Without adhesion the load at a held displacement is a little larger.
        load, peak = record["normal_force"][-1], reference.peak_tangential_traction(maugis)
        slid = reference.sliding_force(load, peak, record.scene["normal_maugis"], PERIOD)
        axes.plot(record["tangential_force"][points] / slid, stick_widths(record, points),
                  color=COLOURS[maugis])
    axes.plot(*slip_zone_curve(load, record.scene["normal_maugis"]), "--", color="C3",
              linewidth=0.9)
    axes.set(xlabel=r"$w_t/(\tau_{\max} a_\infty)$", ylabel=r"$a_{stick}/\beta$", xlim=(0, 1.1),
             ylim=(0, 13.5))


def draw(results):
    """The figure."""
    figure, axes = panels(3, 2, height=7.6)
    titles = []
    for line, residual in zip(axes, RESIDUALS):
        for one, force in zip(line, LOADS[::-1]):
            draw_area(one, results, residual, force)
            titles.append(f"$w_n/w_{{n,r}} = {force:g}$, $\\tau_\\infty = "
                          f"{'' if residual == 1 else f'{residual:g}'}\\tau_{{\\max}}$")
    draw_loss(axes[2, 0], results, LOADS[1])
    draw_stick(axes[2, 1], results, LOADS[1])
    lettered(axes.flat, (*titles, titles[0], titles[0]))
    below(figure, keys(), 0.08, 5)
    return figure


def keys():
    """What curves and symbols are."""
    look = {"linestyle": "none", "color": "w", "markeredgecolor": "k", "markeredgewidth": 0.6}
    return [*(Line2D([], [], color=colour, label=f"$\\lambda_t = {maugis:g}$")
              for maugis, colour in COLOURS.items()),
            Line2D([], [], marker="o", markersize=4, label="onset", **look),
            Line2D([], [], marker=">", markersize=5, label="onset, force beyond", **look),
            Line2D([], [], color=GREY, linestyle=":", linewidth=1.0, label="power law"),
            *(Line2D([], [], color="k", dashes=dashes, linewidth=0.7, label=label)
              for dashes, label in zip(MODE_PARAMETERS.values(), ("Griffith, $m = 1$",
                                                                  "mixed mode, 0.3"))),
            Line2D([], [], color="C3", linestyle="-.", linewidth=0.9, label="uniform slip, 0.1"),
            Line2D([], [], color="C3", linestyle="--", linewidth=0.9, label="slip zone"),
            Line2D([], [], color="k", linewidth=0.4, label="Hertz")]
