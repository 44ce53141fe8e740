"""What is solved, and with which steps, as frozen dataclasses of checked options, and what holds
for them together.

Each field is one option: ``-`` + the class's ``prefix`` + the field's name. Its metadata, made by
`fields.option`, say all the rest (meaning, unit, what is allowed), so that reading, checking and
help need no second list.

Units: lengths along the interface in beta = (R^2 phi_n / E*)^(1/3), normal displacements in u_n,r =
beta^2 / R, tangential ones in u_t,r = sqrt(phi_t / phi_n) u_n,r. With these, the range of the law
is delta_n = u_n,r / normal_maugis and delta_t = u_t,r / tangential_maugis.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import ClassVar

from ..continuation.predictors import PREDICTORS, in_words
from ..interface import laws, shapes
from ..interface.laws import LAWS
from ..options.fields import InputError, Options, as_text, declare, extend, option
from . import isolation, traction
from .load import Load
from .resolution import default_spacing
from .units import Units


@dataclass(frozen=True)
class Scene(Units):
    """Body, interface and grid: everything but the load.

    Parameters are the ``-scene_*`` options, dimensionless (module docstring) even where units is
    'si', for then `Scene.typed` takes them as they are typed; InputError where they are not
    allowed.
    """

    prefix: ClassVar[str] = "scene_"
    title: ClassVar[str] = "Scene: body, interface and grid"
    dimension: int = option(1, "dimension of the interface", choices=(1, 2))
    points: int | tuple | str = option(None, "grid points of the cell; auto: for -scene_accuracy",
                                       kind="integer", minimum=16, even=True, many="directions",
                                       word="auto", default_text="8192 (two dimensions: 512,512)")
    accuracy: float = option(1e-6, "relative accuracy of force and contact area "
                             "that -scene_points auto aims at", above=0, below=1)
    period: float | tuple = option(100.0, "length of the periodic cell; inf: an "
                                   "isolated cylinder (one dimension) or sphere",
                                   "beta", above=0, many="directions", infinite=True)
    spacing: float | tuple = option(None, "distance of the nodes of an isolated contact", "beta",
                                    kind="number", above=0, many="directions",
                                    default_text="resolves the cohesive zone")
    geometry: str = option("cylinder", "initial gap: cylinder x^2/2 (in two "
                           "dimensions along y), sphere r^2/2, sinusoid A (1 "
                           "- cos 2 pi x/L) summed over the directions, "
                           "flat 0, file -scene_geometry_file, rough: cylinder "
                           "(two dimensions: sphere) with self-affine roughness",
                           choices=("cylinder", "sphere", "sinusoid", "flat", "file", "rough"))
    amplitude: float = option(None, "A of the sinusoid", "u_n,r", kind="number", above=0,
                              default_text="(L/2 pi)^2, of curvature 1")
    geometry_file: str = option("", "heights on the grid, highest = nearest the "
                                "flat: FILE.npy, FILE.txt or FILE.h5:dataset", "u_n,r")
    rough_hurst: float = option(0.8, "Hurst exponent H of roughness, whose power "
                                "spectrum falls as q^-(2H + dimension)", minimum=0,
                                maximum=1)
    rough_slope: float = option(None, "root mean square slope of roughness", "u_n,r/beta",
                                kind="number", above=0, default_text="none: rough needs it")
    rough_longest: float = option(None, "longest wave of roughness", "beta", kind="number", above=0,
                                  default_text="the shortest period")
    rough_shortest: float = option(None, "length that all waves of roughness are longer than",
                                   "beta", kind="number", above=0,
                                   default_text="none: rough needs it")
    rough_seed: int = option(0, "seed of the phases of roughness", minimum=0, maximum=2 ** 32 - 1)
    gap_offset: float = option(0.0, "constant added to the initial gap", "u_n,r")
    law: str = option("modified", "tractions: " + ", ".join(f"{name} ({law.meaning})"
                                                            for name, law in LAWS.items()),
                      choices=tuple(LAWS), word="FILE.py:NAME, a class of one's own",
                      also=lambda name: name in laws.OBJECTS or name in laws.OWN)
    normal_maugis: float = option(10.0, "lambda_n: u_n,r over the normal range of the law", above=0)
    tangential_maugis: float = option(1.0, "lambda_t: u_t,r over the tangential range of the law",
                                      above=0)
    work_ratio: float = option(1.0, "tangential over normal work of adhesion; "
                               "enters with elastic coupling, and in energies",
                               above=0)
    poisson: float = option(0.5, "Poisson ratio", minimum=0, maximum=0.5)
    height: float = option(2000.0, "height of the layer", "beta", above=0, infinite=True)
    tangential: str = option("auto", "tangential unknowns: auto (in legs whose "
                             "load or coupling needs them), on, off",
                             choices=("auto", "on", "off"))
    contact_threshold: float = option(2.718281828, "contact is where the gap is below this",
                                      "delta_n", above=0)

    def __new__(cls, *values, **named):
        """A scene that is yet to be filled, which has the options of its law."""
        traction.admit(cls, named.get("law") or "")
        return super().__new__(cls)

    @classmethod
    def prepare(cls, entries):
        """The options of a law in a file of one's own are known before they are read."""
        traction.admit(cls, entries().get("scene_law", ""))

    def __post_init__(self):
        super().__post_init__()
        traction.check(self)
        for name in ("points", "period", "spacing"):
            if self.dimension == 1 and isinstance(getattr(self, name), tuple):
                raise InputError(f"-scene_{name} is '{as_text(self.as_typed(name))}': "
                                 "one dimension takes one number; give one, "
                                 "or -scene_dimension 2")
        isolation.check_scene(self)
        shapes.check_scene(self)

    @property
    def roughness(self):
        """Hurst exponent, rms slope, longest and shortest wave, and seed of a rough geometry
        (u_n,r, beta); None of another."""
        if self.geometry != "rough":
            return None
        longest = min(self.periods) if self.rough_longest is None else self.rough_longest
        return self.rough_hurst, self.rough_slope, longest, self.rough_shortest, self.rough_seed

    @property
    def components(self):
        """Components of a displacement, the normal one first; where tangential unknowns appear:
        `tangential_legs`."""
        return 1 + self.dimension

    @property
    def shape(self):
        """Grid points in each direction, a tuple; ValueError where they have yet to be chosen
        (``grid_choice.chosen``)."""
        if self.points == "auto":
            raise ValueError("the points of this scene have yet to be chosen")
        points = self.points or {1: 8192, 2: 512}[self.dimension]
        return points if isinstance(points, tuple) else (points,) * self.dimension

    @property
    def periods(self):
        """Length of the cell in each direction, a tuple, in beta."""
        return self.period if isinstance(self.period, tuple) else (self.period,) * self.dimension

    @property
    def isolated(self):
        """Whether the contact is the only one: no cell, no period."""
        return math.inf in self.periods

    @property
    def spacings(self):
        """Distance of the nodes in each direction, a tuple, in beta."""
        if self.isolated:
            spacing = self.spacing or default_spacing(self)
            return spacing if isinstance(spacing, tuple) else (spacing,) * self.dimension
        return tuple(period / points for period, points in zip(self.periods, self.shape))

    @property
    def amplitudes(self):
        """Amplitude of the sinusoid in each direction, a tuple, in u_n,r."""
        return tuple((period / (2 * math.pi)) ** 2 if self.amplitude is None else self.amplitude
                     for period in self.periods)

    @property
    def ranges(self):
        """Maugis parameter of each component (displacement in ranges of the law = this times the
        scaled one), a tuple."""
        return (self.normal_maugis,) + (self.tangential_maugis,) * self.dimension

    @property
    def contact_gap(self):
        """Gap below which there is contact, in u_n,r."""
        return self.contact_threshold / self.normal_maugis

    @property
    def coupled(self):
        """Whether the body couples normal and tangential displacements by more than rounding.

        At Poisson ratio 1/2 the coupling is k^2/sinh(k)^2 of the diagonal, k = 2 pi H/L, so only
        thin layers have it.
        """
        if self.isolated:
            return self.poisson < 0.5 or isolation.strains(self)
        k = 2 * math.pi * self.height / max(self.periods)
        return self.poisson < 0.5 or (k < 30 and (k / math.sinh(k)) ** 2 > 1e-16)


