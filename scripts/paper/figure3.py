"""Figure 3: contact area for several thresholds of the gap below which there is contact, and what e
delta_n means.

(a) Distance of the width from that of JKR's contact in the cell, from the fields of one run of
normal loading at lambda_n = 10; (b) the law, and a rectangle of
the same work and height.
"""

import numpy as np
from observed import profiles, width_below
from runs import PERIOD, pressed
from style import panels, shades

from contactsnes import reference

THRESHOLDS = (0.0, 1.0, np.e, 5.0, 8.0, 10.0)
NEEDED = (pressed(10),)


def widths(record):
    """(forces, threshold in delta_n -> contact widths) of a run."""
    found = [[width_below(one.x, one.gap, threshold) for threshold in THRESHOLDS]
             for one in profiles(record, record.field_points)]
    return record["normal_force"][record.field_points], dict(zip(THRESHOLDS, np.transpose(found)))


def draw(results):
    """The figure."""
    figure, ((left, right),) = panels(1, 2, height=2.9)
    forces, found = widths(results["pressed-n10"])
    stable = (forces > 0.985 * reference.jkr_line_pull_off(PERIOD)[1]) & (
        np.arange(forces.size) <= np.argmin(forces))
    exact = [2 * reference.jkr_line_half_width(force, PERIOD) for force in forces[stable]]
    for threshold, colour in zip(THRESHOLDS, shades(len(THRESHOLDS))):
        name = "e" if threshold == np.e else f"{threshold:g}\\,"
        left.plot(forces[stable], 100 * (found[threshold][stable] / exact - 1), color=colour,
                  label=f"${name}\\delta_n$" if threshold else "$0$")
    left.axhline(0, color="k", linestyle="--", linewidth=0.8, label="JKR")
    left.set(xlabel=r"$w_n/w_{n,r}$", ylabel=r"$a_r/a_{JKR} - 1$, %", ylim=(-32, 20))
    left.legend(title="threshold", ncols=2, loc="lower right")
    gap = np.linspace(-0.3, 8, 500)
    law = gap * np.exp(-gap)
    right.plot(gap, law, "C0")
    right.fill_between(gap, 0, law, where=gap >= 0, color="C0", alpha=0.25)
    right.fill_between([0, np.e], 0, np.exp(-1), facecolor="none", edgecolor="C1", hatch="///",
                       linewidth=0.8)
    right.plot([np.e, 4.0], [np.exp(-1)] * 2, ":", color="0.4", linewidth=0.8)
    right.annotate(r"$\sigma_{\max}$", (4.1, np.exp(-1)), va="center")
    right.annotate(r"e$\,\delta_n$", (np.e, -0.05), ha="center", va="center")
    right.axhline(0, color="0.7", linewidth=0.4, zorder=0)
    right.set(xlabel=r"$g_n/\delta_n$", ylabel=r"$p_{int,n}\,\delta_n/\phi_n$", ylim=(-0.2, 0.45))
    for axes, letter in zip((left, right), "ab"):
        axes.set_title(f"({letter})", loc="left")
    return figure
