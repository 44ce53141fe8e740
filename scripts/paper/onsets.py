"""Onset of sliding over the plane of both Maugis parameters, at a held normal force, for two
residual frictions.

A row for each residual friction, a cell for each run: full dots slide from a fold, open ones
gradually (the last node slips past the law's peak), crosses come off before. (a, d) Force at the
onset over tau_max times the area before shear. (b, e) Share of the area lost in all that is lost
before the onset. (c, f) Distance of the force from the nearer of two estimates; lines: where each
is off by 5 %, where both are equal, and where adhesion is of too long a range for JKR.
"""

import functools

import numpy as np
from beyond import HEIGHT, finer, grid_change, unsheared
from matplotlib.colors import BoundaryNorm, ListedColormap
from observed import onset
from runs import PERIOD, Run, half_width, points
from scipy.optimize import brentq, minimize_scalar
from scipy.special import lambertw
from style import panels, shades

from contactsnes import reference

FORCE, RESIDUALS = 0.8, (0.5, 1.0)
NORMAL, TANGENTIAL = (0.3, 0.55, 1, 1.8, 3, 5.5, 10), (0.1, 0.2, 0.5, 1, 2, 5, 10)
SLID = 5
"""Tangential parameter of the runs from which the sliding contact is read: there slip has taken all
adhesion."""
STEPS = {1: 60, 5: 40, 10: 80}
"""Tangential parameter -> least number of points of the shear, where it is not 25: long steps pass
over small folds, and fronts take many small ones."""
WITHIN = 5.0
"""Distance of an estimate up to which it holds, percent."""
MARKERS = {"fold": {"marker": "o", "color": "k", "markeredgecolor": "w", "markeredgewidth": 0.3,
                    "markersize": 4.5}, "gradual": {"marker": "o", "color": "k",
                                                    "markerfacecolor": "w", "markeredgewidth": 0.7,
                                                    "markersize": 4},
           "no onset": {"marker": "x", "color": "k", "markersize": 4}}
COLOURS = {"uniform": "C0", "front": "C2"}
CAPTION = "Onset of sliding over the plane of both Maugis parameters, at a held normal force of 0.8"


def name(residual, normal, tangential):
    """Name of the run of a case."""
    return f"onsets-r{residual:g}-n{normal:g}-t{tangential:g}"


def run(residual, normal, tangential):
    """Shear at the held normal force until beyond the onset."""
    scene = {"normal_maugis": float(normal), "tangential_maugis": float(tangential),
             "residual_friction": residual}
    half = half_width(FORCE) + 0.75 / np.sqrt(normal)
    peak = reference.peak_tangential_traction(tangential)
    strength = min(2 * peak * half, 2 * residual * peak * half + reference.ligament_force(half))
    end = reference.driven_displacement(3 / tangential, strength, PERIOD, HEIGHT)
    steps = STEPS.get(tangential, 25)
    return Run(
        name(residual, normal, tangential),
        {
            **{f"scene_{key}": value for key, value in scene.items()},
            "scene_points": points(2048, **scene),
            "load_start": "normal_displacement="
                          f"{reference.jkr_line_approach(half_width(FORCE), PERIOD):.4g}",
            "load_path": f"normal_force={FORCE:g}; tangential_displacement={end:.6g}",
            "load_stop": "pull_off",
            "continuation_initial_step": f"0.25,{end / steps / 4:.4g}",
            "continuation_largest_step": f"1.5,{end / steps:.4g}",
            "continuation_stability": "sign",
            # Along its length a branch tells exactly where a compliant interface slides; a stiff
            # one's is too long for that.
            **({"continuation_type": "arclength"} if tangential <= 1 else {}),
        },
    )


REFINED = (0.5, 0.3, 0.1), (0.5, 1, 1), (0.5, 10, 2)
NEEDED = (*(run(residual, normal, tangential) for tangential in TANGENTIAL[::-1]
            for normal in NORMAL for residual in RESIDUALS),
          *(finer(run(*case)) for case in REFINED))