extend(Scene, laws.OPTIONS)


@dataclass(frozen=True)
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
    window: str = option("auto", "auto: nodes within the range of the law, in "
                         "several boxes where that is cheaper, enlarged on "
                         "demand; off: the whole cell", choices=("auto", "off"))
    symmetry: str = option("auto", "states even about the apex on half the "
                           "line or a quarter of the plane: auto (where "
                           "gap, body, load, state and method allow it), "
                           "even (an error where they do not), off",
                           choices=("auto", "even", "off"))


@dataclass(frozen=True)
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
        lists = [name for name in self._NAMES if isinstance(getattr(self, name), tuple)]
        if len({len(getattr(self, name)) for name in lists}) > 1:
            raise InputError(
                " and ".join(f"-continuation_{name} is '{as_text(getattr(self, name))}'"
                             for name in lists)
                + ": lists of steps have one length, one number per leg")
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


@dataclass(frozen=True)
class Output(Options):
    """The archive: the ``-archive_*`` options."""

    prefix: ClassVar[str] = "archive_"
    title: ClassVar[str] = "Archive"
    file: str = option("", "HDF5 file for the points of the branch",
                       default_text="none: nothing is written")
    fields: str = option("none", "displacements and tractions kept: none, last point, all points",
                         choices=("none", "last", "all"))
    errors: bool = option(False, "estimate the errors of every point by solving "
                          "it again on a finer grid (-scene_points auto "
                          "does so anyway)")
    resume: bool = option(False, "go on from an archive of the same scene")
    overwrite: bool = option(False, "replace an existing archive")

    def __post_init__(self):
        super().__post_init__()
        if self.resume and self.overwrite:
            raise InputError(
                "-archive_resume and -archive_overwrite exclude each other: give one of them")


