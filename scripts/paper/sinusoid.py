"""A sinusoidal profile (`-scene_geometry sinusoid`), pressed to full contact and back, and sheared
at held normal forces.

(a) Contact area over the normal force for two amplitudes, pressing and pulling; dashed: Johnson's
adhesive contact, dotted: the cylinder of the same curvature. (b) Area over the tangential force
until the contact slides, of the larger wave; thin and dashed: cylinders of equal area before shear;
stars: onset of gross sliding. (c) Force over area at the onset; crosses: the slip front of
`reference.front_onset` in the cell. (d) Tangential tractions at the onset.
"""

import numpy as np
from beyond import HEIGHT, finer, held, refined, strength, unsheared
from observed import onset, profile, sheared_part
from runs import PERIOD, Run
from style import AREA, FORCE, GREY, JUMP, branch, event_keys, key, panels, shades

from contactsnes import reference

WAVE, POINTS = 20.0, 2048
"""Length of the wave, which is the period of the cell, and points on it (spacing times lambda_n^2:
0.98)."""
CURVATURES = (1.0, 0.5)
"""Curvatures of the crests; the amplitude is that times (L/2 pi)^2."""
HIGHEST = {1.0: 24.0, 0.5: 6.0}
"""Normal force to which a wave is pressed: beyond the one at which its contact jumps to the full
period."""
FORCES = {1.0: (2, 8, 16), 0.5: (0.5, 1.5, 3.5)}
"""Normal forces of the sheared partial contacts."""
CAPTION = "A sinusoidal profile: area against normal and tangential force, and the onset of sliding"
PEAK = reference.peak_tangential_traction(1.0)


def amplitude(curvature):
    """Amplitude of the wave of a curvature."""
    return curvature * (WAVE / (2 * np.pi)) ** 2


def scene(curvature):
    """Options of the scene."""
    return {"scene_geometry": "sinusoid", "scene_period": WAVE, "scene_points": POINTS,
            "scene_amplitude": round(amplitude(curvature), 7)}


def partial(curvature, force, work=1.0):
    """Half width of the partial contact by Johnson's theory."""
    return reference.sinusoid_half_width(force, WAVE, amplitude(curvature), work)


def pressed(curvature):
    """Pressed to full contact, and pulled off."""
    return Run(
        f"sinusoid-c{curvature:g}",
        {
            **scene(curvature),
            "load_start": "normal_displacement=0",
            # Near full contact the force depends steeply on the displacement.
            "load_path": f"normal_force={HIGHEST[curvature]:g}; "
            f"normal_displacement={amplitude(curvature) - 0.25:.4g}; "
            "normal_displacement=-8",
            "load_stop": "pull_off",
            "continuation_initial_step": "0.2,0.01,0.1",
            "continuation_largest_step": "1,0.01,0.25",
            "continuation_stability": "sign",
        },
    )


def sheared(curvature, force, full=False):
    """Sheared at a held normal force until it slides: a partial contact, or a full one, pressed
    beyond that force before."""
    width = WAVE if full else 2 * partial(curvature, force) + 1.0
    end = reference.driven_displacement(0.0, 1.1 * PEAK * width, WAVE, HEIGHT)
    highest, size = (f"normal_force={HIGHEST[curvature]:g}; ", "0.5,") if full else ("", "")
    return Run(f"sinusoid-c{curvature:g}-w{force:g}" + "-full" * full,
               {**scene(curvature), "scene_tangential_maugis": 1.0, "scene_residual_friction": 0.5,
                "load_start": "normal_displacement=0",
                "load_path": f"{highest}normal_force={force:g}; tangential_displacement={end:.6g}",
                "load_stop": "gross_sliding,pull_off",
                "continuation_initial_step": f"{size}0.5,{end / 100:.4g}",
                "continuation_largest_step": f"{size}1.5,{end / 40:.4g}",
                "continuation_stability": "sign", "archive_fields": "all" if curvature == 1
                else "none"})


