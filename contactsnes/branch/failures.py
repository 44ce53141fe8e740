"""Which points the grid resolves, and what stops a branch, in words."""

import math
import re
from functools import cache

import numpy as np
import scipy

from ..contact import states
from ..contact.balance import TOLERANCE, left_by_rounding
from ..continuation.points import NotConverged
from ..grid.spots import runs
from ..options.database import database
from ..scene.resolution import PINNING, resolution, resolution_of_states, resolution_warning
from .ends import of_law

NARROW = 20
"""Nodes over which a jump of the grid's own reaches at most: the cohesive zone of a resolved edge
has six."""
ROOMY = 1.0 / 3.0
"""``resolution`` up to which no edge sticks between nodes: what jumps there, however small it is,
is no work of the grid."""
CRITICAL = 0.05
"""Leading eigenvalue (over that of the free surface, 1) below which a state is next to a critical
point."""
SHORT_WAVES = 0.05
"""Part of the largest traction by which it may alternate from node to node where the grid resolves
it.

Measured on cylinders and spheres, Maugis parameters 1 to 10: at most 0.03 where the force is right
to 1 %, above it elsewhere.
"""
USUAL = 1e9
"""Numbers of scene and load up to this size, or down to its inverse, are no reason why a
computation should overflow."""
NUMBER = r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
"""What a number without its sign looks like in the text of an option."""
TRY = ("try smaller steps (-continuation_initial_step, -continuation_smallest_step) or "
       "another -continuation_predictor")
"""What to try where a solver failed."""

PASSED = ": a bifurcation was passed"
"""Why a last point is unstable, where its leg did not begin so."""

AT_START = "try another -load_start, and a leg from there"
"""What to try where there is no first point, to which no steps lead."""

CHOICE = re.compile("(snes|ksp|pc|snes_linesearch|ksp_norm)_type|ksp_pc_side")
"""Options of methods that a solve may fail with."""
USUAL_CHOICES = {("snes_type", "newtonls"), ("ksp_type", "fgmres"), ("ksp_type", "gmres"),
                 ("snes_linesearch_type", "basic")}
"""Those that are taken without being asked for."""


