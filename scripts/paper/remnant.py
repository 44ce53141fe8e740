"""Remnant adhesion: what is left of adhesion at large slip, from none (eq. 5) to four fifths (`-scene_residual_adhesion`).

(a-c) Contact area over the tangential force at three normal forces, held; stars mark the onset of gross sliding, crosses where the
contact comes off. (d) Area of the sliding contact over the remnant adhesion, with JKR's for that work of adhesion (dashed; dotted
where there is no contact by JKR).
"""

import numpy as np

from contactsnes import reference

from beyond import held, sliding, strength, unsheared
from observed import onset, sheared_part
from runs import PERIOD
from style import AREA, FORCE, branch, panels, shades

SHARES, FORCES = (0.0, 0.2, 0.4, 0.6, 0.8), (25, 0.8, -1)
CAPTION = "Remnant adhesion at large slip: area against tangential force at held normal forces, and area in sliding"


def run(share, force):
    """Shear at a held normal force with a share of adhesion left."""
    return held(f"remnant-{share:g}-w{force:g}", force, residual_adhesion=share)


NEEDED = tuple(run(share, force) for force in FORCES for share in SHARES)


def comes_off(record):
    """Whether the contact comes off under shear: no equilibrium beyond a fold, or one without contact."""
    return not record.complete or sliding(record) == 0.0


def jkr_width(force, share):
    """JKR's width for a work of adhesion, Hertz's for none; nan where it does not hold the force."""
    try:
        return 2 * (reference.jkr_line_half_width(force, PERIOD, share) if share else reference.hertz_line_half_width(force, PERIOD))
    except ValueError:
        return np.nan


def draw(results):
    """The figure."""
    figure, axes = panels(2, 2, height=4.6)
    for one, force, letter in zip(axes.flat, FORCES, "abc"):
        for share, colour in zip(SHARES, shades(len(SHARES))):
            record = results[run(share, force).name]
            branch(one, record, "tangential_force", "contact_area", sheared_part(record), color=colour, label=f"{share:g}")
            begun = onset(record)
            if begun and comes_off(record):
                one.plot(begun.force, begun.area, "x", color=colour, markersize=5)
            elif begun:
                one.plot(begun.force, begun.area, "*", color=colour, markersize=7, markeredgecolor="k", markeredgewidth=0.3)
        one.set(xlabel=FORCE, ylabel=AREA, title=f"({letter})  $w_n/w_{{n,r}} = {force:g}$", xlim=(0, None))
    axes[0, 0].legend(title="remnant adhesion $r$")
    last, shares = axes[1, 1], np.linspace(0, 1, 101)
    for number, force in enumerate(FORCES):
        records = [results[run(share, force).name] for share in SHARES]
        kept = [0.0 if comes_off(record) else sliding(record) for record in records]
        last.plot(SHARES, kept, "o", color=f"C{number}", label=f"{force:g}")
        last.plot(1.0, unsheared(records[0]), "s", color=f"C{number}", markerfacecolor="w")
        last.plot(shares, [jkr_width(force, share) for share in shares], "--", color=f"C{number}", linewidth=0.9)
    last.set(xlabel="remnant adhesion $r$ (squares: before shear)", ylabel=AREA + ", sliding", ylim=(0, None), title="(d)")
    last.legend(title=r"$w_n/w_{n,r}$", loc="center right", bbox_to_anchor=(1.0, 0.6))
    return figure


def says(results):
    """What the figure shows, with its numbers."""
    def kept(share, force):
        record = results[run(share, force).name]
        return 100 * sliding(record) / unsheared(record)

    held_on = [share for share in SHARES if not comes_off(results[run(share, -1).name])]
    rises = {force: 100 * (strength(results[run(0.8, force).name]) / strength(results[run(0.0, force).name]) - 1) for force in FORCES[:2]}
    distances = [abs(sliding(results[run(share, force).name]) / jkr_width(force, share) - 1) for force in FORCES for share in SHARES[1:]
                 if not comes_off(results[run(share, force).name]) and np.isfinite(jkr_width(force, share))]
    pulled = (f"Pulled by W = -1 the contact comes off under shear unless at least {held_on[0]:g} of the adhesion remains"
              if held_on and held_on[0] else "Pulled by W = -1 the contact comes off under shear for every share shown" if not held_on
              else "Pulled by W = -1 the contact stays for every share shown")
    return ("Under eq. 5 slip destroys all adhesion, and a sliding contact is one without any: at W = 25 it keeps "
            f"{kept(0.0, 25):.0f} % of the area before shear, at W = 0.8 {kept(0.0, 0.8):.0f} %. If four fifths of the adhesion remain these are "
            f"{kept(0.8, 25):.0f} and {kept(0.8, 0.8):.0f} %, and sliding begins at a force larger by {rises[25]:.0f} and {rises[0.8]:.0f} %. "
            f"The width in sliding is that of a JKR contact with the remaining work of adhesion r phi_n within {100 * max(distances):.0f} % "
            f"(mean {100 * np.mean(distances):.1f} %: its range of adhesion is that of the law, not shorter). {pulled}: r decides whether a contact "
            "under tension can slide at all. λ_t = 1, λ_n = 10, residual friction one half.")
