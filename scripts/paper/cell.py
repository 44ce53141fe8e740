"""Height and period of the cell, at a held normal force of 25.

(a) Contact area over the tangential force for several heights of the layer (full) and periods
(dashed); stars mark the onset of gross sliding. (b) How far the area before shear and the force at
the onset are below those of an isolated contact, over the period, at a height of 2000; dashed:
JKR's area in the cell. (c) How far they are off those of a height of 2000, over the height, at a
period of 100; dashed: JKR's area on a surface that the layer bends by what it yields less than a
half-plane. (d) Tangential force over the mean displacement of the surface for a tangential
parameter of 0.1: the whole path (grey, with its unstable part) at the height of 2000, and three
heights, with the jumps of those that cannot follow it (dotted).
"""

import numpy as np
from beyond import finer, held, percent, refined, strength, unsheared
from observed import onset, sheared_part
from runs import PERIOD, Run, half_width
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from style import AREA, FORCE, GREY, JUMP, branch, event_keys, key, panels, shades

from contactsnes import reference
from contactsnes.interface.elasticity import layer_compliance

HEIGHTS = (10.0, 30.0, 50.0, 100.0, 500.0, 2000.0)
PERIODS = (20.0, 30.0, 50.0, 100.0, 200.0)
FORCE_HELD = 25
COMPLIANT, LOWER = 0.1, (2000.0, 1000.0, 500.0)
CAPTION = "Height and period of the cell"


def run(height=2000.0, period=PERIOD):
    """Shear in a cell."""
    return held(f"cell-h{height:g}-l{period:g}", FORCE_HELD, height=height, period=period, steps=100
                if height < 50 else 50)


def compliant(height, at_fold="jump"):
    """Shear of a compliant interface under a layer of a height."""
    made = held(f"cell-compliant-h{height:g}" + "-traced" * (at_fold == "trace"), FORCE_HELD,
                steps=100, slipped=5.0, tangential_maugis=COMPLIANT, height=height)
    made.options["continuation_at_fold"] = at_fold
    return made


def alone():
    """Shear of an isolated contact, by a force, up to the largest one."""
    force = reference.peak_tangential_traction(1.0) * (2 * half_width(FORCE_HELD) + 2.0)
    return Run("cell-alone", {"scene_residual_friction": 0.5, "scene_period": np.inf,
                              "scene_height": np.inf, "scene_points": "auto",
                              "load_start": f"normal_force={FORCE_HELD}",
                              "load_path": f"tangential_force={force:.4g}",
                              "continuation_initial_step": f"{force / 80:.4g}",
                              "continuation_largest_step": f"{force / 40:.4g}",
                              "continuation_at_fold": "stop", "continuation_stability": "sign"})


NEEDED = (*{one.name: one for one in [run(height=height) for height in HEIGHTS]
            + [run(period=period) for period in PERIODS]}.values(),
          *(compliant(height) for height in LOWER), compliant(2000.0, "trace"), alone(),
          finer(run(period=20.0)))


def measured(record):
    """(contact area before shear, largest tangential force before sliding) of a run."""
    driven = np.any(record["tangential_displacement"] > 0)
    return np.array([unsheared(record) if driven else record["contact_area"][0], strength(record)])


def distances(results, names, of):
    """Relative distances of (area, onset's force) of runs from those of one of them, and of its;
    shape (runs, 2)."""
    return np.array([measured(results[name]) for name in names]) / measured(results[of]) - 1


def jkr_distance(period):
    """Relative distance of JKR's width in a cell from that of the isolated contact."""
    return reference.jkr_line_half_width(FORCE_HELD,
                                         period) / reference.jkr_line_half_width(FORCE_HELD) - 1


