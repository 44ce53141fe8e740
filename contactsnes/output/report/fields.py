"""The figure of a report with a slider over the points: profiles of a line, maps of a plane."""

import numpy as np
from contourpy import contour_generator

from ..extras import extra
from ..figures.data import contact_region, padded, spread
from ..figures.profiles import panels
from .curves import title_of
from .words import symbol

FINER = 8
"""Nodes of profiles for each node of maps in one direction."""


def chosen_points(record, most):
    """Points of the slider: all that have fields or, where these are many, some spread over them
    and all events."""
    stored = record.field_points
    if len(stored) <= most:
        return list(stored)
    events = [point for point in stored if record["event"][point] != "none"][:most // 2]
    spread = np.linspace(0, len(stored) - 1, most - len(events)).astype(int)
    return sorted({*events, *(stored[place] for place in spread)})


def first_shown(record, points):
    """The point that is shown before the slider is moved: the last fold of a contact, else the last
    one of the largest contact."""
    folds = [point for point in points
             if record["event"][point] == "fold" and record["contact_area"][point] > 0.0]
    if folds:
        return folds[-1]
    areas = record["contact_area"][list(points)]
    return points[len(points) - 1 - int(np.argmax(areas[::-1]))]


def fields_figure(record, points, nodes):
    """Figure with a slider.

    Parameters
    ----------
    record : Readable, with fields
    points : list of int
    nodes : int, most nodes in a direction of maps
    """
    gaps, tractions = [], []
    for displacement, traction in record.each(points):
        gaps.append((record.initial_gap + displacement[0]).astype("f4"))
        tractions.append(traction.astype("f4"))
    window, ceiling = contact_region(record.coordinates, gaps, [each[0] for each in tractions])
    make = _profiles if len(record.coordinates) == 1 else _maps
    most = nodes * FINER if len(record.coordinates) == 1 else nodes
    cut = [_cut(x, limits, most) for x, limits in zip(record.coordinates, window)]
    axes = [x[part] for x, part in zip(record.coordinates, cut)]
    gaps = [gap[np.ix_(*cut)] for gap in gaps]
    tractions = [traction[(slice(None), *np.ix_(*cut))] for traction in tractions]
    shown = points.index(first_shown(record, points))
    figure, frames = make(record, axes, gaps, tractions, ceiling)
    for trace, data in zip(figure.data, frames[shown]):
        trace.update(data)
    below = 55 if len(record.coordinates) == 1 else 100
    return _sliding(figure, frames, [title_of(record, point) for point in points], points, shown,
                    below)


def _cut(x, limits, most):
    """Places of the nodes within limits, not more than so many."""
    inside = np.flatnonzero((x >= limits[0]) & (x <= limits[1]))
    return inside[::max(1, -(-len(inside) // most))]


def _sliding(figure, frames, titles, points, shown, below):
    """A figure with its frames and a slider.

    Parameters
    ----------
    figure : of plotly, with the traces of the frame that is shown first
    frames : list of lists of traces, one a point
    titles : list of str, one a point
    points : list of int
    shown : int, place of the frame that is shown first
    below : float, pixels between the axes and the slider
    """
    objects = extra("plotly.graph_objects", "report", "contactsnes report")
    traces = list(range(len(figure.data)))
    figure.frames = [objects.Frame(name=str(point), data=data, traces=traces,
                                   layout=dict(title=dict(text=title)))
                     for point, data, title in zip(points, frames, titles)]
    instant = dict(mode="immediate", frame=dict(duration=0, redraw=True),
                   transition=dict(duration=0))
    steps = [dict(method="animate", label=str(point), args=[[str(point)], instant])
             for point in points]
    play = dict(frame=dict(duration=150, redraw=True), transition=dict(duration=0),
                fromcurrent=True, mode="immediate")
    stop = dict(frame=dict(duration=0, redraw=False), mode="immediate")
    figure.update_layout(
        sliders=[dict(steps=steps, active=shown, currentvalue=dict(visible=False),
                      pad=dict(t=below + 10), x=0.08, len=0.92)],
        updatemenus=[dict(type="buttons", direction="left", x=0.06, y=0, xanchor="right",
                          yanchor="top", pad=dict(t=below), showactive=False, buttons=[
                              dict(label="▶", method="animate", args=[None, play]),
                              dict(label="■", method="animate", args=[[None], stop])])],
        title=dict(text=titles[shown], font=dict(size=13)), template="simple_white",
        margin=dict(l=80, r=20, t=80, b=60))
    return figure


def _profiles(record, axes, gaps, tractions, ceiling):
    """Figure and data of frames of profiles along a line."""
    objects = extra("plotly.graph_objects", "report", "contactsnes report")
    plots = extra("plotly.subplots", "report", "contactsnes report")
    shown = panels(record, gaps, tractions)
    figure = plots.make_subplots(len(shown), 1, shared_xaxes=True, vertical_spacing=0.05)
    frames = [[objects.Scatter(x=axes[0].astype("f4"), y=panel.values[place].astype("f4"),
                               mode="lines", line=dict(color="#0072B2"), showlegend=False)
               for panel in shown] for place in range(len(gaps))]
    for row, (panel, trace) in enumerate(zip(shown, frames[-1]), start=1):
        figure.add_trace(trace, row=row, col=1)
        low, high = np.min(panel.values), np.max(panel.values)
        low, high = (low, min(high, ceiling)) if row == 1 else (low, high)
        figure.update_yaxes(title_text=f"{panel.text} ({symbol(panel.unit)})", row=row, col=1,
                            range=padded(low, high, 0.06))
    figure.update_xaxes(title_text=f"x ({symbol(record.units['x'])})", row=len(shown), col=1)
    figure.update_layout(height=180 * len(shown) + 200)
    return figure, frames


def _maps(record, axes, gaps, tractions, ceiling):
    """Figure and data of frames of maps over a plane, the edge of contact drawn."""
    objects = extra("plotly.graph_objects", "report", "contactsnes report")
    plots = extra("plotly.subplots", "report", "contactsnes report")
    shears = [np.hypot.reduce(traction[1:]) if len(traction) > 1 else 0.0 * traction[0]
              for traction in tractions]
    units = record.units["traction"].split("; ")
    shown = [("gap", record.units["initial_gap"], gaps, "Cividis",
              spread(float(np.min(gaps)), float(ceiling))),
             ("pressure", units[0], [-traction[0] for traction in tractions], "RdBu_r", None),
             ("tangential traction", units[-1], shears, "Viridis", None)]
    shown = shown if np.max(shears) > 0 else shown[:2]
    figure = plots.make_subplots(1, len(shown), shared_yaxes=True, horizontal_spacing=0.02,
                                 subplot_titles=[f"{name} ({symbol(unit)})"
                                                 for name, unit, *_ in shown])
    frames = []
    for place, gap in enumerate(gaps):
        edge = _edge(axes, gap, record.contact_gap)
        frames.append([trace for number, (_, _, values, *_) in enumerate(shown)
                       for trace in (_heatmap(objects, axes, values[place], number),
                                     objects.Scatter(x=edge[0], y=edge[1], mode="lines",
                                                     line=dict(color="black", width=1.5),
                                                     showlegend=False, hoverinfo="skip"))])
    for number, trace in enumerate(frames[-1]):
        figure.add_trace(trace, row=1, col=1 + number // 2)
    for column in range(1, len(shown) + 1):
        figure.update_xaxes(title_text=f"x ({symbol(record.units['x'])})", row=1, col=column,
                            constrain="domain", matches="x")
        _place_bar(figure, column, len(shown), shown[column - 1])
    figure.update_yaxes(title_text=f"y ({symbol(record.units['y'])})", row=1, col=1,
                        scaleanchor="x")
    figure.update_layout(height=620)
    return figure, frames


def _heatmap(objects, axes, values, number):
    """Map of one quantity at one point, its colours those of all points.

    Parameters
    ----------
    objects : plotly.graph_objects
    axes : list of two arrays
    values : array (x, y)
    number : int, of the quantity, from 0
    """
    return objects.Heatmap(x=axes[0].astype("f4"), y=axes[1].astype("f4"), z=values.T.astype("f4"),
                           coloraxis=f"coloraxis{number + 1 if number else ''}",
                           hovertemplate="%{x:.4g}, %{y:.4g}: %{z:.4g}<extra></extra>")


def _place_bar(figure, column, count, shown):
    """Colours of a column of maps, with their bar below it."""
    _, _, values, colours, limits = shown
    low, high = limits or (float(np.min(values)), float(np.max(values)))
    if colours == "RdBu_r":
        low, high = -max(-low, high), max(-low, high)
    figure.update_layout({f"coloraxis{column if column > 1 else ''}": dict(
        colorscale=colours, cmin=low, cmax=high,
        colorbar=dict(orientation="h", x=(column - 0.5) / count, len=0.8 / count, y=-0.12,
                      yanchor="top", thickness=12))})


def _edge(axes, gap, level):
    """The lines where the contact ends, those of several spots apart by a gap of NaN."""
    if not np.min(gap) < level < np.max(gap):
        return [], []
    lines = contour_generator(*axes, gap.T).lines(level)
    parts = [np.vstack([line, [[np.nan, np.nan]]]) for line in lines]
    return tuple(np.vstack(parts).T.astype("f4")) if parts else ([], [])
