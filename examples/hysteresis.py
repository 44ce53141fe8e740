"""Loop of adhesive hysteresis: a cylinder comes near, jumps in, is pulled off and jumps out.

    python examples/hysteresis.py [FOLDER]      figure: hysteresis.png, in FOLDER or results/
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from contactsnes import Branch, Load, Scene, Steps

LOAD = Load(start="normal_displacement=-6", path="normal_displacement=1; normal_displacement=-6")


def main(folder="results", maugis=3.0, points=1024, step=0.05):
    """Draw the figure; the area of the loop, and the energy that its jumps have lost."""
    Path(folder).mkdir(exist_ok=True)
    scene = Scene(normal_maugis=maugis, points=points)
    branch = Branch(scene, LOAD, Steps(initial_step=step, largest_step=step))
    rows = [branch.observe(point) for point in branch]
    displacement, force, leg = (
        np.array([row[name] for row in rows])
        for name in ("normal_displacement", "normal_force", "leg"))
    # The loads do the work that the loop encloses; as it ends where it began, all of it is lost.
    area = np.sum((force[1:] + force[:-1]) / 2 * np.diff(displacement))
    axes = Figure(layout="constrained").subplots()
    axes.plot(displacement[leg < 2], force[leg < 2], label="approach")
    axes.plot(displacement[leg == 2], force[leg == 2], label="retraction")
    axes.set(xlabel="normal displacement ($u_{n,r}$)", ylabel="normal force ($w_{n,r}$)",
             title=f"energy lost: {area:.4g} $w_{{n,r}} u_{{n,r}}$")
    axes.legend()
    axes.figure.savefig(Path(folder, "hysteresis.png"))
    return area, rows[-1]["dissipated_work"]


if __name__ == "__main__":
    print(__doc__) if {"-h", "--help"} & {*sys.argv} else main(*sys.argv[1:])
