"""Figures of any columns against each other: of one archive, or of several together."""

import os
from itertools import count
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...options.fields import InputError
from ...system.streams import legible
from ..columns import instead
from ..prefixes import check_units
from .data import NothingToShow, shear, unsheared, varies
from .measured import draw_measured
from .parts import draw_branch, event_handles, place_legend
from .style import GREY, WIDTH

COLOURS = 7
"""Colours of the style's cycle; further curves are dashed."""


def labels(records):
    """What tells archives apart in a legend: their names, where these are the same with as many of
    their folders as tell them apart."""
    paths = [Path(os.path.abspath(record.path)) for record in records]
    names = [(*path.parent.parts[1:], path.stem) for path in paths]
    return [legible("/".join(own[-_depth(own, set(names) - {own}):])) for own in names]


def _depth(own, others):
    """How many of the last parts of a path no other path ends with."""
    return next(depth for depth in count(1)
                if all(other[-depth:] != own[-depth:] for other in others))


def draw_columns(records, columns, measured=(), part_of=lambda record: slice(0, None)):
    """Figure of columns of archives: the first along x, each of the others in a panel.

    Parameters
    ----------
    records : list of Readable, in the same units
    columns : list of str, two at least
    measured : list of Measured
    part_of : function (Readable) -> slice, the points that are shown
    """
    _check(records, columns)
    check_units(records, columns)
    x, *others = columns
    figure = Figure((WIDTH, (0.3 + 0.5 * len(others)) * WIDTH), layout="constrained")
    stack = figure.subplots(len(others), 1, sharex=True, squeeze=False)[:, 0]
    points = []
    for axes, y in zip(stack, others):
        for number, record in enumerate(records):
            draw_branch(axes, record, x, y, part_of(record), colour=f"C{number % COLOURS}")
        points += draw_measured(axes, records[0], x, y, measured)
        if axes is not stack[-1]:
            axes.set_xlabel("")
    place_legend(stack[0], _handles(records, part_of) + points)
    figure.align_ylabels()
    return figure


def _handles(records, part_of):
    """Entries of the legend: the archives, then the events that occur in any of them."""
    events = event_handles(*((record, part_of(record)) for record in records))
    if len(records) == 1:
        return events
    curves = [Line2D([], [], color=f"C{number % COLOURS}", label=name)
              for number, name in enumerate(labels(records))]
    for handle in events:
        handle.set_color(GREY)
    return curves + events


def _check(records, columns):
    """InputError for fewer than two columns, and for one that an archive does not have."""
    if len(columns) < 2:
        raise InputError(f"-plot_columns is '{','.join(columns)}': give two columns at least, for "
                         "instance tangential_force,contact_area")
    for record in records:
        for name in columns:
            known = [other for other in record if record[other].dtype.kind in "fiu"]
            if name not in known:
                raise InputError(f"-plot_columns: {record.path} has no column {name} of numbers"
                                 + instead(name, known))


def _sheared(record):
    """Direction of the tangential load; NothingToShow, with the archive's name, where there is
    none."""
    try:
        return shear(record)[0]
    except NothingToShow as reason:
        raise NothingToShow(f"{reason} in {record.path.name}") from None


def together(records, measured):
    """Name -> function () that draws a common figure of several archives, or raises
    NothingToShow."""
    def sheared(columns):
        axes = {_sheared(record) for record in records}
        if len(axes) > 1:
            raise NothingToShow("the archives are sheared in different directions")
        axis = axes.pop()
        return draw_columns(records, [name + axis if name.startswith("tangential") else name
                                      for name in columns], measured,
                            lambda record: shear(record)[1])

    def approached():
        if not any(varies(record[name][unsheared(record)]) for record in records
                   for name in ("approach", "normal_force")):
            raise NothingToShow("the normal load does not move")
        # beside points that are measured at the top
        top = any("normal_displacement" in table.columns for table in measured)
        return draw_columns(records, ["normal_displacement" if top else "approach",
                                      "normal_force"], measured, unsheared)

    return {"shear": lambda: sheared(["tangential_displacement", "tangential_force",
                                      "contact_area"]),
            "area": lambda: sheared(["tangential_force", "contact_area"]),
            "approach": approached}
