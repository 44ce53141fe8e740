"""Figure 6: decay of the contact area with the tangential force, for more tangential parameters,
with power laws and theory.

(a), (b) Contact area at the two loads of the paper. Dotted grey: the best power law of each curve,
fitted where up to a quarter of the area is lost that is lost before sliding, drawn up to a half;
the exponents are in the legend of (d). Thin black: fracture mechanics of a bonded contact with
works of adhesion that are the same in both directions - Savkoor and Briggs (mode parameter 1) and
mixed-mode functions of Hutchinson and Suo with smaller ones - up to the force at which it breaks.
Dash-dotted red: slip of the whole contact, for the smallest parameter. (c) Area lost, at the larger
load, axes logarithmic. (d) Width that sticks, where no slip has passed the peak of the traction,
against the share of the force of gross sliding that theory gives (the width a_inf over which
friction acts then is Hertz's and the range of the law); dashed red: the slip zone, which holds for
stiff interfaces.
"""

import numpy as np
from observed import onset, peel, power_law, profile, sheared_part, width_below
from runs import LOADS, MORE_TANGENTIAL, PERIOD, sheared
from style import AREA, FORCE, GREY, panels, shades

from contactsnes import reference
from contactsnes.interface.laws.coupled import SLIP

MODE_PARAMETERS = {1.0: (6, 2), 0.6: (3, 2), 0.3: (1, 2)}
"""Of the mixed-mode function, 1 being Griffith's criterion, and dashes."""
STUCK = (0.1, 1, 10)
"""Parameters whose fields are kept."""
COLOURS = dict(zip(MORE_TANGENTIAL, shades(len(MORE_TANGENTIAL))))
NEEDED = tuple(sheared("full", maugis, force, fields="all" if maugis in STUCK and force == 25
                       else "none") for maugis in MORE_TANGENTIAL for force in LOADS)


def mixed_mode_curve(force, parameter):
    """(tangential forces, contact widths) of bonded contacts at a normal force up to their
    strength."""
    largest = reference.mixed_mode_line_strength(force, parameter, period=PERIOD)[1]
    forces = largest * np.sin(np.linspace(0, np.pi / 2, 40))[:-1]
    return forces, 2 * reference.mixed_mode_line_half_width(force, forces, parameter, period=PERIOD)


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


def stick_width(record, point):
    """Width of the contact in which no slip has passed the peak of the tangential traction."""
    x, _, slip, _, _ = profile(record, point)
    if np.max(np.abs(slip)) <= SLIP:
        return record["contact_area"][point]
    return min(width_below(x, np.abs(slip), SLIP), record["contact_area"][point])


def draw_area(axes, results, force):
    """Contact area against the tangential force, with the fits, whose exponents are returned, and
    theory."""
    exponents, end = {}, 0.0
    for maugis, colour in COLOURS.items():
        record = results[f"full-t{maugis:g}-w{force:g}"]
        forces, areas = peel(record)
        axes.plot(forces, areas, color=colour)
        begun = onset(record)
        if begun:
            axes.plot(begun.force, begun.area, "o", color=colour, markersize=3.5,
                      markeredgecolor="k", markeredgewidth=0.3, zorder=4)
        fit = power_law(forces, areas, 0.25)
        along = np.linspace(0, (0.5 * (areas[0] - areas.min()) / fit.factor) ** (1 / fit.exponent),
                            60)
        axes.plot(along, fit(along), ":", color=GREY, linewidth=1.0, zorder=3)
        exponents[maugis], end = fit.exponent, max(end, forces[-1] if maugis <= 1 else 0.0)
    for parameter, dashes in MODE_PARAMETERS.items():
        axes.plot(*mixed_mode_curve(force, parameter), color="k", linewidth=0.7, dashes=dashes)
    axes.plot(*uniform_slip_curve(force, 0.1), "-.", color="C3", linewidth=0.9)
    hertz = 2 * reference.hertz_line_half_width(force, PERIOD)
    axes.axhline(hertz, color="k", linewidth=0.4)
    axes.set(xlabel=FORCE, ylabel=AREA, xlim=(0, 1.25 * end),
             ylim=(hertz - 0.1 * (areas[0] - hertz), areas[0] + 0.06 * (areas[0] - hertz)))
    return exponents


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
    axes.text(0.33, 0.3, "2", color=GREY, fontsize=7)
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
        axes.plot(record["tangential_force"][points] / slid,
                  [stick_width(record, point) for point in points], color=COLOURS[maugis])
    axes.plot(*slip_zone_curve(load, record.scene["normal_maugis"]), "--", color="C3",
              linewidth=0.9)
    axes.set(xlabel=r"$w_t/(\tau_{\max} a_\infty)$", ylabel=r"$a_{stick}/\beta$", xlim=(0, 1.25),
             ylim=(0, 13.5))


def add_legends(loss, stick, exponents):
    """What the curves of all panels are: theory, and the parameters with their exponents at both
    loads."""
    for parameter, dashes in MODE_PARAMETERS.items():
        name = "Savkoor-Briggs, $m = 1$" if parameter == 1 else f"mixed mode, $m = {parameter:g}$"
        loss.plot([], [], color="k", linewidth=0.7, dashes=dashes, label=name)
    for colour, width, style, name in (("C3", 0.9, "-.", r"uniform slip, $\lambda_t = 0.1$"),
                                       ("C3", 0.9, "--", "slip zone (d)"),
                                       (GREY, 1.0, ":", "power laws (a, b)"),
                                       ("k", 0.4, "-", "Hertz (a, b)")):
        loss.plot([], [], color=colour, linewidth=width, linestyle=style, label=name)
    loss.legend(fontsize=5.5, loc="lower right")
    for maugis, colour in COLOURS.items():
        stick.plot([], [], color=colour, label=f"$\\lambda_t = {maugis:g}$: "
                   f"{exponents[0][maugis]:.2f}, {exponents[1][maugis]:.2f}")
    stick.legend(fontsize=5.5, ncols=2, loc="lower left", title="exponents in (a), (b)",
                 title_fontsize=5.5, handlelength=1.3, columnspacing=1.0)


def draw(results):
    """The figure."""
    figure, ((left, right), (lost, stick)) = panels(2, 2)
    exponents = [draw_area(axes, results, force) for axes, force in zip((left, right), LOADS[::-1])]
    draw_loss(lost, results, LOADS[1])
    draw_stick(stick, results, LOADS[1])
    add_legends(lost, stick, exponents)
    for axes, letter, force in zip((left, right, lost, stick), "abcd",
                                   (*LOADS[::-1], LOADS[1], LOADS[1])):
        axes.set_title(f"({letter}) $w_n/w_{{n,r}} = {force:g}$", loc="left")
    return figure
