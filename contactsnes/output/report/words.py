"""Words, symbols and numbers of a report, as HTML."""

import html
import re

import numpy as np

from ...options.files import is_option
from ...scene.scene import Scene

GREEK = {"beta": "β", "phi": "φ", "delta": "δ"}


def symbol(unit):
    """A unit as HTML: u_n,r with its index below, beta^2 with its power above."""
    text = re.sub(r"\b(beta|phi|delta)\b", lambda match: GREEK[match[0]],
                  html.escape(unit).replace("phi_", "φ_").replace("delta_", "δ_"))
    text = re.sub(r"_([a-z](?:,[a-z])*)", r"<sub>\1</sub>", text)
    text = re.sub(r"\^(\d)", r"<sup>\1</sup>", text)
    return text.replace("sqrt", "√")


def axis_title(record, name):
    """A column with its unit, for an axis."""
    unit = record.units.get(name, "")
    return name.replace("_", " ") + (f" ({symbol(unit)})" if unit else "")


def number(value, digits=5):
    """A number or text as HTML."""
    if isinstance(value, (float, np.floating)):
        return f"{value:.{digits}g}".replace("-", "\N{MINUS SIGN}")
    return html.escape(str(value))


def table(heading, rows):
    """A table of HTML from texts that are HTML already."""
    lines = ["<table>"]
    if heading:
        lines.append("<tr>" + "".join(f"<th>{text}</th>" for text in heading) + "</tr>")
    lines += ["<tr>" + "".join(f"<td>{text}</td>" for text in row) + "</tr>" for row in rows]
    return "\n".join([*lines, "</table>"])


ROUNDING = 1e-12
"""Part of the largest load of its kind below which a load is none."""


def loads(record, point, digits=5):
    """Controlled and resulting loads of a point in words, without those that are rounding; 'no
    load' where all are.

    Parameters
    ----------
    record : Readable
    point : int
    digits : int
    """
    kinds = {}
    for name in record:
        if found := re.fullmatch(r"((normal|tangential)_(displacement|force))(_[xy])?", name):
            kinds.setdefault(found[1], []).append(name)
    told = []
    for names in kinds.values():
        largest = max(np.nanmax(np.abs(record[name]), initial=0.0) for name in names)
        told += [f"{name.replace('_', ' ')} {number(float(record[name][point]), digits)} "
                 f"{symbol(record.units[name])}" for name in names
                 if abs(record[name][point]) > ROUNDING * largest]
    return ", ".join(told) or "no load"


def scene_rows(record):
    """What the scene is made of: option, value, unit and meaning."""
    rows = []
    for name, value in sorted(record.scene.items()):
        rule = Scene.rule(name) if name in Scene.__dataclass_fields__ else None
        unit = Scene.told_in(name, record.scene.get("units"))
        shown = ", ".join(map(number, np.asarray(value).tolist())) if np.ndim(value) else number(
            np.asarray(value).item())
        rows.append([f"<code>{html.escape(name)}</code>", shown, symbol(unit),
                     html.escape(rule["meaning"]) if rule else ""])
    return rows


NUMBERS = {"normal_maugis": "normal Maugis parameter",
           "tangential_maugis": "tangential Maugis parameter",
           "residual_friction": "residual friction"}
"""Attributes of a scene that its headline tells, in words."""


def headline(record):
    """The scene in a sentence."""
    scene = record.scene
    where = "a line" if int(scene.get("dimension", 1)) == 1 else "a plane"
    body = f"Poisson ratio {number(scene['poisson'])}" if "poisson" in scene else ""
    words = [f"{scene.get('geometry', 'a shape')} on a flat, interface {where}",
             f"law {scene.get('law', '')}",
             *(f"{words} {number(scene[name])}" for name, words in NUMBERS.items()
               if name in scene), body]
    return html.escape("; ".join(filter(None, words)))


def repeat(record):
    """The options of the run as a file of options."""
    words = record.options.split("\n")
    return html.escape("\n".join(line for line in words
                                 if line and is_option(line.split()[0])
                                 and not line.startswith(("-archive_", "-options_left",
                                                          "-no_signal_handler"))))
