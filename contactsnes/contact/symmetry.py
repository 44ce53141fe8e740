"""When states are taken for even or odd about the apex: where the contact and its loads are, and
the method allows it, until a state is not."""

from functools import cache, partial

from ..grid.clusters import cost
from ..grid.even import halved
from ..grid.mirrors import centred, lone, unlike
from ..grid.parity import asymmetry, obstacle, one_mirror
from ..grid.parity import parities as parities_of
from ..options.fields import InputError
from .even_form import EvenForm
from .force_form import FORMS
from .forms import DisplacementForm
from .state import State, onto, spread
from .states import normal_gap

EVEN = 1e-6
"""Largest difference of mirror images in a state that counts as even or odd, ranges of the law."""
NEGLIGIBLE = 1e-12
"""Load on a component, over the largest (at least 1), that counts as none: a force that is held may
be the sum of what cancels."""


class Symmetry:
    """Whether the solves of a corrector take states for even, or their components for odd: where
    contact, loads and method allow it, until a state is not.

    Parameters
    ----------
    contact : Contact
    settings : Form, with ``symmetry`` 'auto', 'even' or 'off'
    method : Capabilities of the type of SNES
    log : function (sentence)
    """

    def __init__(self, contact, settings, method, log):
        self.contact = contact
        self.log = log
        self.asked = settings.symmetry == "even"
        self._half = None  # the last window of states made even
        self._loaded = frozenset()  # tangential components on which loads have acted
        self.wanted = settings.symmetry != "off" and method_obstacle(settings, method) is None
        self._told = cache(partial(_told, contact))

    def loaded_by(self, *loads):
        """Take notice of loads (components) that act from now on."""
        for load in loads:
            sizes = [abs(float(value)) for value in load]
            self._loaded |= {i for i, size in enumerate(sizes)
                             if i and size > NEGLIGIBLE * max(1.0, *sizes)}

    def holds(self, components):
        """Whether states with so many components are taken for even or odd."""
        return self.wanted and self._told(components, self._loaded)[0]

    def scatters(self, components):
        """Whether solves with so many components are on some nodes of the plane instead of boxes:
        where processes share out the cell, these are for states with mirrors alone."""
        return self.contact.scattered and not (self.contact.grid.shared
                                               and self.parities(components) is not None)

    def parities(self, components):
        """Those of so many components, of `parity.parities`, or, where states have one mirror of
        two, of `parity.one_mirror`; None where they have none."""
        return self._told(components, self._loaded)[1] if self.wanted else None

    def plain(self, components):
        """Whether all of so many components are taken for even in all directions."""
        found = self.parities(components)
        return found is not None and unlike(found) is None

    def checked(self, state):
        """The state; if it is not even where it should be, no state is taken for even from now
        on."""
        count = state.components
        if self.parities(count) is None or self._is_known(state):
            return state
        if not self._is_even(state):
            self.leave("the state is not even about the apex")
            return state
        half = self.half_of(state.window, count)
        return state if half is None else spread(half, half.fold(state.displacement), state.means)

    def _is_known(self, state):
        """Whether a state is one of those that are even or odd as states are taken now."""
        return (state.half is not None
                and state.half.parities == unlike(self.parities(state.components)))

    def _is_even(self, state):
        """Whether mirror images in a state are alike, and the law acts where there is one only
        nowhere."""
        if not asymmetry(state.window, state.displacement,
                         self.parities(state.components)) <= EVEN:
            return False
        if centred(state.window) == state.window:
            return True
        unpaired = lone(state.window, self.parities(state.components))
        return self.contact.grid.minimum(normal_gap(self.contact, state),
                                         where=unpaired) >= self.contact.law.certain

    def leave(self, why):
        """Take no state for even from now on, for a reason in words."""
        self.wanted = False
        self.log(f"{why}: going on without symmetry")

    def centred(self, state):
        """The state on a centred window, if it is taken for even: half of one box, in place of
        several where that is cheaper."""
        state = self.checked(state)
        if state.half is not None:
            return state
        even = self.parities(state.components) is not None
        window = centred(state.window) if even else state.window
        if (len(window.parts) < len(state.window.parts) and not self.asked
            and 2.0 * cost(state.window) < cost(window)):
            self.leave("boxes around the spots cost less than half of one window")
            return state
        if window == state.window:
            return state
        half = self.half_of(window, state.components)
        if half is None:
            return State(window, onto(state, window), state.means)
        return spread(half, half.fold(onto(state, window)), state.means)

    def mirrored(self, state):
        """A state predicted from even ones, or None, made even: places of the cell's first node
        have no mirror image."""
        if state is None or self.parities(state.components) is None or self._is_known(state):
            return state
        window = centred(state.window)
        half = self._folded(window, state.components)
        return spread(half, half.fold(onto(state, window)), state.means)

    def half_of(self, window, components):
        """The EvenWindow of a window on which states with so many components are taken for even;
        None of another."""
        return (self._folded(window, components)
                if self.holds(components) and centred(window) == window else None)

    def _folded(self, window, components):
        """The EvenWindow of a centred window for so many components; the last one is kept."""
        made = window, self.parities(components)
        if self._half is None or self._half[0] != made:
            self._half = made, halved(*made)
        return self._half[1]

    def form(self, components):
        """The class of displacement forms for states with so many components."""
        return DisplacementForm if self.parities(components) is None else EvenForm


def _told(contact, components, loaded):
    """(whether states with so many components are even or odd in all directions, their parities
    where they are so in one at least).

    Parameters
    ----------
    contact, components, loaded : as of `parity.obstacle`
    """
    if obstacle(contact, components, loaded) is not None:
        return False, one_mirror(contact, components, loaded)
    return True, parities_of(contact.operator(components), components, loaded)


def method_obstacle(settings, method):
    """Why a form of the equations, or a type of SNES on it, does not use even states, in words;
    None if it does."""
    if FORMS[settings.form].whole_cell and not method.is_relaxation:
        return f"the {settings.form} form is solved on the whole cell, but by dynamic relaxation"
    return (None if method.keeps_evenness
            else f"the method (-snes_type {method.name}) is neither Newton's nor a relaxation")


def refuse(contact, sheared, loaded, settings, method):
    """InputError where symmetry is asked for and a leg has none.

    Parameters
    ----------
    contact : Contact
    sheared : whether tangential unknowns appear at the start and in each leg
    loaded : the tangential components that have been loaded there, sets
    settings : Form
    method : Capabilities of the type of SNES
    """
    if settings.symmetry != "even":
        return
    why = obstacles(contact, sheared, loaded, settings, method)
    if any(why):
        raise InputError(f"-contact_symmetry is 'even', but {next(filter(None, why))}: "
                         "allowed here are auto and off")


def obstacles(contact, sheared, loaded, settings, method):
    """Why states are not taken for even at the start and in each leg, in words or None where they
    are, a list.

    Parameters
    ----------
    contact, sheared, loaded, settings, method : as of `refuse`
    """
    why = method_obstacle(settings, method)
    return [why or obstacle(contact, contact.scene.components if tangential else 1, along)
            for tangential, along in zip(sheared, loaded)]


def has_one_mirror(contact, loaded, settings, method):
    """Whether sheared states are taken for even or odd in one direction of two.

    Parameters
    ----------
    contact, settings, method : as of `refuse`
    loaded : the tangential components that have been loaded
    """
    return (method_obstacle(settings, method) is None
            and one_mirror(contact, contact.scene.components, loaded) is not None)
