"""Poisson ratio below 1/2: normal tractions move the surface sideways, and the coupling is a third
parameter beside both Maugis ones.

(a, b) Contact area over the tangential force at two held normal forces; stars mark the onset of
gross sliding. (c) Tangential traction of the pressed contact at W = 25, before shear, with that of
a bonded JKR contact to first order in the coupling (dashed). (d) The same at half the force of the
onset. (e) Force at the onset and area before shear, relative to the incompressible body, over the
coupling (1 - 2 nu)/(2 (1 - nu)). (f) As (b) for three ratios of the works of adhesion, tangential
over normal, at one Poisson ratio.
"""

import numpy as np
from beyond import finer, held, refined, strength, unsheared
from observed import onset, profile, sheared_part, stuck
from runs import PERIOD, half_width
from style import AREA, FORCE, branch, event_keys, key, panels, shades

from contactsnes import reference

RATIOS = (0.5, 0.45, 0.4, 0.3, 0.0)
FORCES = (25, 0.8)
WORKS = (0.25, 1.0, 4.0)
SHOWN = 0.3
CAPTION = "Poisson ratio below one half"


def run(ratio, force, work=1.0):
    """Shear at a held normal force of a body with a Poisson ratio and a ratio of the works of
    adhesion."""
    made = held(f"poisson-{ratio:g}-w{force:g}" + f"-phi{work:g}" * (work != 1), force,
                poisson=ratio, work_ratio=work)
    made.options["archive_fields"] = "all"
    return made


NEEDED = (*(run(ratio, force) for force in FORCES for ratio in RATIOS),
          *(run(ratio, 0.8, work) for ratio in (0.5, SHOWN) for work in WORKS if work != 1),
          finer(run(0.0, 25)))


def coupling(ratio):
    """Dundurs' second parameter against a rigid body."""
    return (1 - 2 * ratio) / (2 * (1 - ratio))


def bonded_traction(x, force, ratio):
    """Tangential traction p_t of a bonded JKR contact that is pressed, to first order in the
    coupling b, in E* u/beta.

    The pressure p_n alone draws the surface together, du_t/dx = 2 b p_n < 0; the bond holds it, int
    p_t(y)/(x - y) dy = -pi b p_n(x) over |x| < a: for Hertz's pressure -b/(2 pi) [r ln((a + x)/(a -
    x)) + 2 a x/r], r = sqrt(a^2 - x^2), for a tension F/(pi r) b F/(pi^2 r) ln((a + x)/(a - x)).
    """
    half = half_width(force)
    root, log = np.sqrt(half ** 2 - x ** 2), np.log((half + x) / (half - x))
    pull = reference.ligament_force(half, PERIOD)
    return coupling(ratio) * (pull * log / (np.pi ** 2 * root) - (root * log + 2 * half * x / root)
                              / (2 * np.pi))


def half_way(record):
    """The point whose tangential force is closest to half of that of the onset."""
    begun = onset(record)
    return int(np.argmin(np.abs(record["tangential_force"][:begun.point + 1] - 0.5 * begun.force)))


def changes(results, force):
    """(force of the onset, area before shear) of every ratio over those of 1/2, minus 1; an
    array."""
    found = np.array([(strength(results[run(ratio, force).name]),
                       unsheared(results[run(ratio, force).name])) for ratio in RATIOS])
    return found / found[0] - 1


def draw_branch(axes, record, **look):
    """Area over tangential force with a star at the onset."""
    branch(axes, record, "tangential_force", "contact_area", sheared_part(record), **look)
    begun = onset(record)
    axes.plot(begun.force, begun.area, "*", color=look["color"], markersize=6, markeredgecolor="k",
              markeredgewidth=0.3)


def draw(results):
    """The figure."""
    figure, ((high, low, pressed), (half, relative, works)) = panels(2, 3, height=5.6)
    key(pressed, "bonded", "k--")
    for ratio, colour in zip(RATIOS, shades(len(RATIOS))):
        for one, force in ((high, 25), (low, 0.8)):
            draw_branch(one, results[run(ratio, force).name], color=colour,
                        label=f"$\\nu = {ratio:g}$")
        record = results[run(ratio, 25).name]
        for one, point in ((pressed, sheared_part(record).start), (half, half_way(record))):
            x, _, _, _, traction = profile(record, point)
            one.plot(x, traction, color=colour, linewidth=0.9, label=f"$\\nu = {ratio:g}$")
        x = np.linspace(-1, 1, 2001)[1:-1] * half_width(25)
        pressed.plot(x, bonded_traction(x, 25, ratio), "--", color=colour, linewidth=0.8)
    for work, colour in zip(WORKS, shades(len(WORKS), "plasma")):
        draw_branch(works, results[run(SHOWN, 0.8, work).name], color=colour,
                    label=f"$\\phi_t/\\phi_n = {work:g}$")
    for force, marker in zip(FORCES, "os"):
        for values, name, colour in zip(100 * changes(results, force).T, ("onset", "area"),
                                        ("C0", "C1")):
            relative.plot([coupling(ratio) for ratio in RATIOS], values, marker + "-", color=colour,
                          markersize=3, label=f"{name}, W = {force:g}")
    loads = [f"$w_n/w_{{n,r}} = {force:g}$" for force in FORCES]
    for one, letter, title in zip((high, low, works), "abf",
                                  (*loads, f"$\\nu = {SHOWN:g}$, {loads[1]}")):
        one.set(xlabel=FORCE, ylabel=AREA, title=f"({letter})  {title}", xlim=(0, None))
    for one, letter, title in zip((pressed, half), "cd",
                                  (f"pressed, {loads[0]}", f"half of onset, {loads[0]}")):
        one.set(xlabel=r"$x/\beta$", ylabel=r"$p_t\,\delta_t/\phi_t$", title=f"({letter})  {title}",
                xlim=(-8, 8), ylim=(-2.6, 1.2))
    relative.set(xlabel=r"$(1-2\nu)/(2(1-\nu))$", ylabel="change from $\\nu = 1/2$, %", title="(e)")
    relative.set_ylim(1.6 * relative.get_ylim()[0], None)
    for one, least in ((high, 10.4), (low, 1.7), (works, 1.4)):
        event_keys(one)
        one.set_ylim(least, None)
    pressed.set_ylim(-3.9, None)
    for one in (high, low, pressed, half, relative, works):
        one.legend(loc="lower left", ncols=1 if one in (relative, works) else 2)
    return figure


