"""Self-affine roughness on a cylinder (`-scene_geometry rough`), pressed, pulled off, and sheared
at held normal forces.

(a) Contact area over the normal force, pressing and pulling, for several root mean square slopes of
one surface; dashed: JKR without roughness. (b) Pull-off force over the slope, three surfaces
(seeds) each; dashed: JKR with the work of adhesion less the elastic energy that flattens the
roughness. (c) Area over the tangential force until the contact slides; thin: other surfaces of the
largest slope; stars: onset of gross sliding. (d) Gaps of the roughest contact before shear, and (e)
its tangential tractions up to the onset. (f) Force over area at the onset; crosses: a slip front in
one contact as wide as all spots, plus signs: one in each spot by itself.
"""

import numpy as np
from beyond import HEIGHT, finer, refined
from matplotlib.lines import Line2D
from observed import onset, profile, sheared_part
from runs import Run
from style import AREA, FORCE, GREY, JUMP, branch, event_keys, key, lettered, panels, shades

from contactsnes import reference
from contactsnes.interface.laws.coupled import SLIP
from contactsnes.interface.roughness import surface

CELL = 50.0
POINTS = 2048
MAUGIS = 5.0
"""Period, points (spacing times lambda_n^2: 0.61; twenty nodes on the shortest wave) and normal
Maugis parameter."""
HURST = 0.8
LONGEST = 3.0
SHORTEST = 0.5
SLOPES = (0, 2, 4, 6)
SEEDS = (2, 1, 3)
SHOWN = 2
"""Root mean square slopes (u_n,r/beta), seeds of the surfaces, and the seed that most panels
show."""
FORCES = (10, 3)
CAPTION = "Self-affine roughness on a cylinder: adhesion, area under shear, and spots that slide"
PEAK = reference.peak_tangential_traction(1.0)
COLOURS = shades(len(SLOPES))


def run(slope, seed, name, **options):
    """A run with a surface."""
    rough = {"geometry": "rough", "rough_hurst": HURST, "rough_slope": float(slope),
             "rough_longest": LONGEST, "rough_shortest": SHORTEST,
             "rough_seed": seed} if slope else {}
    scene = {"period": CELL, "points": POINTS, "normal_maugis": MAUGIS, **rough}
    return Run(f"rough-{name}-s{slope:g}" + f"-{seed}" * bool(slope),
               {**{f"scene_{key}": value for key, value in scene.items()},
                "load_start": "normal_displacement=0", **options, "continuation_stability": "sign",
                "archive_fields": "all"})


def pressed(slope, seed):
    """Pressed to the largest force, and pulled off."""
    return run(slope, seed, "pressed",
               load_path=f"normal_force={FORCES[0]}; normal_displacement=-8", load_stop="pull_off",
               continuation_initial_step="0.5,0.2", continuation_largest_step="0.5,0.2")


def sheared(slope, seed, force):
    """Sheared at a held normal force until all of it slides."""
    end = reference.driven_displacement(0.0, 2 * PEAK * reference.jkr_line_half_width(force, CELL),
                                        CELL, HEIGHT)
    return run(slope, seed, f"w{force:g}", scene_tangential_maugis=1.0, scene_residual_friction=0.5,
               load_path=f"normal_force={force:g}; tangential_displacement={end:.6g}",
               load_stop="gross_sliding,pull_off", continuation_initial_step=f"0.5,{end / 160:.4g}",
               continuation_largest_step=f"1,{end / 80:.4g}")


def surfaces(slope):
    """Seeds that are pressed at a slope."""
    return SEEDS if slope else (SHOWN,)


PRESSED = {(slope, seed): pressed(slope, seed) for slope in SLOPES for seed in surfaces(slope)}
SHEARED = {(slope, seed, force): sheared(slope, seed, force) for force in FORCES for slope in SLOPES
           for seed in (surfaces(slope) if slope == SLOPES[-1] else (SHOWN,))}
ROUGHEST = SHEARED[SLOPES[-1], SHOWN, FORCES[0]]
NEEDED = (*PRESSED.values(), *SHEARED.values(), finer(ROUGHEST))


def flattening(slope):
    """Elastic energy per length of the interface that flattens the roughness, the sum of |q| a^2/8
    over its waves, over phi_n."""
    if not slope:
        return 0.0
    waves = surface((CELL,), HURST, float(slope), LONGEST, SHORTEST, SHOWN)
    return float(sum(np.sum(2 * np.pi / CELL * numbers[0] * amplitudes ** 2)
                     for numbers, amplitudes, _ in waves.blocks()) / 8)


