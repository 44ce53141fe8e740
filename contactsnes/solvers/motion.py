"""Motion of the force form in Fourier space: masses, forces and what can be told of a state,
without PETSc.

The balance F(v) = 0 is reached as the rest of m v'' + m c v' = -F(v), with a mass m and a rate c
for each wave. The masses are stiffnesses: the body's, plus the law's reference tangent, so that the
fastest motion has about the frequency 1, the unit of time.
"""

from functools import cached_property

import numpy as np

from ..kernels.motion import twin
from .waves import CellWaves, EvenWaves, means, set_means, softest

RESTING = {1: 0.15, 2: 0.08}
"""Stiffness of the mean displacement of a body in contact over that of the softest wave, by
dimension of the interface (measured: 0.24 where a tenth of a line cell is in contact, less for
smaller contacts)."""


class Motion:
    """m mu v'' = -F(v) for the force form, all in Fourier space: two transforms a component for
    each force.

    It is followed on the nodes of half the line or a quarter of the plane where the form's states
    are ``even``, with the same masses, sums and norm. Compiled kernels do it where there are some;
    what is written here is NumPy's.

    m(q) = K(q) + tangent, and k_0 + tangent/2 for the mean (0 where it cannot move); K in ranges of
    the law. mu >= 1 keeps deep overlap stable: where the law's steepest tangent exceeds the
    reference, all masses grow so that the fastest frequency stays. When mu grows kinetic energy is
    kept, when it falls the velocity: no repulsion can throw the body off.

    Parameters
    ----------
    form : ForceForm with its load set
    masses : 'fourier' or 'equal' (then the largest m of the component for every wave)
    tangent : reference tangent, dimensionless

    Attributes
    ----------
    waves : CellWaves or EvenWaves
    kernel : the same motion on the same memory in the library, or None
    displacement, velocity, force, acceleration : spectra (components, *waves) of v, v', F and
        -F/(m mu), not normalised
    gap : array (components, nodes), ranges of the law
    stiffening : mu
    steps : number of steps since the beginning
    """

    def __init__(self, form, masses="fourier", tangent=2.0):
        self.form, self.waves = form, (EvenWaves if form.even else CellWaves)(form)
        self.grid, self.transform = self.waves.grid, self.waves.transform
        self.stiffness, spectrum = self.waves.stiffness, self.transform.spectrum
        self.displacement, self.velocity, self.force, self.acceleration = (np.zeros_like(spectrum)
                                                                           for _ in range(4))
        self._work = np.zeros_like(spectrum)
        self.gap = np.empty((form.components, self.waves.initial_gap.size))
        self.target = form.target()
        self.mobile = np.array([form.rigid_compliance[i] > 0.0 or i in form.forced
                                for i in range(form.components)])
        self.mass = self._masses(masses, tangent)
        self.mobility = 1.0 / np.where(self.mass > 0.0, self.mass, np.inf)
        self.reference, self.lightest = tangent, min(softest(self.grid, self.mass))
        self.harmless = self._harmless_gap()
        self.steps, self._stiffening, self._norm = 0, 1.0, form.norm_function()
        self.kernel = twin(self)

    @property
    def stiffening(self):
        """mu."""
        return self.kernel.structure.stiffening if self.kernel else self._stiffening

    @stiffening.setter
    def stiffening(self, stiffening):
        """Set mu."""
        if self.kernel:
            self.kernel.structure.stiffening = stiffening
        self._stiffening = stiffening

    def _masses(self, kind, tangent):
        """m(q) for each component, an array (components, *half spectrum)."""
        mass = self._own_stiffness() + tangent
        if kind == "equal":
            for part in mass:
                part[...] = self.grid.maximum(part)
            mean = means(self.grid, mass)
        else:
            mean = self.form.mean_stiffness + 0.5 * tangent
        set_means(self.grid, mass, mean * self.mobile)
        return mass

    def _harmless_gap(self):
        """Normal gap, at most 0, above which no slip makes the law's tangent exceed the
        reference."""
        gaps = np.linspace(-5.0, 0.0, 501)
        slips = self.form.contact.law.slip_peak * np.array([0.0, 0.5, 1.0, 2.0])
        probe = np.zeros((self.form.components, gaps.size, slips.size))
        probe[0], probe[1:2] = gaps[:, None], slips
        steepest = self._steepest(probe.reshape(len(probe), -1)).reshape(probe.shape[1:]).max(
            axis=1)
        return gaps[steepest <= self.reference].min(initial=0.0)

    def _steepest(self, gap):
        """Bound of the eigenvalues of the law's tangent at gaps (components, nodes): its largest
        row sum at each node."""
        return np.abs(self.form.contact.law.tangent(gap)).sum(axis=1).max(axis=0)

    def _own_stiffness(self):
        """K(q) of each component, without coupling, an array (components, *half spectrum)."""
        return np.stack([np.broadcast_to(self.stiffness[i, i].real, self.force.shape[1:])
                         for i in range(self.form.components)])

    def frequencies(self):
        """Frequencies of the waves beside a contact, where the law does not act; infinite for a
        mean that cannot move.

        That of a mean that can move is the estimate for a body held by a contact.
        """
        stiffness = self._own_stiffness()
        resting = RESTING[len(self.grid.shape)] * softest(self.grid, stiffness)
        set_means(self.grid, stiffness, self.form.mean_stiffness + resting)
        frequencies = np.sqrt(stiffness * self.mobility)
        set_means(self.grid, frequencies,
                  np.where(self.mobile, means(self.grid, frequencies), np.inf))
        return frequencies

    @cached_property
    def slowest(self):
        """Frequency of the slowest motion."""
        return self.grid.minimum(self.frequencies())

    def start(self, displacement):
        """Rest at displacements (components, nodes of the cell), ranges of the law; a mean that
        cannot move is set from the load."""
        self.transform.real.reshape(self.gap.shape)[...] = self.waves.fold(displacement)
        self.transform.forward()
        np.copyto(self.displacement, self.transform.spectrum)
        far = self.form.contact.far_displacement(self.form.components, self.form.load)
        set_means(self.grid, self.displacement,
                  np.where(self.mobile, means(self.grid, self.displacement), self.grid.size * far))
        self.velocity[...] = 0.0
        self.steps, self.stiffening = 0, 1.0
        self._evaluate()

    def displacements(self):
        """Displacements (components, nodes of the cell), ranges of the law."""
        displacement = self.gap.copy()
        displacement[0] -= self.waves.initial_gap
        return self.waves.unfold(displacement)

    def advance(self, time_step, kept, impulse):
        """The step of every method: v' = kept v' - impulse F/(m mu), v += time_step v', and the
        force there.

        Parameters
        ----------
        time_step : float
        kept : float or array (components, *waves), part of the velocity
        impulse : the same, a time
        """
        self.steps += 1
        if self.kernel:
            self.form.evaluations += 1
            self.kernel.advance(time_step, kept, impulse)
            return
        self.velocity *= kept
        np.multiply(self.acceleration, impulse, out=self._work)
        self.velocity += self._work
        self.move(time_step)
        self._evaluate()

    def damped(self, time_step, damping, graded):
        """A step whose damping is central in time: v' = ((1 - h) v' - time_step F/(m mu)) / (1 + h)
        with h = damping graded time_step / 2.

        Parameters
        ----------
        time_step, damping : floats
        graded : array (components, *waves), the damping of each wave over ``damping``
        """
        if self.kernel:
            self.steps += 1
            self.form.evaluations += 1
            self.kernel.damped(time_step, damping, graded)
            return
        half = 0.5 * time_step * damping * graded
        self.advance(time_step, (1.0 - half) / (1.0 + half), time_step / (1.0 + half))

    def move(self, time):
        """v += time v', without the force there."""
        if self.kernel:
            self.kernel.move(time)
            return
        np.multiply(self.velocity, time, out=self._work)
        self.displacement += self._work

    def _evaluate(self):
        """Gap, force and acceleration at the displacement."""
        form, plan = self.form, self.transform
        form.evaluations += 1
        if self.kernel:
            self.kernel.evaluate()
            return
        np.multiply(self.displacement, 1.0 / self.grid.size, out=plan.spectrum)
        plan.backward()
        field = plan.real.reshape(self.gap.shape)
        np.copyto(self.gap, field)
        self.gap[0] += self.waves.initial_gap
        form.contact.law.evaluate(self.gap, field)
        plan.forward()
        self._balance(plan.spectrum)
        self._stiffen()
        np.multiply(self.force, self.mobility, out=self.acceleration)
        self.acceleration *= -1.0 / self.stiffening

    def _balance(self, traction):
        """F = K v + t from the tractions' spectrum, with the form's own balance of the mean."""
        mean = (self.form.mean_stiffness * means(self.grid, self.displacement)
                - self.grid.size * self.target)
        mean += np.where(self.mobile, means(self.grid, traction), 0.0)
        np.copyto(self.force, traction)
        for (i, j), block in self.stiffness.items():
            np.multiply(block, self.displacement[j], out=self._work[i])
            self.force[i] += self._work[i]
        set_means(self.grid, self.force, mean)

    def _stiffen(self):
        """mu from the steepest tangent where surfaces overlap."""
        stiffening = 1.0
        if self.closest() < self.harmless:
            steepest = self.grid.maximum(self._steepest(self.gap[:, self.gap[0] < self.harmless]))
            stiffening += max(0.0, steepest - self.reference) / self.lightest
        if stiffening > self.stiffening:
            self.velocity *= np.sqrt(self.stiffening / stiffening)
        self.stiffening = stiffening

    def about(self):
        """What is computed how, for -snes_view."""
        nodes = f"{self.gap.shape[1]} of {self.form.nodes} nodes"
        return f"Motion: {nodes}, {'compiled' if self.kernel else 'by NumPy'}"

    def closest(self):
        """The smallest normal gap of a node."""
        return self.kernel.structure.closest if self.kernel else self.grid.minimum(self.gap[0])

    def energies(self):
        """Power -F . v', and the squares of velocity v' . m mu v' and force F . F/(m mu), sums over
        the waves of the cell."""
        if self.kernel:
            power, kinetic, square = self.kernel.sums()
            return -power, kinetic, square
        inner = self.waves.inner
        np.multiply(self.velocity, self.mass, out=self._work)
        return (-inner(self.force, self.velocity),
                self.stiffening * inner(self._work, self.velocity),
                -inner(self.force, self.acceleration))

    def changes(self, before):
        """Power of the change of F from ``before``, which is overwritten, with v', and the squares
        of velocity v' . m mu v' and of the change, by m mu, sums over the waves of the cell."""
        if self.kernel:
            return self.kernel.sums(before)
        change, inner = np.subtract(self.force, before, out=before), self.waves.inner
        np.multiply(self.velocity, self.mass, out=self._work)
        kinetic = self.stiffening * inner(self._work, self.velocity)
        np.multiply(change, self.mobility, out=self._work)
        return inner(change, self.velocity), kinetic, inner(self._work, change) / self.stiffening

    def frequency_moments(self, before, time_step):
        """Means of the second and fourth power of the frequencies in the last step, weighted by its
        kinetic energy.

        Rayleigh quotients v' K v' / v' M v' and v' K M^-1 K v' / v' M v' with K v' dt = F -
        ``before``, the force before the step, which may be overwritten. Both are 0 for a body at
        rest.
        """
        power, kinetic, square = self.changes(before)
        kinetic *= time_step**2
        if kinetic < np.finfo(float).tiny:
            return 0.0, 0.0
        return time_step * power / kinetic, square / kinetic

    def norm(self):
        """``residual_norm`` of the archive at the present state, to be sure rounded up; no
        transform."""
        if self.kernel:
            squares, within = self.kernel.squares(), self.kernel.structure.within
        else:
            np.copyto(self._work, self.force)
            self.waves.respond(self._work)
            squares = self.waves.inner(self._work, self._work)
            within = self.grid.count(self.gap[0] < self.form.contact.law.range)
        return self._norm(squares, means(self.grid, self.force), within)