def record_of(results, residual, normal, tangential):
    """The archive of a case, None where it has no points."""
    try:
        return results[name(residual, normal, tangential)]
    except KeyError:
        return None


def each(results, value):
    """Array (residual frictions, tangential, normal parameters) of a number of each case, nan where
    it is None."""
    found = [[[value(results, residual, normal, tangential) for normal in NORMAL]
              for tangential in TANGENTIAL] for residual in RESIDUALS]
    return np.array(found, dtype=float)


def slid(results, normal):
    """(area, width of the friction: force over traction) of the sliding contact, the same for all
    tangential laws."""
    last = results[name(0.5, normal, SLID)]
    return last["contact_area"][-1], last["tangential_force"][-1] / (
        0.5 * reference.peak_tangential_traction(SLID))


def front(results, residual, normal, tangential):
    """Force of the slip front that runs through, or of friction on the whole sliding contact where
    there is no such front."""
    traction = residual * reference.peak_tangential_traction(tangential)
    return reference.front_onset(0.5 * slid(results, normal)[1], traction,
                                 max(reference.front_work(residual), 0.0), PERIOD)[1]


def gripping_width(slip, normal):
    """Width of the friction of a contact that slips as a whole by b ranges: that of Maugis and
    Dugdale for the adhesion exp(-b^2), times exp(-gap) where tension opens it: within a by the
    law's own rise, gap exp(-gap) = tension, beyond by the opening at a crack's tip."""
    left = float(reference.fading_work(slip))
    maugis = normal * left ** (2 / 3)
    inner, outer = reference.maugis_line(FORCE / left ** (2 / 3), maugis)
    places = (np.arange(200) + 0.5) / 200
    x = inner * np.sin(0.5 * np.pi * places)
    tension = -reference.maugis_line_pressure(x, inner, outer,
                                              maugis) / reference.peak_normal_traction(maugis)
    gap = -lambertw(-np.clip(tension, 0.0, 1.0) / np.e).real
    held = np.mean(np.exp(-gap) * 0.5 * np.pi * np.cos(0.5 * np.pi * places)) * inner
    return 2 * left ** (1 / 3) * (held + np.mean(np.exp(-np.e * places ** 1.5)) * (outer - inner))


@functools.cache
def uniform_unit(normal):
    """Largest force of a contact that slips as a whole, over the tangential parameter."""
    found = minimize_scalar(lambda slip: -slip * np.exp(-slip ** 2) * gripping_width(slip, normal),
                            bounds=(0.2, np.sqrt(0.5)), method="bounded", options={"xatol": 1e-4})
    return -2 * found.fun


def uniform(normal, tangential):
    """Force at which the contact slips as a whole."""
    return uniform_unit(normal) * tangential


def maps(results):
    """Name -> array of what is drawn: the force at the onset over tau_max times the area, the share
    of the area lost before, percent from uniform slip and from the front, whether it is a fold."""
    def begun(value):
        def of_case(results, residual, normal, tangential):
            record = record_of(results, residual, normal, tangential)
            found = record and onset(record)
            return value(found, residual, normal, tangential, record) if found else None
        return each(results, of_case)

    def share(found, residual, normal, tangential, record):
        area, _ = slid(results, normal)
        whole = unsheared(results[name(residual, normal, 1)])
        return (whole - found.area) / (whole - area)

    return {
        "force": begun(
            lambda found, residual, normal, tangential, record: (
                found.force / (reference.peak_tangential_traction(tangential) * unsheared(record))
            )
        ),
        "share": begun(share),
        # Uniform slip supposes that adhesion is still there.
        "uniform": begun(
            lambda *case: (
                100 * (case[0].force / uniform(*case[2:4]) - 1) if share(*case) < 0.9 else None
            )
        ),
        "front": begun(
            lambda found, residual, normal, tangential, record: (
                100 * (found.force / front(results, residual, normal, tangential) - 1)
            )
        ),
        "fold": begun(lambda found, *_: found.unstable),
    }


