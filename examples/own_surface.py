"""A surface of one's own: heights made in NumPy, with bumps of different heights, are pressed.

    python examples/own_surface.py [FOLDER]      figure: own_surface.png, in FOLDER or results/
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from contactsnes import Branch, Load, Scene


def main(folder="results", points=1024, cell=60.0):
    """Draw the figure; contact areas, and how many spots each point has."""
    x = (np.arange(points) - points // 2) * cell / points
    heights = 2.0 * np.cos(6 * np.pi * x / cell) + np.cos(2 * np.pi * x / cell)
    Path(folder).mkdir(exist_ok=True)
    np.save(file := f"{folder}/bumps.npy", heights)
    scene = Scene(geometry="file", geometry_file=file, points=points, period=cell, normal_maugis=2)
    branch = Branch(scene, Load(start="normal_displacement=-2", path="normal_displacement=1"))
    (above, below) = Figure(layout="constrained").subplots(2)
    areas, spots = [], []
    for point in branch:
        areas.append(branch.observe(point)["contact_area"])
        gap = branch.contact.extended(point.state)[0] + branch.contact.initial_gap
        touching = gap < scene.contact_threshold  # gaps are in ranges of the law here
        spots.append(int(np.sum(touching & ~np.roll(touching, 1))))
        below.plot(point.forces[0], areas[-1], "o", color=f"C{spots[-1]}")
    above.plot(x, gap / scene.ranges[0])
    above.set(xlabel=r"$x$ ($\beta$)", ylabel="gap ($u_{n,r}$)")
    below.set(xlabel="normal force ($w_{n,r}$)", ylabel=r"contact area ($\beta$)")
    above.figure.savefig(Path(folder, "own_surface.png"))
    return areas, spots


if __name__ == "__main__":
    print(__doc__) if {"-h", "--help"} & {*sys.argv} else main(*sys.argv[1:])