def cylinder(force):
    """The cylinder with the area of the larger wave's contact at a normal force, sheared at its own
    normal force."""
    run = held(f"sinusoid-cylinder-w{force:g}",
               round(float(reference.jkr_line_load(partial(1.0, force), PERIOD)), 4))
    return run._replace(options={**run.options, "load_stop": "gross_sliding,pull_off"})


PARTIAL = {(curvature, force): sheared(curvature, force) for curvature, forces in FORCES.items()
           for force in forces}
FULL = sheared(1.0, FORCES[1.0][-1], full=True)
GROUPS = [(curvature, [PARTIAL[curvature, force] for force in forces])
          for curvature, forces in FORCES.items()]
CYLINDERS = tuple(cylinder(force) for force in FORCES[1.0])
NEEDED = (*map(pressed, CURVATURES), *PARTIAL.values(), FULL, *CYLINDERS, finer(PARTIAL[1.0, 8]))


def front(record):
    """Force of a slip front in the cell that leaves the residual friction behind, by the friction
    of the sliding contact."""
    half_width = min(record["tangential_force"][-1] / PEAK, 0.4999 * record.scene["period"])
    return reference.front_onset(half_width, 0.5 * PEAK, reference.front_work(0.5),
                                 record.scene["period"])[1]


def draw_pressing(axes, results):
    """Areas over the normal force, with the theories."""
    half_widths = np.linspace(1e-3, 0.4999, 800) * WAVE
    for number, curvature in enumerate(CURVATURES):
        record = results[pressed(curvature).name]
        branch(axes, record, "normal_force", "contact_area", color=f"C{number}",
               label=f"$A = {amplitude(curvature):.2f}\\,u_{{n,r}}$")
        axes.plot(reference.sinusoid_load(half_widths, WAVE, amplitude(curvature)), 2 * half_widths,
                  "--", color=f"C{number}", linewidth=0.8)
    axes.plot(reference.jkr_line_load(half_widths, PERIOD), 2 * half_widths, ":", color=GREY,
              label="cylinder, JKR")
    axes.plot([], [], "--", color=GREY, linewidth=0.8, label="Johnson")
    key(axes, *JUMP[:2], **JUMP[2])
    axes.set(xlabel=r"$w_n/w_{n,r}$", ylabel=AREA, xlim=(-6, 1.05 * HIGHEST[1.0]),
             ylim=(0, 1.04 * WAVE))
    axes.legend(loc="lower right")


def draw_shear(axes, results):
    """Areas over the tangential force, and tractions at the onset."""
    area, traction = axes
    for run, same, colour in zip((*(PARTIAL[1.0, force] for force in FORCES[1.0]), FULL),
                                 (*CYLINDERS, None), shades(4)):
        record, label = results[run.name], run.name.split("-w")[1].replace("-", ", ")
        branch(area, record, "tangential_force", "contact_area", sheared_part(record), color=colour,
               label=label)
        begun = onset(record)
        if begun:
            area.plot(begun.force, begun.area, "*", color=colour, markersize=7, markeredgecolor="k",
                      markeredgewidth=0.3, zorder=5)
        if same:
            other = results[same.name]
            branch(area, other, "tangential_force", "contact_area", sheared_part(other),
                   color=colour, linewidth=0.7, linestyle="--")
            area.plot(strength(other), other["contact_area"][onset(other).point], "s", color="w",
                      markersize=4, markeredgecolor=colour)
        x, _, _, _, values = profile(record, begun.point if begun else record.points - 1)
        traction.plot(x, values, color=colour, label=label)
    area.set(xlabel=FORCE, ylabel=AREA, xlim=(0, None), ylim=(0, 1.04 * WAVE))
    traction.set(xlabel=r"$x/\beta$", ylabel=r"$p_t/p_{t,r}$", xlim=(-WAVE / 2, WAVE / 2),
                 ylim=(0, 1.3))
    for level in (PEAK, 0.5 * PEAK):
        traction.axhline(level, linestyle=":", color="purple", linewidth=0.9)
    area.plot([], [], "--", color=GREY, linewidth=0.7, marker="s", markersize=4,
              markerfacecolor="w", label="cylinder")
    event_keys(area)
    key(traction, r"$\tau_{\max}$, $\tau_\infty$", ":", color="purple", linewidth=0.9)
    traction.set_xticks([-10, -5, 0, 5, 10])
    area.legend(title=r"$w_n/w_{n,r}$", loc="center right", bbox_to_anchor=(1.0, 0.42))
    traction.legend(title=r"$w_n/w_{n,r}$", loc="upper right", ncols=2)