def crossing(results, residual, normal):
    """Tangential parameter at which both estimates are equal, nan where there is none."""
    def difference(log):
        return uniform(normal, np.exp(log)) / front(results, residual, normal, np.exp(log)) - 1

    ends = np.log(TANGENTIAL[0] / 3), np.log(TANGENTIAL[-1])
    return (np.exp(brentq(difference, *ends)) if difference(ends[0]) * difference(ends[1]) < 0
            else np.nan)


def shortest_range():
    """Normal parameter below which adhesion is of too long a range for JKR: Maugis and Dugdale's
    width is larger by `WITHIN`."""
    def excess(log):
        return reference.maugis_line(FORCE, np.exp(log))[1] / reference.jkr_line_half_width(
            FORCE) - 1 - WITHIN / 100

    return np.exp(brentq(excess, np.log(NORMAL[0]), np.log(NORMAL[-1])))


def edges(centres):
    """Borders of cells around places on a logarithmic axis."""
    logs = np.log(centres)
    inner = 0.5 * (logs[1:] + logs[:-1])
    return np.exp(np.concatenate([[2 * logs[0] - inner[0]], inner, [2 * logs[-1] - inner[-1]]]))


def shaded(name, levels):
    """Six shades between levels, as the look of a map."""
    colours = ListedColormap(shades(len(levels) - 1, name))
    return {"cmap": colours, "norm": BoundaryNorm(levels, colours.N)}


def draw(results):
    """The figure."""
    found, (figure, axes) = maps(results), panels(2, 3, height=6.4)
    nearer = np.fmin(np.abs(found["uniform"]), np.abs(found["front"]))
    looks = ((found["force"], r"onset force over $\tau_{\max} a_0$",
              shaded("viridis", (0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9))),
             (100 * found["share"], "area lost before, % of all lost",
              shaded("cividis", (-1, 10, 30, 50, 90, 99, 101))),
             (nearer, "from the nearer estimate, %", shaded("YlOrBr", (0, 0.3, 1, 2, 5, 10, 30))))
    for column, (values, label, look) in enumerate(looks):
        for line, residual in enumerate(RESIDUALS):
            one = axes[line, column]
            drawn = one.pcolormesh(edges(NORMAL), edges(TANGENTIAL),
                                   np.ma.masked_invalid(values[line]), **look)
            draw_markers(one, results, residual, found["fold"][line])
            one.set(xscale="log", yscale="log", facecolor="0.9", xlim=edges(NORMAL)[[0, -1]],
                    ylim=edges(TANGENTIAL)[[0, -1]], title=f"({'abcdef'[3 * line + column]})  "
                    "$\\tau_\\infty = "
                    f"{'' if residual == 1 else f'{residual:g}'}\\tau_{{\\max}}$")
            one.set_xticks([0.3, 1, 3, 10], ["0.3", "1", "3", "10"], minor=False)
            one.set_yticks([0.1, 1, 10], ["0.1", "1", "10"], minor=False)
            one.set_xticks([], minor=True)
        figure.colorbar(drawn, ax=axes[:, column], location="bottom", label=label, aspect=25,
                        ticks=look["norm"].boundaries[1:-1])
        axes[1, column].set_xlabel(r"$\lambda_n$")
    for line, one in enumerate(axes[:, 0]):
        one.set_ylabel(r"$\lambda_t$")
        draw_theory(axes[line, 2], results, found, line)
    legend(figure)
    return figure


def draw_markers(axes, results, residual, folds):
    """The kind of onset of each case."""
    for row, tangential in enumerate(TANGENTIAL):
        for column, normal in enumerate(NORMAL):
            fold = folds[row, column]
            kind = "no onset" if np.isnan(fold) else "fold" if fold else "gradual"
            axes.plot(normal, tangential, linestyle="none", label=kind, **MARKERS[kind])


