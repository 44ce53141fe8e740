"""Figure 7: decay of the contact area with the tangential force until the onset of sliding, for
several normal forces.

A row for each tangential parameter (the paper shows the first), a column for each law. Dotted
black: w_t = tau_max a_r; red: the same with tau_fit, fitted to the onsets (dots; open where the
onset is stable). Crosses: the largest force of a slip front that leaves the residual friction
behind (`reference.front_onset`), where a front is short enough.
"""

import numpy as np
from matplotlib.lines import Line2D
from observed import onset, peel
from runs import LAWS, MORE_LOADS, TANGENTIAL, sheared
from style import AREA, FORCE, below, lettered, panels, shades

from contactsnes import reference


def loads(maugis, law="half"):
    """Normal forces that are shown for a tangential parameter and a law, from the largest."""
    if maugis != 10:
        return MORE_LOADS[::-1]
    return tuple(force for force in MORE_LOADS[::-2] if law != "mcgarry" or force != 10.4)


SHADES = dict(zip((25, 16, 10.4, 3, 0.8, 0), shades(6, "plasma")))
"""Loads whose curves are drawn, with their shades; onsets are those of all."""
NEEDED = tuple(sheared(law, maugis, force, fields="all" if force == 25 and law != "mcgarry"
                       else "none") for maugis in TANGENTIAL for law in LAWS
               for force in loads(maugis, law))


def front_onset(results, maugis, force):
    """Force at which a slip front runs through with tau_inf = tau_max/2, and the half width that
    sticks then, of a contact at a normal force; the width of the friction is that of the sliding
    state, the same for every tangential parameter."""
    sliding = results[f"half-t1-w{force:g}"]["tangential_force"][-1] / (
        0.5 * reference.peak_tangential_traction(1.0))
    traction = 0.5 * reference.peak_tangential_traction(maugis)
    stick, largest = reference.front_onset(0.5 * sliding, traction, reference.front_work(0.5))
    return largest, stick


def onset_line(results, law, maugis):
    """(tau_fit, half width of its 95 % interval, largest relative distance of an onset from the
    line, onsets).

    Least squares of w_t = tau_fit a_r through the origin.
    """
    found = [onset(results[f"{law}-t{maugis:g}-w{force:g}"]) for force in loads(maugis, law)]
    found = [one for one in found if one]
    areas, forces = (np.array([getattr(one, name) for one in found]) for name in ("area", "force"))
    slope = np.sum(areas * forces) / np.sum(areas ** 2)
    rest = forces - slope * areas
    spread = np.sqrt(np.sum(rest ** 2) / max(len(found) - 1, 1) / np.sum(areas ** 2))
    return slope, 1.96 * spread, np.max(np.abs(rest / forces)), found


def sinking(results):
    """What is to be said of contacts under eq. 3 that have not begun to slide by the end of their
    run."""
    told = []
    for maugis in TANGENTIAL:
        for force in loads(maugis, "mcgarry"):
            record = results[f"mcgarry-t{maugis:g}-w{force:g}"]
            if onset(record) is None and record["contact_area"][-1] > 0:
                told.append(f"; lambda_t = {maugis:g}, W = {force:g}: none with eq. 3 by w_t "
                            f"= {record['tangential_force'][-1]:.3g}, where the rim "
                            "that slips, and is repelled no more, has sunk "
                            "into the flat by "
                            f"{-10 * record['minimum_gap'].min():.0f} delta_n")
    return "".join(told)


def draw(results):
    """The figure."""
    figure, axes = panels(3, 3, height=7.4)
    for line, maugis in zip(axes, TANGENTIAL):
        peak = reference.peak_tangential_traction(maugis)
        for one, law in zip(line, LAWS):
            slope, _, _, found = onset_line(results, law, maugis)
            for force in loads(maugis, law):
                if force not in SHADES:
                    continue
                colour = SHADES[force]
                record = results[f"{law}-t{maugis:g}-w{force:g}"]
                one.plot(*peel(record), color=colour, label=f"{force:g}")
                if law == "half" and maugis >= 1 and onset(record):
                    estimate = front_onset(results, maugis, force)[0]
                    one.plot(estimate, onset(record).area, "x", color="r", markersize=5,
                             markeredgewidth=0.8, zorder=5)
            for begun in found:
                one.plot(begun.force, begun.area, "o", color="k", markersize=3.5,
                         markerfacecolor="k" if begun.unstable else "w", zorder=4)
            areas = np.array([0, 19])
            one.plot(peak * areas, areas, "k:", linewidth=0.9)
            one.plot(slope * areas, areas, "r-", linewidth=0.8)
            one.set(xlim=(0, 1.08 * max([begun.force for begun in found] + [0.1])),
                    ylim=(0, 19 if maugis == TANGENTIAL[0] else 13.5))
            one.annotate(f"$\\tau_{{fit}} = {slope / peak:.2f}\\,\\tau_{{\\max}}$", (0.97, 0.1),
                         xycoords="axes fraction", ha="right",
                         bbox={"facecolor": "w", "edgecolor": "none", "pad": 1})
        line[0].set_ylabel(AREA)
    for one in axes[-1]:
        one.set_xlabel(FORCE)
    lettered(axes.flat, [f"{name}, $\\lambda_t = {maugis:g}$" for maugis in TANGENTIAL
                         for name in ("eq. 3", r"eq. 5, $\rho = 1$", r"eq. 5, $\rho = 1/2$")])
    below(figure, keys(), 0.09, 4)
    return figure


def keys():
    """What curves, symbols and lines are."""
    look = {"linestyle": "none", "color": "k", "markersize": 4}
    return [*(Line2D([], [], color=colour, label=f"$w_n/w_{{n,r}} = {force:g}$")
              for force, colour in SHADES.items()),
            Line2D([], [], marker="o", label="onset, a fold", **look),
            Line2D([], [], marker="o", markerfacecolor="w", label="onset, gradual", **look),
            Line2D([], [], marker="x", **{**look, "color": "r"}, label="slip front, theory"),
            Line2D([], [], color="k", linestyle=":", label=r"$\tau_{\max} a_r$"),
            Line2D([], [], color="r", label=r"$\tau_{fit}\, a_r$")]