def draw_onsets(axes, results):
    """Forces over areas at the onset of sliding, and the front's."""
    shown = [*((group, "o", f"C{number}", f"$A = {amplitude(curvature):.2f}\\,u_{{n,r}}$")
               for number, (curvature, group) in enumerate(GROUPS)),
             ([FULL], "D", "C0", "from full contact"), (CYLINDERS, "s", "w", "cylinder")]
    for runs, marker, colour, label in shown:
        records = [results[run.name] for run in runs if onset(results[run.name])]
        found = [onset(record) for record in records]
        axes.plot([one.area for one in found], [one.force for one in found], marker, color=colour,
                  markeredgecolor="k", markersize=4.5, markeredgewidth=0.6, label=label)
        if runs != [FULL]:
            axes.plot([one.area for one in found], [front(record) for record in records], "x",
                      color="r", markersize=4, markeredgewidth=0.8, zorder=5)
    areas = np.array([0, WAVE])
    axes.plot(areas, PEAK * areas, "k:", linewidth=0.9, label=r"$\tau_{\max} a_r$")
    axes.plot(areas, 0.5 * PEAK * areas, "k-.", linewidth=0.7, label=r"$\tau_\infty a_r$")
    axes.plot([], [], "rx", markersize=4, label="slip front")
    axes.set(xlabel=AREA + ", at the onset", ylabel=FORCE + ", at the onset", xlim=(0, 1.05 * WAVE),
             ylim=(0, 1.08 * PEAK * WAVE))
    axes.legend(loc="upper left")


def draw(results):
    """The figure."""
    figure, axes = panels(2, 2, height=6.2)
    draw_pressing(axes[0, 0], results)
    draw_shear((axes[0, 1], axes[1, 1]), results)
    draw_onsets(axes[1, 0], results)
    for one, letter in zip(axes.flat, "abcd"):
        one.set_title(f"({letter})", loc="left")
    return figure


def jumps(results, curvature):
    """(normal forces at which the wave jumps to full contact, and from it), then the theory's and
    the law's strength; nan where none."""
    record, wave = results[pressed(curvature).name], amplitude(curvature)
    folds, force = record["event"] == "fold", record["normal_force"]
    inward, outward = (force[folds & (record["fold_kind"] == kind)]
                       for kind in ("jump_in", "pull_off"))
    largest = np.max(reference.sinusoid_load(np.linspace(0.01, 0.4999, 4000) * WAVE, WAVE, wave))
    strongest = np.pi * wave - WAVE * reference.peak_normal_traction(10.0)
    return (*(np.append(found, np.nan)[0] for found in (inward, outward)), largest, strongest)


def from_theory(results, curvature):
    """Largest relative difference of the areas of stable partial contacts from Johnson's, at forces
    from 0."""
    record, half_widths = results[pressed(curvature).name], np.linspace(0.01, 0.4999, 4000) * WAVE
    load = reference.sinusoid_load(half_widths, WAVE, amplitude(curvature))
    stable = slice(int(np.argmin(load[:2000])), int(np.argmax(load)) + 1)
    force, area = record["normal_force"], record["contact_area"]
    chosen = (record["event"] == "none") & (force >= 0) & (force < 0.99 * load.max()) & (
        area > 0) & (area < 2 * half_widths[stable][-1])
    return np.max(np.abs(area[chosen] / (2 * np.interp(force[chosen], load[stable],
                                                       half_widths[stable])) - 1), initial=0.0)


