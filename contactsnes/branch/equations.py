"""The equations that solves are of: the window, the form on it and its SNES, kept as long as they
serve."""

from ..contact import states
from ..contact.force_form import FORMS
from ..contact.scattered import boxed, on_nodes
from ..contact.symmetry import Symmetry
from ..grid.boxes import in_words
from ..solvers.capabilities import asked
from ..solvers.krylov import large
from ..solvers.patience import Patience
from ..solvers.precision import pays
from ..solvers.snes import create_snes
from ..solvers.vectors import collect


class Equations:
    """The form on a state's window, and its SNES, each made when a solve asks for another one.

    Parameters
    ----------
    contact : Contact
    settings : Form (options ``-contact_*``)
    log : function (sentence), for what a user should know about a run
    tolerance : of the residual norm, if not the one of -snes_atol

    Attributes
    ----------
    form, snes : those of the last solve, or None
    arc : the form with the arc length, and its SNES, while the form stays, or None
    boxes : int, of the last window that was told
    """

    prefix = ""  # of the options of its SNES

    def __init__(self, contact, settings, log=lambda sentence: None, tolerance=None):
        self.contact = contact
        self.settings = settings
        self.log = log
        self.tolerance = tolerance
        self.form = self.snes = self.arc = None
        self.patience = Patience()
        self.boxes = 1
        self.symmetry = Symmetry(contact, settings, asked(), log)

    def fitted(self, state, afresh=False):
        """The state on the window that the settings and the law ask for, ``afresh`` where its own
        will not do."""
        widest = self.contact.widest
        whole = self.settings.window == "off" or FORMS[self.settings.form].whole_cell
        if not whole:
            # Coarser grids for the full approximation scheme are made of one box.
            scatters = (self.symmetry.scatters(state.components)
                        and not asked().one_window)
            state = (on_nodes(self.contact, state, afresh) if scatters
                     else states.fitted(self.contact, boxed(self.contact, state), afresh))
            whole = len(state.window.parts) > 1 and asked().one_window
        if whole and state.window != widest:
            state = states.State(widest, widest.take(self.contact.extended(state)), state.means)
        return self.symmetry.centred(state)

    def form_on(self, guess, controls):
        """The form on the guess's window, as of `bare_form`, with its SNES, kept as it is."""
        form = self.bare_form(guess, controls)
        if self.snes is None:
            self.make_room()
            self.snes = create_snes(form, self.prefix, self.tolerance,
                                    pays(form, self.settings.linear_precision))
            self.patience.watch(self.snes, self.contact)
        return form

    def bare_form(self, guess, controls):
        """The form on the guess's window, kept while window and controls stay; of a new one there
        is no SNES yet."""
        kept = self.form
        kind = FORMS[self.settings.form]
        kind = kind if kind.whole_cell else self.symmetry.form(len(controls))
        parities = None if kind.whole_cell else self.symmetry.parities(len(controls))
        if (type(kept) is not kind or kept.window != guess.window
            or kept.controls != tuple(controls) or kept.parities != parities):
            if len(guess.window.parts) != self.boxes:
                self.boxes = len(guess.window.parts)
                self.log(in_words(guess.window))
            kept = None
            self.release()  # the old one's memory is the new one's
            half = guess.half if self.symmetry.holds(len(controls)) else None
            self.form = kind(self.contact, *(() if kind.whole_cell else (guess.window,)),
                             controls, *([parities, half] if parities else []))
        if kind.whole_cell:
            self.form.even = self.symmetry.plain(len(controls))
        return self.form

    def make_room(self, whole=False):
        """Give back a large form's SNES, with the arc length or without, and, as a ``whole``, the
        form: each takes as much memory as what comes next."""
        if self.form is not None and large(self.form):
            self.snes = self.arc = None
            self.release() if whole else collect(True)

    def release(self):
        """Give back the form and its SNES, whose memory others take, until a solve asks for
        them."""
        much = self.form is not None and large(self.form)
        self.form = self.snes = self.arc = None
        if much:
            self.contact.circle.cache_clear()
        collect(much)
