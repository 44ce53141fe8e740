"""Remnant adhesion: what is left of adhesion at large slip, from none (eq. 5) to four fifths
(`-scene_residual_adhesion`).

(a-c) Contact area over the tangential force at three normal forces, held; stars mark the onset of
gross sliding, crosses where the contact comes off instead. (d) Area of the sliding contact over the
remnant adhesion r (none where it came off; squares: before shear), with JKR's for the work of
adhesion r phi_n (dashed), and the width over which the gap of JKR's contact is below e delta_n, as
areas are measured (full).
"""

import numpy as np
from beyond import finer, held, refined, sliding, strength, unsheared
from matplotlib.lines import Line2D
from observed import onset, sheared_part
from runs import PERIOD
from scipy.optimize import brentq
from style import AREA, FORCE, below, branch, lettered, panels, shades

from contactsnes import reference

SHARES = (0.0, 0.2, 0.4, 0.6, 0.8)
FORCES = (25, 0.8, -1)
MAUGIS = 10.0
CAPTION = "Remnant adhesion at large slip"


def run(share, force):
    """Shear at a held normal force with a share of adhesion left; one that is pulled may come off,
    which is no reason for a finer grid."""
    return held(f"remnant-{share:g}-w{force:g}", force, residual_adhesion=share,
                normal_maugis=MAUGIS)._replace(finer=force > 0)


NEEDED = (*(run(share, force) for force in FORCES for share in SHARES), finer(run(0.4, 0.8)))


def comes_off(record):
    """Whether the contact comes off under shear: no equilibrium beyond a fold, or one without
    contact."""
    return not record.complete or sliding(record) == 0.0


def jkr_width(force, share):
    """JKR's width for a share of the work of adhesion, Hertz's for none; nan where it does not hold
    the force."""
    try:
        return 2 * (reference.jkr_line_half_width(force, PERIOD, share) if share
                    else reference.hertz_line_half_width(force, PERIOD))
    except ValueError:
        return np.nan


def measured_width(force, share):
    """Width over which the gap outside JKR's contact, isolated, is below e delta_n: Hertz's and
    that of a flat punch in tension."""
    inner = 0.5 * jkr_width(force, share)
    if not inner > 0:
        return np.nan
    pull = 2 / np.pi * np.sqrt(2 * np.pi * inner * share)

    def excess(x):
        return 0.5 * x * np.sqrt(x * x - inner * inner) + (pull - 0.5 * inner * inner) * np.arccosh(
            x / inner) - np.e / MAUGIS
    return 2 * brentq(excess, inner, inner + 10)


def least_share(force):
    """Least share of the adhesion with which JKR's contact holds a pull: the pull-off force grows
    as its power 2/3."""
    return (force / reference.jkr_line_pull_off(PERIOD)[1]) ** 1.5


def draw(results):
    """The figure."""
    figure, axes = panels(2, 2, height=5.4)
    for one, force in zip(axes.flat, FORCES):
        for share, colour in zip(SHARES, shades(len(SHARES))):
            record = results[run(share, force).name]
            branch(one, record, "tangential_force", "contact_area", sheared_part(record),
                   color=colour)
            begun = onset(record)
            if begun:
                one.plot(begun.force, begun.area, "x" if comes_off(record) else "*", color=colour,
                         markersize=7, markeredgecolor=colour if comes_off(record) else "k",
                         markeredgewidth=1.5 if comes_off(record) else 0.3)
        one.set(xlabel=FORCE, ylabel=AREA, xlim=(0, None))
    last, shares = axes[1, 1], np.linspace(0, 1, 101)
    for number, force in enumerate(FORCES):
        records = [results[run(share, force).name] for share in SHARES]
        staying = [(share, sliding(record)) for share, record in zip(SHARES, records)
                   if not comes_off(record)]
        last.plot(*np.transpose(staying or [(np.nan, np.nan)]), "o", color=f"C{number}",
                  label=f"$w_n/w_{{n,r}} = {force:g}$")
        last.plot(1.0, unsheared(records[0]), "s", color=f"C{number}", markerfacecolor="w")
        last.plot(shares, [jkr_width(force, share) for share in shares], "--", color=f"C{number}",
                  linewidth=0.9)
        last.plot(shares, [measured_width(force, share) for share in shares], "-",
                  color=f"C{number}", linewidth=0.7)
    last.plot([], [], "k--", linewidth=0.9, label=r"JKR, $r\,\phi_n$")
    last.plot([], [], "k-", linewidth=0.7, label=r"JKR, gap $< e\,\delta_n$")
    last.plot([], [], "ks", markerfacecolor="w", label="before shear")
    last.set(xlabel="remnant adhesion $r$", ylabel=AREA + ", sliding", ylim=(0, None))
    last.legend(loc="center", bbox_to_anchor=(0.55, 0.63), ncols=2)
    lettered(axes.flat, [f"$w_n/w_{{n,r}} = {force:g}$" for force in FORCES])
    below(figure, keys(), 0.09, 4)
    return figure