def draw_theory(axes, results, found, line):
    """Where estimates hold, where they are equal, and where JKR's contact does not apply."""
    for (estimate, colour), label in zip(COLOURS.items(),
                                         ("uniform slip", "slip front, or friction of all")):
        values = np.ma.masked_where(np.isnan(found["fold"][line]),
                                    np.nan_to_num(np.abs(found[estimate][line]), nan=100.0))
        if values.min() < WITHIN < values.max():
            axes.contour(NORMAL, TANGENTIAL, values, levels=[WITHIN], colors=colour, linewidths=1.6)
        axes.plot([], [], color=colour, linewidth=1.6, label=f"{label}: off by {WITHIN:g} %")
    axes.plot(NORMAL, [crossing(results, RESIDUALS[line], normal) for normal in NORMAL], "k--",
              linewidth=1.0, label="uniform slip = slip front")
    axes.axvline(shortest_range(), linestyle=":", color="k", linewidth=1.0,
                 label="Maugis-Dugdale's width = 1.05 JKR's")


def legend(figure):
    """One legend below for all panels, of what is in them."""
    found = {}
    for axes in figure.axes:
        found.update({label: handle for handle, label in zip(*axes.get_legend_handles_labels())})
    order = sorted(found, key=[*MARKERS, *found].index)
    figure.legend([found[label] for label in order], order, loc="lower center", ncols=3)
    figure.get_layout_engine().set(rect=(0, 0.12, 1, 0.88))


def compressed(symbol, places, holds, known):
    """The places on an axis where something holds, of those that are known, in words."""
    places, holds = np.array(places)[known], np.asarray(holds, bool)[known]
    chosen = [f"{place:g}" for place in places[holds]]
    inside = np.flatnonzero(holds)
    if holds.all():
        return f"all {symbol}"
    if len(chosen) < 2 or np.any(np.diff(inside) > 1):
        return f"{symbol} = {', '.join(chosen)}"
    if holds[-1]:
        return f"{symbol} >= {chosen[0]}"
    return f"{symbol} <= {chosen[-1]}" if holds[0] else f"{symbol} = {chosen[0]} to {chosen[-1]}"


def told(holds, known):
    """Where something holds in the plane, in words: for each set of normal parameters the
    tangential ones with it."""
    kinds = {}
    for row, (values, there) in enumerate(zip(holds, known)):
        if values.any():
            kinds.setdefault(compressed("lambda_n", NORMAL, values, there), []).append(row)
    everywhere = np.full(len(TANGENTIAL), True)
    numbers = np.arange(len(TANGENTIAL))
    return (
        ", ".join(
            compressed("lambda_t", TANGENTIAL, np.isin(numbers, rows), everywhere) + f" with {kind}"
            for kind, rows in kinds.items()
        )
        or "no case"
    )


def missing(results):
    """A sentence on the cases that reached no onset."""
    without = []
    for residual in RESIDUALS:
        for tangential in TANGENTIAL:
            for normal in NORMAL:
                record = record_of(results, residual, normal, tangential)
                if record is None or onset(record) is None:
                    why = ("no points" if record is None else "comes off"
                           if record["event"][-1] == "pull_off" else "ended early")
                    without.append(f"{residual:g}, {normal:g}, {tangential:g}: {why}")
    return ("Every case reached an onset. " if not without
            else "Without an onset (residual friction, lambda_n, lambda_t): " + "; ".join(without)
            + ". ")


def level(residual):
    """The residual friction in words."""
    return f"tau_inf = {'' if residual == 1 else f'{residual:g} '}tau_max"


def says(results):
    """What the figure shows, with its numbers."""
    found = maps(results)
    front_off, known = np.abs(found["front"]), np.isfinite(found["fold"])
    text = f"{known.sum()} onsets at W = {FORCE:g} held. " + missing(results)
    for line, residual in enumerate(RESIDUALS):
        folds = found["fold"][line] == 1
        there = known[line]
        lost = found["share"][line] > 0.99
        text += (f"With {level(residual)} {folds.sum()} of {there.sum()} onsets are folds"
                 + ("" if folds.sum() == there.sum() else f" ({told(folds, there)})"))
        if residual == 1:
            text += (": the force falls with the area only, and the onset "
                     "is gradual where slip has taken that before "
                     f"({(there & ~folds & lost).sum()} cases) or takes it over "
                     "a slip too long for the drive's stiffness of "
                     f"{reference.drive_stiffness(PERIOD, HEIGHT):.4g} "
                     f"({(there & ~folds & ~lost).sum()})")
        text += (f". The force is {np.nanmin(found['force'][line]):.2f} to "
                 f"{np.nanmax(found['force'][line]):.2f} tau_max a_0; all the area "
                 "that slip takes is lost before (to 1 %) at "
                 f"{told(lost, there)}. ")
    return text + theory_told(results, found, np.abs(found["uniform"]),
                              front_off) + grid_told(results)