class Resolution:
    """Marks points in their order: whether the grid resolves them, or makes folds of its own.

    Parameters
    ----------
    contact : Contact
    log : function (sentence)
    last : Point before the first one, if any
    """

    def __init__(self, contact, log, last=None):
        self.contact = contact
        self.log = log
        self.last = last
        self._said = set()
        self._bound = cache(lambda sheared: max(resolution(contact.scene, sheared)))
        self._found = resolution_of_states(contact.scene)

    def marked(self, point):
        """The point with ``resolved``."""
        survey = self.contact.survey(point.state)
        # where a node has slipped past the law's peak, slip fronts are to be resolved, too
        sheared = survey.slip > self.contact.law.slip_peak
        bound = self._bound(len(point.controls) > 1)
        found = self._found(survey.steepest)
        jumped = (point.event == "jump" and self.last is not None and max(bound, found) > ROOMY
                  and narrow(self.contact, self.last.state, point.state))
        # Also on fine grids: a region that sticks may vanish over few nodes.
        crowded = point.event == "fold" and not point.resolved
        # Where it is steeper than it can be without overlap, the state has lost the margin that
        # spacings are judged by.
        sharpened = found > max(1.0, 1.05 * bound)
        alternating = survey.alternating
        coarse = alternating > SHORT_WAVES
        pinned = self._bound(sheared) > PINNING or sharpened
        self._tell(point, jumped, found if sharpened else None, crowded, pinned, sheared,
                   alternating)
        # a further event of a point is as much resolved as the point itself
        same = self.last is None or point.state is not self.last.state or self.last.resolved
        self.last = point.changed(resolved=int(point.resolved and same
                                               and not (jumped or pinned or coarse)))
        return self.last

    def _tell(self, point, jumped, sharpened, crowded, pinned, sheared, alternating):
        """Say why a point is not resolved.

        Parameters
        ----------
        point : Point
        jumped, crowded, pinned : whether a jump is the grid's, folds are too near to each other,
            and edges stick between nodes
        sharpened : steepest softening of the law, E*/beta, where the grid is too coarse for it;
            else None
        sheared : whether fronts of slip are to be resolved, too
        alternating : part of the largest traction that alternates from node to node
        """
        if jumped:
            self._say("jump", f"what a jump moved is nowhere wider than {NARROW} nodes: its fold "
                      "may be the grid's, where an edge of contact or "
                      "slip passes from node to node; see whether it "
                      "stays on a grid twice as fine")
        elif sharpened is not None:
            self._say("sharpened", "friction softens faster than the grid resolves, "
                      f"by {sharpened:.3g}, at "
                      f"{self.contact.scene.loads(point.controls, point.load)}: rims of "
                      "contact sink, and edges may stick between nodes; a "
                      "grid twice as fine goes farther")
        elif crowded:
            self._say("crowded", f"this fold ({point.fold_kind}) may be one of "
                      "several, which the grid makes of one: the branch "
                      "bends unevenly while an edge passes a node; see "
                      "how far it moves on a grid twice as fine")
        elif pinned and point.event == "fold":
            self._say("fold", f"this fold ({point.fold_kind}) may be the grid's: "
                              f"{resolution_warning(self.contact.scene, sheared)}")
        elif alternating > SHORT_WAVES and not pinned:
            self._say("coarse", "the traction alternates from node to node by "
                      f"{alternating:.2g} of its largest value, at "
                      f"{self.contact.scene.loads(point.controls, point.load)}: the grid does not "
                      "resolve it; take more -scene_points")

    def _say(self, kind, sentence):
        """Log a sentence, once of each kind."""
        if kind not in self._said:
            self._said.add(kind)
            self.log(sentence)


def narrow(contact, before, after):
    """Whether what changed from one state to another, by half of the most or more, is nowhere wider
    than `NARROW` nodes.

    Parameters
    ----------
    contact : Contact
    before, after : State
    """
    window = max(before.window, after.window, key=lambda window: window.total)
    first, last = states.onto(before, window), states.onto(after, window)
    change = np.linalg.norm(last - first, axis=0)
    change[np.minimum(first[0], last[0]) + window.take(contact.initial_gap) > states.NEAR] = 0.0
    changed = change > 0.5 * contact.grid.maximum(change, initial=0.0)
    grid, part = contact.grid, window.parts[0]
    boxes = window.box(changed).reshape(len(window.parts), *part.shape)
    if len(grid.shape) == 1:
        total = grid.size if window.is_whole else math.inf
        widths = [runs(np.flatnonzero(box), total) for box in boxes]
        return grid.any(changed) and bool(np.concatenate(widths).max() < NARROW - 1)
    boxes = part.with_rows(boxes, NARROW)
    # what goes around the cell has more on its other side (rows of processes have it already)
    around = [(0, 0)] + [(NARROW * (closed and not (grid.shared and axis == 0)),) * 2
                         for axis, closed in enumerate(part.closed)]
    boxes = np.pad(boxes, around, mode="wrap")
    depths = [_deepest(box, around[1:], grid) for box in boxes]
    return grid.any(changed) and bool(2.0 * max(depths) < NARROW)


def _deepest(mask, around, grid):
    """Largest distance of a node of a mask on a plane from those where it does not hold, in nodes.

    Parameters
    ----------
    mask : array of bool, with nodes around those that are asked for
    around : how many of these, before and after in each direction, besides rows of processes
    grid : Grid
    """
    depth = scipy.ndimage.distance_transform_edt(np.pad(mask, 1))[1:-1, 1:-1]
    asked = tuple(slice(before, count - after) for count, (before, after)
                  in zip(depth.shape, around))
    return grid.maximum(grid.without_rows(depth[asked], NARROW))


