"""Error bars: each point of a branch on a coarse grid with an estimate of its error.

    python examples/error_bars.py [FOLDER]      figure: error_bars.png, in FOLDER or results/
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from contactsnes import Branch, Load, Scene
from contactsnes.branch.accuracy import Estimator

LOAD = Load(path="; ".join(f"normal_displacement={end}" for end in range(1, 9)))


def pressed(points, maugis):
    """Displacement, force and estimated error of the force at the ends of legs on a grid."""
    branch = Branch(Scene(normal_maugis=maugis, points=points), LOAD)
    estimate, ends = Estimator(branch.contact), {point.leg: point for point in branch}
    rows = [(*end.displacements, *end.forces, estimate(end).normal_force) for end in ends.values()]
    return np.transpose(rows)


def main(folder="results", points=640, maugis=3.0):
    """Draw the figure; estimated errors and those against a grid eight times finer."""
    Path(folder).mkdir(exist_ok=True)
    (displacement, force, error), fine = pressed(points, maugis), pressed(8 * points, maugis)[1]
    scale = np.maximum(1.0, np.abs(force))  # errors are relative to the value, or to one
    axes = Figure(layout="constrained").subplots()
    axes.errorbar(displacement, (force - fine) / scale, error, fmt="o", capsize=3)
    axes.set(xlabel="normal displacement ($u_{n,r}$)", ylabel="relative error of the normal force")
    axes.figure.savefig(Path(folder, "error_bars.png"))
    return error, np.abs(force - fine) / scale


if __name__ == "__main__":
    print(__doc__) if {"-h", "--help"} & {*sys.argv} else main(*sys.argv[1:])