def layer_distance(height):
    """Relative change of JKR's width by the height of the layer, which is large against it.

    What the layer yields less than a half-plane under the force W, spread over the waves q of the
    cell, adds the curvature k = (2 W/L) sum q^2 [2/q - C_nn(q)] to that of the cylinder: W = (1 +
    k) pi a^2/4 - F(a).
    """
    waves = 2 * np.pi / PERIOD * np.arange(1, 1001)
    bent = (
        2
        * FORCE_HELD
        / PERIOD
        * np.sum(waves**2 * (2 / waves - layer_compliance(waves, 0.5, height).normal))
    )
    plain = half_width(FORCE_HELD)

    def excess(change):
        half = plain * (1 + change)
        return reference.jkr_line_load(half, PERIOD) + bent * np.pi * half ** 2 / 4 - FORCE_HELD
    return brentq(excess, -0.8, 0.1, xtol=1e-15)


def path(results):
    """(mean displacement of the surface, tangential force) along the whole path of the compliant
    interface."""
    record = results[compliant(2000.0, "trace").name]
    part = sheared_part(record)
    return record["mean_tangential_displacement"][part], record["tangential_force"][part]


def least_height(results):
    """Height of the layer below which no displacement of the top is a limit: L k_0t = L/(4 H) is
    the steepest fall of the force."""
    mean, force = path(results)
    moved = np.diff(mean) > 1e-6
    steepest = np.max(-np.diff(force)[moved] / np.diff(mean)[moved])
    return PERIOD / (4 * steepest) if steepest > 0 else np.inf


def off_path(results, height):
    """Largest distance of a run's forces from the path, at the same mean displacements, over the
    largest force."""
    mean, force = path(results)
    record = results[compliant(height).name]
    part = sheared_part(record)
    found, at = record["tangential_force"][part], record["mean_tangential_displacement"][part]
    moved = np.concatenate([[True], np.diff(mean) > 1e-6])
    inside = at <= mean[moved][-1]
    return np.max(np.abs(PchipInterpolator(mean[moved], force[moved])(at[inside])
                         - found[inside])) / force.max()


def draw_cells(axes, results):
    """Panel a."""
    cells = [{"height": value} for value in (10.0, 30.0, 100.0, 2000.0)] + [{"period": value}
                                                                            for value in (20.0,
                                                                                          50.0)]
    for cell, colour in zip(cells, [*shades(4), *shades(6, "plasma")[2:5:2]]):
        record = results[run(**cell).name]
        begun = onset(record)
        branch(axes, record, "tangential_force", "contact_area", sheared_part(record), color=colour,
               linewidth=1.0, linestyle="-" if "height" in cell else "--",
               label=f"{'H' if 'height' in cell else 'L'} = {next(iter(cell.values())):g}")
        axes.plot(begun.force, begun.area, "*", color=colour, markersize=6, markeredgecolor="k",
                  markeredgewidth=0.3)
    axes.set(xlabel=FORCE, ylabel=AREA,
             title=f"(a)  $w_n/w_{{n,r}} = {FORCE_HELD}$, $\\lambda_t = 1$", xlim=(0, None),
             ylim=(8.6, None))
    event_keys(axes)
    axes.legend(ncols=3, loc="lower left")


def draw_path(axes, results):
    """Panel d."""
    mean, force = path(results)
    axes.plot(mean, force, color=GREY, linewidth=2.5, label="whole path")
    for height, colour in zip(LOWER, shades(len(LOWER))):
        branch(axes, results[compliant(height).name], "mean_tangential_displacement",
               "tangential_force", color=colour, linewidth=0.9, marker=".", markersize=3,
               label=f"H = {height:g}")
    axes.set(xlabel=r"$\bar u_t/u_{t,r}$", ylabel=FORCE, title=f"(d)  $\\lambda_t = {COMPLIANT:g}$",
             xlim=(0, min(60.0, mean.max())), ylim=(0, None))
    key(axes, *JUMP[:2], **JUMP[2])
    axes.legend(loc="upper right")


