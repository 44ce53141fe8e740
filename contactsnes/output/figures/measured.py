"""Measured points from CSV files, beside the curves of archives."""

import csv
import math
import re
from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D

from ...options.fields import InputError, nearest
from ...scene.units import PREFIXES
from ...system.streams import legible

HEADING = re.compile(r"\s*(?P<name>[\w.]+)\s*([\[(](?P<unit>.*)[\])])?\s*")
"""A name, and a unit in brackets."""

SQUARE = re.compile(r"²|(?<=m)2$")
ERROR = "_error"
LOOK = dict(linestyle="none", marker="o", markersize=3.5, markerfacecolor="white",
            color="black", markeredgewidth=0.7, elinewidth=0.6, capsize=1.5, zorder=4)


class Measured:
    """A table of measured points.

    Parameters
    ----------
    path : path of a CSV file: a heading of names of columns, perhaps with units in brackets, and
        numbers, between semicolons or tabulators with decimal commas, too; lines that begin with #
        are comments

    Attributes
    ----------
    name : str, of the file without its ending
    columns : dict, name -> array
    units : dict, name -> str; empty where the heading says none: then that of the archive is meant
    used : bool, whether a figure has shown them

    Raises
    ------
    InputError : for a file that cannot be read so
    """

    def __init__(self, path):
        self.path, self.name, self.used = Path(path), legible(Path(path).stem), False
        try:
            with open(path, newline="", encoding="utf-8-sig") as file:
                lines = [line for line in file if line.strip() and not line.startswith("#")]
        except (OSError, UnicodeDecodeError) as error:
            why = getattr(error, "strerror", None) or error
            raise InputError(f"-plot_with is '{path}', which cannot be read as text ({why}): "
                             "name a CSV file whose heading names columns") from None
        dialect = _dialect(lines) if lines else csv.excel
        heading, *rows = csv.reader(lines, dialect=dialect) if lines else [[]]
        if dialect.delimiter != ",":  # then numbers may have decimal commas
            rows = [[text.replace(",", ".") for text in row] for row in rows]
        found = [HEADING.fullmatch(text) for text in heading]
        if not rows or not all(found):
            raise InputError(f"-plot_with is '{path}', which has no heading of names and rows of "
                             "numbers: write for instance tangential_force,contact_area [mm^2] "
                             "above the numbers")
        names = [match["name"] for match in found]
        if twice := [name for name in names if names.count(name) > 1]:
            raise InputError(f"-plot_with is '{path}', which has two columns {twice[0]}: leave one")
        self.units = {match["name"]: match["unit"] or "" for match in found}
        table = [self._numbers(number, row, len(heading)) for number, row in enumerate(rows, 1)]
        self.columns = dict(zip(self.units, np.array(table).T))

    def _numbers(self, number, row, count):
        """A row as numbers; an empty field is none."""
        try:
            if len(row) != count:
                raise ValueError
            return [float(text) if text.strip() else math.nan for text in row]
        except ValueError:
            raise InputError(f"-plot_with is '{self.path}', whose row {number} "
                             f"is '{','.join(row)}': {count} numbers are allowed there") from None

    def values(self, record, name):
        """A column in the unit that figures of a `Readable` have it in; None where it is not
        there."""
        if name not in self.columns:
            return None
        return self.columns[name] * self._size(record, name) * record.factor(_plain(name))

    def _size(self, record, name):
        """Size of a column's unit in that of the archive."""
        typed = SQUARE.sub("^2", self.units[name] or self.units.get(_plain(name), ""))
        typed = typed.replace("\N{GREEK SMALL LETTER MU}", "µ")  # as keyboards have it
        known = record.stored_units[_plain(name)]
        if typed in ("", known):
            return 1.0
        power = 2 if known.endswith("^2") else 1
        for place, sign in PREFIXES.items():
            if known and typed in (sign + known, sign.replace("µ", "u") + known):
                return 10.0 ** (power * place)
        raise InputError(f"-plot_with is '{self.path}', whose column {name} is in '{typed}', but "
                         f"the archive has it in '{known}': give it in that unit"
                         + (", prefixes such as m, k or µ are allowed" if known in UNITS else ""))


UNITS = ("m", "m^2", "N", "N/m", "J", "J/m", "Pa")


def _plain(name):
    """The column that a name of an error belongs to, or the name."""
    return name[:-len(ERROR)] if name.endswith(ERROR) else name


def _dialect(lines):
    """How a file separates: commas, semicolons, tabs."""
    try:
        return csv.Sniffer().sniff(lines[0], ",;\t")
    except csv.Error:
        return csv.excel


def read_measured(text):
    """The tables that an option names, with commas, a list."""
    return [Measured(path.strip()) for path in text.split(",") if path.strip()]


def draw_measured(axes, record, x, y, measured):
    """Draw the measured points that have two columns, with their errors; entries of a legend.

    Parameters
    ----------
    axes : matplotlib's
    record : Readable
    x, y : str, names of columns
    measured : list of Measured
    """
    handles = []
    for number, table in enumerate(measured):
        horizontal, vertical = table.values(record, x), table.values(record, y)
        if horizontal is None or vertical is None:
            continue
        look = {**LOOK, "marker": "oD^sv"[number % 5]}
        axes.errorbar(horizontal, vertical, xerr=table.values(record, x + ERROR),
                      yerr=table.values(record, y + ERROR), **look)
        table.used = True
        handles.append(Line2D([], [], label=table.name,
                              **{name: look[name] for name in look
                                 if name not in ("elinewidth", "capsize", "zorder")}))
    return handles


def check_names(measured, records):
    """InputError for a table with a column that seems to be meant for one of the archives'."""
    for table, strange, known in _strange(measured, records):
        for name in strange:
            if (guess := _guess(name, known, 0.8)) or name.lower().startswith("err"):
                raise InputError(f"-plot_with is '{table.path}', whose column {name} is unknown"
                                 f"{guess or f': errors of a column are in NAME{ERROR}'}")


def check_used(measured, records):
    """InputError for a table that no figure has shown, with the names that there are."""
    for table, strange, known in _strange(measured, records):
        if not table.used:
            told = ", ".join(name + _guess(name, known, 0.4) for name in strange)
            raise InputError(f"-plot_with is '{table.path}': no figure has two of its columns, "
                             f"{', '.join(table.columns)}"
                             + (f"; unknown is {told}" if strange else "")
                             + "; -plot_columns draws any pair of columns")


def _strange(measured, records):
    """Tables, those of their columns that no archive has, and the columns of archives."""
    known = sorted({name for record in records for name in record})
    for table in measured:
        yield table, [name for name in table.columns if _plain(name) not in known], known


def _guess(name, known, cutoff):
    """What may have been meant by a name, empty where nothing looks like it."""
    guess = nearest(name, known, cutoff)
    return guess and f" (did you mean {guess}?)"
