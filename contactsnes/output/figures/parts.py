"""Parts of figures: branches with their events, and legends."""

import textwrap

import matplotlib
import numpy as np
from matplotlib.cbook import is_math_text
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.textpath import text_to_path

from .data import NothingToShow
from .style import BLUE, DASHED, EVENTS, GREY, MARKS
from .words import column_label, word


def draw_branch(axes, record, x, y, part, shown=EVENTS, colour=BLUE):
    """Draw a column against another: jumps dashed, events and start marked.

    Parameters
    ----------
    axes : matplotlib's
    record : Readable
    x, y : str, names of columns
    part : slice of the points
    shown : names of the events that are marked
    colour : of the curve, matplotlib's
    """
    horizontal = record[x][part]
    vertical = record[y][part]
    events = record["event"][part]
    if not (np.isfinite(horizontal) & np.isfinite(vertical)).any():
        raise NothingToShow(f"{record.path.name} has no point with both {x} and {y}" + (
            ": a half-plane under a force has no displacement as a whole"
            if np.isnan(record["approach"]).all() else ""))
    dots = {"marker": ".", "markersize": 3} if len(events) <= 25 else {}
    for piece in pieces(events):
        axes.plot(horizontal[piece], vertical[piece], color=colour, **dots)
        if piece[0] > 0:
            jump = slice(piece[0] - 1, piece[0] + 1)
            axes.plot(horizontal[jump], vertical[jump], color=colour, **DASHED)
    axes.plot(horizontal[0], vertical[0], **{**MARKS["start"], "color": colour}, linestyle="none",
              zorder=3)
    for name in shown:
        axes.plot(horizontal[events == name], vertical[events == name], **MARKS[name],
                  linestyle="none", zorder=3)
    axes.set_xlabel(column_label(record, x))
    axes.set_ylabel(column_label(record, y))
    axes.margins(0.06)


def pieces(events):
    """Indices of the points between jumps: one array for each piece of the branch."""
    return np.split(np.arange(len(events)), np.flatnonzero(events[1:] == "jump") + 1)


def draw_inset(axes, record, part):
    """Inset, above a rising curve, of several events where they crowd at its lower end; whether
    there is need of it.

    Parameters
    ----------
    axes : matplotlib's
    record : Readable
    part : slice of the points
    """
    events, x, y = (record[name][part] for name in ("event", "approach", "normal_force"))
    at = events != "none"
    crowded = all(np.max(values[at], initial=values[0]) - np.min(values) < 0.2 * np.ptp(values)
                  for values in (x, y))
    if np.count_nonzero(at) < 3 or not crowded:
        return False
    inset = axes.inset_axes([0.11, 0.57, 0.34, 0.38])
    draw_branch(inset, record, "approach", "normal_force", part)
    limits = []
    for values, whole in ((x[at], x), (y[at], y)):
        margin = 0.3 * np.ptp(values) or 0.05 * np.ptp(whole)
        limits.append((np.min(values) - margin, np.max(values) + margin))
    inset.set(xlabel="", ylabel="", xlim=limits[0], ylim=limits[1])
    (left, right), (low, high) = limits
    axes.indicate_inset([left, low, right - left, high - low], edgecolor=GREY, linewidth=0.5)
    return True


def event_handles(*shown):
    """Entries of the legend for the start and the events that occur.

    Parameters
    ----------
    shown : (Readable, slice of its points), for each archive
    """
    found = [record["event"][part] for record, part in shown]
    handles = [Line2D([], [], **MARKS["start"], linestyle="none",
                      label="start" if max(map(len, found)) > 1 else "only point")]
    for name in (name for name in EVENTS if name in np.concatenate(found)):
        line = DASHED | {"color": BLUE} if name == "jump" else {"linestyle": "none"}
        look = {**MARKS[name], **line, "markerfacecolor": MARKS[name]["color"]}
        handles.append(Line2D([], [], **look, label=kinds(shown) if name == "fold"
                              else word(name)))
    return handles


def kinds(shown):
    """Folds with the kinds that occur; ``shown`` as of `event_handles`."""
    words = sorted({word(kind) for record, part in shown if "fold_kind" in record
                    for kind in record["fold_kind"][part][record["event"][part] == "fold"] if kind})
    return f"fold ({', '.join(words)})" if words else "fold"


SPACES = dict(columnspacing=1.2, handletextpad=0.5, handlelength=1.8)
"""Between and before the entries of a legend, heights of its letters."""
ROOM, LONGEST = 0.78, 34
"""Part of the width of a figure that a legend may take, and letters of its entries in a line."""


def place_legend(axes, handles, title=None):
    """A legend above the axes, where it can hide nothing, in as many columns as there is room for.

    Parameters
    ----------
    axes : matplotlib's
    handles : list of its entries; what stands in several panels has one
    title : str, optional
    """
    handles = list({(one.get_label(), one.get_marker(), str(one.get_color())): one
                    for one in handles}.values())
    for handle in handles:
        handle.set_label(textwrap.fill(handle.get_label(), LONGEST))
    most = min(len(handles), 3 if max(len(one.get_label()) for one in handles) < 12 else 2)
    size = FontProperties(size=matplotlib.rcParams["legend.fontsize"]).get_size_in_points()
    above = _above(axes)
    room = ROOM * 72 * axes.figure.get_size_inches()[0] / size - above
    columns = next((count for count in range(most, 1, -1) if _width(handles, count) < room), 1)
    axes.legend(handles=handles, title=title, loc="lower left", bbox_to_anchor=(0, 1), ncol=columns,
                borderaxespad=above, **SPACES)


def _above(axes):
    """Room around a legend, heights of its letters: the power of ten of the numbers along y stands
    below it, where they have one."""
    formatter = axes.yaxis.get_major_formatter()
    formatter.set_locs(axes.get_yticks())
    return 1.8 if formatter.get_offset() else 0.2


def _width(handles, columns):
    """Width of a legend with so many columns, heights of its letters."""
    before = SPACES["handlelength"] + SPACES["handletextpad"]
    texts = [before + max(map(_length, handle.get_label().split("\n"))) for handle in handles]
    return SPACES["columnspacing"] * (columns - 1) + sum(
        max(part) for part in np.array_split(texts, columns))


def _length(line):
    """Length of a line of text, heights of its letters."""
    size = FontProperties(size=10.0)
    length, _, _ = text_to_path.get_text_width_height_descent(line, size, is_math_text(line))
    return length / size.get_size_in_points()


def break_labels(figure):
    """Labels of the y axes that are longer than their panel in two lines, about as long."""
    figure.draw_without_rendering()
    for axes in figure.axes:
        text = axes.yaxis.label
        line = text.get_text()
        if "\n" in line or text.get_window_extent().height <= axes.get_window_extent().height:
            continue
        gaps = [place for place, letter in enumerate(line)
                if letter == " " and line[:place].count("$") % 2 == 0]
        if gaps:
            place = min(gaps, key=lambda gap: max(_length(line[:gap]), _length(line[gap + 1:])))
            text.set_text(f"{line[:place]}\n{line[place + 1:]}")
