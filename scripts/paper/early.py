"""Early sliding at a tangential parameter of 10: what residual friction does to it, and damped
motion.

(a) Force at the onset over residual friction at both loads (symbols and full lines), that at which
the largest traction reaches the law's peak (dashed), the largest force of the slip front (dotted)
and the residual friction of the sliding contact (thin). (b, c) Tangential traction at the onset at
both loads. (d, e) Contact area over the tangential force, with the onsets. (f) Displacement at
which gross sliding sets in in damped motion (Verlet, equal masses, one rate of damping in units of
the critical one of the slowest motion, from rest in each step of the load) over that of the
equilibrium at W = 25: bars from the last point that sticks to the first that slides.
"""

import numpy as np
from observed import onset, peel, profile, sheared_part, width_below
from regimes import begun, friction_width
from runs import LOADS, PERIOD, RESIDUALS, ROOT, Run, mapped, sheared
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator
from style import AREA, FORCE, SYMBOLS, key, lettered, panels, shades

from contactsnes import reference
from contactsnes.interface.laws.coupled import SLIP

MAUGIS = 10
FORCE_HELD = 25
RESIDUAL = {"half": 0.5, "none": 0.0}
"""Name of a law -> residual over largest friction, of the motions."""
SHOWN = {25: (0, 0.05, 0.2, 0.5, 1), 0.8: (0, 0.05, 0.1, 0.2, 0.8)}
"""Residual frictions whose tractions and areas are drawn, at each load."""
LEAST = 0.3
"""Least force of the axes of areas."""
CAPTION = "Early sliding at a tangential parameter of 10: a matter of residual friction"


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


REST, STOPPED, STRONG, WEAK = "to rest", "300 time steps", "strongly damped", "weakly damped"
MOTIONS = {"half": {REST: moved("half", 8192, "rest", 500, 4500, tolerance=1e-3),
                    STOPPED: moved("half", 8192, "stopped", 200, 4800, steps=300),
                    STRONG: moved("half", 8192, "strong", 500, 5000, damping=10.0, steps=1000),
                    WEAK: moved("half", 8192, "weak", 1000, 5000, damping=0.1, steps=4000)},
           "none": {REST: moved("none", 8192, "rest", 40, 800, tolerance=1e-3, steps=3000,
                                begin=400),
                    WEAK: moved("none", 8192, "weak", 400, 800, damping=0.1, steps=3000)}}
"""Law -> label -> run."""
EQUILIBRIA = {"half": sheared("half", MAUGIS, FORCE_HELD, fields="all"),
              "none": mapped(0, MAUGIS, FORCE_HELD)}
NEEDED = (*(mapped(residual, MAUGIS, force) for residual in RESIDUALS for force in LOADS),
          *(run for runs in MOTIONS.values() for run in runs.values()))
MOVED = -1
"""Leg of the points of motions in an archive."""
LOOKS = {REST: ("o", "C0"), STOPPED: ("s", "C1"), STRONG: ("^", "C2"), WEAK: ("X", "C3")}


def sticking(record, point):
    """Half of the width in contact that has not slipped past the law's peak."""
    x, gap, slip, _, _ = profile(record, point)
    width = width_below(x, np.where(gap < record.scene["contact_threshold"], np.abs(slip), 1e6),
                        SLIP)
    return 0.5 * min(width, record["contact_area"][point])


def slipped(record, point):
    """Share of the width in contact that has slipped past the law's peak."""
    return 1.0 - 2.0 * sticking(record, point) / record["contact_area"][point]


def slides(record):
    """(last displacement at which something sticks, first at which nothing does); inf where the run
    ends before."""
    driven, first = record["tangential_displacement"], onset(record)
    if first is None:
        return driven[-1], np.inf
    return (first.displacement,) * 2 if first.unstable else (driven[first.point - 1],
                                                             driven[first.point])


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
    record = results[EQUILIBRIA["half"].name]
    return least_sliding_found(record) / slides(record)[0]


def onsets(results, law):
    """Label -> (last displacement at which something sticks, first at which nothing does) of the
    motions over the equilibrium's onset."""
    first = slides(results[EQUILIBRIA[law].name])[0]
    return {label: tuple(np.array(slides(results[run.name])) / first)
            for label, run in MOTIONS[law].items()}


def front(results, residual, force):
    """Largest force of the slip front, or the friction of the sliding contact without a front."""
    return reference.front_onset(0.5 * friction_width(results, force),
                                 residual * reference.peak_tangential_traction(MAUGIS),
                                 max(reference.front_work(residual), 0.0), PERIOD)[1]


