"""Words, symbols and units in figures."""

import re

from .data import along_load, free_of_rounding, varies


def names(record, chosen):
    """What tells the chosen points apart: symbol of the first load that differs, and its values
    with the events; of the same value the points, too."""
    axes = along_load(record)
    columns = [*(f"tangential_displacement{axis}" for axis in axes), "normal_force",
               "normal_displacement", *(f"tangential_force{axis}" for axis in axes)]
    name = next((name for name in columns
                 if varies(free_of_rounding(record, name, chosen)[chosen])), "normal_force")
    loads = free_of_rounding(record, name, chosen)
    values = [(number(loads[point], 4), record["event"][point]) for point in chosen]
    texts = [value if event == "none" else f"{value}, {word(event)}" for value, event in values]
    texts = [f"{text}, point {point}" if texts.count(text) > 1 else text
             for text, point in zip(texts, chosen)]
    return label("", word_and_symbol(name)[1], record.units[name]), texts


def number(value, digits):
    """A number with a typographic minus sign, nothing without a sign."""
    return f"{value + 0.0:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def word(name):
    """An event or kind of fold in plain words."""
    return str(name).replace("_", " " if name == "gross_sliding" else "-")


LONG = 22
"""Letters of a label that a panel has room for."""

SYMBOLS = {
    "normal_force": ("normal force", "W_n"),
    "approach": ("approach", r"\bar{d}"),
    "normal_displacement": ("normal displacement", "D"),
    "tangential_force": ("tangential force", "W_t"),
    "tangential_displacement": ("tangential displacement", "U_t"),
}


def column_label(record, name):
    """Label of a column: words, symbol and unit."""
    unit = record.units[name]
    if name == "contact_area":
        return label(*(("contact area", "A") if unit.endswith(("^2", "²"))
                       else ("contact length", "2a")), unit)
    plain = name.removesuffix("_x").removesuffix("_y")
    if plain not in SYMBOLS:
        scale, words = in_latex(unit), name.replace("_", " ")
        told = f"({unit})" if scale == unit else f"(${scale}$)"
        # of a long one the unit is on a line of its own
        between = "\n" if len(words) + len(unit) > LONG else " "
        return f"{words}{between}{told}" if unit else words
    return label(*word_and_symbol(name), unit)


def word_and_symbol(name):
    """Words and symbol of a column for a label."""
    axis = name[-2:] if name.endswith(("_x", "_y")) else ""
    words, symbol = SYMBOLS[name.removesuffix(axis)]
    return words, tangential(symbol[0], axis) if axis else symbol


def tangential(symbol, axis):
    """Symbol of a tangential quantity in a direction ('', '_x', '_y')."""
    return f"{symbol}_{{t{axis.replace('_', ',')}}}"


def in_latex(unit):
    """A dimensionless unit as it is set in formulas; one in SI as it is."""
    scale = re.sub(r"([a-zA-Z])_([a-zA-Z,]+)", r"\1_{\2}", unit)
    scale = re.sub(r"sqrt\((.*?)\)", r"\\sqrt{\1}", scale)
    return re.sub(r"\b(beta|phi|delta)", r"\\\1", scale)


def label(words, symbol, unit, between=" "):
    """Label in a figure: words, and a symbol over its scale ($2a/\beta$) or before its SI unit in
    brackets.

    Parameters
    ----------
    words, symbol : str, the symbol in LaTeX
    unit : str, as in the archive
    between : str, what separates words and symbol
    """
    scale = in_latex(unit)
    if not unit:
        text = f"${symbol}$"
    elif scale == unit:
        text = f"${symbol}$ ({unit})"
    else:
        if " " in scale:  # a long one: on a line of its own
            scale, between = "(" + scale.replace(" ", r"\,") + ")", "\n"
        text = f"${symbol} / {scale}$"
    return f"{words}{between if words else ''}{text}"
