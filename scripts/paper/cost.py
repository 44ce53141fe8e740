"""What the runs cost, and what damped Verlet as in the paper would have: measured on a sample of
the same kind of points.

A sample is the first point, two steps of pressing and three of shear on 2^13 points, by either
method, at the normal force 25. Every point of the runs counts as one of its kind, so that a finer
grid, where Verlet needs more steps, is taken to cost as many transforms of its own size: the
estimate is a low one.
"""

import math

import numpy as np
from runs import LAWS, ROOT, TANGENTIAL, Run

KINDS = ("first point", "pressing", "shear")
SHEAR = {0.1: 9.0, 1: 60.0, 10: 75.0}
"""End of the sampled shear for each tangential parameter: three of its steps."""


def sample(maugis, method):
    """A short run of the sample by a method ('newton', 'verlet-plain')."""
    end = SHEAR[maugis]
    return Run(f"sample-{method}-t{maugis:g}", finer=False,
               options={"options_file": str((ROOT / "options" / f"{method}.opts").relative_to(
        ROOT)), "scene_tangential_maugis": float(maugis),
                        **{f"scene_{name}": value for name, value in LAWS["half"].items()},
                        "load_start": "normal_displacement=35",
                        "load_path": f"normal_displacement=36; tangential_displacement={end:g}",
                        "continuation_initial_step": f"0.5,{end / 3:g}",
                        "continuation_largest_step": f"0.5,{end / 3:g}"})


NEEDED = tuple(sample(maugis, method) for maugis in TANGENTIAL
               for method in ("newton", "verlet-plain"))


def kinds(record):
    """Kind of each point, as indices of KINDS."""
    sheared = record["tangential_force"] != 0
    return np.where(sheared, 2, np.where(np.arange(record.points) == 0, 0, 1))


def mean_costs(results, method):
    """Transforms of a point of each kind in the sample, a mean over the parameters; and the points
    of the sample."""
    cost, count = np.zeros(3), np.zeros(3)
    for maugis in TANGENTIAL:
        record = results[f"sample-{method}-t{maugis:g}"]
        np.add.at(cost, kinds(record), record["transforms"])
        np.add.at(count, kinds(record), 1)
    return cost / count, int(count.sum())


def weight(record):
    """Transforms of 2^13 points that one of a run's grid is worth."""
    points = int(record.scene["points"])
    return points * math.log(points) / (8192 * math.log(8192))


def totals(results, runs):
    """(transforms of all runs, those that Verlet would take, points), in transforms of 2^13
    points."""
    verlet, _ = mean_costs(results, "verlet-plain")
    spent = estimated = points = 0.0
    for run in runs:
        if run.name not in results or run.name.startswith("sample"):
            continue
        record = results[run.name]
        spent += weight(record) * record["transforms"].sum()
        estimated += weight(record) * verlet[kinds(record)].sum()
        points += record.points
    return spent, estimated, int(points)


def report(results, runs):
    """Lines for the page."""
    spent, estimated, points = totals(results, runs)
    means = {method: mean_costs(results, method) for method in ("newton", "verlet-plain")}
    cells = [f"{kind}: {means['newton'][0][at]:.0f} and {means['verlet-plain'][0][at]:.0f}"
             for at, kind in enumerate(KINDS)]
    return [f"The {points} points of the runs took {spent:.3g} transforms "
            "of 2^13 points (folds, jumps and stability included, "
            "estimates of errors not). Damped Verlet as in the paper "
            f"(`options/verlet-plain.opts`) would take about {estimated:.2g}, "
            f"{estimated / spent:.0f} times as many, by {means['verlet-plain'][1]} "
            "points that were measured with both methods (transforms of "
            "Newton's method and of Verlet's a point - "
            f"{'; '.join(cells)}). That leaves out that finer grids take "
            "Verlet more steps, and that it cannot locate a fold."]
