"""The page of a report."""

import html
import json
from pathlib import Path

import numpy as np

from ...system.streams import legible
from ..extras import extra
from ..files import ArchiveError, check_ending, check_output, target_beside
from ..prefixes import read
from ..tables import replaced
from . import certificates, words
from .curves import curves
from .fields import chosen_points, fields_figure, first_shown

STYLE = """body { font: 15px/1.45 system-ui, sans-serif; max-width: 1150px; margin: 1.5em auto;
  padding: 0 1em; color: #222 }
h1 { font-size: 1.5em } h2 { font-size: 1.15em; margin-top: 1.8em; border-bottom: 1px solid #ddd }
table { border-collapse: collapse; font-size: 0.92em } th { text-align: left }
td, th { padding: 2px 14px 2px 0; vertical-align: top } pre { background: #f5f5f5; padding: 1em;
  overflow-x: auto } .bad { color: #b30000; font-weight: bold } .warning { background: #fff3cd;
  padding: 0.5em 1em; margin: 0.4em 0 } details { margin: 0.6em 0 } .quiet { color: #666 }"""

LINK = """const moving = %s, first = %d, points = %s;
const curves = document.getElementById("curves"), fields = document.getElementById("fields");
function show(point) {
  moving.forEach((axes, panel) => Plotly.restyle(curves, {x: [[axes[0][point]]],
    y: [[axes[1][point]]]}, [first + panel]));
}
if (fields) fields.on("plotly_sliderchange", event => show(points[event.slider.active]));"""


def write_report(path, asked):
    """Write the report of an archive; the path of the page.

    Parameters
    ----------
    path : path of the archive
    asked : ReportOptions

    Raises
    ------
    ArchiveError, InputError
        Where there is no archive, no point, no folder of the page, or no plotly.
    """
    record = read(path)
    if not record.points:
        raise ArchiveError(f"{path} has no points to report on yet.")
    target = Path(asked.output) if asked.output else target_beside(path, ".html")
    check_ending(target, "a report", (".html", ".htm"))
    check_output(target)
    text = page(record, asked)
    replaced(target, lambda partial: partial.write_text(legible(text), encoding="utf-8"))
    return target


def page(record, asked):
    """The page as a text of HTML.

    Parameters
    ----------
    record : Readable
    asked : ReportOptions
    """
    name = html.escape(record.path.name)
    body = [f"<h1>{name}</h1>", f"<p>{words.headline(record)}. {_told(record)}</p>",
            *(f'<p class="warning">{html.escape(text)}</p>' for text in record.warnings),
            "<h2>Forces, areas, energies</h2>", *_figures(record, asked),
            "<h2>Events</h2>", _events(record),
            "<h2>What is certified</h2>", _certificates(record),
            "<h2>The scene</h2>",
            words.table(["option", "value", "unit", "meaning"], words.scene_rows(record)),
            "<h2>The same again</h2>",
            "<p>These lines, in a file, are what <code>contactsnes run</code> takes:</p>",
            f"<pre>{words.repeat(record)}</pre>",
            f'<p class="quiet">{html.escape(", ".join(map(" ".join, record.versions.items())))}'
            "</p>"]
    return "\n".join(["<!DOCTYPE html>", '<html lang="en"><head><meta charset="utf-8">',
                      f"<title>{name}</title>", f"<style>{STYLE}</style></head><body>", *body,
                      "</body></html>", ""])


def _told(record):
    """How many points there are, where they end, what they cost."""
    single = np.sum(record["transforms_single"]) if "transforms_single" in record else 0
    more = f", {single:.0f} in single precision" if single else ""
    return (f"{record.points} points, to {words.loads(record, -1)}; "
            f"{np.sum(record['transforms']):.0f} transforms{more}, "
            f"{np.sum(record['wall_time']):.1f} s.")


def _figures(record, asked):
    """The figures, the library that draws them, and what links them, as HTML."""
    plotly = extra("plotly.io", "report", "contactsnes report")
    points = chosen_points(record, asked.points)
    figure, moving = curves(record, first_shown(record, points) if points else -1)
    given = dict(full_html=False, config={"displaylogo": False, "responsive": True})
    parts = [plotly.to_html(figure, include_plotlyjs=True, div_id="curves", **given)]
    if points and record.initial_gap is not None:
        parts += ["<h2>Gap and tractions</h2>",
                  plotly.to_html(fields_figure(record, points, asked.nodes), div_id="fields",
                                 include_plotlyjs=False, auto_play=False, **given)]
    else:
        parts.append('<p class="quiet">No fields are stored: <code>-archive_fields all</code> '
                     "keeps them.</p>")
    arrays = [[_plain(values) for values in axes] for axes in moving]
    link = LINK % (json.dumps(arrays), len(figure.data) - len(moving), json.dumps(points))
    return [*parts, f"<script>{link}</script>"]


def _plain(values):
    """Numbers as JSON has them, nan as nothing."""
    return [float(f"{value:.7g}") if np.isfinite(value) else None for value in values.tolist()]


def _events(record):
    """The table of events."""
    rows = certificates.events(record)
    heading = ["point", "event", "at", "load known to"]
    return words.table(heading, rows) if rows else "<p>None.</p>"


def _certificates(record):
    """The table of certificates; what is not fine stands out."""
    return words.table([], [[what, value if fine else f'<span class="bad">{value}</span>']
                            for what, value, fine in certificates.rows(record)])