def draw(results):
    """The figure."""
    figure, ((cells, periods), (heights, slides)) = panels(2, 2, height=5.6)
    draw_cells(cells, results)
    draw_path(slides, results)
    tall = [height for height in HEIGHTS if height != 2000]
    far = distances(results, [run(period=period).name for period in PERIODS], alone().name)
    low = distances(results, [run(height=height).name for height in tall], run().name)
    for axes, values, found in ((periods, PERIODS, far), (heights, tall, low)):
        for column, (what, mark) in enumerate((("area before shear", "s"),
                                               ("force at onset", "o"))):
            axes.loglog(values, np.maximum(np.abs(found[:, column]), 1e-12), mark + "-",
                        color=f"C{1 - column}", markersize=4, label=what)
    periods.loglog(PERIODS, [-jkr_distance(period) for period in PERIODS], "k--", linewidth=0.9,
                   label="JKR in the cell")
    along = np.geomspace(20, 250, 60)
    heights.loglog(along, [abs(layer_distance(height)) for height in along], "k--", linewidth=0.9,
                   label="JKR under the layer")
    periods.set(xlabel=r"period $L/\beta$", ylabel="distance from isolated",
                title="(b)  $H = 2000$")
    heights.set(xlabel=r"height $H/\beta$", ylabel="distance from $H = 2000$",
                title="(c)  $L = 100$", ylim=(1e-8, 3))
    periods.set_xticks(PERIODS, [f"{period:g}" for period in PERIODS])
    periods.set_xticks([], minor=True)
    periods.legend()
    heights.legend()
    return figure


def says(results):
    """What the figure shows, with its numbers."""
    far = distances(results, [run(period=period).name for period in PERIODS], alone().name)
    jkr = np.array([jkr_distance(period) for period in PERIODS])
    told = {height: " and ".join(map(percent, distances(results, [run(height=height).name],
                                                        run().name)[0])) for height in HEIGHTS}
    critical = least_height(results)
    jumps = {height: bool(np.any(results[compliant(height).name]["event"] == "jump"))
             for height in LOWER}
    right = all((height > critical) == jumped for height, jumped in jumps.items())
    fates = ", ".join(f"{'a jump' if jumped else 'none'} at {height:g}"
                      for height, jumped in jumps.items())
    return (f"At W = {FORCE_HELD} the contact is "
            f"{measured(results[run().name])[0]:.1f} beta wide (lambda_n = 10, "
            "residual friction one half, force held). Its area before "
            "shear and the force at the onset differ from those of "
            "an isolated contact by " + ", ".join(f"{percent(area)} and "
                                                        f"{percent(force)} % at L = "
                                                        f"{period:g}"
                                                        for period, (area,
                                                                     force) in zip(PERIODS[::-1],
                                                                                   far[::-1]))
            + f"; JKR's area in the cell by {', '.join(map(percent, jkr[::-1]))} "
            f"%, the same within {100 * np.max(np.abs(jkr - far[:, 0])):.1g} "
            "percentage points. The height bends the surface only where "
            "the layer is not a half-plane for the longest wave of "
            "the cell: area and onset differ from those of H = "
            f"2000 by {told[500.0]} % at H = 500, {told[100.0]} % "
            "at 100 (JKR's area under the layer: "
            f"{percent(layer_distance(100.0))} %), {told[30.0]} % at 30, and "
            f"{told[10.0]} % at 10, where an incompressible layer is "
            "thinner than the contact is wide. What the height does "
            "govern is the displacement of the top, U = mean u_t "
            "+ 4 H T/L, and so whether sliding begins by a jump: "
            "the path of the force over the mean displacement of the "
            "surface is the same for every thick layer (lambda_t = "
            f"0.1, H = {LOWER[-1]:g}: within {off_path(results, LOWER[-1]):.0e} "
            "of the largest force), and a layer cannot follow it "
            "where L/(4 H) is less than its steepest fall, with "
            f"lambda_t = 0.1 above H = {critical:.0f}. "
            f"Found: {fates}" + (", as predicted. " if right else ", not as predicted. ")
            + refined(results, run(period=20.0), "L = 20"))
