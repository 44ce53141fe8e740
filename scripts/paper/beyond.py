"""What the figures beyond the paper's share: runs at a held normal force, and what is read off
them."""

from observed import onset, sheared_part
from runs import FINER, PERIOD, Run, half_width, points

from contactsnes import reference
from contactsnes.interface.elasticity import rigid_stiffness

HEIGHT = 2000.0
SLIPPED = 40.0
"""Displacement of the surface, in delta_t, that is left to slip in at the end of a run."""


def held(name, force, steps=50, start=None, slipped=SLIPPED, **scene):
    """A contact that is pressed to a normal force and sheared to gross sliding and beyond while
    that force is held.

    steps : the least number of points of the shear; start : displacement of the top to begin at
        (default: a contact at about W = 0.8);
    slipped : displacement left to slip in at the end, in units of delta_t
    """
    scene = {"tangential_maugis": 1.0, "residual_friction": 0.5, **scene}
    period = scene.get("period", PERIOD)
    height = scene.get("height", HEIGHT)
    poisson = scene.get("poisson", 0.5)
    strength = reference.peak_tangential_traction(scene["tangential_maugis"]) * (
        2 * half_width(max(force, 0.8)) + 2.0)
    end = reference.driven_displacement(3 * strength + slipped / scene["tangential_maugis"],
                                        strength, period, height, poisson)
    if start is None:
        normal = rigid_stiffness(poisson, height)[0]
        start = reference.jkr_line_approach(reference.jkr_line_half_width(0.8, period),
                                            period) + 0.8 / (period * normal)
    return Run(name, {**{f"scene_{key}": value for key, value in scene.items()},
                      "scene_points": scene.get("points") or points(0, **scene),
                      "load_start": f"normal_displacement={start:.6g}",
                      "load_path": f"normal_force={force:g}; tangential_displacement={end:.6g}",
                      "load_stop": "pull_off",
                      "continuation_initial_step": f"0.25,{end / steps / 2:.4g}",
                      "continuation_largest_step": f"1.5,{end / steps:.4g}",
                      "continuation_stability": "sign"})


def finer(run):
    """A run again on twice the points, without certificates."""
    return run.on(2 * run.options["scene_points"], continuation_stability="off")._replace(
        name=run.name + FINER, finer=False)


def grid_change(results, run):
    """Relative changes of (force at the onset, area there, area before shear) from a run to the
    same one on twice the points."""
    found = [results[one.name] for one in (run, finer(run))]
    coarse, fine = ((strength(record), onset(record).area, unsheared(record)) for record in found)
    return tuple(abs(a / b - 1) for a, b in zip(coarse, fine))


def refined(results, run, where):
    """A sentence on what twice the points change."""
    force, area, before = grid_change(results, run)
    return (f"Twice the points change the onset's force by {force:.0e} of "
            f"itself, the areas there and before shear by {area:.0e} "
            f"and {before:.0e} ({where}).")


def percent(ratio):
    """A relative change in percent, as text."""
    return f"{100 * ratio:+.2g}" if abs(ratio) >= 1e-6 else "0"


def unsheared(record):
    """Contact area before the shear."""
    return record["contact_area"][sheared_part(record)][0]


def sliding(record):
    """Contact area at the end, where the whole contact slides; 0 where it has come off."""
    return record["contact_area"][-1]


def strength(record):
    """Largest tangential force up to the onset of gross sliding, or up to where the contact comes
    off."""
    begun = onset(record)
    return float(record["tangential_force"].max()) if begun is None else begun.force
