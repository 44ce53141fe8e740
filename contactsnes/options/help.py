"""The help: every option with its meaning, unit, default and range."""

import dataclasses
import shutil
import textwrap

from .fields import COMMON, allowed


def help_text(classes=(), width=None, notes=(), units=None):
    """Every option with meaning, unit, default and range, grouped by prefix, and what else there is
    to know.

    Parameters
    ----------
    classes : dataclasses of options of our own PC and SNES types, shown after those of the scene
    width : columns; by default the terminal's
    notes : (title, text) of what follows the options
    units : unit of an option -> what stands in its place where values are typed in another system
    """
    width = width or shutil.get_terminal_size().columns
    parts = []
    for cls in (*COMMON, *classes):
        parts += [f"{cls.title} (-{cls.prefix})", *entries_of(cls, width, units), ""]
    for title, text in notes:
        parts += [title, textwrap.fill(text, width, initial_indent="  ", subsequent_indent="  "),
                  ""]
    parts += [textwrap.fill(
        "All options of PETSc (-snes_*, -ksp_*, -pc_*, -log_view, ...) work as its manual says.",
        width)]
    return "\n".join(parts)


def entries_of(cls, width=None, units=None):
    """The options of a dataclass, one text each.

    Parameters
    ----------
    cls : dataclass of options
    width, units : as of `help_text`
    """
    width = width or shutil.get_terminal_size().columns
    return [_entry(cls.option_name(field.name), field.metadata, width, units or {})
            for field in dataclasses.fields(cls)]


def _entry(name, rule, width, units):
    """One option of the help: name, meaning, unit, default and range, wrapped."""
    in_si = f", or {units[rule['unit']]}" if units.get(rule["unit"]) else ""
    unit = f" [{rule['unit']}{in_si}]" if rule["unit"] else ""
    default = f"default {rule['default_text']}" if rule["default_text"] else "no default"
    text = f"{rule['meaning']}{unit} ({default}; {allowed(rule)})"
    return f"  {name}\n" + textwrap.fill(text, width, initial_indent="      ",
                                          subsequent_indent="      ")
