"""The pages that show figures and statements: scripts/paper/README.md, and the gallery in the README."""

import numpy as np

from contactsnes.tables import markdown, write_between

import cost
import poisson
import remnant
from observed import onset
from runs import ROOT
from statements import area_at, table

HERE = ROOT / "scripts" / "paper"
BEGIN, END = "<!-- scripts/reproduce writes from here -->\n", "<!-- as far as here -->\n"
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
BEYOND = {module.__name__: module for module in (remnant, poisson)}
"""Name -> module of each figure beyond the paper's, in the order of the page: its runs NEEDED, draw, CAPTION and says."""


def runs_beyond():
    """The runs of the figures beyond the paper's."""
    return [run for module in BEYOND.values() for run in module.NEEDED]


def symbols(text):
    """Greek letters and the like of a text in Markdown."""
    for plain, shown in (("lambda_t", "λ_t"), ("lambda_n", "λ_n"), ("tau_", "τ_"), ("delta_", "δ_"), ("phi_", "φ_"), ("beta", "β"), ("nu = ", "ν = "),
                         (" +- ", " ± "), ("<~", "≲"), ("_max", "<sub>max</sub>"), ("_inf", "<sub>∞</sub>"), ("_fit", "<sub>fit</sub>"),
                         ("_r", "<sub>r</sub>"), ("_n", "<sub>n</sub>"), ("_t", "<sub>t</sub>"), ("|", "\\|")):
        text = text.replace(plain, shown)
    return text


def statement_table(results):
    """Lines of the table of statements."""
    rows = [[str(number), *map(symbols, row)] for number, row in enumerate(table(results), start=1)]
    return markdown(["", "where", "the paper says", "measured as", "found", "verdict"], rows)


def errors(results, runs):
    """Lines on convergence, stability and the errors of the grid of all points."""
    residual, count, worst, ends, astray = 0.0, {"stable": 0, "fold": 0, "unstable": 0, "unchecked": 0}, {}, [], []
    for run in runs:
        if run.name not in results or run.name.startswith("sample"):
            continue
        record = results[run.name]
        residual = max(residual, record["residual_norm"].max())
        folds = record["event"] == "fold"
        count["fold"] += int(folds.sum())
        for name, value in (("stable", 1), ("unstable", 0), ("unchecked", -1)):
            count[name] += int(np.sum((record["stable"] == value) & ~folds))
        astray += [f"{run.name} at {record['tangential_displacement'][point]:.4g}"
                   for point in np.flatnonzero((record["stable"] == 0) & ~folds)]
        for name in ("contact_area", "normal_force", "slip"):
            if f"error_{name}" in record:
                worst[name] = max(worst.get(name, 0.0), np.nanmax(record[f"error_{name}"]))
        if not record.complete:
            ends.append(run.name)
    told = ", ".join(f"{value:.0e} of the {name.replace('_', ' ')}" for name, value in worst.items())
    lines = [f"Of {sum(count.values())} points, all with a residual norm of at most {residual:.0e} ranges of the law, {count['stable']} are "
             f"certified stable, {count['fold']} are folds, {count['unstable']} have an unstable mode ({'; '.join(dict.fromkeys(astray))}), and {count['unchecked']} were not "
             "checked (eq. 3 and compliant interfaces with half the residual friction, whose modes lie too close together; coarse grids)."
             + (f" Runs that ended before their end: {', '.join(ends)}." if ends else ""),
             "", f"Errors of the grid, from a finer one at every point of figure 4 and of figure 5 up to a tangential parameter of 1: at most {told}."]
    if {"half-t10-w25", "half-t10-w25-p16384"} <= {run.name for run in runs if run.name in results}:
        pair = [results[name] for name in ("half-t10-w25", "half-t10-w25-p16384")]
        begun = [onset(record) for record in pair]
        forces = np.linspace(0.0, 0.9 * min(one.force for one in begun if one), 200)
        areas = [np.array([area_at(record, force) for force in forces]) for record in pair]
        lines[-1] += (f" For a parameter of 10, 2^15 and 2^14 points differ by at most {np.max(np.abs(areas[0] / areas[1] - 1)):.0e} in the area "
                      f"at a given force (interpolated between points), and by {abs(begun[0].force / begun[1].force - 1):.0e} in the onset.")
    return lines


def beyond_figures(results):
    """Lines of the figures beyond the paper's: image, and what it shows."""
    lines = []
    for name, module in BEYOND.items():
        lines += [f"### {module.CAPTION}", "", f"![{module.CAPTION}]({name}.png)", "", symbols(module.says(results)), ""]
    return lines


def write(results, runs):
    """Write both pages; ``runs`` are those of the paper's figures."""
    images = [f"![{caption}]({name}.png)\n\n{caption}." for name, caption in CAPTIONS.items() if (HERE / f"{name}.png").is_file()]
    (HERE / "README.md").write_text("\n".join([
        "# The paper, figure by figure", "",
        "Written by `scripts/reproduce`. Lengths are in β, tangential forces in w_t,r, normal ones in w_n,r; W is the normal force.", "",
        "## Statements", "", *statement_table(results), "", "## Convergence and cost", "", *errors(results, [*runs, *runs_beyond()]), "",
        *cost.report(results, runs), "", "## Figures", "", "\n\n".join(images), "", "## Beyond the figures", "",
        *beyond_figures(results)]), encoding="utf-8")
    shown = ("figure4", "figure5", "figure6", "figure7")
    gallery = [f'<img src="scripts/paper/{name}.png" width="48%" alt="{CAPTIONS[name]}">' for name in shown]
    write_between(ROOT / "README.md", BEGIN, END, "\n".join([*gallery, "", *cost.report(results, runs), ""]))
