"""The pages that show figures and statements: scripts/paper/README.md, and the gallery in docs."""

from functools import partial

import cell
import cost
import early
import numpy as np
import onsets
import poisson
import prose
import regimes
import remnant
import rough
import sinusoid
import statements  # noqa: F401  makes the statements of the table
import statements_more  # noqa: F401
import statements_residual  # noqa: F401
import statements_theory  # noqa: F401
from errors import figure_table
from runs import ROOT, Finer
from statement import ALL, evaluated, in_order, row

from contactsnes.output.tables import markdown, write_between

HERE = ROOT / "scripts" / "paper"
GALLERY = ROOT / "docs" / "gallery.md"
PAGE = ROOT / "docs" / "incipient-sliding.md"
MARKS = ("<!-- scripts/paper writes from here -->\n", "<!-- scripts/paper: as far as here -->\n")
BEGIN, END = "<!-- scripts/reproduce writes from here -->\n", "<!-- as far as here -->\n"
UNITS = (
    "Written by `scripts/reproduce`. Lengths are in β, tangential forces in w_t,r, normal "
    "ones in w_n,r; W is the normal force.")
ERROR_BARS = (
    "Each number is told with its error bar: the change on a grid of twice the points, the "
    "step of the load in which an event lies, or the confidence interval of a fit, whichever "
    "is largest; numbers without one are exact, and ± ? stands where it is not known: there "
    "is no run on a finer grid, or none that differs. ρ = τ<sub>∞</sub>/τ<sub>max</sub>.")
MOVEMENTS = (
    "Errors of the grid: the runs of these figures are made again on twice the points, but for "
    "those of residual frictions beside τ<sub>max</sub> and half of it, whose onsets have their "
    "own errors in the map below; each figure is drawn from these, too, and both drawings are "
    "compared.")
CAPTIONS = {
    "figure2": "Figure 2: the traction-separation laws",
    "figure3": "Figure 3: contact area for several thresholds",
    "figure4": "Figure 4: contact area and pressure under a normal load",
    "figure5": "Figure 5: shear, half residual friction (thin: full)",
    "figure5-full": "Figure 5 with full residual friction (thin: half)",
    "figure5-long": "Figure 5 over the whole range of displacements",
    "figure6": "Figure 6: area against tangential force",
    "figure7": "Figure 7: area against tangential force, onsets of sliding",
}
BESIDE = {"figure2": "Curves and line styles are the paper's; eqs. 3b and "
          "5b are corrected (statements 1 and 2). For eq. 5 the "
          "two curves of the tangential traction without an open gap "
          "coincide.", "figure3": "(a) is drawn as the distance from JKR's "
          "width. The paper's widths converge for large thresholds, "
          "these go on to grow. The least threshold, whose contact "
          "is the overlap alone, loses contact before pull-off.",
          "figure4": "Maugis and Dugdale's theory and the inset in (b) are "
          "added; both theories are those of the periodic cell. Curves "
          "end at the fold under a prescribed displacement.",
          "figure5": "Contacts are those of the forces 25 and 0.8, not "
          "of the approaches 40 and 2, which have other forces in "
          "the cell as the paper describes it. Sliding begins for "
          "lambda_t = 10 far beyond the range in which the others' "
          "does, not early: the drawing over the whole range shows "
          "it. Marks in (a) have the colours of the profiles.",
          "figure5-full": "The paper has both residual frictions in its laws, "
          "and profiles for one; this is the other one. Without a "
          "drop of friction sliding begins gradually unless adhesion is "
          "lost at once.", "figure5-long": "The same runs, axes logarithmic.",
          "figure6": "(a, b) are the paper's, with tau_inf = tau_max; onsets, theory and the rest "
          "are added. Power laws are fitted where up to a quarter of what is lost is lost: the "
          "paper does not tell its window.",
          "figure7": "The paper shows the first row. Lines and onsets are those of all loads, "
          "curves of six. Crosses are an estimate that the paper does not have.",}
"""Name of a figure -> in what it differs from the paper's, and why."""
BEYOND = {module.__name__: module for module in (regimes, early, remnant, poisson, cell, sinusoid,
                                                 rough, onsets)}
"""Name -> module of each figure beyond the paper's, in the order of the page: its runs NEEDED,
draw, CAPTION and says."""


def runs_beyond():
    """The runs of the figures beyond the paper's."""
    return [run for module in BEYOND.values() for run in module.NEEDED]


def symbols(text):
    """Greek letters and the like of a text in Markdown."""
    for plain, shown in (("lambda_t", "λ_t"), ("lambda_n", "λ_n"), ("tau_", "τ_"),
                         ("rho", "ρ"), ("alpha", "α"), ("delta_", "δ_"), ("phi_", "φ_"),
                         ("beta", "β"), ("nu = ", "ν = "), (" +- ", " ± "), ("<~", "≲"),
                         ("_max", "<sub>max</sub>"), ("_inf", "<sub>∞</sub>"),
                         ("_fit", "<sub>fit</sub>"), ("_r", "<sub>r</sub>"), ("_n", "<sub>n</sub>"),
                         ("_t", "<sub>t</sub>"), ("|", "\\|")):
        text = text.replace(plain, shown)
    return text


