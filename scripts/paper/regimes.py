"""How sliding begins: a map over residual friction and the tangential Maugis parameter at both
loads of the paper, the approach held, and the height over the period of the cell.

(a, d) Kind of the onset. Uniform slip: the contact slides as a whole while adhesion is still there;
early: at the force at which the largest traction reaches the law's peak, within a tenth; slip
front: later. Hatched: all the area that slip takes is lost before nine tenths of the onset's force.
Full dots: the onset is a fold under the paper's drive, open ones: it is gradual. Lines, in theory:
where the strength of the contact, tau_max a, is that of a crack around it, sqrt(2 pi a G)
(dashed); where the residual friction alone, rho tau_max a, is (full); where the force of the slip
front is a tenth above that of the crack (dotted). (b, e) Force at the onset over that at which the
largest traction reaches the peak. (c, f) Least height over period of a layer under which the onset
is a fold: symbols from the whole path of the force over the mean displacement of the surface, which
is that of all thick layers; lines: uniform slip of a contact of constant width; dashed: a crack
around the contact, where there is one; grey: the paper's cell.
"""

import functools
from typing import NamedTuple

import numpy as np
from beyond import finer, grid_change
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from observed import Onset, onset, sheared_part
from runs import LOADS, MAPPED, PERIOD, RESIDUALS, Run, drive, half_width, mapped
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from statement import evaluated
from style import GREY, SYMBOLS, panels, shades

from contactsnes import reference
from contactsnes.interface.laws.coupled import TANGENTIAL_PEAK
from contactsnes.output.tables import markdown

CAPTION = "How sliding begins, over residual friction, stiffness of the interface, and the cell"
COMPLIANT, SHARES = (0.1, 0.2, 0.36), (0, 0.5, 0.8, 0.9, 1)
"""Tangential parameters and residual frictions of the whole paths of (c, f)."""
PEAK, EARLY, WHOLE, GONE, BEFORE = 0.99, 1.1, 0.9, 0.01, 0.9
"""Share of the law's peak that counts as reached; force over that of the spike up to which an onset
is early; mean traction over the peak from which on the contact slides as a whole; share of the area
that counts as none; share of the onset's force before which a loss is one before."""
KINDS = ("uniform slip", "early, at the spike", "slip front")
COLOURS = ("#9ecae1", "#fdae6b", "#d9d9d9")
RATIOS = (0.9, 1.03, 1.1, 1.5, 2.5, 5.0, 60.0)


def traced(residual, maugis, force):
    """A compliant interface on its whole path, through its folds, from which its fold under a layer
    of any height follows."""
    scene = {"tangential_maugis": float(maugis), "residual_friction": float(residual)}
    half = half_width(force)
    end = drive(scene, reference.peak_tangential_traction(maugis) * (2 * half + 2)) + 5.0 / maugis
    start = max(2.0, reference.jkr_line_approach(half, PERIOD))
    return Run(f"traced-r{residual:g}-t{maugis:g}-w{force:g}", finer=False, options={
        **{f"scene_{key}": value for key, value in scene.items()}, "scene_points": 8192,
        "load_start": f"normal_displacement={start:.3f}",
        "load_path": f"normal_force={force:g}; "
                     f"normal_displacement=hold, tangential_displacement={end:.6g}",
        "continuation_initial_step": f"0.5,{end / 100:.4g}",
        "continuation_largest_step": f"1,{end / 50:.4g}", "continuation_at_fold": "trace",
        "continuation_stability": "sign"})


CASES = tuple((residual, maugis, force) for force in LOADS for residual in RESIDUALS
              for maugis in MAPPED)
MORE_CASES = (*CASES, *((0, 10, force) for force in (3, 10.4)))
"""Those of the statements, too: at other loads."""
MAP = tuple(mapped(*case) for case in sorted(MORE_CASES, key=lambda case: -case[1]))
NEEDED = (*MAP, *(traced(residual, maugis, force) for maugis in COMPLIANT for residual in SHARES
                  for force in LOADS),
          # Those of the paper's figures are made again with these.
          *(finer(run) for run in MAP if not run.finer), finer(traced(0.8, 0.2, 25)))