def beside_cylinders(results):
    """Forces at the onset over those of the cylinders of equal area, as a sentence."""
    runs = [PARTIAL[1.0, force] for force in FORCES[1.0]]
    ratios = [100 * (strength(results[run.name]) / strength(results[same.name]) - 1)
              for run, same in zip(runs, CYLINDERS)]
    kept = [[100 * onset(results[run.name]).area / unsheared(results[run.name]) for run in group]
            for group in (runs, CYLINDERS)]
    same = "less area" if all(wave <= other for wave, other in zip(*kept)) else "another area"
    loads, changes, waves, others = (", ".join(f"{value:{form}}" for value in values)
                                     for values, form in ((FORCES[1.0], "g"), (ratios, "+.1f"),
                                                          (kept[0], ".0f"), (kept[1], ".0f")))
    return (f"At W = {loads} the larger wave slides at forces that differ "
            f"by {changes} % from those of cylinders of equal area "
            f"before shear, and has {same} at the onset: {waves} % "
            f"of what it was, the cylinders {others} %")


def says(results):
    """What the figure shows, with its numbers."""
    (inward, outward, largest, strongest), (inward_flat, outward_flat, largest_flat,
                                            strongest_flat) = (jumps(results, curvature)
                                                               for curvature in CURVATURES)
    fronts = {f"A = {amplitude(curvature):.2f}, W = {load:g}": 100
              * (front(results[run.name]) / strength(results[run.name]) - 1)
              for (curvature, load), run in PARTIAL.items()}
    worst = max(fronts, key=lambda case: abs(fronts[case]))
    others = max(abs(value) for case, value in fronts.items() if case != worst)
    full = results[FULL.name]
    last, force = FORCES[1.0][-1], strength(results[PARTIAL[1.0, FORCES[1.0][-1]].name])
    heights, areas = ([f"{value(curvature):{form}}" for curvature in CURVATURES]
                      for value, form in ((amplitude, ".2f"),
                                          (lambda curvature: 100 * from_theory(results, curvature),
                                           ".1f")))
    return (f"Waves of a length of {WAVE:g} and amplitudes of "
            f"{' and '.join(heights)} u_n,r (lambda_n = 10, lambda_t = 1, "
            "residual friction one half). Areas of the partial contacts "
            f"are Johnson's within {' and '.join(areas)} % where W >= 0, "
            f"and they jump to full contact at W = {inward:.2f} and "
            f"{inward_flat:.2f} (Johnson: {largest:.2f}, {largest_flat:.2f}). Back "
            f"from there the contact stays full until W = {outward:.1f} "
            f"and {outward_flat:.1f}; the tension of the troughs would "
            "reach the law's peak at pi A - L lambda_n/e = "
            f"{strongest:.1f} and {strongest_flat:.1f} (the theory, of no "
            f"range, has no such end). {beside_cylinders(results)}. The slip "
            "front in the cell, with the width of the friction in "
            f"sliding, gives the force at the onset within {others:.1f} "
            f"%, but {fronts[worst]:+.0f} % off for {worst}. At W = "
            f"{last} two stable contacts exist: the full one has no "
            "edge from which slip could enter, and slides at "
            f"{strength(full):.2f}, {100 * strength(full) / (PEAK * WAVE):.0f} % of "
            f"tau_max L and {strength(full) / force:.2f} times the partial "
            "one's force; sliding leaves both a width of "
            f"{full['contact_area'][-1]:.2f} and "
            f"{results[PARTIAL[1.0, last].name]['contact_area'][-1]:.2f}. "
            + refined(results, PARTIAL[1.0, 8], "the larger wave, W = 8"))
