"""Early sliding at a tangential parameter of 10, W = 25: what grids that pin the slip front, and
damped motion, make of it.

Residual friction one half: (a) half width that still sticks, (b) mean displacement of the surface
relative to the equilibrium on 2^15 points, (c) tangential tractions where the top has moved by
1000, (d) tangential force; shaded: where gross sliding is in equilibrium, the lower end being the
theory's. (e) The same as (d) without residual friction. (f) Displacement at which gross sliding
sets in, over that of the equilibrium: bars from the last point that sticks to the first that slides
(dotted: none). Equilibria are Newton's; damped motion (Verlet, equal masses, one rate of damping in
units of the critical one of the slowest motion) starts at rest in each step.
"""

import numpy as np
from beyond import percent
from matplotlib.figure import Figure
from observed import onset, profile, sheared_part, width_below
from runs import PERIOD, ROOT, Run, sheared
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator
from style import FORCE, GREY, WIDE

from contactsnes import reference
from contactsnes.interface.laws.coupled import SLIP

MAUGIS = 10
FORCE_HELD = 25
SHOWN = 1000.0
DRIVE = r"$u_{app,t}/u_{t,r}$"
RESIDUAL = {"half": 0.5, "none": 0.0}
"""Name of a law -> residual over largest friction."""
CAPTION = "Early sliding: pinned fronts and damped motion at a tangential parameter of 10"


def moved(law, points, label, step, end, *, damping=1.0, steps=6000, tolerance=1e-8, time_step=1.75,
          begin=0.0):
    """Damped motion in steps of the displacement, from the equilibrium at ``begin``; stopped at a
    tolerance, or after some time steps."""
    legs = ([f"normal_force={FORCE_HELD}"]
            + [f"normal_displacement=hold, tangential_displacement={begin:g}"] * (begin > 0))
    return Run(f"moved-{law}-p{points}-{label}", finer=False,
               program=(str((ROOT / "scripts/paper/moved.py").relative_to(ROOT)),),
               options={"scene_tangential_maugis": float(MAUGIS),
                        "scene_residual_friction": RESIDUAL[law], "scene_points": points,
                        "load_start": "normal_displacement=35.772", "load_path": "; ".join(legs),
                        "continuation_largest_step": ",".join(["1", "25"][:len(legs)]),
                        "continuation_initial_step": ",".join(["0.5", "12"][:len(legs)]),
                        "snes_verlet_masses": "equal", "snes_verlet_damping_exponent": 0,
                        "snes_verlet_time_step": time_step, "moved_step": step, "moved_end": end,
                        "moved_damping": damping, "moved_steps": steps,
                        "moved_tolerance": tolerance})


def newton(law, points):
    """Equilibria on a grid, without certificates; those of one half are runs of the paper's
    figures."""
    if law == "half":
        return sheared("half", MAUGIS, FORCE_HELD, fields="all") if points == 32768 else sheared(
            "half", MAUGIS, FORCE_HELD, points=points, suffix=f"-p{points}", beyond=points == 8192)
    # Beyond folds, for a front that a grid pins has several.
    run = sheared("half", MAUGIS, FORCE_HELD, points=points, residual_friction=0.0, beyond=True)
    return run._replace(name=f"none-t{MAUGIS}-w{FORCE_HELD}-p{points}", options={
        **run.options, "continuation_stability": "off", "load_stop": "gross_sliding,pull_off"})


