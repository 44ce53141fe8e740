"""Figure 4: normal loading for three normal Maugis parameters, with JKR's solution and Maugis and
Dugdale's.

(a) Contact area over the normal load, the inset zoomed in; (b) pressures at a load of 10.4. Both
solutions are those of the periodic cell, exact (dotted: Maugis and Dugdale's); dashed in (a) is
JKR's isolated contact, wider than that with neighbours by less than the line. The inset of (b) is
an edge of the contact.
"""

import functools

import numpy as np
from observed import profile
from runs import NORMAL, PERIOD, pressed
from style import AREA, panels

from contactsnes import reference

PRESSURE_LOAD = 10.4
COLOURS = dict(zip(NORMAL, ("C0", "C1", "C2")))
NEEDED = tuple(pressed(maugis) for maugis in NORMAL)


@functools.cache
def maugis_curve(maugis):
    """(normal forces, contact widths 2c) of Maugis and Dugdale's line contact in the cell, from
    pull-off on."""
    least = reference.maugis_line_pull_off(maugis, PERIOD)[0]
    forces = least + (27.5 - least) * np.linspace(1e-4, 1, 50) ** 2
    return forces, 2 * reference.maugis_line(forces, maugis, PERIOD)[1]


def draw(results):
    """The figure."""
    figure, ((left, right),) = panels(1, 2, height=3.6)
    inset = left.inset_axes([0.47, 0.13, 0.41, 0.42])
    a = np.linspace(reference.jkr_line_fold(PERIOD)[0], 6.9, 300)
    alone = np.linspace(reference.jkr_line_pull_off()[0], 6.9, 300)
    theory = {maugis: maugis_curve(maugis) for maugis in NORMAL}
    for axes in (left, inset):
        for maugis in NORMAL:
            record = results[f"pressed-n{maugis}"]
            axes.plot(record["normal_force"], record["contact_area"], color=COLOURS[maugis],
                      label=f"$\\lambda_n = {maugis}$")
            axes.plot(*theory[maugis], ":", color=COLOURS[maugis], linewidth=1.1)
        axes.plot(reference.jkr_line_load(a, PERIOD), 2 * a, "k", linewidth=0.8, label="JKR")
        axes.plot(reference.jkr_line_load(alone), 2 * alone, "--", color="C4", linewidth=0.7,
                  label="JKR, isolated")
    left.plot([], [], ":", color="0.3", linewidth=1.1, label="Maugis-Dugdale")
    left.set(xlabel=r"$w_n/w_{n,r}$", ylabel=AREA, xlim=(-3, 28), ylim=(0, 14))
    inset.set(xlim=(9.8, 11), ylim=(8.7, 9.4))
    inset.yaxis.tick_right()
    left.indicate_inset_zoom(inset, edgecolor="0.5", linewidth=0.5)
    left.legend(loc="upper left")
    edge = right.inset_axes([0.22, 0.37, 0.56, 0.34])
    half = reference.jkr_line_half_width(PRESSURE_LOAD, PERIOD)
    within = half * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 401))[1:-1]
    for axes in (right, edge):
        for maugis in NORMAL:
            record = results[f"pressed-n{maugis}"]
            point = int(np.argmin(np.abs(record["normal_force"] - PRESSURE_LOAD)))
            x, _, _, traction, _ = profile(record, point)
            axes.plot(x, -traction * maugis, color=COLOURS[maugis],
                      label=f"$\\lambda_n = {maugis}$")
            inner, outer = reference.maugis_line(PRESSURE_LOAD, maugis, PERIOD)
            x = np.linspace(-1.15 * outer, 1.15 * outer, 2001)
            axes.plot(x, reference.maugis_line_pressure(x, inner, outer, maugis, PERIOD), ":",
                      color=COLOURS[maugis], linewidth=1.1)
        axes.plot(within, reference.jkr_line_pressure(within, half, PERIOD), "r--", linewidth=0.9,
                  label="JKR")
        axes.axhline(0, color="0.7", linewidth=0.4, zorder=0)
    right.plot([], [], ":", color="0.3", linewidth=1.1, label="Maugis-Dugdale")
    right.set(xlabel=r"$x/\beta$", ylabel=r"$p_n\,R/(E^*\beta)$", xlim=(-6, 6), ylim=(-8, 2.6))
    edge.set(xlim=(4.05, 5.05), ylim=(-3.9, 0.4))
    right.indicate_inset_zoom(edge, edgecolor="0.5", linewidth=0.5)
    right.legend(loc="lower center", ncols=2)
    for axes, letter in zip((left, right), "ab"):
        axes.set_title(f"({letter})", loc="left")
    return figure