def pull_off(record):
    """Largest tension before the contact comes off."""
    return -float(record["normal_force"].min())


def spots(record, point):
    """(width, share that sticks) of each spot of contact at a point."""
    x, gap, slip, _, _ = profile(record, point)
    contact = np.concatenate(([False], gap < record.scene["contact_threshold"], [False]))
    edges = np.flatnonzero(contact[1:] != contact[:-1])
    return [((last - first) * (x[1] - x[0]), float(np.mean(np.abs(slip[first:last]) <= SLIP)))
            for first, last in zip(edges[::2], edges[1::2])]


def fronts(record):
    """Forces at which a slip front runs through one contact as wide as the friction in sliding, and
    through each spot by itself."""
    def force(width):
        return min(reference.front_onset(0.5 * width, 0.5 * PEAK, reference.front_work(0.5),
                                         CELL)[1], PEAK * width)

    widths = np.array([width for width, _ in spots(record, record.points - 1)])
    friction = record["tangential_force"][-1] / (0.5 * PEAK)
    return force(friction), sum(force(width) for width in widths * friction / np.sum(widths))


def draw_pressing(axes, results):
    """Areas over the normal force, and pull-off forces."""
    area, tension = axes
    for slope, colour in zip(SLOPES, COLOURS):
        branch(area, results[PRESSED[slope, SHOWN].name], "normal_force", "contact_area",
               color=colour, label=f"{slope:g}")
        forces = [pull_off(results[PRESSED[slope, seed].name]) for seed in surfaces(slope)]
        tension.plot([slope] * len(forces), forces, "o", color=colour, markeredgecolor="k",
                     markeredgewidth=0.4, markersize=4.5, label=f"slope {slope:g}")
    loads = np.linspace(-1.7, FORCES[0], 100)
    area.plot(loads, [2 * reference.jkr_line_half_width(load, CELL) for load in loads], "k--",
              linewidth=0.8, label="JKR")
    slopes = np.linspace(0, 1.1 * SLOPES[-1], 200)
    works = np.maximum(1 - flattening(1.0) * slopes ** 2, 0.0)
    tension.plot(slopes, [-reference.jkr_line_pull_off(CELL, work)[1] if work else 0.0
                          for work in works], "k--", linewidth=0.8, label="JKR, less adhesion")
    area.set(xlabel=r"$w_n/w_{n,r}$", ylabel=AREA, ylim=(0, None))
    key(area, *JUMP[:2], **JUMP[2])
    area.legend(title="slope", loc="lower right")
    tension.set(xlabel=r"root mean square slope$/(u_{n,r}/\beta)$", ylim=(0, 4.6),
                xlim=(-0.3, 1.1 * SLOPES[-1]), ylabel=r"pull-off force$/w_{n,r}$")
    tension.legend(loc="upper right")


def draw_shear(axes, results):
    """Areas over the tangential force, and forces over areas at the onset."""
    area, begin = axes
    for (slope, seed, force), made in SHEARED.items():
        record, colour = results[made.name], COLOURS[SLOPES.index(slope)]
        if force == FORCES[0]:
            branch(area, record, "tangential_force", "contact_area", sheared_part(record),
                   color=colour, linewidth=1.2 if seed == SHOWN else 0.6)
        begun = onset(record)
        if begun:
            for one in axes if force == FORCES[0] else (begin,):
                place = (begun.force, begun.area) if one is area else (begun.area, begun.force)
                one.plot(*place, "*" if one is area else "o" if force == FORCES[0] else "s",
                         color=colour, markeredgecolor="k", markeredgewidth=0.3, markersize=7
                         if one is area else 4.5, zorder=4)
            for estimate, marker in zip(fronts(record), ("kx", "k+")):
                begin.plot(begun.area, estimate, marker, markersize=4, markeredgewidth=0.8,
                           zorder=5)
    areas = np.array([0, 10.0])
    begin.plot(areas, PEAK * areas, "k:", linewidth=0.9, label=r"$\tau_{\max} a_r$")
    begin.plot(areas, 0.5 * PEAK * areas, "k-.", linewidth=0.7, label=r"$\tau_\infty a_r$")
    labels = [*(f"$w_n/w_{{n,r}} = {force}$" for force in FORCES), "one front", "a front a spot"]
    for marker, label in zip(("ko", "ks", "kx", "k+"), labels):
        begin.plot([], [], marker, markersize=4, markerfacecolor="w", label=label)
    begin.set(xlabel=AREA + ", at the onset", ylabel=FORCE + ", at the onset", xlim=(0, 10),
              ylim=(0, 16))
    slopes = [Line2D([], [], color=colour, label=f"{slope:g}")
              for slope, colour in zip(SLOPES, COLOURS)]
    begin.add_artist(begin.legend(loc="upper left"))
    begin.legend(handles=[Line2D([], [], linestyle="none", marker="D", markersize=4, color=colour,
                                 label=f"{slope:g}") for slope, colour in zip(SLOPES, COLOURS)],
                 title="slope", loc="upper right")
    key(area, "other seeds", linewidth=0.6)
    event_keys(area)
    area.legend(handles=[*slopes, *area.get_legend_handles_labels()[0]], title="slope", ncols=2,
                loc="lower left")
    area.set(xlabel=FORCE, ylabel=AREA, xlim=(0, None), ylim=(3.6, None))


