"""The base of traction-separation laws: what a law declares, what is asked of it, and defaults of
the rest.

Gaps and tractions are in ranges of the law: a = g_n / delta_n, b = |g_t| / delta_t, tractions in
phi_n / delta_n and phi_t / delta_t. Arrays have the shape (components, nodes): the normal component
first, then one or two tangential ones. Attraction is positive: the traction on the body is the
negative of the law's.
"""

from functools import cached_property

import numpy as np

from ..declared import Declared
from ..formula import Formula, Tractions
from ..law_measures import certain_gap, slipped, softening

MADE = ("formula", "_evaluated", "evaluate", "normal")
"""Attributes that are made of all others: a formula, its programs, and compiled ones in their
place."""
MEASURED = ("_opened", "_slipped", "certain", "_coupled_softenings")
"""Those that are measured of the tractions, once."""


def slip_of(gap):
    """Size of the slip (nodes) of gaps (components, nodes), two components at least."""
    return np.abs(gap[1]) if len(gap) == 2 else np.sqrt(np.square(gap[1:]).sum(axis=0))


class Law(Declared):
    """A traction-separation law without memory: tractions follow from the gaps at a node, whatever
    came before.

    A subclass is made a dataclass when it is defined. Its options are class attributes made by
    `options.fields.option`, ``-scene_`` + their names, and its parameters from Python. It has to
    have ``tractions``, or ``evaluate`` in place of it; tractions vanish at no gap and no slip,
    attract without slip where a > 0, but for a ``barrier``, and repel where a < 0. All else has
    defaults: what follows from the tractions is found from them by sampling.

    Attributes
    ----------
    name : what ``-scene_law`` calls it; a class of its own file in this folder without one is a
        base of others
    meaning : what the help says of it
    slip_options : names of options that change nothing without slip
    range : normal gap, in ranges, beyond which the law counts as zero
    derived : names of properties that follow from the options by more than arithmetic (a root, an
        integral) and are numbers of ``tractions``
    deepest : normal gap, in ranges, below which tractions are only continued, linearly
    repulsion : overlap, in ranges, over which the repulsion grows by a factor e
    opening_range, slip_range : gap and slip, in ranges, within which it is sampled
    gap_corners, slip_corners : normal gaps and slips, in ranges, across which the tangent or its
        slope jumps
    odd : whether a slip the other way has the other traction, and the same normal one
    """

    slip_options, derived = (), ()
    range = 37.0
    deepest = -30.0
    repulsion = 1.0
    opening_range, slip_range = 5.0, 6.0
    gap_corners, slip_corners, odd = (), (), True
    spared = {"evaluate": lambda gap, traction, tangent=None: traction}

    def tractions(self, a, b):
        """Normal traction N(a, b) and the friction over the slip, T(a, b) / b, as expressions of
        NumPy from which derivatives are made.

        Parameters
        ----------
        a : array (nodes), normal gap in ranges, not below ``deepest``
        b : array (nodes), slip in ranges, at least 0: N and T / b are finite at b = 0

        Returns
        -------
        two arrays (nodes) or numbers, phi_n / delta_n and phi_t / delta_t
        """
        raise NotImplementedError(f"the law {type(self).__name__} has neither tractions(a, b) nor "
                                  "evaluate(gap, traction, tangent=None)")

    def evaluate(self, gap, traction, tangent=None):
        """Fill ``traction`` and, if given, ``tangent`` at once.

        ``traction`` may be ``gap`` itself. With one component there is no slip. The traction is
        returned.

        Parameters
        ----------
        gap : array (components, nodes), ranges of the law
        traction : array of the same shape, phi_n / delta_n and phi_t / delta_t; attraction positive
        tangent : array (components, components, nodes), dt_i / dg_j, dimensionless; None: not
            wanted
        """
        self._evaluated.evaluate(gap, traction, tangent)
        return traction

    @property
    def parameters(self):
        """Names of the numbers of ``tractions``: options, and what is derived from them."""
        return (*(name for name, field in self.declared().items()
                  if isinstance(field.default, float)), *self.derived)

    @cached_property
    def formula(self):
        """The Formula of the tractions; None of a law with an ``evaluate`` of its own."""
        return self._evaluated.formula if type(self).evaluate is Law.evaluate else None

    @cached_property
    def _evaluated(self):
        """The tractions' formula as programs."""
        if type(self).tractions is Law.tractions:
            self.tractions(None, None)
        return Tractions(Formula(self))

    def __setattr__(self, name, value):
        """Set an attribute; what was made, or measured, with its old value is forgotten."""
        super().__setattr__(name, value)
        for made in set(MADE if name in MADE else MADE + MEASURED) - {name}:
            vars(self).pop(made, None)

    def __getstate__(self):
        """What is copied and kept: not the formula, which is made again."""
        return {name: value for name, value in vars(self).items() if name not in MADE}

    def traction(self, gap, out=None):
        """Tractions t(g) at every node.

        Parameters
        ----------
        gap : array (components, nodes), ranges of the law
        out : array of the same shape, optional; filled and returned

        Returns
        -------
        array (components, nodes), phi_n / delta_n and phi_t / delta_t; attraction positive.
        """
        return self.evaluate(gap, np.empty_like(gap) if out is None else out)

    def tangent(self, gap, out=None):
        """Consistent tangent dt_i / dg_j, array (components, components, nodes), dimensionless."""
        count, nodes = gap.shape
        out = np.empty((count, count, nodes)) if out is None else out
        self.evaluate(gap, np.empty_like(gap), out)
        return out

    def normal(self, a):
        """N(a) and N'(a) without slip, two arrays like the normal gap a (nodes)."""
        if self.formula is not None:
            return self._evaluated.normal(np.ravel(a))
        traction, tangent = np.empty((1, np.size(a))), np.empty((1, 1, np.size(a)))
        self.evaluate(np.array(a, dtype=float).reshape(1, -1), traction, tangent)
        return traction[0], tangent[0, 0]

    def potential(self, gap, work_ratio=1.0):
        """Energy of the interface at every node, phi_n, zero where the surfaces are apart; None
        where there is no potential.

        Parameters
        ----------
        gap : array (components, nodes), ranges of the law
        work_ratio : phi_t / phi_n
        """
        return None

    # What follows from the tractions

    @cached_property
    def _opened(self):
        """Largest attraction without slip, its steepest fall, and largest repulsion where a > 0."""
        fine = 5001j if self.range > 37.0 else 0j  # a long range is coarse where the law is steep
        normal, slope = self.normal(np.r_[0.0:self.range:37001j, 0.0:self.opening_range:fine])
        return float(normal.max()), float(np.max(-slope)), float(max(np.max(-normal), 0.0))

    @cached_property
    def _slipped(self):
        """What `law_measures.slipped` finds."""
        return slipped(self)

    @property
    def normal_peak(self):
        """Largest adhesive traction without slip, phi_n / delta_n."""
        return self._opened[0]

    @property
    def barrier(self):
        """Largest repulsion without slip where a > 0, phi_n / delta_n: 0 unless the law has one."""
        return self._opened[2]

    @property
    def tangential_peak(self):
        """Largest tangential traction at no normal gap, phi_t / delta_t; 0 of Coulomb's."""
        return 0.0 if self._slipped.overlap else self._slipped.peak

    @property
    def friction_size(self):
        """The same or, where that is 0, the largest one in overlap; 1 without friction."""
        return self.tangential_peak or self._slipped.peak or 1.0

    @property
    def slip_peak(self):
        """Slip at the peak of the tangential traction, in ranges: beyond it a node has slipped."""
        return self._slipped.place

    @property
    def softening(self):
        """Steepest fall of the attraction with the opening, -dt_n/da, phi_n/delta_n^2."""
        return self._opened[1]

    @property
    def slip_softening(self):
        """Steepest fall of the friction with the slip, -dt_t/db, phi_t/delta_t^2."""
        return self._slipped.softening

    def coupled_softening(self, normal_maugis, tangential_maugis):
        """Steepest softening of gap and slip together: minus the smallest real eigenvalue of the
        scaled tangent where a > 0.

        Slip weakens adhesion and opening weakens friction: that alone softens. Units of E*/beta.
        """
        known = vars(self).setdefault("_coupled_softenings", {})
        if (normal_maugis, tangential_maugis) not in known:
            scale = np.array([normal_maugis, tangential_maugis])
            gaps = np.array(np.meshgrid(np.linspace(1e-9, self.opening_range, 201),
                                        np.linspace(0.0, 3.0, 121))).reshape(2, -1)
            tangent = self.tangent(gaps) * np.multiply.outer(scale, scale)[..., None]
            known[normal_maugis, tangential_maugis] = float(np.max(softening(tangent)))
        return known[normal_maugis, tangential_maugis]

    @cached_property
    def certain(self):
        """Normal gap, in ranges, that every node outside a window must have
        (`law_measures.certain_gap`)."""
        return certain_gap(self)

    @property
    def reach(self):
        """Normal gap of the nodes that a window takes, in ranges, more than ``certain``: outside of
        it nodes come within that only once they have moved."""
        return 37.0 * self.certain / 30.0

    # The regularised gap

    @property
    def moving_stiffness(self):
        """kappa of the regularised gap in which states are moved along a branch or from grid to
        grid, phi_n/delta_n^2."""
        return 1.5 * self.softening

    @property
    def newton_stiffness(self):
        """kappa of the regularised gap of Newton's steps by default, phi_n/delta_n^2."""
        return self.moving_stiffness

    def regularised(self, gap, stiffness):
        """w = a + N(a) / stiffness of a normal gap (nodes), ranges of the law: in overlap it is a
        traction, no logarithm of one; single-valued for a stiffness above ``softening``."""
        return gap + self.normal(gap)[0] / stiffness

    def gap_of_regularised(self, target, stiffness):
        """The normal gap a (nodes) with a + N(a) / stiffness = target, pointwise by a bracketed
        Newton iteration."""
        new = np.where(target < 0.0,
                       -self.repulsion * np.log1p(-stiffness * np.minimum(target, 0.0)), target)
        # a and w have one sign, and N(a) is at most its peak, at least minus its barrier where a >
        # 0, and negative in overlap: a lies between these.
        low = np.where(target > 0.0, target - self.normal_peak / stiffness, target)
        high = np.where(target > 0.0, target + self.barrier / stiffness, 0.0)
        nodes, now = np.arange(len(target)), new.copy()
        for _ in range(60):
            normal, slope = self.normal(now)
            excess = now + normal / stiffness - target
            low, high = np.where(excess < 0.0, now, low), np.where(excess > 0.0, now, high)
            trial = now - excess / (1.0 + slope / stiffness)
            trial = np.where((trial >= low) & (trial <= high), trial, 0.5 * (low + high))
            # Most nodes are done long before the last.
            going = ~(np.abs(trial - now) <= 1e-10 * (1.0 + np.abs(trial)))
            new[nodes] = trial
            if not going.any():
                break
            nodes, now, target, low, high = (values[going] for values in (nodes, trial, target, low,
                                                                          high))
        return new

    def regularised_step(self, gap, step, stiffness):
        """The step of the normal gap that is ``step`` to first order, but taken in w = a + N(a) /
        stiffness, which has no exponential in overlap: steps that would overshoot are moderate.

        Parameters
        ----------
        gap, step : arrays (nodes), ranges of the law
        stiffness : dimensionless, above ``softening``

        Returns
        -------
        array (nodes), ranges of the law
        """
        normal, slope = self.normal(gap)
        return self.gap_of_regularised(gap + normal / stiffness + (1.0 + slope / stiffness) * step,
                                       stiffness) - gap