class Begun(NamedTuple):
    """How a contact begins to slide.

    onset : Onset; spike : force at which the largest traction reaches the peak of the law, that of
        the onset where it does not; whole : mean traction over the peak at the onset; left : share
        that is still there of the area that slip takes; lost : force at which all but a hundredth
        of that is lost, over the onset's, 1 where it is not
    """

    onset: Onset
    spike: float
    whole: float
    left: float
    lost: float

    @property
    def ratio(self):
        """Force at the onset over that of the spike."""
        return self.onset.force / self.spike

    @property
    def kind(self):
        """Index of `KINDS`."""
        if self.whole >= WHOLE and self.left > 0.1:
            return 0
        return 1 if self.ratio <= EARLY else 2


def slid_area(results, force):
    """Area after gross sliding at the normal displacement of a force, the same for all
    interfaces."""
    return results[f"half-t0.1-w{force:g}"]["contact_area"][-1]


def friction_width(results, force):
    """Width of the friction then: force over residual traction."""
    return results[f"half-t0.1-w{force:g}"]["tangential_force"][-1] / (
        0.5 * reference.peak_tangential_traction(0.1))


def grid_changes(results, maugis=MAPPED):
    """(residual friction, tangential parameter, normal force) -> relative changes of the force at
    the onset and of the area there on twice the points, of the cases that were made on these."""
    changes = {case: evaluated(grid_change, results, mapped(*case))[0] for case in CASES
               if case[1] in maugis}
    return {case: change[:2] for case, change in changes.items() if change}


def onset_error(results, residual, maugis, force, area=False):
    """Error of the force at an onset, or of the area there: what twice the points change, or the
    step it lies in; 0 where neither is known."""
    begin = begun(results, residual, maugis, force).onset
    change = grid_changes(results, (maugis,)).get((residual, maugis, force), (0.0, 0.0))
    return change[1] * begin.area if area else max(begin.force_error, change[0] * begin.force)


def precision(results):
    """A sentence on what twice the points change, by ranges of the tangential parameter."""
    told = []
    for low, high in ((MAPPED[0], 3.6), (6, 6), (10, 10), (14, 14)):
        within = [one for one in MAPPED if low <= one <= high]
        changes = grid_changes(results, within)
        count = len(RESIDUALS) * len(LOADS) * len(within)
        where = f"lambda_t = {low:g}" + f" to {high:g}" * (high > low)
        told.append(f"{where}: {max(change[0] for change in changes.values()):.0e} and "
                    f"{max(change[1] for change in changes.values()):.0e} "
                    f"({len(changes)} of {count} cases)" if changes
                    else f"{where}: not known")
    return ("Twice the points change forces at the onset and areas there, at most and relative to "
            "themselves, by - " + "; ".join(told) + ".")


def crossed(values, forces, level):
    """Force at which values that rise with it first reach a level; the last force where they do
    not."""
    first = int(np.argmax(values >= level))
    if not values[first] >= level:
        return forces[-1]
    return float(np.interp(level, values[first - 1:first + 1], forces[first - 1:first + 1])
                 if first else forces[0])


@functools.lru_cache(maxsize=4096)
def begun(results, residual, maugis, force):
    """`Begun` of a case, None where sliding does not begin."""
    record = results[mapped(residual, maugis, force).name]
    found = onset(record)
    if found is None:
        return None
    part = slice(sheared_part(record).start, found.point + 1)
    forces, areas, traction = (record[name][part] for name in (
        "tangential_force", "contact_area", "maximum_tangential_traction"))
    least = slid_area(results, force) if force in LOADS else areas.min()
    taken = (areas[0] - areas) / (areas[0] - least)
    lost = crossed(taken, forces, 1.0 - GONE) / found.force if taken.max() > 1 - GONE else 1.0
    return Begun(found, crossed(traction / TANGENTIAL_PEAK, forces, PEAK),
                 found.force / (reference.peak_tangential_traction(maugis) * found.area),
                 1.0 - taken[-1], min(lost, 1.0))


def crack(results, residual, force):
    """Force of a crack around the contact that has lost its adhesion, sqrt(2 pi a G)."""
    return reference.ligament_force(0.5 * friction_width(results, force), PERIOD,
                                    max(reference.front_work(residual), 0.0))


def stiff_from(results, force):
    """Tangential parameter at which tau_max a is the force of the crack."""
    return crack(results, 0.0, force) / (TANGENTIAL_PEAK_TRACTION * friction_width(results, force))


TANGENTIAL_PEAK_TRACTION = reference.peak_tangential_traction(1.0)