EQUILIBRIA = {law: {size: newton(law, size) for size in (8192, 16384, 32768)} for law in RESIDUAL}
MOTIONS = {"half": {"to rest, $2^{13}$": moved("half", 8192, "rest", 500, 4500),
                    "to rest, $2^{14}$": moved("half", 16384, "rest", 1000, 5000, tolerance=1e-3,
                                               steps=4000),
                    "norm $10^{-3}$, short load steps, $2^{13}$": moved("half", 8192, "small", 40,
                                                                        400, tolerance=1e-3),
                    "300 time steps, $2^{13}$": moved("half", 8192, "stopped", 200, 4800,
                                                      steps=300),
                    "strongly damped, 1000 time steps, $2^{13}$": moved("half", 8192, "strong", 500,
                                                                        5000, damping=10.0,
                                                                        steps=1000),
                    "weakly damped, $2^{13}$": moved("half", 8192, "weak", 1000, 5000, damping=0.1,
                                                     steps=4000),
                    "weakly damped, $2^{14}$": moved("half", 16384, "weak", 1000, 2000, damping=0.1,
                                                     steps=4000),
                    "weakly damped, short time step, $2^{13}$": moved("half", 8192, "short", 1000,
                                                                      1000, damping=0.1, steps=6000,
                                                                      time_step=0.8),},
           "none": {"to rest, $2^{13}$": moved("none", 8192, "rest", 40, 800, tolerance=1e-3,
                                               steps=3000, begin=400),
                    "to rest, $2^{14}$": moved("none", 16384, "rest", 40, 800, tolerance=1e-3,
                                               steps=3000, begin=400),
                    "weakly damped, $2^{13}$": moved("none", 8192, "weak", 400, 800, damping=0.1,
                                                     steps=3000),
                    "weakly damped, $2^{14}$": moved("none", 16384, "weak", 400, 800, damping=0.1,
                                                     steps=3000),}}
"""Law -> label -> run."""
REST, WEAK = ([f"{label}, $2^{{{power}}}$" for power in (13, 14)]
              for label in ("to rest", "weakly damped"))
STOPPED, STRONG, SHORT = (f"{label}, $2^{{13}}$" for label in ("300 time steps",
                                                               "strongly damped, 1000 time steps",
                                                               "weakly damped, short time step"))
NEEDED = tuple(run for law in RESIDUAL for runs in (EQUILIBRIA[law], MOTIONS[law])
               for run in runs.values())
MOVED = -1
"""Leg of the points of motions in an archive."""
LOOKS = ("o", "s", ".", "v", "^", "X", "P", "D")
LINES = {8192: ("C3", "-"), 16384: ("C0", "--"), 32768: ("k", "-")}


def sticking(record, point):
    """Half of the width in contact that has not slipped past the law's peak."""
    x, gap, slip, _, _ = profile(record, point)
    width = width_below(x, np.where(gap < record.scene["contact_threshold"], np.abs(slip), 1e6),
                        SLIP)
    return 0.5 * min(width, record["contact_area"][point])


def sheared_points(record):
    """Points under shear, of equilibria as far as the onset, each displacement once."""
    begun, moved = onset(record), record["tangential_displacement"]
    last = record.points if begun is None else begun.point + 1
    return np.array([point for point in range(sheared_part(record).start + 1, last)
                     if not moved[point] <= moved[:point].max()])


def along(record, values):
    """Function of the displacement through values at the points under shear."""
    points = sheared_points(record)
    return PchipInterpolator(record["tangential_displacement"][points],
                             [values(record, point) for point in points], extrapolate=False)


def column(name):
    """Function of a record and a point: a column of the archive."""
    return lambda record, point: record[name][point]


def slides(record):
    """(last displacement at which something sticks, first at which nothing does); inf where the run
    ends before."""
    moved, begun = record["tangential_displacement"], onset(record)
    if begun is None:
        return moved[-1], np.inf
    return (begun.displacement,) * 2 if begun.unstable else (moved[begun.point - 1],
                                                             moved[begun.point])


def least_sliding(force):
    """Least displacement at which gross sliding is in equilibrium at residual friction one half and
    a normal force, in theory: the residual traction over the sliding contact, which draws back its
    middle by what the half-plane gives, just to the law's peak."""
    traction = RESIDUAL["half"] * reference.peak_tangential_traction(MAUGIS)
    half = reference.sliding_half_width(force, 10.0, PERIOD)
    drawn = -4 / np.pi * traction * quad(lambda x: np.log(2 * np.sin(np.pi * x / PERIOD)), 0.0,
                                         half)[0]
    return reference.driven_displacement(SLIP / MAUGIS + drawn, 2 * half * traction, PERIOD, 2000.0)