def stiff_told(off):
    """From which tangential parameter on the front's estimate is within 1 %, in words."""
    worst = [np.nanmax(off[row:]) for row in range(len(TANGENTIAL))]
    first = next((row for row, value in enumerate(worst) if value < 1), None)
    return ("" if first is None else f", and within {worst[first]:.1g} % for all "
            f"lambda_n from lambda_t = {TANGENTIAL[first]:g} on")


def theory_told(results, found, uniform_off, front_off):
    """Sentences on where the estimates hold."""
    text = ("Two estimates: uniform slip of a Maugis-Dugdale contact of "
            "the adhesion exp(-b^2), whose friction fades as exp(-gap) "
            "where tension opens the gap (where slip has not yet "
            "taken nine tenths of the area); and the slip front that "
            "leaves tau_inf behind in the sliding contact, or, where no "
            "work is left for a front (tau_inf = tau_max), the "
            "friction of that contact. ")
    for line, residual in enumerate(RESIDUALS):
        known, nearer = np.isfinite(found["fold"][line]), np.fmin(uniform_off, front_off)[line]
        neither = known & (nearer > WITHIN)
        equal = np.array([crossing(results, residual, normal) for normal in NORMAL])
        text += (f"For {level(residual)} uniform slip is within {WITHIN:g} % "
                 f"at {told(uniform_off[line] < WITHIN, known)}; the front at "
                 f"{told(front_off[line] < WITHIN, known)}{stiff_told(front_off[line])}; "
                 f"neither in {neither.sum()} cases")
        if neither.any():
            row, column = np.unravel_index(np.argmax(np.where(neither, nearer, -1)), neither.shape)
            text += (f", by up to {nearer[row, column]:.0f} % (lambda_n = "
                     f"{NORMAL[column]:g}, lambda_t = {TANGENTIAL[row]:g})")
        text += (f"; both are equal at lambda_t = {np.nanmin(equal):.2f} to "
                 f"{np.nanmax(equal):.2f}. " if np.isfinite(equal).any() else ". ")
    first = found["uniform"][0, 0]
    soft = [value for normal, value in zip(NORMAL, first) if normal < shortest_range()]
    begun = onset(results[name(RESIDUALS[0], NORMAL[-1], TANGENTIAL[0])])
    plain = 100 * (begun.force / reference.uniform_slip_onset(FORCE, TANGENTIAL[0], PERIOD)[1] - 1)
    return text + (f"Below lambda_n = {shortest_range():.1f} Maugis and Dugdale's "
                   f"contact is wider than JKR's by more than {WITHIN:g} "
                   f"%; there forces at lambda_t = {TANGENTIAL[0]:g} are "
                   f"{min(soft):+.0f} to {max(soft):+.0f} % from uniform slip "
                   f"({level(RESIDUALS[0])}). At lambda_n = {NORMAL[-1]:g} it "
                   f"is {first[-1]:+.1f} %, and {plain:+.1f} % from a JKR "
                   "contact whose friction does not fade. ")


def grid_told(results):
    """Sentence on the errors of the grid."""
    changes = [grid_change(results, run(*case)) for case in REFINED]
    places = ", ".join(f"({normal:g}, {tangential:g})" for _, normal, tangential in REFINED)
    return ("Twice the points change the force at the onset by at most "
            f"{max(change[0] for change in changes):.0e} of it, the area there "
            f"by {max(change[1] for change in changes):.0e} (at {places}, "
            f"{level(REFINED[0][0])}).")