def keys():
    """What curves and symbols of (a-c) are."""
    return [*(Line2D([], [], color=colour, label=f"$r = {share:g}$")
              for share, colour in zip(SHARES, shades(len(SHARES)))),
            Line2D([], [], color="k", marker="*", markerfacecolor="w", linestyle="none",
                   label="onset of sliding"),
            Line2D([], [], color="k", marker="x", linestyle="none", label="comes off"),
            Line2D([], [], color="k", linestyle=":", linewidth=0.7, label="jump")]


def fates(results):
    """What becomes of the contact under tension, in words."""
    stays = [not comes_off(results[run(share, -1).name]) for share in SHARES]
    least = f"JKR's contact holds that pull for r above {least_share(-1):.2f}"
    if all(stays) or not any(stays):
        return ("Under a tension of W = -1 it "
                f"{'slides' if stays[0] else 'comes off'} for every r shown "
                f"({least})")
    if stays != sorted(stays):
        kept = ", ".join(f"{share:g}" for share, stay in zip(SHARES, stays) if stay)
        return f"Under a tension of W = -1 it stays for r = {kept} ({least})"
    first = stays.index(True)
    return ("Under a tension of W = -1 it comes off when it is "
            f"sheared for r up to {SHARES[first - 1]:g}, and slides, still "
            f"pulled, from {SHARES[first]:g} on ({least}): the remnant "
            "adhesion decides whether a contact under tension can slide")


def says(results):
    """What the figure shows, with its numbers."""
    def kept(share, force):
        record = results[run(share, force).name]
        return 100 * sliding(record) / unsheared(record)

    rises = {force: 100 * (strength(results[run(0.8, force).name])
                           / strength(results[run(0.0, force).name]) - 1) for force in FORCES}
    staying = [(share, force) for force in FORCES for share in SHARES
               if not comes_off(results[run(share, force).name])]
    jkr, measured = (100 * max([abs(sliding(results[run(share, force).name]) / width(force, share)
                                    - 1) for share, force in staying if share
                                and jkr_width(force, share) > 0] or [np.nan])
                     for width in (jkr_width, measured_width))
    return ("Under eq. 5 slip destroys all adhesion, and a sliding contact "
            "is one without any; with a remnant share r of it, "
            "adhesion at large slip is r phi_n (lambda_n = 10, "
            "lambda_t = 1, residual friction one half, normal force "
            f"held). Without remnant adhesion sliding leaves {kept(0.0, 25):.0f} "
            f"% of the area at W = 25 and {kept(0.0, 0.8):.0f} % "
            "at W = 0.8; with four fifths it leaves "
            f"{kept(0.8, 25):.0f} and {kept(0.8, 0.8):.0f} %, and the force "
            f"at which sliding begins changes by {rises[25]:+.0f} and "
            f"{rises[0.8]:+.0f} %. {fates(results)}. Where contacts slide with "
            "r > 0 their area is JKR's for the work of adhesion "
            f"r phi_n within {jkr:.2g} %; the width where the gap of "
            "that JKR contact is below e delta_n, as areas are "
            f"measured, agrees within {measured:.2g} %. " + refined(results, run(0.4, 0.8),
                                                                             "r = 0.4, W = 0.8"))
