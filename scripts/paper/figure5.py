"""Figure 5: shear of the contacts pressed to normal forces of 25 and 0.8, for three tangential
Maugis parameters.

(a) Contact area, (b) tangential force and (c) mean slip over delta_t against the tangential
displacement of the top; stars and circles mark the onset of gross sliding. (d-f) Tangential
tractions at the displacements that small vertical lines mark in (a). Full lines have the residual
friction of the title, the thin ones in (a-c) the other one.
"""

import numpy as np
from observed import onset, profile, sheared_part
from runs import LOADS, TANGENTIAL, sheared
from style import AREA, FORCE, GREY, branch, panels, shades

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


def draw_loading(axes, results, law, column, thin=False):
    """Curves of a column over the applied displacement, with onsets."""
    for maugis in TANGENTIAL:
        for force in LOADS:
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
                  record["mean_tangential_displacement"][part] * maugis, color=COLOURS[maugis],
                  label=f"$\\lambda_t = {maugis:g}$")
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
    axes.set(xlabel=r"$x/\beta$", ylabel=r"$p_t/p_{t,r}$", xlim=(-8, 8), ylim=(-0.03, 1.3),
             title=f"$\\lambda_t = {maugis:g}$")
    axes.legend(title=r"$u_{app,t}/u_{t,r}$", ncols=3, fontsize=5.5, title_fontsize=5.5,
                loc="upper center", columnspacing=0.8)


def draw(results, law="half", whole=False):
    """The figure for one of the two residual frictions, up to `SHOWN` or over the whole range of
    displacements."""
    other, residual = ("full", 0.5) if law == "half" else ("half", 1.0)
    figure, axes = panels(2, 3, height=4.6)
    (area, force, slip), profiles = axes
    for which, thin in ((other, True), (law, False)):
        draw_loading(area, results, which, "contact_area", thin)
        draw_loading(force, results, which, "tangential_force", thin)
    draw_slip(slip, results, law)
    for maugis in TANGENTIAL:
        record = results[f"{law}-t{maugis:g}-w25"]
        points = marked(record)
        for point, colour in zip(points, shades(len(points))):
            area.plot(record["tangential_displacement"][point], record["contact_area"][point], "|",
                      color=colour, markersize=7, markeredgewidth=1.0)
    area.set(ylabel=AREA, ylim=(0, 14))
    force.set(ylabel=FORCE, **(dict(yscale="log", ylim=(3e-2, 200)) if whole
                               else dict(ylim=(0, 12.5))))
    slip.set(ylabel=r"$\langle u_t^s\rangle/\delta_t$", yscale="log", ylim=(1e-2, 3e3))
    for one in (area, force, slip):
        one.set(xlabel=r"$u_{app,t}/u_{t,r}$", **(dict(xscale="log", xlim=(3, 1e4)) if whole
                                                  else dict(xlim=(0, SHOWN))))
    slip.legend()
    for force_, line in LINES.items():
        area.plot([], [], color=GREY, linestyle=line, marker=MARKERS[force_],
                  label=f"$w_n/w_{{n,r}} = {force_:g}$")
    area.legend(loc="center left", bbox_to_anchor=(0, 0.62))
    for one, maugis in zip(profiles, TANGENTIAL[::-1]):
        draw_profiles(one, results[f"{law}-t{maugis:g}-w25"], maugis, residual)
    for one, letter in zip(axes.flat, "abcdef"):
        one.set_title(f"({letter})", loc="left")
    return figure