def residual_boundary(results, maugis, force, of_front):
    """Residual friction at which rho tau_max a is the force of the crack, or, with ``of_front``, at
    which the slip front's largest force is a tenth above it; nan where there is none."""
    width, peak = friction_width(results, force), reference.peak_tangential_traction(maugis)

    def excess(residual):
        brittle = crack(results, residual, force)
        if not of_front:
            return residual * peak * width - brittle
        return reference.front_onset(0.5 * width, residual * peak,
                                     max(reference.front_work(residual), 0.0),
                                     PERIOD)[1] - EARLY * brittle
    return brentq(excess, 1e-6, 0.999, xtol=1e-7) if excess(1e-6) * excess(0.999) < 0 else np.nan


def least_height(record):
    """Height over period from which on the fall of the force is steeper than the drive, L k = L/(4
    H); inf where the force does not fall, 0 where the surface turns back: a fold under any
    layer."""
    part = sheared_part(record)
    mean, force = (record[name][part] for name in ("mean_tangential_displacement",
                                                   "tangential_force"))
    keep = np.concatenate([[True], np.diff(mean) > 1e-9])
    if not np.all(np.diff(mean) > -1e-6):
        return 0.0
    curve = CubicSpline(mean[keep], force[keep])
    upto = mean[keep][-1]
    steepest = -curve(np.linspace(0.0, upto, 20001), 1).min()
    return 1.0 / (4.0 * steepest) if steepest > 1e-7 else np.inf


def least_height_by_theory(results, residual, maugis, force):
    """The same for uniform slip of a contact of the width in sliding."""
    softening = reference.uniform_slip_softening(0.5 * friction_width(results, force), maugis,
                                                 residual)
    return 1.0 / (4.0 * softening)


def crack_height(results, force):
    """The same for a crack around the contact, which carries F(s) = sqrt(2 pi s G) and moves the
    surface by (2/pi) F ln(1/sin(pi s/L)): 0 where that turns back, whatever the layer."""
    half = 0.5 * friction_width(results, force)
    s = half * np.array([1.0 + 1e-6, 1.0 - 1e-6])
    carried = np.array([reference.ligament_force(one, PERIOD) for one in s])
    mean = carried / np.array([reference.ligament_stiffness(one, PERIOD) for one in s])
    fall = -np.diff(carried)[0] / np.diff(mean)[0]
    return 1.0 / (4.0 * fall) if fall > 0 else 0.0


def place(values, axis, log=False):
    """Where values lie on an axis whose cells are the values of a list."""
    known, asked = np.array(axis, float), np.asarray(values, float)
    if log:
        known, asked = np.log(known), np.log(asked)
    return np.interp(asked, known, np.arange(len(axis)), left=np.nan, right=np.nan)


def lines(axes, results, force):
    """Boundaries by theory."""
    along = np.geomspace(MAPPED[0], MAPPED[-1], 25)
    for of_front, style in ((False, "-"), (True, ":")):
        there = [residual_boundary(results, maugis, force, of_front) for maugis in along]
        axes.plot(place(there, RESIDUALS), place(along, MAPPED, log=True), "k" + style,
                  linewidth=1.2)
    axes.axhline(place(stiff_from(results, force), MAPPED, log=True), color="k", linestyle="--",
                 linewidth=1.2)


def grid(axes, letter, force):
    """Axes of a map."""
    axes.set(xlim=(-0.5, len(RESIDUALS) - 0.5), ylim=(-0.5, len(MAPPED) - 0.5),
             xlabel=SYMBOLS["residual"], ylabel=r"$\lambda_t$",
             title=f"({letter})  $w_n/w_{{n,r}} = {force:g}$")
    axes.set_xticks(range(len(RESIDUALS)), [f"{value:g}".replace("0.", ".") for value in RESIDUALS])
    axes.set_yticks(range(len(MAPPED)), [f"{value:g}" for value in MAPPED])
    axes.tick_params(length=0)


def table(results, force, value):
    """Array (tangential parameters, residual frictions) of a number of each `Begun`, nan without
    one."""
    cases = [[begun(results, residual, maugis, force) for residual in RESIDUALS]
             for maugis in MAPPED]
    return np.array([[np.nan if one is None else value(one) for one in row] for row in cases])


