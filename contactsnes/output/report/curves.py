"""Curves of a report: forces, areas and energies along the path, with their events."""

import numpy as np

from ..extras import extra
from ..figures.data import NothingToShow, shear
from ..figures.parts import pieces
from ..figures.style import EVENTS
from .words import axis_title, loads, symbol

BLUE = "#0072B2"
SYMBOLS = {"fold": "triangle-down", "jump": "square-open", "gross_sliding": "star", "pull_off": "x",
           "bifurcation": "diamond"}
"""Event -> its mark, plotly's; the colour is that of `figures.style`."""
ENERGIES = {"elastic_energy": "#0072B2", "interfacial_energy": "#009E73",
            "external_work": "black", "dissipated_work": "#D55E00"}


def panels(record):
    """(x, y) of the panels, names of columns; None for the number of the point."""
    along = "approach" if np.isfinite(record["approach"]).all() else None
    found = [(along, "normal_force")]
    try:
        axis = shear(record)[0]
        moved = f"tangential_displacement{axis}"
        found += [(moved if np.isfinite(record[moved]).all() else None, f"tangential_force{axis}"),
                  (f"tangential_force{axis}", "contact_area")]
    except NothingToShow:
        found += [(along, "contact_area"), ("normal_force", "contact_area")]
    return found


def curves(record, point):
    """(figure of plotly, [(x, y) of each panel's marker, arrays over all points]), the markers at
    a point."""
    plots = extra("plotly.subplots", "report", "contactsnes report")
    shown = panels(record)
    figure = plots.make_subplots(2, 2, horizontal_spacing=0.12, vertical_spacing=0.16)
    places = [(1, 1), (1, 2), (2, 1)]
    numbers, moving = np.arange(record.points), []
    for place, (x, y) in zip(places, shown):
        _draw(figure, place, record, x, y)
        figure.update_xaxes(title_text=axis_title(record, x) if x else "point", row=place[0],
                            col=place[1])
        figure.update_yaxes(title_text=axis_title(record, y), row=place[0], col=place[1])
        moving.append((record[x] if x else numbers, record[y]))
    _energies(figure, record)
    for place, (x, y) in zip(places, moving):
        figure.add_scatter(x=x[[point]], y=y[[point]], mode="markers", showlegend=False,
                           name="shown below",
                           marker=dict(size=13, color="rgba(0,0,0,0)",
                                       line=dict(width=2, color="black")),
                           hoverinfo="skip", row=place[0], col=place[1])
    figure.update_layout(template="simple_white", height=720, margin=dict(l=70, r=20, t=30, b=60),
                         legend=dict(orientation="h", y=1.07), hovermode="closest")
    return figure, moving


def _draw(figure, place, record, x, y):
    """One curve: jumps dashed, events marked.

    Parameters
    ----------
    figure : of plotly
    place : (row, column)
    record : Readable
    x, y : names of columns, x None for the number of the point
    """
    row, col = place
    events, numbers = record["event"], np.arange(record.points)
    horizontal, vertical = record[x] if x else numbers, record[y]
    for piece in pieces(events):
        figure.add_scatter(x=horizontal[piece], y=vertical[piece], mode="lines+markers",
                           line=dict(color=BLUE), marker=dict(size=4), showlegend=False,
                           text=[f"point {number}" for number in numbers[piece]],
                           hovertemplate="%{text}: %{x:.5g}, %{y:.5g}<extra></extra>",
                           row=row, col=col)
        if piece[0] > 0:
            jump = [piece[0] - 1, piece[0]]
            figure.add_scatter(x=horizontal[jump], y=vertical[jump], mode="lines", row=row, col=col,
                               line=dict(color=BLUE, dash="dash", width=1), showlegend=False,
                               hoverinfo="skip")
    for name, colour in EVENTS.items():
        at = np.flatnonzero(events == name)
        if at.size:
            figure.add_scatter(x=horizontal[at], y=vertical[at], mode="markers", row=row, col=col,
                               marker=dict(symbol=SYMBOLS[name], size=11, color=colour),
                               name=name.replace("_", " "), legendgroup=name,
                               showlegend=place == (1, 1),
                               text=[f"{name.replace('_', ' ')}, point {point}" for point in at],
                               hovertemplate="%{text}: %{x:.5g}, %{y:.5g}<extra></extra>")


def _energies(figure, record):
    """Energies and works against the number of the point."""
    for name, colour in ENERGIES.items():
        if name in record and np.isfinite(record[name]).any():
            figure.add_scatter(y=record[name], mode="lines", name=name.replace("_", " "), row=2,
                               col=2, line=dict(color=colour), legend="legend2",
                               hovertemplate="point %{x}: %{y:.5g}<extra>" + name.replace("_", " ")
                               + "</extra>")
    figure.update_xaxes(title_text="point", row=2, col=2)
    figure.update_yaxes(title_text=f"energy ({symbol(record.units['external_work'])})", row=2,
                        col=2)
    figure.update_layout(legend2=dict(x=0.58, y=0.42, xanchor="left", yanchor="top",
                                      bgcolor="rgba(255,255,255,0.6)"))


def title_of(record, point):
    """A point in words: its number, its loads, its event."""
    event = record["event"][point]
    special = f" <b>{event.replace('_', ' ')}</b>" if event != "none" else ""
    told = loads(record, point, 4)
    if "tangential displacement y" in told:  # more than the page is wide
        told = told.replace(", tangential", ",<br>tangential", 1)
    return f"point {point}: {told}{special}"