def draw_forces(axes, results):
    """Panel a."""
    along = np.concatenate([[0.0], np.geomspace(0.005, 1, 60)])
    for force, colour, marker in zip(LOADS[::-1], ("C0", "C3"), "*o"):
        found = {residual: begun(results, residual, MAUGIS, force) for residual in RESIDUALS}
        found = {residual: one for residual, one in found.items() if one}
        axes.plot(list(found), [one.onset.force for one in found.values()], color=colour,
                  linewidth=0.9, marker=marker, markersize=6 if marker == "*" else 4,
                  label=f"onset, $w_n = {force:g}$")
        axes.plot(list(found), [one.spike for one in found.values()], "--", color=colour,
                  linewidth=0.9, label="spike at the peak")
        axes.plot(along, [front(results, residual, force) for residual in along], ":", color="k",
                  linewidth=0.9)
        axes.plot(along[1:], reference.peak_tangential_traction(MAUGIS) * along[1:]
                  * friction_width(results, force), "-", color="k", linewidth=0.5)
    axes.plot([], [], "k:", linewidth=0.9, label="slip front")
    axes.plot([], [], "k-", linewidth=0.5, label=r"$\tau_\infty a$ in sliding")
    axes.set_xscale("symlog", linthresh=0.02, linscale=0.5)
    axes.set(yscale="log", xlabel=SYMBOLS["residual"], ylabel=FORCE, xlim=(-0.004, 1.2),
             ylim=(1, 4000))
    axes.set_xticks([0, 0.02, 0.05, 0.1, 0.2, 0.5, 1], ["0", ".02", ".05", ".1", ".2", ".5", "1"])
    axes.set_xticks([], minor=True)
    axes.legend(loc="upper left", handlelength=1.8)


def draw_tractions(axes, results, force):
    """Panels b and c: the right half, at the onset."""
    for residual, colour in zip(SHOWN[force], shades(len(SHOWN[force]))):
        record = results[mapped(residual, MAUGIS, force).name]
        if onset(record) is None:
            continue
        x, _, _, _, traction = profile(record, onset(record).point)
        axes.plot(x[x >= 0], traction[x >= 0], color=colour, linewidth=0.9,
                  label=f"$\\rho = {residual:g}$")
    half = 0.5 * friction_width(results, force)
    axes.set(xlabel=r"$x/\beta$", ylabel=r"$p_t/p_{t,r}$", xlim=(0, 1.2 * half), ylim=(0, 1.3))
    axes.legend(ncols=2, loc="upper left", handlelength=1.2, columnspacing=0.8)


def draw_areas(axes, results, force):
    """Panels d and e."""
    for residual, colour in zip(SHOWN[force], shades(len(SHOWN[force]))):
        record = results[mapped(residual, MAUGIS, force).name]
        forces, areas = peel(record)
        first = onset(record)
        if first is None:
            continue
        along = np.geomspace(LEAST, forces[-1], 300)
        axes.plot(along, PchipInterpolator(forces, areas)(along), color=colour, linewidth=1.0,
                  label=f"$\\rho = {residual:g}$")
        axes.plot(first.force, first.area, "o" if force < 1 else "*", color=colour,
                  markeredgecolor="k", markeredgewidth=0.4, markersize=4 if force < 1 else 7,
                  zorder=4, clip_on=False)
    key(axes, "onset", "ko" if force < 1 else "k*", markerfacecolor="w", markeredgewidth=0.4,
        markersize=4 if force < 1 else 7)
    axes.set(xlabel=FORCE, ylabel=AREA, xscale="log",
             xlim=(LEAST, 200 if force > 1 else 40))
    axes.legend(loc="upper right", handlelength=1.4)


def draw_motions(axes, results):
    """Panel f."""
    labels = []
    kinds = {"-": "slides by then", ":": "sticks on"}
    for law, runs in MOTIONS.items():
        labels.append(f"$\\rho = {RESIDUAL[law]:g}$:")
        found = onsets(results, law)
        for label in runs:
            (sticks, slid), (marker, colour) = found[label], LOOKS[label]
            axes.plot((sticks, min(slid, 9)), (-len(labels),) * 2,
                      "-" if slid < np.inf else ":", color=colour, linewidth=1.5)
            axes.plot(sticks, -len(labels), color=colour, marker=marker, markersize=4)
            labels.append(label)
    axes.axvline(1, color="k", linewidth=0.6, label="equilibrium")
    for style, label in kinds.items():
        key(axes, label, f"k{style}", marker="o", markevery=[0], linewidth=1.5)
    axes.set_yticks(range(0, -len(labels), -1), labels)
    axes.tick_params(axis="y", length=0)
    axes.set(xlabel="sliding / equilibrium's", xlim=(-0.05, 1.4), ylim=(-len(labels) + 0.4, 3.6))
    axes.legend(loc="upper left")