def draw_profiles(axes, results):
    """Gaps before shear, and tractions up to the onset, of the roughest contact."""
    gaps, tractions = axes
    record = results[ROUGHEST.name]
    first, last = sheared_part(record).start, onset(record).point
    x, gap, _, _, _ = profile(record, first)
    gaps.plot(x, record.initial_gap, color=GREY, linewidth=0.7, label="first touch")
    gaps.plot(x, gap / MAUGIS, color="C0", label="gap")
    gaps.axhline(np.e / MAUGIS, color="k", linestyle=":", linewidth=0.8, label=r"e$\,\delta_n$")
    gaps.fill_between(x, 0, 10 / 13, where=gap < np.e, transform=gaps.get_xaxis_transform(),
                      color="C0", alpha=0.15, linewidth=0, label="contact")
    # room for the legend above what is drawn
    gaps.set(ylabel=r"$g_n/u_{n,r}$", ylim=(-0.5, 12.5))
    for line in gaps.lines[:2]:
        line.set_ydata(np.where(line.get_ydata() < 9.5, line.get_ydata(), np.nan))
    gaps.legend(loc="upper center", ncols=2, handlelength=1.0)
    forces = record["tangential_force"]
    chosen = [first + int(np.argmin(np.abs(forces[first:last + 1] - share * forces[last])))
              for share in (0.3, 0.6, 0.9, 1.0)]
    for point, colour in zip(dict.fromkeys(chosen), shades(4, "plasma")):
        tractions.plot(x, profile(record, point)[4], color=colour, linewidth=0.9,
                       label=f"{forces[point]:.2f}")
    tractions.plot(x, profile(record, record.points - 1)[4], color=GREY, linewidth=0.7,
                   label="sliding")
    tractions.set(ylabel=r"$p_t/p_{t,r}$", ylim=(0, 1.9))
    tractions.legend(title=FORCE, ncols=2, loc="upper center",
                     columnspacing=0.8)
    for one in axes:
        one.set(xlabel=r"$x/\beta$", xlim=(-6, 6))


def draw(results):
    """The figure."""
    figure, axes = panels(2, 3, height=5.8)
    draw_pressing(axes[0, :2], results)
    draw_shear((axes[0, 2], axes[1, 2]), results)
    draw_profiles(axes[1, :2], results)
    force, slope = f"$w_n/w_{{n,r}} = {FORCES[0]}$", f"slope {SLOPES[-1]}"
    lettered(axes.flat, ("", "", force, f"{slope}, {force}", f"{slope}, {force}", ""))
    return figure


