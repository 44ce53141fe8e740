"""Progress of a run in lines and a bar: what a point has to say in one line, events, counts and the
closing table."""

import math
import time

from ..contact.energies import energy_unit
from ..scene.load import names, quantities
from ..scene.settings import tangential_legs
from ..scene.units import prefix, prefixed

INEXACT = 0.002
"""Part of the largest work of the loads by which the balance of energies may miss without a word:
what is left of it at the end of a loop, as much as its jumps have lost, may be far less."""

ROUNDING = 1e-11
"""Part of the scale of a quantity, or of the largest value of its kind, below which it is shown as
0."""


class Progress:
    """What a run says while it goes on: a bar, or one line a point, and sentences between; and its
    counts and events.

    Parameters
    ----------
    scene : Scene
    load : Load
    show : function (text) that prints a line
    live : bool, whether there is a terminal for a bar

    Attributes
    ----------
    columns : name -> heading of what a line shows of a point
    """

    def __init__(self, scene, load, show, live):
        plane = ("_x", "_y") if scene.dimension == 2 else ("",)
        self.loads = {"normal_displacement": "D", "normal_force": "W"}
        if any(tangential_legs(scene, load)):
            for end in plane:
                self.loads |= {f"tangential_displacement{end}": f"U{end}",
                               f"tangential_force{end}": f"T{end}"}
        self.handy = self._units(scene, load) if scene.units == "si" else {}
        self.largest = {}
        self.loads = {name: "/".join([heading, *self.handy.get(name, (1.0,))[1:]])
                      for name, heading in self.loads.items()}
        self.columns = {"leg": "leg", **self.loads,
                        "contact_area": "/".join(["area", *self.handy.get("contact_area",
                                                                          (1.0,))[1:]]),
                        "nonlinear_iterations": "nonlinear", "linear_iterations": "linear",
                        "transforms": "transforms", "event": "event"}
        self.counts = dict.fromkeys(("nonlinear_iterations", "linear_iterations",
                                     "function_evaluations", "transforms",
                                     "transforms_single"), 0)
        self.points = 0
        self.events = []
        self.lost = 0.0
        self.began = time.monotonic()
        self.missing, self.work = 0.0, 0.0
        self.stable = {}
        self.show = show
        self.live = live
        self.unit = "window" if scene.isolated else "whole cell"
        self.energy_unit = scene.scale(energy_unit(scene))[1]
        self.bar, self.legs = None, load.path.count(";") + 1

    @property
    def taken(self):
        """Names of the numbers that it takes of a point."""
        return {*self.columns, *self.counts, "dissipated_work", "energy_imbalance",
                "external_work", "interface_work", "stable", "fold_kind"}

    def _units(self, scene, load):
        """Name -> (size, name of the unit with a prefix) of a column: in which the largest value
        that the load names is a handy number, of it or of what is told beside it in the same unit,
        forces and tangential displacements; where it names none, the scale of the scene."""
        known, largest = quantities(scene.dimension), {}
        legs = scene.legs(load) if load.path else ()
        for controls in (scene.initial(load), *(leg.controls for leg in legs)):
            for component, (control, value) in controls.items():
                name = names(scene.dimension)[component, control]
                largest[name] = max(largest.get(name, 0.0), abs(value or 0.0))
        found = {}
        for name in (*self.loads, "contact_area"):
            size, unit = scene.scale(known[name].unit if name in known
                                     else ("beta", "beta^2")[scene.dimension - 1])
            beside = (value for other, value in largest.items() if "normal_displacement" not in (
                name, other) and other.split("_")[1] in name.split("_"))
            typed = largest.get(name) or max(beside, default=0.0) or 1.0
            found[name] = prefix(typed * size, unit)
        return found

    def _shown(self, row):
        """A row with loads and area in handy units, and 0 for what is rounding."""
        shown = dict(row)
        for name in (*self.loads, "contact_area"):
            kind = name.removesuffix("_x").removesuffix("_y")
            value = row[name] / self.handy.get(name, (1.0,))[0]
            self.largest[kind] = max(self.largest.get(kind, 1.0), abs(value))
            shown[name] = 0.0 if abs(value) < ROUNDING * self.largest[kind] else value
        return shown

    def log(self, sentence):
        """Print a sentence without tearing the bar."""
        if self.bar is None:
            self.show(sentence)
        else:
            self.bar.write(sentence)

    def point(self, row, position):
        """Show a point that was accepted."""
        row = self._shown({**row, "event": _event(row)})
        loads = ", ".join(" ".join([heading.partition("/")[0], f"{row[name]:.6g}",
                                    *self.handy.get(name, (1.0,))[1:]])
                          for name, heading in self.loads.items())
        if not self.live:
            if not self.points:
                self.show(self._line(self.columns))
            self.show(self._line(row))
        self.points += 1
        self.counts = {name: count + row[name] for name, count in self.counts.items()}
        self.lost = row["dissipated_work"]
        self.missing = max(self.missing, abs(row["energy_imbalance"]))
        known = "interface" if math.isnan(row["external_work"]) else "external"  # of a half-plane
        self.work = max(self.work, abs(row[f"{known}_work"]))
        self.stable[row["stable"]] = self.stable.get(row["stable"], 0) + 1
        if row["event"]:
            self.events.append(f"{row['event']} at {loads}")
        if self.live:
            self._advance(row, position, loads)

    def _advance(self, row, position, loads):
        """Move the bar, which begins with the first point."""
        if self.bar is None:
            from tqdm import tqdm  # where there is a terminal only

            self.bar = tqdm(total=self.legs,
                            bar_format="{bar:30}| {n:.2f}/{total} legs, {elapsed}{postfix}",
                            miniters=0, leave=False)
        if row["event"]:
            self.bar.write(self.events[-1])
        self.bar.set_postfix_str(
            f"{loads}, {self.points} points, {self.counts['transforms']:.0f} transforms",
            refresh=False)
        self.bar.update(max(row["leg"] - 1, 0) + position - self.bar.n)

    def _line(self, row):
        """Values, or headings, in columns."""
        texts = []
        for name, heading in self.columns.items():
            value = row[name]
            width = {"leg": 3, "event": 0}.get(name, 11 if name in self.loads else 10)
            if isinstance(value, float):
                value = (f"{value:.1f}" if name == "transforms" else f"{value:.1e}"
                         if name.startswith("error") else f"{value:.6g}")
            texts.append(f"{value:>{width}}")
        return " ".join(texts).rstrip()

    def close(self):
        """Remove the bar."""
        if self.bar is not None:
            self.bar.close()
            self.bar = None

    def summary(self, known):
        """The closing table of this run; ``known``: points that an archive had before."""
        lines = [f"  points        {self.points}" + (f" (after {known} of an earlier run)" if known
                                                     else "")]
        if self.stable.keys() & {0, 1}:
            unasked = self.stable.get(-1, 0)
            lines.append(f"  stable        {self.stable.get(1, 0)} points, "
                         f"{self.stable.get(0, 0)} not" + f", {unasked} not asked" * bool(unasked))
        lines += [f"  {'event':13} {event}" for event in self.events]
        if any(event.startswith("jump") for event in self.events):
            lost = ("not known" if math.isnan(self.lost)
                    else prefixed(self.lost, self.energy_unit, 6) if self.handy
                    else f"{self.lost:.6g} {self.energy_unit}")
            lines.append(f"  {'dissipated':13} {lost} in jumps")
        if self.missing > INEXACT * self.work:
            lines.append(f"  {'works':13} {self.missing:.2g} of at most "
                         f"{self.work:.3g} {self.energy_unit} is missing in the "
                         "balance of energies (energy_imbalance): the work of "
                         "the loads is integrated over steps, shorter ones "
                         "know it better")
        for name, unit in (("nonlinear_iterations", "nonlinear"), ("linear_iterations", "linear")):
            lines.append(f"  {unit:13} {self.counts[name]} iterations")
        single = self.counts["transforms_single"]
        lines.append(f"  transforms    {self.counts['transforms']:.1f} of the {self.unit}"
                     + (f", {single:.1f} in single precision" if single else ""))
        lines.append(f"  time          {time.monotonic() - self.began:.1f} s")
        return "\n".join(["", *lines])


def _event(row):
    """Event and kind of fold of a row, in words; empty for none."""
    words = "" if row["event"] == "none" else row["event"]
    return f"{words} ({row['fold_kind']})" if row["fold_kind"] else words
