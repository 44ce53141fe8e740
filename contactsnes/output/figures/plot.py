"""The figures of an archive, those that make sense for what it holds.

- ``RUN-shear.png``: tangential force and contact area against tangential displacement
- ``RUN-area.png``: contact area against tangential force
- ``RUN-approach.png``: normal force against normal displacement, unsheared if it stays put
  under shear
- ``RUN-profiles.png``: gap and tractions around the contact at chosen points (in two dimensions
  along y = 0)
- ``RUN-shape.png``: half axes of the contact (on a line edges and fronts of slip), and what sticks
  and slips, against the load that moves
- ``RUN-outlines.png``: where the contact ends at chosen points, over each other
- ``RUN-maps.png``: gap, pressure and tangential traction over a two-dimensional interface at up
  to three points

The shear's figures begin where the tangential load begins.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import matplotlib

from ..files import ArchiveError
from ..prefixes import read
from .data import NothingToShow, choose_points
from .loads import draw_approach, draw_area, draw_shear
from .maps import draw_maps
from .profiles import draw_profiles
from .shape import draw_outlines, draw_shape
from .style import STYLE


class Figures(NamedTuple):
    """Files that were written, and the figures that were not, with the reason."""

    files: list[Path]
    skipped: dict[str, str]


def plot(path, output=None, pdf=False, points=None):
    """Draw the figures that an archive has data for.

    Parameters
    ----------
    path : path of the archive
    output : folder of the figures; by default that of the archive
    pdf : bool, whether to write each figure as PDF, too
    points : list of int, points of profiles and maps, counted from 0 or, if negative, from the end;
        by default the first and the last of the shear, events, and some between them

    Returns
    -------
    Figures

    Raises
    ------
    ArchiveError
        If there is no archive, no point, no field of a chosen point, or no such folder.
    """
    record = read(path)
    folder = Path(path).parent if output is None else Path(output)
    if not record.points:
        raise ArchiveError(f"{path} has no points to plot yet.")
    if not folder.is_dir():
        raise ArchiveError(
            f"The folder of the figures, {folder}, does not exist: create it or name another.")
    chosen = choose_points(record, points)
    figures = Figures([], {})
    with matplotlib.rc_context(STYLE):
        for name, draw in _kinds(chosen).items():
            try:
                figure = draw(record)
            except NothingToShow as reason:
                figures.skipped[name] = str(reason)
                continue
            for suffix in (".png", ".pdf") if pdf else (".png",):
                figures.files.append(folder / f"{Path(path).stem}-{name}{suffix}")
                figure.savefig(figures.files[-1])
    return figures


def _kinds(chosen):
    """Name -> function of a record that draws a figure, or raises NothingToShow."""
    return {"shear": draw_shear, "area": draw_area, "approach": draw_approach,
            "shape": draw_shape, "outlines": lambda record: draw_outlines(record, chosen),
            "profiles": lambda record: draw_profiles(record, chosen),
            "maps": lambda record: draw_maps(record, chosen)}