def least_sliding_found(record):
    """The same from the last sliding point of a run: its force stays, and it slides back until a
    node in contact is at the peak."""
    _, gap, slip, _, _ = profile(record, record.points - 1)
    spare = (np.abs(slip[gap < record.scene["contact_threshold"]]).min()
             - SLIP) / record.scene["tangential_maugis"]
    return record["tangential_displacement"][-1] - spare


def least_share(results):
    """That over the displacement at the onset."""
    record = results[EQUILIBRIA["half"][32768].name]
    return least_sliding_found(record) / slides(record)[0]


def looked(law):
    """(label, run, look) of the motions under a law."""
    return [(label, run, {"marker": LOOKS[number], "color": f"C{number + 1}", "linestyle": "none",
                          "markersize": 4.5, "alpha": 0.9})
            for number, (label, run) in enumerate(MOTIONS[law].items())]


def lines(law):
    """(label, run, look) of the equilibria under a law."""
    return [(f"equilibria, $2^{{{int(np.log2(size))}}}$", run,
             {"color": LINES[size][0], "linestyle": LINES[size][1]})
            for size, run in EQUILIBRIA[law].items()]


def draw_half(results, fronts, means, forces):
    """Fronts, mean displacements and forces with residual friction one half."""
    equilibrium = results[EQUILIBRIA["half"][32768].name]
    front = along(equilibrium, sticking)
    mean = along(equilibrium, column("mean_tangential_displacement"))
    moved = np.linspace(*front.x[[0, -1]], 400)
    fronts.plot(moved, front(moved), color="k")
    forces.plot(moved, along(equilibrium, column("tangential_force"))(moved), color="k")
    for _, run, look in lines("half")[:2]:
        record = results[run.name]
        points = sheared_points(record)
        there = record["tangential_displacement"][points]
        means.plot(there, record["mean_tangential_displacement"][points] / mean(there) - 1,
                   linewidth=0.6, **look)
    for _, run, look in looked("half"):
        record = results[run.name]
        points = sheared_points(record)
        there = record["tangential_displacement"][points]
        fronts.plot(there, [sticking(record, point) for point in points], **look)
        means.plot(there, record["mean_tangential_displacement"][points] / mean(there) - 1, **look)
        forces.plot(there, record["tangential_force"][points], **look)
    for axes in (fronts, forces):
        axes.axvspan(least_sliding(equilibrium["normal_force"][-1]), 5200, color=GREY, alpha=0.25,
                     linewidth=0)
        axes.set(xlabel=DRIVE, xlim=(0, 4800))
    fronts.set(ylabel=r"half width that sticks, $s/\beta$",
               title=r"(a)  $\tau_\infty = \tau_{\max}/2$", ylim=(0, None))
    fronts.annotate("symbols as in (f)", (0.03, 0.03), xycoords="axes fraction", fontsize=6)
    means.axhline(0, color="k", linewidth=0.8)
    means.set(xlabel=DRIVE, ylabel=r"$\langle u_t\rangle/\langle u_t\rangle_{eq} - 1$",
              title=r"(b)  $\tau_\infty = \tau_{\max}/2$", xlim=(0, 4200), ylim=(-1, 1))
    means.set_yscale("symlog", linthresh=1e-4)
    forces.set(ylabel=FORCE, title=r"(d)  $\tau_\infty = \tau_{\max}/2$", ylim=(0, None))


def draw_profiles(results, axes):
    """Tangential tractions of three motions, and of the equilibrium, at about the same
    displacement."""
    for label, which, look in (("weakly damped", "weak", dict(color="C6", linewidth=0.4)),
                               ("300 time steps", "stopped", dict(color="C4", linewidth=0.9)),
                               ("to rest", "rest", dict(color="C1", linewidth=2.0, alpha=0.6)),
                               ("equilibrium", None, dict(color="k", linewidth=0.7))):
        record = results[EQUILIBRIA["half"][32768].name if which is None
                         else f"moved-half-p8192-{which}"]
        x, _, _, _, traction = profile(record, nearest(record, SHOWN))
        axes.plot(x, traction, label=label, **look)
    axes.set(xlabel=r"$x/\beta$", ylabel=r"$p_t/p_{t,r}$",
             title=f"(c)  $u_{{app,t}}/u_{{t,r}} = {SHOWN:g}$", xlim=(-8, 8), ylim=(-1, 1.5))
    axes.legend(fontsize=5.5, loc="upper center", ncols=2)


