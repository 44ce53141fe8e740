"""Figures of forces, displacements and the contact area along a path."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .data import NothingToShow, shear, unsheared, varies
from .measured import draw_measured
from .parts import draw_branch, draw_inset, event_handles, pieces, place_legend
from .style import BLUE, EVENTS, GREY, WIDTH, ZERO
from .words import label


def draw_shear(record, measured=()):
    """Figure of tangential force and contact area against the applied tangential displacement;
    measured points (``measured.Measured``) beside them."""
    direction, part = shear(record)
    figure = Figure((WIDTH, 1.25 * WIDTH), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    displacement = f"tangential_displacement{direction}"
    draw_branch(above, record, displacement, f"tangential_force{direction}", part)
    draw_branch(below, record, displacement, "contact_area", part)
    points = [*draw_measured(above, record, displacement, f"tangential_force{direction}", measured),
              *draw_measured(below, record, displacement, "contact_area", measured)]
    above.set_xlabel("")
    place_legend(above, event_handles((record, part)) + points)
    figure.align_ylabels()
    return figure


def draw_area(record, measured=()):
    """Figure of the contact area against the tangential force; measured points beside it."""
    direction, part = shear(record)
    figure = Figure((WIDTH, 0.8 * WIDTH), layout="constrained")
    axes = figure.subplots()
    draw_branch(axes, record, f"tangential_force{direction}", "contact_area", part)
    points = draw_measured(axes, record, f"tangential_force{direction}", "contact_area", measured)
    place_legend(axes, event_handles((record, part)) + points)
    return figure


def draw_approach(record, measured=()):
    """Figure of the normal force against the displacements of the mean surface and, if another, of
    the top; measured points beside it."""
    top = record["normal_displacement"]
    surface = record["approach"]
    force = record["normal_force"]
    part = unsheared(record)
    if record.points > 1 and not (varies(force[part])
                                  and (varies(top[part]) or varies(surface[part])
                                       or np.isnan(top).any())):
        raise NothingToShow("the normal load does not move")
    figure = Figure((WIDTH, 0.8 * WIDTH), layout="constrained")
    axes = figure.subplots()
    handles = []
    if not np.allclose(top, surface, rtol=1e-6, atol=1e-6 * np.max(np.abs(top))):
        for piece in pieces(record["event"][part]):
            axes.plot(top[part][piece], force[part][piece], ":", color=GREY)
        handles = [Line2D([], [], color=BLUE, label=r"mean surface, $\bar{d}$"),
                   Line2D([], [], color=GREY, linestyle=":", label="top of the body, $D$")]
    crowded = draw_inset(axes, record, part)
    draw_branch(axes, record, "approach", "normal_force", part, () if crowded else EVENTS)
    points = [*draw_measured(axes, record, "approach", "normal_force", measured),
              *draw_measured(axes, record, "normal_displacement", "normal_force", measured)]
    axes.axhline(0, **ZERO)
    axes.axvline(0, **ZERO)
    if handles:
        axes.set_xlabel(label("normal displacement", "d", record.units["approach"]))
    place_legend(axes, handles + event_handles((record, part)) + points)
    return figure
