"""Texts of heights: rows of numbers as instruments and spreadsheets write them, and what Gwyddion
tells above them."""

import re
from pathlib import Path

import numpy as np

from .instruments import WIDE
from .stored_heights import UNITS, known

NO_NUMBER = re.compile(r"#(?=N/A|NV\b|[A-Z/0]+[!?]|(?:QNAN|QNB|SNAN|IND|INF)\d*\b)")
"""In what spreadsheets and the C of Windows write for no number (#N/A, 1.#QNAN), a sign that begins
no comment."""
NO_HEIGHT = re.compile(r"nodata\w*[\s=:]+([-+]?\d[-+.\deE]*)", re.IGNORECASE)
"""How a heading tells the number that stands for no height."""
MINUS = "\N{MINUS SIGN}"
"""What some languages have before a number in place of a hyphen."""
WITH_COMMAS = (";", "\t")
"""What may separate numbers that have decimal commas."""
TOLD = re.compile(r"^#[ \t]*(Width|Height|Value units):[ \t]*(.*?)[ \t\r]*$", re.MULTILINE)
"""Lines in which Gwyddion tells how long the rows of an image are (its width) and its columns, and
the unit of its numbers."""
LENGTH = re.compile(r"(\d[\d.,]*(?:[eE][-+]?\d+)?)[ \t]*(\S+)")
"""How it writes a length."""


def size_and_unit(text, shape):
    """The size of a map, in its unit, and that unit, as Gwyddion tells them above its numbers, None
    where it tells none, whose size is in metres; ValueError for numbers that are no heights.

    Parameters
    ----------
    text : str
    shape : (rows, columns); one row, or one column, is a profile
    """
    told = dict(TOLD.findall(text))
    unit = known(told.get("Value units") or None)
    sides = [_metres(told.get(name, "")) for name, count in zip(("Height", "Width"), shape)
             if count > 1]
    return tuple(side / UNITS[unit or "m"] for side in sides) if all(sides) else None, unit


def _metres(length):
    """A length in metres; 0 for what is none."""
    found = LENGTH.fullmatch(length)
    try:
        return float(found[1].replace(",", ".")) * UNITS[known(found[2])]
    except (TypeError, ValueError):
        return 0.0


def read_table(text):
    """Rows of numbers of a text, an array (rows, columns).

    They are separated by blanks, tabulators, semicolons or commas, and stand after lines that are
    none; an empty cell, what is no number, and the number that the heading tells to be none, is a
    hole. A separator that ends every row separates nothing.
    """
    lines = [NO_NUMBER.sub("?", line).split("#")[0].rstrip(" \r") for line in text.splitlines()]
    lines = [line for line in lines if line.strip()]
    first = next((place for place, line in enumerate(lines) if _is_row(line)), len(lines))
    while 0 < first < len(lines) and _is_row_with_holes(lines[first - 1], lines[first]):
        first -= 1
    rows = lines[first:]
    if not rows:
        raise ValueError("it has no row of numbers, with blanks, commas, tabulators or semicolons "
                         "(then also decimal commas) between them")
    separator = _separator(rows[-1])
    if separator and all(row.endswith(separator) for row in rows):
        rows = [row.removesuffix(separator) for row in rows]
    if separator in WITH_COMMAS:
        rows = [row.replace(",", ".") for row in rows]
    try:
        found = np.loadtxt(rows, delimiter=separator, ndmin=2)
    except ValueError:
        found = np.genfromtxt(rows, delimiter=separator, ndmin=2)
    if none := NO_HEIGHT.search(text):
        found[found == float(none[1])] = np.nan
    return found


def text_of(filename):
    """The text of a file, of one byte a letter or more."""
    content = Path(filename).read_bytes()
    text = content.decode("utf-16" if content.startswith(WIDE) else "utf-8-sig", errors="replace")
    return text.replace(MINUS, "-")


def _separator(row):
    """What separates the numbers of a row; None for blanks."""
    return next((sign for sign in (";", "\t", ",") if sign in row), None)


def _is_row(line):
    """Whether a line has numbers, or empty cells, and nothing else."""
    filled = [cell for cell in _cells(line) if cell.strip()]
    return bool(filled) and all(map(_is_number, filled))


def _is_row_with_holes(line, row):
    """Whether the line before a row is one, too, with words where heights are missing: it has as
    many cells, more than a place and a height, and most are numbers."""
    cells = _cells(line)
    numbers = sum(map(_is_number, cells))
    return len(cells) == len(_cells(row)) and numbers > max(3, len(cells) / 2)


def _cells(line):
    """What a line has between its separators."""
    separator = _separator(line)
    return (line.replace(",", ".") if separator in WITH_COMMAS else line).split(separator)


def _is_number(cell):
    """Whether a cell holds a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