def nearest(record, displacement):
    """The point whose displacement is nearest to one."""
    return int(np.argmin(np.abs(record["tangential_displacement"] - displacement)))


def draw_none(results, axes):
    """Forces without residual friction."""
    for _, run, look in lines("none"):
        record = results[run.name]
        points = sheared_points(record)
        axes.plot(record["tangential_displacement"][points], record["tangential_force"][points],
                  linewidth=0.8, **look)
        axes.plot(slides(record)[0], record["tangential_force"][points[-1]], "*",
                  color=look["color"], markersize=7)
    for _, run, look in looked("none"):
        record = results[run.name]
        points = sheared_points(record)
        points = points[record["leg"][points] == MOVED]
        axes.plot(record["tangential_displacement"][points], record["tangential_force"][points],
                  **look)
    axes.set(xlabel=DRIVE, ylabel=FORCE, title=r"(e)  $\tau_\infty = 0$", xlim=(300, 700),
             ylim=(-0.3, None))


def onsets(results, law):
    """Label -> (last displacement at which something sticks, first at which nothing does) over the
    equilibrium's on 2^15 points."""
    begun = slides(results[EQUILIBRIA[law][32768].name])[0]
    return {label: tuple(np.array(slides(results[run.name])) / begun)
            for label, run, _ in [*lines(law), *looked(law)]}


def draw_onsets(results, axes):
    """Where gross sliding sets in, for both laws; labels and marks are those of all panels."""
    labels = []
    for law in RESIDUAL:
        labels.append(f"$\\tau_\\infty = {RESIDUAL[law]:g}\\,\\tau_{{\\max}}$:")
        found = onsets(results, law)
        for label, _, look in [*lines(law), *looked(law)]:
            (sticks, slid), place = found[label], -len(labels)
            axes.plot((sticks, min(slid, 9)), (place, place), "-" if slid < np.inf else ":",
                      color=look["color"], linewidth=1.5)
            axes.plot(sticks, place, color=look["color"], marker=look.get("marker", "|"),
                      markersize=5)
            labels.append(label)
    axes.axvline(1, color="k", linewidth=0.6)
    axes.set_yticks(range(0, -len(labels), -1), labels, fontsize=5)
    axes.tick_params(axis="y", length=0)
    axes.set(xlabel="sliding / equilibrium's", title="(f)", xlim=(-0.1, 1.5))


def draw(results):
    """The figure."""
    figure = Figure((WIDE, 6.2), layout="constrained")
    upper, lower = figure.subfigures(2, 1)
    (fronts, means, profiles), (forces, none, places) = upper.subplots(1, 3), lower.subplots(1, 3)
    draw_half(results, fronts, means, forces)
    draw_profiles(results, profiles)
    draw_none(results, none)
    draw_onsets(results, places)
    return figure


def behind(results, label, values=sticking):
    """Largest deviation of a motion at residual friction one half from the equilibrium on 2^15
    points, with its sign: of the half width that sticks, or of other ``values`` (function of a
    record and a point), then relative."""
    record = results[MOTIONS["half"][label].name]
    exact = along(results[EQUILIBRIA["half"][32768].name], values)
    points = sheared_points(record)
    there = exact(record["tangential_displacement"][points])
    away = np.array([values(record, point) for point in points]) - there
    away = (away if values is sticking else away / there)[np.isfinite(away)]
    return away[np.argmax(np.abs(away))]


def between(results, law, label):
    """Where a motion begins to slide, in words."""
    sticks, slid = slides(results[MOTIONS[law][label].name])
    return f"between {sticks:.0f} and {slid:.0f}" if slid < np.inf else f"not up to {sticks:.0f}"