def way_out(general=TRY):
    """What to try where a solver failed: first of all without methods of the user's choice, then
    what is of use in ``general``."""
    chosen = [f"-{name} {text}" for name, text in database().items()
              if CHOICE.fullmatch(name) and text != "python" and (name, text) not in USUAL_CHOICES]
    return f"try without {' '.join(chosen)}, or {general[4:]}" if chosen else general


def beyond_rounding(contact, last):
    """What there is to say where -snes_atol asks for less than rounding leaves; else an empty text.

    Parameters
    ----------
    contact : Contact
    last : Point, the last one; None before the first
    """
    asked = float(database().get("snes_atol", TOLERANCE))
    left = 4.0 * np.finfo(float).eps
    if last is not None:
        left = max(left, left_by_rounding(contact, last.state, last.controls, last.load))
    if asked >= left:
        return ""
    size = "" if last is None else (
        f" of displacements of {contact.grid.maximum(np.abs(last.state.displacement)):.2g} ranges "
        "of the law")
    return (f"-snes_atol {asked:g} is below what rounding leaves{size}, about {left:.0e}: try "
            f"{100.0 * left:.0e}")


def explained(error, contact, sheared, modes, last=None, since=PASSED,
              others=(), nearly=lambda: None):
    """A NotConverged that says what the failure of a path is, and what to try.

    Parameters
    ----------
    error : NotConverged
    contact : Contact
    sheared : whether the path has tangential unknowns
    modes : function () -> modes of the last point (`stability.Stability.modes`), None without a
        point or a tangent
    last : Point, the last one, if any
    since : why it is unstable, where it is (``Remarks.unstable_since``)
    others : options of other ways past a fold
    nearly : function () -> Point near the first one, which is not there; None without any
    """
    told = beyond_rounding(contact, last or nearly()) or of_law(contact, last)
    if told:
        return NotConverged(f"{error}; {told}")
    scene, softest = contact.scene, critical(contact, sheared)
    if max(resolution(scene, sheared)) > PINNING:
        return NotConverged(f"{error}; the grid is too coarse, edges stick "
                            f"between nodes: {resolution_warning(scene, sheared)}")
    try:
        found = modes()
    except (RuntimeError, ArithmeticError, ValueError):
        found = None
    if found is None:
        return NotConverged(f"{error}; a failure of the solver: "
                            f"{way_out(TRY if last else AT_START)}")
    told = f"leading eigenvalue {found.leading.real:.3g}"
    if found.unstable:
        why = f"unstable ({found.unstable} modes, {told}){since}"
    elif found.leading.real < softest:
        why = (f"stable, but hardly ({told}): a fold or a bifurcation is next to it; try "
               + ", or ".join(("smaller steps", *others)))
    else:
        why = f"stable ({told}), and no fold was found: a failure of the solver; {way_out()}"
    return NotConverged(f"{error}; the last point is {why}")


def critical(contact, sheared):
    """Leading eigenvalue below which a state is next to a critical point: less than a tall layer
    alone gives its mean."""
    components = contact.scene.components if sheared else 1
    give = contact.rigid_compliance(components) * contact.mean_mass(components)
    return CRITICAL / max(1.0, 0.2 * give.max())


def uncomputable(error, options):
    """Exit status and sentence on an overflow, an ArithmeticError: bad input only where numbers
    that were given are extreme.

    Parameters
    ----------
    error : ArithmeticError
    options : name -> text of all options
    """
    given = {name: [number for number in re.findall(NUMBER, text) if float(number)
                    and not 1.0 / USUAL <= float(number) <= USUAL] for name, text in options.items()
             if name.startswith(("scene_", "load_"))}
    extreme = "; ".join(f"-{name} {', '.join(numbers)}" for name, numbers in given.items()
                        if numbers)
    if extreme:
        return (2, "numbers of the scene or the load are too large or "
                f"too small to compute with ({error}): {extreme}")
    return (1, "a number became too large or too small to compute with "
            f"on the way ({error}): a failure of the solver; {way_out()}")
