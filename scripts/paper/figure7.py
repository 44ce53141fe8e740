"""Figure 7: decay of the contact area with the tangential force until the onset of sliding, for
several normal forces.

A row for each tangential parameter (the paper shows the first), a column for each law. Dotted
black: w_t = tau_max a_r; red: the same with tau_fit, fitted to the onsets (dots; open where the
onset is stable). Crosses: the largest force of a slip front that leaves the residual friction
behind (`reference.front_onset`), where a front is short enough.
"""

import numpy as np
from observed import onset, peel
from runs import LAWS, MORE_LOADS, TANGENTIAL, sheared
from style import AREA, FORCE, LAW_NAMES, panels, shades

from contactsnes import reference


def loads(maugis):
    """Normal forces that are shown for a tangential parameter, from the largest."""
    return MORE_LOADS[::-2] if maugis == 10 else MORE_LOADS[::-1]


NEEDED = tuple(sheared(law, maugis, force, fields="all" if force == 25 and law != "mcgarry"
                       else "none") for maugis in TANGENTIAL for law in LAWS
               for force in loads(maugis))


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
    found = [onset(results[f"{law}-t{maugis:g}-w{force:g}"]) for force in loads(maugis)]
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
        for force in loads(maugis):
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
    figure, axes = panels(3, 3, height=6.3)
    for line, maugis in zip(axes, TANGENTIAL):
        peak = reference.peak_tangential_traction(maugis)
        for one, law in zip(line, LAWS):
            slope, _, _, found = onset_line(results, law, maugis)
            for force, colour in zip(loads(maugis), shades(len(loads(maugis)), "plasma")):
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
            if maugis == TANGENTIAL[0]:
                one.set_title(LAW_NAMES[law])
            one.annotate(f"$\\lambda_t = {maugis:g}$\n$\\tau_{{fit}} = "
                         f"{slope / peak:.2f}\\,\\tau_{{\\max}}$", (0.97, 0.05),
                         xycoords="axes fraction", ha="right", fontsize=6.5,
                         bbox={"facecolor": "w", "edgecolor": "none", "pad": 1})
        line[0].set_ylabel(AREA)
    for one in axes[-1]:
        one.set_xlabel(FORCE)
    axes[0, 0].legend(title=r"$w_n/w_{n,r}$", fontsize=5.5, title_fontsize=5.5, ncols=4,
                      loc="upper left", columnspacing=0.8, handlelength=1.2)
    return figure
