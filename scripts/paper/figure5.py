"""Figure 5: shear of the contacts pressed to normal forces of 25 and 0.8, for three tangential
Maugis parameters.

(a) Contact area, its axis broken between the loads, (b) tangential force and (c) mean slip over
delta_t against the tangential displacement of the top; stars and circles mark the onset of gross
sliding. (d-f) Tangential tractions at the displacements that small vertical lines mark in (a). The
thin lines in (a, b) have the other residual friction.
"""

import numpy as np
from matplotlib.lines import Line2D
from observed import onset, profile, sheared_part
from runs import LOADS, TANGENTIAL, sheared
from style import AREA, FORCE, GREY, SYMBOLS, below, branch, lettered, panels, shades

from contactsnes.interface.laws.coupled import TANGENTIAL_PEAK

COLOURS = dict(zip(TANGENTIAL, ("C0", "C1", "C2")))
MARKERS = {25: "*", 0.8: "o"}
LINES = {25: "-", 0.8: "--"}
SHOWN = 1000.0
"""Tangential displacement up to which (a-c) go; the whole range has logarithmic axes."""
PROFILES = 6
NEEDED = tuple(sheared(law, maugis, force, fields="all" if force == 25 else "none")
               for law in ("half", "full") for maugis in TANGENTIAL for force in LOADS)


def marked(record):
    """Points whose profiles are drawn: spread over the shear before the onset in equal steps of the
    force, and one beyond it."""
    part, begun = sheared_part(record).start, onset(record)
    last = begun.point if begun else record.points - 1
    force = record["tangential_force"][part:last + 1]
    before = [part + int(np.argmin(np.abs(force - share * force.max())))
              for share in np.linspace(0.2, 0.97, PROFILES - 2)]
    return list(dict.fromkeys([*before, last, min(last + 6, record.points - 1)]))


def draw_loading(axes, results, law, column, thin=False, forces=LOADS):
    """Curves of a column over the applied displacement, with onsets."""
    for maugis in TANGENTIAL:
        for force in forces:
            record = results[f"{law}-t{maugis:g}-w{force:g}"]
            look = {"color": COLOURS[maugis], "linestyle": LINES[force], "linewidth": 0.6 if thin
                    else 1.2, "alpha": 0.6 if thin else 1}
            branch(axes, record, "tangential_displacement", column, sheared_part(record), **look)
            begun = onset(record)
            if begun and not thin:
                axes.plot(begun.displacement, record[column][begun.point], MARKERS[force],
                          color=COLOURS[maugis], markersize=6, markeredgecolor="k",
                          markeredgewidth=0.4, zorder=5)


def draw_slip(axes, results, law):
    """Mean displacement of the surface over delta_t, at the force 25."""
    for maugis in TANGENTIAL:
        record = results[f"{law}-t{maugis:g}-w25"]
        part = sheared_part(record)
        axes.plot(record["tangential_displacement"][part],
                  record["mean_tangential_displacement"][part] * maugis, color=COLOURS[maugis])
        begun = onset(record)
        axes.plot(begun.displacement, record["mean_tangential_displacement"][begun.point] * maugis,
                  "*", color=COLOURS[maugis], markeredgecolor="k", markeredgewidth=0.4)


def draw_profiles(axes, record, maugis, residual):
    """Tangential tractions at the marked points."""
    points = marked(record)
    for point, colour in zip(points, shades(len(points))):
        x, _, _, _, traction = profile(record, point)
        axes.plot(x, traction, color=colour, linewidth=0.9,
                  label=f"{record['tangential_displacement'][point]:.0f}")
    for level in {1.0, residual}:
        axes.axhline(level * TANGENTIAL_PEAK, linestyle=":", color="purple", linewidth=0.9)
    axes.set(xlabel=r"$x/\beta$", ylabel=r"$p_t/p_{t,r}$", xlim=(-8, 8), ylim=(-0.03, 1.42))
    axes.legend(title=SYMBOLS["drive"], ncols=3, loc="upper center", columnspacing=0.6,
                handlelength=0.9)