def draw_kinds(axes, results, force, letter):
    """Panels a and d."""
    kinds = table(results, force, lambda one: one.kind)
    axes.imshow(kinds, origin="lower", aspect="auto", cmap=ListedColormap(COLOURS), vmin=-0.5,
                vmax=2.5)
    before = table(results, force, lambda one: one.lost < BEFORE)
    folds = table(results, force, lambda one: one.onset.unstable)
    for row, column in np.argwhere(before == 1):
        axes.add_patch(hatched(column, row))
    for unstable, face in ((1, "k"), (0, "w")):
        rows, columns = np.nonzero(folds == unstable)
        axes.plot(columns, rows, "o", color="k", markerfacecolor=face, markersize=3,
                  markeredgewidth=0.6)
    lines(axes, results, force)
    grid(axes, letter, force)


def hatched(column, row):
    """A hatched cell."""
    return Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor="none", edgecolor="#777777",
                           hatch="//////", linewidth=0.0)


def draw_ratios(axes, results, force, letter):
    """Panels b and e; what a colour bar needs."""
    ratios = table(results, force, lambda one: one.ratio)
    colours = ListedColormap(shades(len(RATIOS) - 1, "YlGnBu"))
    drawn = axes.imshow(ratios, origin="lower", aspect="auto", cmap=colours,
                        norm=BoundaryNorm(RATIOS, colours.N))
    grid(axes, letter, force)
    return drawn


def draw_heights(axes, results, force, letter):
    """Panels c and f."""
    along = np.geomspace(COMPLIANT[0] / 1.3, 2.0, 40)
    for residual, colour, marker in zip(SHARES, shades(len(SHARES)), "osD^v"):
        found = [least_height(results[traced(residual, maugis, force).name])
                 for maugis in COMPLIANT]
        axes.plot(COMPLIANT, np.maximum(found, 1e-3), marker, color=colour, markersize=4,
                  label=f"{residual:g}")
        if residual < 1:
            axes.plot(along, [least_height_by_theory(results, residual, maugis, force)
                              for maugis in along], color=colour, linewidth=0.8)
    if crack_height(results, force) > 0:
        axes.axhline(crack_height(results, force), color="k", linestyle="--", linewidth=0.8)
    axes.axhline(2000.0 / PERIOD, color=GREY, linewidth=1.5)
    axes.set(xscale="log", yscale="log", xlabel=r"$\lambda_t$", ylabel="$H/L$",
             title=f"({letter})  $w_n/w_{{n,r}} = {force:g}$", ylim=(2e-2, 4e2),
             xlim=(along[0], along[-1]))
    axes.annotate("fold", (0.97, 0.95), xycoords="axes fraction", ha="right", va="top")
    axes.annotate("gradual", (0.04, 0.16), xycoords="axes fraction")


def draw(results):
    """The figure."""
    figure, axes = panels(2, 3, height=6.2)
    for row, force in enumerate(LOADS[::-1]):
        draw_kinds(axes[row, 0], results, force, "ad"[row])
        drawn = draw_ratios(axes[row, 1], results, force, "be"[row])
        draw_heights(axes[row, 2], results, force, "cf"[row])
    bar = figure.colorbar(drawn, ax=axes[:, 1], location="bottom", aspect=18, pad=0.02,
                          label="force at onset over spike's")
    bar.set_ticks(RATIOS[1:-1], labels=[f"{ratio:g}" for ratio in RATIOS[1:-1]])
    figure.legend(handles=keys(), loc="lower left", ncols=2, bbox_to_anchor=(0.0, 0.0))
    figure.legend(handles=height_keys(), loc="lower right", ncols=2, bbox_to_anchor=(1.0, 0.0))
    figure.get_layout_engine().set(rect=(0, 0.05, 1, 0.95))
    return figure


def keys():
    """What shades, dots and lines of (a, b, d, e) are."""
    return [*(Patch(facecolor=colour, label=kind) for colour, kind in zip(COLOURS, KINDS)),
            Patch(facecolor="none", edgecolor="#777777", hatch="//////", linewidth=0,
                  label="area lost before"),
            Line2D([], [], marker="o", color="k", linestyle="none", markersize=3, label="fold"),
            Line2D([], [], marker="o", color="k", markerfacecolor="w", linestyle="none",
                   markersize=3, label="gradual"),
            *(Line2D([], [], color="k", linestyle=style, linewidth=1.2, label=label)
              for style, label in (("--", r"$\tau_{\max}a$ = crack"),
                                   ("-", r"$\rho\,\tau_{\max}a$ = crack"),
                                   (":", "front = 1.1 cracks")))]