def pinned(record):
    """Words on the folds of a record under shear, and on the jumps after which something still
    sticks."""
    events, begun = record["event"], onset(record)
    folds = np.flatnonzero((events == "fold") & (record["tangential_force"] > 0))
    jumps = [point for point in np.flatnonzero(events == "jump") if begun and point < begun.point]
    if not jumps:
        return "no jumps before"
    moved = max(np.abs(record[name][jumps] / record[name][np.array(jumps) - 1] - 1).max()
                for name in ("mean_tangential_displacement", "tangential_force", "contact_area"))
    return (f"{folds.size} folds from {record['tangential_displacement'][folds[0]]:.0f} "
            "on, whose jumps, while something still sticks, change mean "
            f"displacement, force and area by at most {100 * moved:.2g} %")


def grids(records):
    """Where equilibria begin to slide, on 2^15 points and relative to that on coarser ones, in
    words."""
    begun = slides(records[32768])[0]
    middle, coarse = (percent(slides(records[size])[0] / begun - 1) for size in (16384, 8192))
    return (f"where the top has moved by {begun:.0f} (2^15 points; {middle} "
            f"% on 2^14, {coarse} % on 2^13, with "
            f"{pinned(records[8192])})")


def told_motions(results):
    """Sentences on the motions at residual friction one half."""
    torn = [behind(results, label) for label in WEAK]
    swings = [100 * abs(behind(results, label, column("tangential_force"))) for label in WEAK]
    worst = max(results[MOTIONS["half"][label].name]["residual_norm"].max() for label in WEAK)
    return ("Damped motion to rest leaves the half width that sticks "
            f"within {max(abs(behind(results, label)) for label in REST):.1g} of the "
            f"equilibrium's (node spacing {PERIOD / 8192:.1g}) and slides "
            f"{between(results, 'half', REST[0])} on 2^13, "
            f"{between(results, 'half', REST[1])} on 2^14 points, in the steps "
            "of its load. Stopped before, it is late: what sticks is "
            f"wider by up to {behind(results, STOPPED):.2g} after 300 time "
            f"steps and {behind(results, STRONG):.2g} with strong damping, "
            f"sliding begins {between(results, 'half', STOPPED)}, and "
            f"{between(results, 'half', STRONG)}. Weakly damped motion in large "
            "steps of the load, with a time step near the largest "
            "stable one, sets the shortest waves of the grid shaking: "
            f"the width is off by up to {torn[0]:+.2g} on 2^13 and "
            f"{torn[1]:+.2g} on 2^14 points" + (", so that in a profile nearly "
                                                      "all seems to slide early"
                                                      if max(torn) < -2 else "") + "; the force "
            f"swings by up to {swings[0]:.2g} and {swings[1]:.2g} %, all "
            f"of it is seen to slide {between(results, 'half', WEAK[0])} on "
            f"2^13, and residual norms are as large as {worst:.0e}. "
            "With less than half the time step the width is off "
            f"by {behind(results, SHORT):+.1g}. ")


def says(results):
    """What the figure shows, with its numbers."""
    half, none = ({size: results[run.name] for size, run in EQUILIBRIA[law].items()}
                  for law in RESIDUAL)
    theory, least = least_sliding(half[32768]["normal_force"][-1]), least_sliding_found(half[32768])
    overshoots = max(slides(results[MOTIONS["none"][label].name])[1]
                     for label in WEAK) < slides(none[32768])[0]
    return ("With residual friction one half a front of slip goes in "
            f"steadily, and equilibria slide {grids(half)}: where the grid "
            "pins the front it goes in by instabilities, by a node "
            f"each. {told_motions(results)}No grid and no damping makes gross "
            f"sliding an equilibrium below {least:.0f} (theory: {theory:.0f}), "
            f"{100 * (1 - least_share(results)):.1f} % before the onset: the "
            "sliding contact still carries tau_inf, which draws the "
            "surface back. Without residual friction, as under eq. 3 at "
            f"large slip, nothing does. There equilibria slide {grids(none)}, "
            f"motion to rest {between(results, 'none', REST[0])} on 2^13 and "
            f"{between(results, 'none', REST[1])} on 2^14 points, weakly damped "
            f"motion {between(results, 'none', WEAK[0])} and "
            f"{between(results, 'none', WEAK[1])}" + (": it overshoots, and that is "
                                                      "for good. " if overshoots else ". ")
            + "So inertia can make an onset early without residual "
            "friction; with it, there is only the look of one in "
            "states that are not at rest.")
