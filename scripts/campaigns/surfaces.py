"""Random measured surfaces: maps in the kinds of files that are read, with holes, cropped, with
options that fit them and some that do not; what `info` tells of them against NumPy's numbers."""

import re

import h5py
import numpy as np

from . import judge

TOLD = re.compile(r"heights of .*: root mean square (\S+) u_n,r, from lowest to highest (\S+) ")
KINDS = ("csv", "semicolon.csv", "txt", "npy", "h5", "xyz")
STEP = 0.25
"""Distance of the nodes, beta."""


def create(seed, number, folder):
    """(options, values on the nodes that are used or None where they are not known, whether all
    is good) of a number, the same for a seed; the file is written."""
    draw = np.random.default_rng([seed, number, 2])
    shape = tuple(int(n) for n in 2 * draw.integers(10, 20, 2) + (draw.random() < 0.15))
    places = np.meshgrid(*map(np.arange, shape), indexing="ij")
    values = np.round(draw.normal(size=shape) + 0.1 * places[0] - 0.05 * places[1], 6)
    if draw.random() < 0.4:
        values[tuple(draw.integers(0, 8, (2, 5)))] = np.nan
    kind = draw.choice(KINDS)
    options = {"scene_geometry": "file", "scene_geometry_file": write(folder, kind, values)}
    good = True
    if draw.random() < 0.4:
        first, last = 2 * int(draw.integers(0, 3)), int(shape[1] - shape[1] % 2)
        options["scene_heights_crop"] = f"{first}:{first + 16},0:{last}"
        values = values[first:first + 16, :last]
    elif any(n % 2 for n in shape):
        good = False  # odd, and not fitted
    if kind != "xyz":
        options["scene_heights_size"] = f"{STEP * shape[0]},{STEP * shape[1]}"
    fill = draw.choice(("none", "mean", "nearest", "interpolate", "guess"), p=(3, 3, 1, 1, 1) /
                       np.float64(9))
    options["scene_heights_fill"] = str(fill)
    holes = np.isnan(values)
    good &= fill != "guess" and not (fill == "none" and holes.any())
    known = fill == "mean" or not holes.any()
    values = np.where(holes, np.nanmean(values), values)
    wrong = draw.choice(("", "period", "unit", "points", "edges"), p=(0.6, 0.1, 0.1, 0.1, 0.1))
    if wrong:
        options |= {"period": {"scene_heights_size": "9", "scene_period": "9"},
                    "unit": {"scene_heights_unit": "um"}, "points": {"scene_points": "64,64"},
                    "edges": {"scene_heights_edges": "round"}}[wrong]
        good = False
    return options, values if known else None, good


def write(folder, kind, values):
    """Write a map as a kind of file; its name as it is typed."""
    path = folder / f"map.{kind}"
    if kind == "npy":
        np.save(path, values)
    elif kind == "h5":
        with h5py.File(path, "w") as file:
            file["measured/z"] = values
        return f"{path}:measured/z"
    elif kind == "xyz":
        places = np.meshgrid(*(STEP * np.arange(n) for n in values.shape), indexing="ij")
        rows = np.array([*(place.ravel() for place in places), values.ravel()]).T
        np.savetxt(path, np.random.default_rng(0).permutation(rows), fmt="%.6f")
    else:
        text = "\n".join({"csv": ",", "semicolon.csv": ";", "txt": " "}[kind].join(
            f"{value:.6f}" for value in row) for row in values)
        path.write_text("a measured surface\n"
                        + (text.replace(".", ",") if kind[0] == "s" else text) + "\n",
                        encoding="utf-8")
    return str(path)


def judged(verdict, seed, number, worker, folder, seconds):
    """Take down where `info` takes a map that it should refuse, refuses one that is good, or tells
    other heights than it has."""
    options, values, good = create(seed, number, folder)
    words = ["info", *(word for name, value in options.items() for word in (f"-{name}", value))]
    done = worker.run(words, folder / "surface", seconds)
    verdict.runs += 1
    verdict.seconds += done.seconds
    said = f"{judge.command(words)}: status {done.status}: {done.reason}"
    if done.crashed or done.status < 0:
        verdict.add("crashed" if done.crashed else "time", "surface", said)
    elif done.status != (0 if good else 2):
        verdict.add("silent", "surface", said)
    elif good and values is not None:
        told = TOLD.search(done.out)
        if told is None or not np.allclose([float(number) for number in told.groups()],
                                           [np.std(values), np.ptp(values)], rtol=1e-3):
            verdict.add("silent", "surface", f"{said}: {told and told.groups()} in place of "
                        f"{np.std(values):.4g}, {np.ptp(values):.4g}")
