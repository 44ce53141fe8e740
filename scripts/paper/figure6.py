"""Figure 6: decay of the contact area with the tangential force, for more tangential parameters, with power laws and theory.

Dotted grey: the best power law of each curve, fitted where up to a quarter of the area is lost that is lost before sliding. Thin black:
fracture mechanics - Savkoor and Briggs (mode parameter 1) and mixed-mode functions of Hutchinson and Suo with smaller ones, where
nothing slips. Dash-dotted red: slip of the whole contact, for the smallest parameter. Dashed red: the width that sticks within the
slip zone of a contact that has lost its adhesion, for 3.6, whose end is gross sliding, too.
"""

import numpy as np

from contactsnes import reference

from observed import onset, peel, power_law
from runs import LOADS, MORE_TANGENTIAL, PERIOD, sheared
from style import AREA, FORCE, GREY, panels, shades

MODE_PARAMETERS = (1.0, 0.6, 0.3)
"""Of the mixed-mode function, 1 being Griffith's criterion."""
NEEDED = tuple(sheared("full", maugis, force, fields="all" if maugis in (0.1, 1, 10) and force == 25 else "none")
               for maugis in MORE_TANGENTIAL for force in LOADS)


def mixed_mode_curve(force, parameter):
    """(tangential forces, contact widths) of bonded contacts at a normal force up to their strength."""
    largest = reference.mixed_mode_line_strength(force, parameter, period=PERIOD)[1]
    forces = largest * np.sin(np.linspace(0, np.pi / 2, 40))[:-1]
    return forces, np.array([2 * reference.mixed_mode_line_half_width(force, one, parameter, period=PERIOD) for one in forces])


def uniform_slip_curve(force, maugis):
    """(tangential forces, contact widths) of a contact that slips as a whole, up to the peak of the law."""
    states = [reference.uniform_slip_state(force, slip, maugis, period=PERIOD) for slip in np.linspace(0, np.sqrt(0.5), 60)]
    return np.array([state[1] for state in states]), np.array([2 * state[0] for state in states])


def slip_zone_curve(results, force, maugis):
    """(tangential forces, widths that stick) of the slip zone at tau_max: the width is that over which friction acts at the end."""
    peak = reference.peak_tangential_traction(maugis)
    half_width = 0.5 * results[f"full-t{maugis:g}-w{force:g}"]["tangential_force"][-1] / peak
    stick = half_width * np.cos(np.linspace(0, np.pi / 2, 60))
    return reference.slip_zone_force(half_width, stick, peak), 2 * stick


def draw(results):
    """The figure."""
    figure, (line,) = panels(1, 2)
    for axes, force in zip(line, LOADS[::-1]):
        end = 0.0
        for maugis, colour in zip(MORE_TANGENTIAL, shades(len(MORE_TANGENTIAL))):
            record = results[f"full-t{maugis:g}-w{force:g}"]
            forces, areas = peel(record)
            axes.plot(forces, areas, color=colour, label=f"$\\lambda_t = {maugis:g}$")
            begun = onset(record)
            if begun:
                axes.plot(begun.force, begun.area, "o", color=colour, markersize=3.5, markeredgecolor="k", markeredgewidth=0.3, zorder=4)
            fit = power_law(forces, areas, 0.25)
            along = np.linspace(0, min(1.5 * fit.end, (fit.area / fit.factor) ** (1 / fit.exponent)), 60)
            axes.plot(along, fit(along), ":", color=GREY, linewidth=1.0, zorder=3)
            end = max(end, forces[-1] if maugis <= 1 else 0.0)
        for parameter, dashes in zip(MODE_PARAMETERS, ((6, 2), (3, 2), (1, 2))):
            forces, widths = mixed_mode_curve(force, parameter)
            axes.plot(forces, widths, color="k", linewidth=0.7, dashes=dashes, label=f"mixed mode, $m = {parameter:g}$")
        axes.plot(*uniform_slip_curve(force, 0.1), "-.", color="C3", linewidth=0.9, label=r"uniform slip, $\lambda_t = 0.1$")
        axes.plot(*slip_zone_curve(results, force, 3.6), "--", color="C3", linewidth=0.7, label=r"slip zone, $\lambda_t = 3.6$")
        axes.axhline(2 * reference.hertz_line_half_width(force, PERIOD), color="k", linewidth=0.4, label="Hertz")
        initial = areas[0]
        axes.set(xlabel=FORCE, ylabel=AREA, title=f"$w_n/w_{{n,r}} = {force:g}$", xlim=(0, 1.4 * end),
                 ylim=(2 * reference.hertz_line_half_width(force, PERIOD) - (0.12 if force < 2 else 0.14) * initial, 1.03 * initial))
    line[0].legend(fontsize=5, ncols=3, loc="lower left", columnspacing=1.0)
    return figure
