"""Each test of the program switched off in turn, in the process of one run: what the checker or the
comparison has to see.

Only `worker` plants, by replacing functions of the package after a fork; the package knows nothing
of it.
"""

from typing import Callable, NamedTuple

from .scenes import Scene


class Fault(NamedTuple):
    """A test that is switched off: how, the scene that shows it, and the variants that it is
    compared with.

    plant : function that replaces parts of the package
    scene : options
    variants : names of those that are run with the fault off (`judge.variants`); none: the checker
        alone
    steps : of each leg
    """

    plant: Callable
    scene: dict
    variants: tuple = ()
    steps: tuple = (0.5,)


LINE = {"scene_points": 128, "scene_period": 20, "scene_normal_maugis": 2, "scene_height": "inf"}
PRESSED = {**LINE, "load_start": "normal_displacement=-1", "load_path": "normal_displacement=1"}
SHEARED = {**LINE, "scene_poisson": 0.3, "scene_residual_friction": 0.5,
           "load_start": "normal_displacement=1", "load_path": "tangential_displacement=4"}
SNAPPING = {**LINE, "scene_points": 256, "scene_period": 30,
            "load_start": "normal_displacement=-5.115", "load_path": "normal_displacement=0.216"}
RELEASED = {**LINE, "load_start": "normal_displacement=1", "load_path": "normal_displacement=-5"}


def _steps():
    """Every step that converged is accepted."""
    from contactsnes.continuation.natural import NaturalSteps

    def step(self, target, predictor, guess=None):
        from dataclasses import replace

        from contactsnes.continuation.load_steps import predict

        guess = guess or predict(self.system, self.history, self.leg, target, predictor)
        return replace(self.system.solve(guess, self.leg.controls, self.leg.load(target), 60),
                       leg=self.leg.number, position=target)

    NaturalSteps._step = step


def _residual():
    """A point is what a loose solver leaves, and told as converged."""
    from contactsnes.branch import corrector, equations
    from contactsnes.solvers import snes

    create = snes.create_snes

    def loose(form, prefix="", tolerance=None, *options):
        found = create(form, prefix, tolerance, *options)
        found.setTolerances(atol=1e-4)
        return found

    equations.create_snes = loose
    point = corrector.Corrector._point

    def told(self, form, state, imbalance, *rest):
        return point(self, form, state, imbalance._replace(norm=1e-9, largest=1e-9), *rest)

    corrector.Corrector._point = told


def _trust():
    """The solver's own residual is believed, whatever it leaves out."""
    from contactsnes.branch.corrector import Corrector
    from contactsnes.contact.balance import Imbalance

    def believed(self, form, state, snes):
        norm = min(snes.getFunctionNorm(), 1e-8)
        return Imbalance(norm, norm)

    Corrector._imbalance = believed


def _window():
    """The window stays as it is, whatever comes into the range of the law."""
    from contactsnes.branch.corrector import Corrector
    from contactsnes.contact import states

    fitted = Corrector.fitted

    def held(self, state, afresh=False):
        state = fitted(self, state, afresh)
        first = vars(self).setdefault("_first_window", state.window)
        return state if state.window == first else states.State(first, states.onto(state, first),
                                                                state.means)

    states.covers = lambda contact, state, closest=None: True
    Corrector.fitted = held


def _evenness():
    """Every state is taken for even."""
    from contactsnes.contact import symmetry as mirrored

    mirrored.obstacle = lambda contact, components, loaded=(): None
    mirrored.Symmetry._is_even = lambda self, state: True
    _trust()


def _events():
    """Gross sliding is not looked for."""
    from dataclasses import replace

    from contactsnes.branch.corrector import Corrector

    point = Corrector._point
    Corrector._point = lambda self, *arguments: replace(point(self, *arguments), sliding=False)


def _folds():
    """A fold is where the search for it begins."""
    from dataclasses import replace

    from contactsnes.continuation.limit_points import LimitPoint

    def locate(self):
        self._polished = lambda: self.left
        return replace(self._fold(False), fold_precision=1e-16)

    LimitPoint.locate = locate


def _jumps():
    """The energy that a jump loses is not counted."""
    from contactsnes.contact.energies import PathEnergies

    summed = PathEnergies._summed
    PathEnergies._summed = (lambda self, point, before, external, interface, lost, **others:
                            summed(self, point, before, external, interface, 0.0 * lost, **others))


def _law():
    """A law that repels a little too much."""
    from contactsnes.interface.laws.coupled import Coupled

    normal = Coupled._normal

    def wrong(self, a):
        value, held = normal(self, a)
        return 1.001 * value, held

    Coupled._normal = wrong


def _body():
    """A body whose normal and tangential directions couple with the wrong sign."""
    from contactsnes.interface import elasticity

    layer = elasticity.layer_compliance
    elasticity.layer_compliance = lambda *arguments: (lambda s: s._replace(coupling=-s.coupling))(
        layer(*arguments))


def _control():
    """Forces are told a little too large."""
    from contactsnes.contact import observables

    component = observables.Measurement.component
    observables.Measurement.component = (lambda self, values,
                                         index: 1.00001 * component(self, values, index))


def _area():
    """The edge of contact is put on the next node."""
    from contactsnes.contact.observables import Measurement

    Measurement.contact_area = lambda self: float(self.grid.node_area
                                                  * self.grid.count(self.in_contact))


WIDENING = {**LINE, "scene_points": 512, "scene_period": 40, "scene_normal_maugis": 4,
            "load_start": "normal_displacement=-1", "load_path": "normal_displacement=16"}
UNEVEN = {**LINE, "scene_geometry": "file", "scene_normal_maugis": 2, "scene_period": 12,
          "load_start": "normal_displacement=0", "load_path": "normal_displacement=1"}

FAULTS = {
    "acceptance of steps": Fault(_steps, SNAPPING, ("shorter steps",), (1.5,)),
    "residual": Fault(_residual, PRESSED),
    "growth of the window": Fault(_window, WIDENING, (), (4.0,)),
    "evenness": Fault(_evenness, UNEVEN),
    "events": Fault(_events, {**SHEARED, "load_path": "tangential_displacement=10"}, (), (2.0,)),
    "precision of folds": Fault(_folds, RELEASED, ("shorter steps",), (2.0,)),
    "energy of jumps": Fault(_jumps, SNAPPING, (), (1.5,)),
    "law": Fault(_law, {**PRESSED, "contact_kernels": "off"}),
    "coupling of the body": Fault(_body, SHEARED, (), (1.0,)),
    "forces": Fault(_control, PRESSED),
    "contact area": Fault(_area, PRESSED),
}
"""What is switched off, or wrong -> `Fault`."""


def plant(name):
    """Plant a fault in this process."""
    FAULTS[name].plant()


def scene(name):
    """The scene of a fault."""
    import numpy as np

    fault = FAULTS[name]
    waves = (np.array([[1, 1.0, 0.0], [2, 0.3, 0.7]]) if fault.scene.get("scene_geometry") == "file"
             else None)
    return Scene(0, list(FAULTS).index(name), dict(fault.scene), fault.steps, True, waves)
