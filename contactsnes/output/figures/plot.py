"""The figures of an archive, those that make sense for what it holds, and of several together.

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
- ``RUN-spots.png``: numbered spots of a two-dimensional contact, and how many there are of each
  size
- ``RUN-columns.png``: columns that are asked for

The shear's figures begin where the tangential load begins.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import matplotlib

from ...options.arguments import several
from ...options.fields import InputError
from ..asked import FORMATS, PlotOptions, listed
from ..files import ArchiveError, refuse_shared, wanting
from ..prefixes import alike, read
from ..reading import NoColumn, Record
from .curves import draw_columns, together
from .data import NothingToShow, choose_points
from .loads import draw_approach, draw_area, draw_shear
from .maps import draw_maps
from .measured import check_names, check_used, read_measured
from .parts import break_labels
from .profiles import draw_profiles
from .shape import draw_outlines, draw_shape
from .spots import draw_spots
from .style import saved, settings, sized


class Figures(NamedTuple):
    """Files that were written, and the figures that were not, with the reason."""

    files: list[Path]
    skipped: dict[str, str]


def plot(path, output=None, pdf=False, points=None, **options):
    """Draw the figures that archives have data for.

    Parameters
    ----------
    path : path of the archive, or a Record, or a list of them, whose curves then stand in common
        figures
    output : folder of the figures; by default that of the (first) archive
    pdf : bool, whether to write each figure as PDF, too
    points : list of int, points of profiles and maps, counted from 0 or, if negative, from the end;
        by default the first and the last of the shear, events, and some between them
    options : more of ``-plot_*`` by name: format, size (cm), style, columns, together (the name of
        common figures), measured (CSV files)

    Returns
    -------
    Figures

    Raises
    ------
    ArchiveError
        If there is no archive, no point, no field of a chosen point, or no such folder.
    InputError
        If an option is not allowed, or does not fit the archives.
    """
    joint = isinstance(path, (list, tuple))
    paths = [one.path if isinstance(one, Record) else one for one in (path if joint else [path])]
    if not paths:
        raise InputError("there is no archive to plot: give the path of one, or a list of them")
    if points is not None:
        points = several("points", points, "a list of whole numbers, from 0 or from the end")
    asked = PlotOptions(**_by_name(options),
                        points=",".join(map(str, points or ())),
                        output="" if output is None else str(output))
    if pdf:
        asked = replace(asked, format=f"{asked.format},pdf")
    if joint and not asked.together:
        asked = replace(asked, together="together")
    return next(iter(list(draw(paths, asked))))


def _by_name(options):
    """Options of `plot` as those of ``PlotOptions``: several columns as a text."""
    found = {"with_" if name == "measured" else name: value for name, value in options.items()}
    if isinstance(found.get("columns"), (list, tuple)):
        found["columns"] = ",".join(map(str, found["columns"]))
    return found


def draw(paths, asked):
    """Draw the figures that options ask for; yield `Figures` of each archive, or those of all
    together.

    Parameters
    ----------
    paths : list of paths of archives
    asked : PlotOptions
    """
    measured, columns, records = read_measured(asked.with_), listed(asked.columns), []
    _check_together(asked.together)
    if not asked.together:
        refuse_shared(paths, asked.output, "figures", "draw them one by one into folders of their "
                      "own, or by -plot_together in common ones")
    for some in [paths] if asked.together else [[path] for path in paths]:
        records += (group := [_read(path) for path in some])
        check_names(measured, group)
        folder = _folder(group[0].path, asked.output)
        if asked.together:
            alike(group)
            kinds, stem = together(group, measured), asked.together
        else:
            kinds, stem = _kinds(group[0], asked.chosen, measured), group[0].path.stem
        if columns:
            # first, so that nothing is written where they cannot be drawn
            kinds = {"columns": partial(draw_columns, group, columns, measured), **kinds}
        yield _drawn(kinds, folder / stem, asked)
    check_used(measured, records)


def _check_together(name):
    """InputError for what is no beginning of the names of common figures."""
    if name and (Path(name).name != name or name == ".."):
        raise InputError(f"-plot_together is '{name}': give the beginning of the names of the "
                         "figures, and their folder by -plot_output")
    if Path(name).suffix[1:].lower() in FORMATS:
        raise InputError(f"-plot_together is '{name}': give the beginning of the names of the "
                         "figures, whose ending -plot_format says")


def _read(path):
    """An archive for figures; ArchiveError for one without points."""
    record = read(path)
    if not record.points:
        raise ArchiveError(f"{path} has no points to plot yet.")
    return record


def _folder(path, output):
    """The folder of the figures; ArchiveError where there is none."""
    folder = Path(output) if output else path.parent
    if not folder.is_dir():
        raise ArchiveError(
            f"The folder of the figures, {folder}, {wanting(folder)} or name another.")
    return folder


def _drawn(kinds, stem, asked):
    """Draw figures, name -> function (), and write them: `Figures`."""
    figures = Figures([], {})
    with matplotlib.rc_context(settings(asked.style)):
        for name, make in kinds.items():
            try:
                figure = sized(make(), asked.size)
            except (NothingToShow, NoColumn) as reason:
                figures.skipped[name] = reason.args[0]
                continue
            for suffix in asked.formats:
                figures.files.append(stem.with_name(f"{stem.name}-{name}{suffix}"))
                _save(figure, figures.files[-1], low=isinstance(asked.size, tuple))
    return figures


def _save(figure, path, low):
    """Write a figure, whose panels may be low; InputError where there is no room for what stands in
    it."""
    with warnings.catch_warnings():
        warnings.filterwarnings("error", "constrained_layout not applied")
        try:
            if low:
                break_labels(figure)
            saved(figure, path)
        except UserWarning:
            width, height = 2.54 * figure.get_size_inches()
            raise InputError(f"-plot_size is too small for {path}, {width:.3g} x {height:.3g} cm: "
                             "give more, or width and height with a comma") from None


def _kinds(record, points, measured):
    """Name -> function () that draws a figure of an archive, or raises NothingToShow."""
    chosen = choose_points(record, points)
    return {"shear": lambda: draw_shear(record, measured),
            "area": lambda: draw_area(record, measured),
            "approach": lambda: draw_approach(record, measured),
            "shape": lambda: draw_shape(record),
            "outlines": lambda: draw_outlines(record, chosen),
            "profiles": lambda: draw_profiles(record, chosen),
            "maps": lambda: draw_maps(record, chosen),
            "spots": lambda: draw_spots(record, points)}
