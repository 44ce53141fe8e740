"""Continuation by hand: points of a branch are taken one by one, until a rule of one's own ends it.

    python examples/by_hand.py [FOLDER]      figure: by_hand.png, in FOLDER or results/

A cylinder under a constant force is sheared until slip has taken a given part of its contact area.
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

from contactsnes import Branch, Load, Scene


def main(folder="results", lost=0.05, points=1024):
    """Draw the figure; (tangential force, contact area) of the sheared points, the last beyond."""
    Path(folder).mkdir(exist_ok=True)
    scene = Scene(normal_maugis=3.0, residual_friction=0.5, points=points, period=60.0)
    branch = Branch(scene, Load(path="normal_force=5; tangential_displacement=800"))
    found = []
    for point in branch:  # nothing further is computed before it is asked for
        numbers = branch.observe(point)
        if point.leg < 2:  # the leg that shears
            whole = numbers["contact_area"]
        else:
            found.append((numbers["tangential_force"], numbers["contact_area"]))
            if found[-1][1] <= (1.0 - lost) * whole:
                break
    axes = Figure(layout="constrained").subplots()
    axes.plot(*zip((0.0, whole), *found), "o-")
    axes.axhline((1.0 - lost) * whole, ls=":")
    axes.set(xlabel="tangential force ($w_{t,r}$)", ylabel=r"contact area ($\beta$)")
    axes.figure.savefig(Path(folder, "by_hand.png"))
    return whole, found


if __name__ == "__main__":
    print(__doc__) if {"-h", "--help"} & {*sys.argv} else main(*sys.argv[1:])