def slipped(record, point):
    """Share of the contact that has passed the peak of the tangential traction."""
    _, gap, slip, _, _ = profile(record, point)
    return 1 - stuck(slip, gap, np.e)


def trailing(record):
    """(share of the force that x < 0 carries, distances of the edges at x < 0 and x > 0 from the
    centre) at half of the onset's force."""
    x, gap, _, _, traction = profile(record, half_way(record))
    contact = x[gap < np.e]
    return np.sum(traction[x < 0]) / np.sum(traction), -contact[0], contact[-1]


def bonded_distance(results, ratio, share=0.8):
    """Largest distance of the traction of the pressed contact from that of the bonded one for |x| <
    share a, over the latter's largest."""
    record = results[run(ratio, 25).name]
    x, _, _, _, traction = profile(record, sheared_part(record).start)
    inside = np.abs(x) < share * half_width(25)
    theory = bonded_traction(x[inside], 25, ratio)
    return np.max(np.abs(traction[inside] - theory)) / np.max(np.abs(theory))


def edges_told(results):
    """Which half carries more of the shear and what becomes of the edges, in words."""
    shares, moved = [], []
    for ratio in RATIOS[1:]:
        record = results[run(ratio, 25).name]
        share, left, right = trailing(record)
        shares.append(share)
        moved.append((ratio, 0.5 * unsheared(record), left, right))
    name, carried = (("trailing half (x < 0)", shares) if min(shares) > 0.5
                     else ("leading half (x > 0)", [1 - share for share in shares]))
    more = (f"the {name} carries {100 * min(carried):.0f} to "
            f"{100 * max(carried):.0f} % of half of the onset's force"
            if min(carried) > 0.5 else "which half carries more of half of the "
            "onset's force depends on ν")
    edges = [
        f"from -{before:.2f} to -{left:.2f} and from +{before:.2f} to +{right:.2f} at ν = {ratio:g}"
        for ratio, before, left, right in (moved[0], moved[-1])]
    return f"{more}, and the edges move {'; '.join(edges)}"


def says(results):
    """What the figure shows, with its numbers."""
    large, small = (100 * changes(results, force) for force in FORCES)
    pressed = [100 * slipped(results[run(ratio, 25).name],
                             sheared_part(results[run(ratio, 25).name]).start) for ratio in RATIOS]
    third, nearest = RATIOS.index(SHOWN), RATIOS[1]
    plain, *others = [np.array(results[run(0.5, 0.8, work).name]["tangential_force"])
                      for work in (1.0, WORKS[0], WORKS[-1])]
    spread = max(np.max(np.abs(one - plain)) if len(one) == len(plain) else np.inf
                 for one in others)
    works = [100 * (strength(results[run(SHOWN, 0.8, work).name])
                    / strength(results[run(0.5, 0.8).name]) - 1) for work in WORKS]
    same = "are the same" if spread == 0 else f"differ by {spread:.0e}"
    return ("At ν = 1/2 pressing leaves no tangential traction; below it "
            "the pressure draws the surface together (du_t/dx = 2 b "
            "p_n without friction, b = (1 - 2ν)/(2 (1 - ν))), the "
            "interface holds it, and p_t is odd in x: with the "
            "shear for x < 0, against it for x > 0. At ν = "
            f"{nearest:g} it is that of a bonded JKR contact within "
            f"{100 * bonded_distance(results, nearest):.1f} % over the inner 80 "
            "% (W = 25, lambda_n = 10, lambda_t = 1, residual "
            "friction one half, force held). A stronger coupling makes "
            "the rim slip by "
            "pressing alone: " + ", ".join(f"{share:.0f} % at ν = {ratio:g}"
                                           for share, ratio in zip(pressed, RATIOS)
                                           if ratio < nearest) + " of the contact at W = "
            "25 have passed tau_max. The area before shear changes by "
            f"{large[third, 1]:+.1f} % at ν = {SHOWN:g} and "
            f"{large[-1, 1]:+.1f} % at ν = 0 (W = 0.8: "
            f"{small[third, 1]:+.1f} and {small[-1, 1]:+.1f} %), the force at "
            f"the onset by {large[third, 0]:+.0f} and {large[-1, 0]:+.0f} % "
            f"(W = 0.8: {small[third, 0]:+.1f} and {small[-1, 0]:+.1f} %). "
            f"The two edges differ: {edges_told(results)} (W = 25). The "
            "ratio of the works of adhesion enters through the coupling "
            f"only: at ν = 1/2 forces with {WORKS[0]:g}, 1 and "
            f"{WORKS[-1]:g} {same}, at ν = {SHOWN:g} the onset's force "
            "differs from that of ν "
            "= 1/2 by " + ", ".join(f"{value:+.1f} % for {work:g}"
                                    for work, value in zip(WORKS, works)) + " (W = 0.8). "
            + refined(results, run(0.0, 25), "ν = 0, W = 25"))
