"""The pages that show figures and statements: scripts/paper/README.md, and the gallery in the README."""

import numpy as np

from contactsnes.tables import markdown, write_between

import cost
from runs import ROOT
from statements import table

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


def symbols(text):
    """Greek letters and the like of a text in Markdown."""
    for plain, shown in (("lambda_t", "λ_t"), ("lambda_n", "λ_n"), ("tau_", "τ_"), ("delta_", "δ_"), ("phi_", "φ_"), ("beta", "β"),
                         (" +- ", " ± "), ("<~", "≲"), ("_max", "<sub>max</sub>"), ("_inf", "<sub>∞</sub>"), ("_fit", "<sub>fit</sub>"),
                         ("_r", "<sub>r</sub>"), ("_n", "<sub>n</sub>"), ("_t", "<sub>t</sub>"), ("|", "\\|")):
        text = text.replace(plain, shown)
    return text


def statement_table(results):
    """Lines of the table of statements."""
    rows = [[str(number), *map(symbols, row)] for number, row in enumerate(table(results), start=1)]
    return markdown(["", "where", "the paper says", "measured as", "found", "verdict"], rows)


def errors(results, runs):
    """A line on convergence, stability and the errors of the grid of all points."""
    residual, unstable, points, worst, ends = 0.0, 0, 0, {"contact_area": 0.0, "normal_force": 0.0, "slip": 0.0}, []
    for run in runs:
        if run.name not in results or run.name.startswith("sample"):
            continue
        record = results[run.name]
        points += record.points
        residual = max(residual, record["residual_norm"].max())
        unstable += int(np.sum((record["stable"] == 0) & (record["event"] != "fold"))) if "stable" in record else record.points
        for name in worst:
            if f"error_{name}" in record:
                worst[name] = max(worst[name], np.nanmax(record[f"error_{name}"]))
        if not record.complete:
            ends.append(run.name)
    text = (f"All {points} points have a residual norm of at most {residual:.0e} ranges of the law. {points - unstable} of them are certified "
            f"stable or are folds, {unstable} are not. Grid errors, by a finer grid at every point of the runs up to a tangential parameter "
            f"of 1: at most {worst['contact_area']:.0e} of the area, {worst['normal_force']:.0e} of the force, {worst['slip']:.0e} of the "
            "mean slip, all far below the width of a line.")
    return [text + (f" Runs that ended before their end: {', '.join(ends)}." if ends else "")]


def write(results, runs):
    """Write both pages."""
    images = [f"![{caption}]({name}.png)\n\n{caption}." for name, caption in CAPTIONS.items() if (HERE / f"{name}.png").is_file()]
    (HERE / "README.md").write_text("\n".join([
        "# The paper, figure by figure", "",
        "Written by `scripts/reproduce`. Lengths are in β, tangential forces in w_t,r, normal ones in w_n,r; W is the normal force.", "",
        "## Statements", "", *statement_table(results), "", "## Convergence and cost", "", *errors(results, runs), "",
        *cost.report(results, runs), "", "## Figures", "", "\n\n".join(images), ""]), encoding="utf-8")
    shown = ("figure4", "figure5", "figure6", "figure7")
    gallery = [f'<img src="scripts/paper/{name}.png" width="48%" alt="{CAPTIONS[name]}">' for name in shown]
    write_between(ROOT / "README.md", BEGIN, END, "\n".join([*gallery, "", *cost.report(results, runs), ""]))
