"""The force at which sliding begins against residual friction, from the table of a study.

    python figure.py TABLE.csv FIGURE.png
"""

import csv
import sys

from matplotlib.figure import Figure

ACROSS, CURVES = "scene_residual_friction", "scene_tangential_maugis"


def main(table, figure):
    """Draw the figure of a table; its curves: parameter -> [(friction, force), ...]."""
    with open(table, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    curves = {}
    for row in rows:
        curves.setdefault(float(row[CURVES]), []).append(
            (float(row[ACROSS]), float(row["tangential_force"])))
    axes = Figure(figsize=(4, 3), layout="constrained").subplots()
    for maugis, points in sorted(curves.items()):
        axes.plot(*zip(*sorted(points)), "o-", ms=3, label=f"{maugis:g}")
    axes.set(xlabel="residual friction", ylabel="force of the onset ($w_{t,r}$)")
    axes.legend(title="tangential Maugis parameter", fontsize="small", title_fontsize="small")
    axes.figure.savefig(figure, dpi=200)
    return curves


if __name__ == "__main__":
    main(*sys.argv[1:])