def height_keys():
    """What symbols and lines of (c, f) are."""
    return [*(Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=4,
                     label=f"$\\rho = {residual:g}$")
              for residual, colour, marker in zip(SHARES, shades(len(SHARES)), "osD^v")),
            Line2D([], [], color="k", linewidth=0.8, label="uniform slip"),
            Line2D([], [], color="k", linewidth=0.8, linestyle="--", label="crack"),
            Line2D([], [], color=GREY, linewidth=1.5, label="the paper")]


def steps(holds, values):
    """Range of the values for which something holds, in words."""
    there = [value for value, yes in zip(values, holds) if yes]
    return f"{min(there):g} to {max(there):g}" if there else "none"


def agreement(results, force):
    """(onsets whose kind theory gives, all onsets)."""
    right = total = 0
    stiff = stiff_from(results, force)
    for maugis in MAPPED:
        boundary = residual_boundary(results, maugis, force, True)
        for residual in RESIDUALS:
            one = begun(results, residual, maugis, force)
            if one is None:
                continue
            expected = (0 if maugis < stiff else
                        2 if residual > (0 if np.isnan(boundary) else boundary) else 1)
            right, total = right + (one.kind == expected), total + 1
    return right, total


def onset_tables(results):
    """Lines of a table for each load: forces at the onset, and how it comes."""
    lines = []
    for force in LOADS[::-1]:
        rows = []
        for maugis in MAPPED[::-1]:
            cells = [begun(results, residual, maugis, force) for residual in RESIDUALS]
            rows.append([f"{maugis:g}"] + ["-" if one is None else f"{one.onset.force:.4g} "
                                           f"{'uef'[one.kind]}{'' if one.onset.unstable else ', g'}"
                                           for one in cells])
        heading = ["λ<sub>t</sub> \\ ρ", *(f"{value:g}" for value in RESIDUALS)]
        lines += [f"W = {force:g}:", "", *markdown(heading, rows), ""]
    return [*lines, precision(results).replace("lambda_t", "λ_t")]


def says(results):
    """What the figure shows, with its numbers."""
    text = ""
    for force in LOADS[::-1]:
        kinds, folds = (table(results, force, value) for value in (
            lambda one: one.kind, lambda one: one.onset.unstable))
        early = [f"{maugis:g} ({steps(kinds[row] == 1, RESIDUALS)})"
                 for row, maugis in enumerate(MAPPED) if np.any(kinds[row] == 1)]
        whole = [maugis for row, maugis in enumerate(MAPPED) if np.any(kinds[row] == 0)]
        right, total = agreement(results, force)
        text += (f"W = {force:g}: {int(np.isfinite(kinds).sum())} onsets, {int(np.nansum(folds))} "
                 "of them folds. The contact slips as a whole, with adhesion still there, up to "
                 f"lambda_t = {max(whole, default=0):g} (tau_max a is the force of a crack at "
                 f"{stiff_from(results, force):.2g}); above, an onset comes early, within a tenth "
                 "of the force at which the spike reaches the law's peak, for lambda_t (rho) = "
                 + (", ".join(early) or "none") + "; else a front of slip goes in first. Two "
                 "lines of theory, the strength of the contact against that of a crack and the "
                 f"front's force a tenth above the crack's, give the kind of {right} of the "
                 f"{total}. ")
    least = {(residual, maugis, force): least_height(results[traced(residual, maugis, force).name])
             for residual in SHARES for maugis in COMPLIANT for force in LOADS}
    off = max(abs(least[residual, 0.1, 25]
                  / least_height_by_theory(results, residual, 0.1, 25) - 1)
              for residual in (0, 0.5, 0.8))
    rise = {force: least[1, 0.1, force] for force in LOADS}
    once = traced(0.8, 0.2, 25)
    again = [results[run.name] for run in (once, finer(once))]
    change = abs(least_height(again[0]) / least_height(again[1]) - 1)
    return text + (
        "Whether a compliant onset is a fold hinges on the drive: it is one under a layer higher, "
        f"in periods, than {least[0, 0.1, 25]:.2g} at rho = 0, {least[0.8, 0.1, 25]:.2g} at 0.8 "
        f"and {least[0.9, 0.1, 25]:.2g} at 0.9 (lambda_t = 0.1, W = 25; uniform slip of a contact "
        f"of constant width within {100 * off:.0f} % up to 0.8); at rho = 1, where only the loss "
        f"of area makes the force fall, {rise[25]:.2g} and, at W = 0.8, {rise[0.8]:.2g}; the "
        f"paper's layer is 20 high. {precision(results)} Least heights change by {change:.0e} "
        "(rho = 0.8, lambda_t = 0.2, W = 25).")
