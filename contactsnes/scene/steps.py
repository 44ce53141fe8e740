"""Form of the equations, steps along the load path and the archive, as frozen dataclasses of
checked options."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ..continuation.predictors import PREDICTORS, in_words
from ..options.fields import InputError, Options, as_text, option


@dataclass(frozen=True, repr=False)
class Form(Options):
    """Form of the equations: the ``-contact_*`` options."""

    prefix: ClassVar[str] = "contact_"
    title: ClassVar[str] = "Form of the equations"
    form: str = option("displacement", "displacement (compliance form, on the "
                       "window) or force (stiffness form, on the cell)",
                       choices=("displacement", "force"))
    first: str = option("none", "before each solve of the displacement form: "
                        "none, or relaxation (FIRE on the cell, in the "
                        "force form, to -contact_first_tolerance; its options "
                        "under the prefix -first_)", choices=("none", "relaxation"))
    first_tolerance: float = option(1e-2, "residual_norm at which the relaxation hands over",
                                    "ranges of the law", above=0)
    cascade: bool = option(True, "first point through softer laws on coarser "
                           "grids, where they lead to the same state "
                           "(displacement form)")
    window: str = option("auto", "auto: nodes within the range of the law (of "
                         "rough planes any, elsewhere in one box or, where "
                         "that is cheaper, several), enlarged on demand; "
                         "off: the whole cell", choices=("auto", "off"))
    symmetry: str = option("auto", "states even or odd about the apex on half the "
                           "line or a quarter of the plane: auto (where "
                           "gap, body, load, state and method allow it), "
                           "even (an error where they do not), off",
                           choices=("auto", "even", "off"))
    kernels: str = option("auto", "what computes: auto (compiled kernels where they were built, "
                          "else NumPy) or off (NumPy; the answers agree to rounding)",
                          choices=("auto", "off"))
    linear_precision: str = option("auto", "of transforms inside linear solves: auto (single where "
                                   "it pays and no solve is asked for more than it holds), single "
                                   "(the same on any size) or double; residuals are in double",
                                   choices=("auto", "double", "single"))
    cache: str = option("", "folder for what is kept between runs: compiled laws of one's own, and "
                        "what FFTW learned", default_text="contactsnes in $XDG_CACHE_HOME or "
                        "~/.cache")


@dataclass(frozen=True, repr=False)
class Steps(Options):
    """Steps along the load path: the ``-continuation_*`` options; step sizes in the unit of the
    quantity that moves."""

    _NAMES: ClassVar[tuple] = ("smallest_step", "initial_step", "largest_step")
    prefix: ClassVar[str] = "continuation_"
    title: ClassVar[str] = "Steps along the load path"
    type: str = option("natural", "parameter of the path: natural, the load; "
                       "arclength, the length of the branch",
                       choices=("natural", "arclength"))
    at_fold: str = option("jump", "at a limit point: jump to the next "
                          "equilibrium, stop, or trace the branch through it",
                          choices=("jump", "stop", "trace"))
    locate_folds: bool = option(None, "locate folds to 1e-8 of the load; else steps bracket them, "
                                "and fold_precision says how closely", kind="flag",
                                default_text="true on lines and of convex bodies, false on rough "
                                             "planes")
    initial_step: float | tuple = option(None, "first step of a leg", "of what moves",
                                         kind="number", above=0, many="legs",
                                         default_text="1/40 of the leg")
    largest_step: float | tuple = option(None, "largest step", "of what moves", kind="number",
                                         above=0, many="legs", default_text="1/20 of the leg")
    smallest_step: float | tuple = option(None, "smallest step, below which a solve has failed",
                                          "of what moves", kind="number", above=0, many="legs",
                                          default_text="1e-6 of the leg")
    predictor: str = option("edge", f"start of a solve: {in_words()}", choices=tuple(PREDICTORS))
    at_bifurcation: str = option("pass", "at a bifurcation, which -continuation_stability "
                                 "finds: pass, stop, follow the stable branch",
                                 choices=("pass", "stop", "follow"))
    stability: str = option("off", "stability of points: not checked, stable or "
                            "not, with the leading eigenvalue of "
                            "overdamped motion", choices=("off", "sign", "eigenvalue"))

    def __post_init__(self):
        super().__post_init__()
        if self.at_bifurcation != "pass" and self.stability == "off":
            raise InputError(f"-continuation_at_bifurcation is '{self.at_bifurcation}', "
                             "but -continuation_stability is 'off', and "
                             "bifurcations are not looked for: take "
                             "-continuation_stability sign or eigenvalue, or "
                             "leave it out")
        if len({len(value) for value in vars(self).values() if isinstance(value, tuple)}) > 1:
            raise InputError(f"{self.lists}: lists of steps have one length, one number per leg")
        for leg in range(self.legs or 1):
            self._check_order(leg)

    def _check_order(self, leg):
        """Smallest <= initial <= largest step, of those that are given for a leg."""
        given = [(name, self._given(name, leg)) for name in self._NAMES]
        given = [(name, value) for name, value in given if value is not None]
        for (low, small), (high, large) in zip(given, given[1:]):
            if small > large:
                raise InputError(f"-continuation_{low} is '{as_text(small)}': allowed "
                                 f"is at most -continuation_{high}, which is "
                                 f"'{as_text(large)}'")

    @property
    def lists(self):
        """The lists of steps with their options, in words."""
        return " and ".join(f"{self.option_name(name)} is '{as_text(getattr(self, name))}'"
                            for name in self._NAMES if isinstance(getattr(self, name), tuple))

    @property
    def legs(self):
        """Number of legs that the lists of steps are for; None where each is one number."""
        return next((len(value) for value in vars(self).values() if isinstance(value, tuple)), None)

    @property
    def keeps_modes(self):
        """Whether fields of points include a mode: the leading one, or the null vector of a
        fold."""
        return self.stability == "eigenvalue" or self.type == "arclength" or self.at_fold == "trace"

    def _given(self, name, leg):
        """The step the user set for a leg (from 0), or None."""
        value = getattr(self, name)
        return value[leg] if isinstance(value, tuple) else value

    def sizes(self, leg, length):
        """Initial, largest and smallest step of leg number `leg` (the first is 1) over a distance
        `length`.

        A default gives way to a value that was set, so that smallest <= initial <= largest.
        """
        smallest, initial, largest = (self._given(name, leg - 1) for name in self._NAMES)
        length = abs(length)
        if initial is None:
            initial = max(min(length / 40, largest or math.inf), smallest or 0)
        largest = max(length / 20, initial) if largest is None else largest
        return initial, largest, min(1e-6 * length, initial) if smallest is None else smallest


@dataclass(frozen=True, repr=False)
class Output(Options):
    """The archive: the ``-archive_*`` options."""

    prefix: ClassVar[str] = "archive_"
    title: ClassVar[str] = "Archive"
    file: str = option("", "HDF5 file for the points of the branch",
                       default_text="none: nothing is written")
    fields: str = option("none", "displacements and tractions kept: none, last point, all points",
                         choices=("none", "last", "all"))
    fields_on: str = option(None, "nodes on which displacements and tractions are kept: those of "
                            "the cell, or active ones, where the law acts, of which reading makes "
                            "the cell's", kind="text", choices=("cell", "active"),
                            default_text="active on planes, cell on lines")
    precision: str = option("double", "of these fields; single ones take half the room, and are "
                            "compressed when the path is done", choices=("double", "single"))
    errors: bool = option(False, "estimate the errors of every point by solving "
                          "it again on a finer grid (-scene_points auto "
                          "does so anyway)")
    stiffness: bool = option(False, "find the stiffness dW/dD of every point, by a linear solve")
    resume: bool = option(False, "go on from an archive of the same scene")
    overwrite: bool = option(False, "replace an existing archive")

    def on_active(self, scene):
        """Whether fields of a scene are kept on active nodes."""
        return (self.fields_on or ("active" if scene.dimension == 2 else "cell")) == "active"

    def __post_init__(self):
        super().__post_init__()
        if self.resume and self.overwrite:
            raise InputError(
                "-archive_resume and -archive_overwrite exclude each other: give one of them")