OPTION_CLASSES = declare(Scene, Form, Load, Steps, Output)


def check(scene, load, steps=Steps()):
    """InputError unless load path and steps fit the scene. A path that is not set is not missed
    here."""
    if scene.isolated:
        isolation.check_load(scene, load)
    shapes.check_grid(scene)
    sheared = _sheared(scene, load)
    if scene.tangential == "off" and any(sheared):
        text = [load.start or "", *load.path.split(";")][sheared.index(True)].strip()
        raise InputError("-scene_tangential is 'off', but the load has "
                         f"'{text}': allowed are auto and on, or a load "
                         "without tangential quantities")
    if load.path and steps.legs not in (None, len(sheared) - 1):
        raise InputError(f"the steps of -continuation_ are for {steps.legs} legs, "
                         f"-load_path has {len(sheared) - 1}: give one number, "
                         "or one per leg")


def _sheared(scene, load):
    """Whether the start and each leg name a tangential quantity (at the start: other than what
    holds without), a list."""
    initial = load.initial(scene.dimension, scene.isolated)
    resting = "force" if scene.isolated else "displacement"
    legs = load.legs(scene.dimension) if load.path else ()
    return [any(control != (resting, 0.0) for component, control in initial.items() if component),
            *(max(leg.controls) > 0 for leg in legs)]


def tangential_legs(scene, load):
    """Whether tangential unknowns appear at the start (first entry) and in each leg, a tuple of
    bool.

    With -scene_tangential auto: everywhere if the body couples the components, else from the first
    leg on that names a tangential quantity.
    """
    everywhere = scene.tangential == "on" or scene.coupled or isolation.slides(scene, load)
    sheared = _sheared(scene, load)
    return tuple(scene.tangential != "off" and (everywhere or any(sheared[:leg + 1]))
                 for leg in range(len(sheared)))


def ineffective(scene, load, names, form=Form(), output=Output(), estimates=False):
    """Options among `names` (without dash, as in 'scene_poisson') that change nothing here: list of
    (name, why).

    `estimates`: whether the errors of points are estimated.
    """
    sheared = any(tangential_legs(scene, load))
    unsheared = "no tangential unknown appears"
    rules = (*traction.ineffective(scene, sheared), ("scene_tangential_maugis", not sheared,
                                                     unsheared),
             ("scene_work_ratio", not sheared, unsheared),
             ("scene_amplitude", scene.geometry != "sinusoid", f"the geometry is {scene.geometry}"),
             *((f"scene_rough_{name}", scene.geometry != "rough",
                f"the geometry is {scene.geometry}") for name in ("hurst", "slope", "longest",
                                                                  "shortest", "seed")),
             ("scene_geometry_file", scene.geometry != "file", f"the geometry is {scene.geometry}"),
             ("scene_accuracy", not estimates, "the points are given, and no errors are estimated"),
             ("contact_cascade", scene.isolated and not load.start,
              "the path begins without a contact"), ("contact_window", form.form == "force",
                                                     "the force form is solved on the whole cell"),
             ("contact_cascade", form.form == "force",
              "the force form is solved on the whole cell"), ("archive_fields", not output.file,
                                                              "there is no -archive_file"),
             ("archive_resume", not output.file, "there is no -archive_file"),
             ("archive_overwrite", not output.file, "there is no -archive_file"))
    found = {}
    for name, without_effect, why in rules:
        if without_effect and name in names:
            found.setdefault(name, why)
    return list(found.items())


def attributes(scene):
    """Name -> value of a scene for the archive, as it is typed, with defaults filled in; two
    directions give a tuple."""
    values = {field.name: scene.as_typed(field.name) for field in dataclasses.fields(scene)
              if field.name not in traction.untold(scene)}
    grid = (("spacing", scene.spacings),) if scene.isolated else (("points", scene.shape),
                                                                  ("amplitude", scene.amplitudes))
    for name, directions in (("period", scene.periods), *grid):
        values[name] = scene.told(directions if scene.dimension == 2 else directions[0],
                                  Scene.rule(name)["unit"])
    del values["accuracy"]  # an aim, which a run that is resumed may change
    if scene.roughness:
        values["rough_longest"] = scene.told(scene.roughness[2], "beta")
    homes = {"amplitude": "sinusoid", "geometry_file": "file"} | {name: "rough" for name in values
                                                                  if name.startswith("rough_")}
    return {name: value for name, value in values.items() if value is not None
            and scene.geometry == homes.get(name, scene.geometry)}
