"""Pull-off force of a cylinder against the normal Maugis parameter, beside two theories.

    python examples/sweep.py [FOLDER]      figure: sweep.png, in FOLDER or results/
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

from contactsnes import Branch, Load, Scene, Steps, reference

PERIOD = 100.0  # of the cell


def pull_off(maugis):
    """The force at which a cylinder lets go: the fold of a branch along which the force falls."""
    points = 2 * max(128, round(0.6 * PERIOD * maugis ** 2))  # resolves the cohesive zone
    scene = Scene(normal_maugis=maugis, points=points, period=PERIOD)
    *_, last = Branch(scene, Load(path="normal_force=-3"), Steps(at_fold="stop"))
    return last.forces[0]


def main(folder="results", values=(0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0)):
    """Draw the figure; forces found and those of Maugis and Dugdale's theory."""
    Path(folder).mkdir(exist_ok=True)
    found = [pull_off(value) for value in values]
    theory = [reference.maugis_line_pull_off(value, PERIOD)[0] for value in values]
    axes = Figure(layout="constrained").subplots()
    axes.plot(values, found, "o", values, theory, "-")
    axes.axhline(reference.jkr_line_pull_off(PERIOD)[-1], ls=":")
    axes.set(xlabel="normal Maugis parameter", ylabel="pull-off force ($w_{n,r}$)")
    axes.legend(["computed", "Maugis and Dugdale", "Johnson, Kendall and Roberts"])
    axes.figure.savefig(Path(folder, "sweep.png"))
    return found, theory


if __name__ == "__main__":
    print(__doc__) if {"-h", "--help"} & {*sys.argv} else main(*sys.argv[1:])