def statement_table(found):
    """Lines of the table of statements."""
    rows = [[str(number), *map(symbols, one)] for number, one in enumerate(found, start=1)]
    return markdown(["", "where", "the paper says", "measured as", "found", "verdict"], rows)


BESIDE_FOLD = 1e-6
"""Part of a fold's displacement, within which a point shares the fold's neutral mode."""


def kinds(record):
    """What certificates say of each point: stable, fold, unstable, beside a fold, whose neutral
    mode it has, or unknown."""
    moved, folds = record["tangential_displacement"], record["event"] == "fold"
    beside = np.any(np.abs(moved[:, None] - moved[folds]) <= BESIDE_FOLD * np.abs(moved[folds]),
                    axis=1)
    return np.select([folds, record["stable"] == 1, record["unstable_modes"] > 0, beside],
                     ["fold", "stable", "unstable", "beside"], "unknown")


def convergence(results, runs):
    """Lines on the convergence and stability of all points."""
    residual, traced, ends, astray = 0.0, 0, [], []
    count = dict.fromkeys(("stable", "fold", "unstable", "beside", "unknown"), 0)
    for run in runs:
        if run.name not in results or run.options.get("continuation_stability", "off") == "off":
            continue
        record = results[run.name]
        residual, found = max(residual, record["residual_norm"].max()), kinds(record)
        for name in count:
            count[name] += int(np.sum(found == name))
        if run.options.get("continuation_at_fold") == "trace":
            traced += int(np.sum(found == "unstable"))
        else:
            places = record["tangential_displacement"][found == "unstable"]
            astray += [f"{places.size} of {run.name} between {places.min():.6g} "
                       f"and {places.max():.6g}"] if places.size else []
        if not record.complete:
            ends.append(f"{run.name} ({results.reason(run.name)})")
    astray += [f"{traced} between folds of branches that are traced"] * (traced > 0)
    return [f"Of {sum(count.values())} points, all with a residual norm of "
            f"at most {residual:.0e} ranges of the law, {count['stable']} "
            f"are certified stable, {count['fold']} are folds, {count['beside']} lie within "
            f"{BESIDE_FOLD:.0e} of a fold's displacement and share its neutral mode (as where "
            f"gross sliding begins at the fold itself), {count['unstable']} have an unstable mode"
            + (f" ({'; '.join(astray)})" if astray else "")
            + f", and {count['unknown']} have a mode that is neutral or was not found."
            + (f" Runs that ended before their end: {'; '.join(ends)}." if ends else "")]


def beyond_figures(told):
    """Lines of the figures beyond the paper's: image, and what it shows, of ``told``, name ->
    (text, None) or (None, what is missing)."""
    lines = []
    for name, module in BEYOND.items():
        text, missing = told[name]
        lines += [f"### {module.CAPTION}", "", f"![{module.CAPTION}]({name}.png)", "",
                  symbols(text or f"Not told: {missing}."), ""]
    return lines


def fixed(runs):
    """Names of runs, and of those beyond the paper, that are not made again on finer grids."""
    return {run.name for run in [*runs, *runs_beyond()] if not run.finer}


def pieces(results, runs):
    """Name -> function without arguments of what the pages tell, each by itself; ``runs`` are those
    of the paper's figures."""
    finer = Finer(results, fixed(runs))
    everything = {run.name: run for run in [*runs, *runs_beyond()]}.values()
    return {**{name: partial(evaluated, module.says, results) for name, module in BEYOND.items()},
            "tables": partial(evaluated, regimes.onset_tables, results),
            **{number: partial(row, one, results, finer) for number, one in enumerate(in_order())},
            "wrong": partial(prose.wrong, results),
            "convergence": partial(convergence, results, everything),
            "cost": partial(cost.report, results, runs)}


def write(told, movements):
    """Write both pages; ``told`` are the values of `pieces`, ``movements`` how far the paper's
    figures move on finer grids (`errors.movement`)."""
    images = [f"![{caption}]({name}.png)\n\n{caption}. {symbols(BESIDE[name])}"
              for name, caption in CAPTIONS.items() if (HERE / f"{name}.png").is_file()]
    (HERE / "README.md").write_text("\n".join([
        "# The paper, figure by figure", "", UNITS, "", "## Statements", "", ERROR_BARS, "",
        *statement_table([told[number] for number in range(len(ALL))]), "",
        "## Convergence, errors and cost", "", *told["convergence"], "", MOVEMENTS, "",
        *figure_table(movements), "", *told["cost"], "", "## Figures", "",
        "\n\n".join(images), "", "## Beyond the figures", "", *beyond_figures(told)]),
        encoding="utf-8")
    shown = ("figure4", "figure5", "figure6", "figure7")
    gallery = [f'<img src="../scripts/paper/{name}.png" width="48%" alt="{CAPTIONS[name]}">'
               for name in shown]
    gallery += [f'<img src="../scripts/paper/{name}.png" width="32%" alt="{module.CAPTION}">'
                for name, module in BEYOND.items()]
    write_between(GALLERY, BEGIN, END, "\n".join([*gallery, "", *told["cost"], ""]))
    lines, missing = told["tables"]
    write_between(PAGE, *MARKS, "\n".join([*(lines or [f"Not told: {missing}."]), ""]))