def broken(axes):
    """Two axes in the place of one, {load: axes}, above each other."""
    axes.axis("off")
    return {25: axes.inset_axes([0, 0.52, 1, 0.48]), 0.8: axes.inset_axes([0, 0, 1, 0.47])}


def draw_areas(axes, results, law, other, whole):
    """Panel a, its two parts, with marks where profiles are drawn."""
    parts = broken(axes)
    for force, part in parts.items():
        for which, thin in ((other, True), (law, False)):
            draw_loading(part, results, which, "contact_area", thin, forces=(force,))
        areas = [results[f"{law}-t{maugis:g}-w{force:g}"]["contact_area"] for maugis in TANGENTIAL]
        low = min(map(np.min, areas))
        first = results[f"{law}-t1-w{force:g}"]
        high = first["contact_area"][sheared_part(first)][0]
        part.set(ylim=(low - 0.15 * (high - low), high + 0.15 * (high - low)), **limits(whole))
    for maugis in TANGENTIAL:
        record = results[f"{law}-t{maugis:g}-w25"]
        points = marked(record)
        for point, colour in zip(points, shades(len(points))):
            parts[25].plot(record["tangential_displacement"][point], record["contact_area"][point],
                           "|", color=colour, markersize=7, markeredgewidth=1.0)
    parts[25].set_xticklabels([])
    parts[0.8].set(xlabel=SYMBOLS["drive"])
    parts[0.8].set_ylabel(AREA, y=1.05)
    return parts[25]


def limits(whole):
    """The axis of the displacement: to `SHOWN`, or the whole range."""
    return {"xscale": "log", "xlim": (3, 1e4)} if whole else {"xlim": (0, SHOWN)}


def draw(results, law="half", whole=False):
    """The figure for one of the two residual frictions, up to `SHOWN` or over the whole range of
    displacements."""
    other, residual = ("full", 0.5) if law == "half" else ("half", 1.0)
    figure, axes = panels(2, 3, height=6.0)
    (area, force, slip), profiles = axes
    top = draw_areas(area, results, law, other, whole)
    for which, thin in ((other, True), (law, False)):
        draw_loading(force, results, which, "tangential_force", thin)
    draw_slip(slip, results, law)
    force.set(ylabel=FORCE, **(dict(yscale="log", ylim=(3e-2, 200)) if whole
                               else dict(ylim=(0, 12.5))))
    slip.set(ylabel=r"$\langle u_t^s\rangle/\delta_t$", yscale="log", ylim=(1e-2, 3e3))
    for one in (force, slip):
        one.set(xlabel=SYMBOLS["drive"], **limits(whole))
    for one, maugis in zip(profiles, TANGENTIAL[::-1]):
        draw_profiles(one, results[f"{law}-t{maugis:g}-w25"], maugis, residual)
    lettered((top, force, slip, *profiles), ("", "", "", *(f"$\\lambda_t = {maugis:g}$"
                                                         for maugis in TANGENTIAL[::-1])))
    below(figure, keys(residual), 0.1, 4)
    return figure


def keys(residual):
    """What lines and symbols are, those of the other residual friction thin."""
    return [*(Line2D([], [], color=colour, label=f"$\\lambda_t = {maugis:g}$")
              for maugis, colour in COLOURS.items()),
            Line2D([], [], color=GREY, marker="|", linestyle="none", markersize=7,
                   label="profiles of (d-f)"),
            *(Line2D([], [], color=GREY, linestyle=LINES[force], marker=MARKERS[force],
                     markersize=6, markeredgecolor="k", markeredgewidth=0.4,
                     label=f"$w_n/w_{{n,r}} = {force:g}$, onset") for force in LOADS[::-1]),
            Line2D([], [], color=GREY, linewidth=1.2, label=f"$\\rho = {residual:g}$"),
            Line2D([], [], color=GREY, linewidth=0.6, alpha=0.6,
                   label=f"$\\rho = {1.5 - residual:g}$"),
            Line2D([], [], color="k", linestyle=":", linewidth=0.7, label="jump"),
            Line2D([], [], color="purple", linestyle=":", linewidth=0.9,
                   label=r"$\tau_{\max}$, $\tau_\infty$")]
