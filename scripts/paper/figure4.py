"""Figure 4: normal loading for three normal Maugis parameters, with JKR's solution and Maugis and Dugdale's.

(a) Contact area over the normal load, the inset zoomed in; (b) pressures at a load of 10.4. JKR's solution is that of the periodic
cell, exact; that of Maugis and Dugdale is isolated, and shifted by the cell's effect on JKR's width.
"""

import numpy as np

from contactsnes import reference

from observed import profile
from runs import NORMAL, PERIOD, pressed
from style import AREA, panels

PRESSURE_LOAD = 10.4
COLOURS = dict(zip(NORMAL, ("C0", "C1", "C2")))
NEEDED = tuple(pressed(maugis) for maugis in NORMAL)


def maugis_width(force, maugis):
    """Width 2c of Maugis and Dugdale's line contact in the cell: isolated, and shifted as JKR's is by the cell."""
    shift = reference.jkr_line_half_width(force, PERIOD) - reference.jkr_line_half_width(force)
    return 2 * (reference.maugis_line(force, maugis)[1] + shift)


def draw(results):
    """The figure."""
    figure, ((left, right),) = panels(1, 2)
    inset = left.inset_axes([0.55, 0.13, 0.42, 0.42])
    a = np.linspace(reference.jkr_line_fold(PERIOD)[0], 6.9, 300)
    forces = np.linspace(-1.6, 27, 60)
    for axes in (left, inset):
        for maugis in NORMAL:
            record = results[f"pressed-n{maugis}"]
            axes.plot(record["normal_force"], record["contact_area"], color=COLOURS[maugis], label=f"$\\lambda_n = {maugis}$")
            axes.plot(forces, [maugis_width(force, maugis) for force in forces], ":", color=COLOURS[maugis], linewidth=0.9)
        axes.plot(reference.jkr_line_load(a, PERIOD), 2 * a, "k", linewidth=0.8, label="JKR")
    left.plot([], [], ":", color="0.3", linewidth=0.9, label="Maugis-Dugdale")
    left.set(xlabel=r"$w_n/w_{n,r}$", ylabel=AREA, xlim=(-3, 28), ylim=(0, 14))
    inset.set(xlim=(9.8, 11), ylim=(8.7, 9.4))
    inset.tick_params(labelsize=5.5)
    left.indicate_inset_zoom(inset, edgecolor="0.5", linewidth=0.5)
    left.legend(loc="upper left")
    for maugis in NORMAL:
        record = results[f"pressed-n{maugis}"]
        point = int(np.argmin(np.abs(record["normal_force"] - PRESSURE_LOAD)))
        x, _, _, traction, _ = profile(record, point)
        right.plot(x, -traction * maugis, color=COLOURS[maugis], label=f"$\\lambda_n = {maugis}$")
    half = reference.jkr_line_half_width(PRESSURE_LOAD, PERIOD)
    x = half * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 400))
    right.plot(x, np.where(np.abs(x) < half, reference.jkr_line_pressure(x, half, PERIOD), np.nan), "r--", linewidth=0.9, label="JKR")
    right.set(xlabel=r"$x/\beta$", ylabel=r"$p_n\,R/(E^*\beta)$", xlim=(-6, 6), ylim=(-8, 2.6))
    right.axhline(0, color="0.7", linewidth=0.4, zorder=0)
    right.legend(loc="lower center")
    for axes, letter in zip((left, right), "ab"):
        axes.set_title(f"({letter})", loc="left")
    return figure