def adhesion(results):
    """Sentences on pull-off forces, and on the area under the largest normal force."""
    def listed(values):
        return ", ".join(f"{value:.2f}" for value in values)

    tensions = {slope: sorted(pull_off(results[PRESSED[slope, seed].name])
                              for seed in surfaces(slope)) for slope in SLOPES}
    means = {slope: 100 * (np.mean(tensions[slope]) / tensions[0][0] - 1) for slope in SLOPES[1:]}
    raised, lowered = ([f"{slope:g}" for slope, change in means.items() if change * sign > 0]
                       for sign in (1, -1))
    theory = {slope: -reference.jkr_line_pull_off(CELL, max(1 - flattening(slope), 1e-12))[1]
              for slope in SLOPES[1:]}
    above = sum(value > theory[slope] for slope in SLOPES[1:] for value in tensions[slope])
    count = sum(len(tensions[slope]) for slope in SLOPES[1:])
    record = results[PRESSED[SLOPES[-1], SHOWN].name]
    snaps = [int(np.sum((record["event"] == "fold") & (record["leg"] == leg))) for leg in (1, 2)]
    areas = [float(results[SHEARED[slope, SHOWN, FORCES[0]].name]["contact_area"][
        sheared_part(results[SHEARED[slope, SHOWN, FORCES[0]].name])][0]) for slope in SLOPES]
    return (
        "Pull-off forces are "
        + "; ".join(f"{listed(tensions[slope])} at slope {slope:g}" for slope in SLOPES)
        + ". On average "
        "over the surfaces roughness raises adhesion at slopes of "
        f"{' and '.join(raised) or 'none'} and lowers it at "
        f"{' and '.join(lowered) or 'none'}. JKR with the work of adhesion "
        "less the energy that flattens the roughness, which is "
        f"{listed(map(flattening, SLOPES[1:]))} of it, is exceeded by "
        f"{above} of "
        f"{count}"
        + (": crests hold on their own, and waves that stay closed hold the edge of the contact"
           if above else "") + ". "
        f"Under W = {FORCES[0]} the areas are {listed(areas)} for "
        f"these slopes; for the largest one {snaps[0]} jumps on "
        f"pressing and {snaps[1]} on pulling, by which pieces of "
        "contact snap in and off."
    )


def sliding_order(results):
    """Sentences on which spots slide first."""
    found = {case: spots(results[run.name], onset(results[run.name]).point)
             for case, run in SHEARED.items() if case[0]}
    several = [each for each in found.values() if len(each) > 1]
    slid = [sum(share == 0 for _, share in each) for each in several]
    widest_sticks = sum(max(each)[1] > 0 for each in several)
    early = [int(np.sum(record["event"][sheared_part(record).start:onset(record).point] == "fold"))
             for record in (results[SHEARED[case].name] for case in found)]
    verdict = ("one after another, narrow ones first" if several and min(slid) > 0
               and widest_sticks == len(several) else "partly together")
    lost = (f". In {sum(count > 0 for count in early)} of all {len(early)} rough "
            f"contacts the path has jumps before, {max(early)} at most, "
            "that leave part of the contact sticking" if any(early) else "")
    return (f"Spots slide {verdict}: of {len(several)} sheared contacts that "
            "have several spots at the onset of gross sliding, "
            f"{sum(count > 0 for count in slid)} have some that slide as a "
            f"whole by then ({sum(slid)} of {sum(map(len, several))} spots "
            f"in all); in {widest_sticks} the widest one still sticks "
            f"in part{lost}.")


def says(results):
    """What the figure shows, with its numbers."""
    begun = {case: onset(results[run.name]) for case, run in SHEARED.items()}
    smooth = begun[0, SHOWN, FORCES[0]]
    ratios = [one.force / (PEAK * one.area) for one in begun.values()]
    changes = ", ".join(f"{100 * (begun[slope, SHOWN, FORCES[0]].force / smooth.force - 1):+.0f}"
                        for slope in SLOPES[1:])
    spread = [begun[SLOPES[-1], seed, FORCES[0]].force for seed in SEEDS]
    errors = {force: max(abs(fronts(results[SHEARED[case].name])[0] / one.force - 1)
                         for case, one in begun.items() if case[2] == force) for force in FORCES}
    return (f"A cylinder with self-affine roughness, Hurst exponent {HURST:g}, "
            f"waves from {SHORTEST:g} to {LONGEST:g}, root mean square "
            f"slopes of {', '.join(f'{slope:g}' for slope in SLOPES)} u_n,r/beta and "
            f"{len(SEEDS)} surfaces (lambda_n = {MAUGIS:g}, lambda_t = 1, "
            f"residual friction one half, period {CELL:g}). {adhesion(results)} "
            f"Sheared at W = {FORCES[0]} these contacts slide at forces "
            f"that differ by {changes} % from the smooth one's, those "
            f"of the largest slope at {min(spread):.2f} to "
            f"{max(spread):.2f}; for all contacts here the force is "
            f"{min(ratios):.2f} to {max(ratios):.2f} tau_max times the real "
            "area at the onset. A slip front in one contact as "
            "wide as the friction in sliding meets it within "
            f"{100 * errors[FORCES[0]]:.0f} % at W = {FORCES[0]} and "
            f"{100 * errors[FORCES[1]]:.0f} % at {FORCES[1]}. "
            f"{sliding_order(results)} " + refined(results, ROUGHEST,
                                                   f"slope {SLOPES[-1]}, W = {FORCES[0]}"))