def draw(results):
    """The figure."""
    figure, axes = panels(2, 3, height=4.8)
    draw_forces(axes[0, 0], results)
    for one, force in zip(axes[0, 1:], LOADS[::-1]):
        draw_tractions(one, results, force)
    for one, force in zip(axes[1, :2], LOADS[::-1]):
        draw_areas(one, results, force)
    draw_motions(axes[1, 2], results)
    lettered(axes.flat, ("", *[f"$w_n/w_{{n,r}} = {force:g}$" for force in LOADS[::-1]] * 2, ""))
    return figure


def behind(results, label):
    """Largest deviation, with its sign, of the half width that sticks in a motion at residual
    friction one half from the equilibrium."""
    record, exact = (results[run.name] for run in (MOTIONS["half"][label], EQUILIBRIA["half"]))
    last, start = onset(exact).point, sheared_part(exact).start
    points = np.arange(start, last + 1)
    there = exact["tangential_displacement"][points]
    keep = np.concatenate([[True], np.diff(np.maximum.accumulate(there)) > 0])
    along = PchipInterpolator(there[keep], [sticking(exact, point) for point in points[keep]],
                              extrapolate=False)
    mine = np.flatnonzero(record["leg"] == MOVED)
    away = np.array([sticking(record, point) for point in mine]) - along(
        record["tangential_displacement"][mine])
    away = away[np.isfinite(away)]
    return away[np.argmax(np.abs(away))] if away.size else np.nan


def between(results, law, label):
    """Where a motion begins to slide, in words."""
    sticks, slid = slides(results[MOTIONS[law][label].name])
    return f"between {sticks:.0f} and {slid:.0f}" if slid < np.inf else f"not up to {sticks:.0f}"


def told_motions(results):
    """Sentences on the motions."""
    half, none = (slides(results[run.name])[0] for run in EQUILIBRIA.values())
    record = results[EQUILIBRIA["half"].name]
    least = least_sliding_found(record)
    begins = {(law, label): between(results, law, label)
              for law, runs in MOTIONS.items() for label in runs}
    return ("Damped motion to rest slides where equilibria do: "
            f"{begins['half', REST]} at rho = 0.5 (equilibrium: {half:.0f}) and "
            f"{begins['none', REST]} at rho = 0 ({none:.0f}), in the steps of its load. Stopped "
            f"before, it is late ({begins['half', STOPPED]} after 300 time steps, "
            f"{begins['half', STRONG]} with strong damping); weakly damped, it shakes "
            f"(what sticks is off by up to {behind(results, WEAK):+.2g}), and overshoots: at rho = "
            f"0 it slides {begins['none', WEAK]}, for good. At rho = 0.5 no motion can "
            f"rest sliding below {least:.0f} (theory: "
            f"{least_sliding(record['normal_force'][-1]):.0f}), "
            f"{100 * (1 - least_share(results)):.1f} % before the onset, for tau_inf pulls the "
            "surface back.")


def says(results):
    """What the figure shows, with its numbers."""
    cells = {force: {residual: one for residual in RESIDUALS
                     if (one := begun(results, residual, MAUGIS, force))} for force in LOADS}
    ratios = "; ".join(f"W = {force:g}: " + ", ".join(
        f"{one.ratio:.2f} ({residual:g})" for residual, one in cells[force].items())
        for force in LOADS)
    off = max(abs(one.onset.force / front(results, residual, force) - 1)
              for force in LOADS for residual, one in cells[force].items() if residual > 0)
    return ("The force at the onset over that at which the spike reaches the law's peak is, for "
            f"each residual friction, {ratios}. A spike that reaches tau_max starts sliding only "
            "where nothing is left behind it that carries: with rho = 0 the crack around the "
            "contact runs through at once; with more the slipped rim goes on to carry tau_inf, and "
            "a front has to go in, until its force is largest (theory within "
            f"{100 * off:.2g} % for rho > 0). {told_motions(results)}")
