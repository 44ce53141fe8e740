"""Motion of the force form in Fourier space: masses, forces and what can be told of a state,
without PETSc.

The balance F(v) = 0 is reached as the rest of m v'' + m c v' = -F(v), with a mass m and a rate c
for each wave. The masses are stiffnesses: the body's, plus the law's reference tangent, so that the
fastest motion has about the frequency 1, the unit of time.
"""

import numpy as np

RESTING = {1: 0.15, 2: 0.08}
"""Stiffness of the mean displacement of a body in contact over that of the softest wave, by
dimension of the interface (measured: 0.24 where a tenth of a line cell is in contact, less for
smaller contacts)."""

LEVELLED = 6.0
"""Slip, in ranges, beyond which friction is what it will remain: exp(-(b - 0.7)^2) < 1e-12
(dimensionless)."""


class Motion:
    """m mu v'' = -F(v) for the force form, all in Fourier space: two transforms a component for
    each force.

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
    displacement, velocity, force, acceleration : half spectra (components, ...) of v, v', F and
        -F/(m mu), not normalised
    gap : array (components, nodes), ranges of the law
    stiffening : mu
    steps : number of steps since the beginning
    """

    def __init__(self, form, masses="fourier", tangent=2.0):
        self.form = form
        self.grid = form.grid
        self.transform = form.convolution.transform
        self._target, spectrum = form.target(), self.transform.spectrum
        self.displacement, self.velocity, self.force, self.acceleration = (np.zeros_like(spectrum)
                                                                           for _ in range(4))
        self._work, self.gap = np.zeros_like(spectrum), np.empty(form.shape)
        self._mean = (slice(None), *[0] * len(self.grid.shape))
        self.stiffness = {key: self.grid.size * block
                          for key, block in form.convolution.blocks.items()}
        self.mobile = np.array([form.rigid_compliance[i] > 0.0 or i in form.forced
                                for i in range(form.components)])
        self.mass = self._masses(masses, tangent)
        self.mobility = 1.0 / np.where(self.mass > 0.0, self.mass, np.inf)
        self._tangent, self._lightest = tangent, self.mass.reshape(form.components, -1)[:, 1:].min()
        self._harmless = self._harmless_gap()
        self.steps, self.stiffening = 0, 1.0

    def _masses(self, kind, tangent):
        """m(q) for each component, an array (components, *half spectrum)."""
        mass = self._own_stiffness() + tangent
        if kind == "equal":
            mass[...] = mass.reshape(len(mass), -1).max(axis=1).reshape(-1,
                                                                        *[1] * len(self.grid.shape))
        else:
            mass[self._mean] = self.form.mean_stiffness + 0.5 * tangent
        mass[self._mean] *= self.mobile
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
        return gaps[steepest <= self._tangent].min(initial=0.0)

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
        softest = stiffness.reshape(len(stiffness), -1)[:, 1:].min(axis=1)
        stiffness[self._mean] = self.form.mean_stiffness + RESTING[len(self.grid.shape)] * softest
        frequencies = np.sqrt(stiffness * self.mobility)
        frequencies[self._mean] = np.where(self.mobile, frequencies[self._mean], np.inf)
        return frequencies

    def start(self, displacement):
        """Rest at displacements (components, nodes), ranges of the law; a mean that cannot move is
        set from the load."""
        self.transform.real.reshape(self.form.shape)[...] = displacement
        self.transform.forward()
        np.copyto(self.displacement, self.transform.spectrum)
        far = self.form.contact.far_displacement(self.form.components, self.form.load)
        self.displacement[self._mean] = np.where(self.mobile, self.displacement[self._mean],
                                                 self.grid.size * far)
        self.velocity[...] = 0.0
        self.steps, self.stiffening = 0, 1.0
        self._evaluate()

    def advance(self, time_step, kept, impulse):
        """The step of every method: v' = kept v' - impulse F/(m mu), v += time_step v', and the
        force there.

        Parameters
        ----------
        time_step : float
        kept : float or array (components, *half spectrum), part of the velocity
        impulse : the same, a time
        """
        self.velocity *= kept
        np.multiply(self.acceleration, impulse, out=self._work)
        self.velocity += self._work
        self.move(time_step)
        self.steps += 1
        self._evaluate()

    def move(self, time):
        """v += time v', without the force there."""
        np.multiply(self.velocity, time, out=self._work)
        self.displacement += self._work

    def _evaluate(self):
        """Gap, force and acceleration at the displacement."""
        form, plan = self.form, self.transform
        np.multiply(self.displacement, 1.0 / self.grid.size, out=plan.spectrum)
        plan.backward()
        field = plan.real.reshape(form.shape)
        np.copyto(self.gap, field)
        self.gap[0] += form.initial_gap
        form.contact.law.evaluate(self.gap, field)
        form.evaluations += 1
        plan.forward()
        self._balance(plan.spectrum)
        self._stiffen()
        np.multiply(self.force, self.mobility, out=self.acceleration)
        self.acceleration *= -1.0 / self.stiffening

    def _balance(self, traction):
        """F = K v + t from the tractions' spectrum, with the form's own balance of the mean."""
        mean = (self.form.mean_stiffness * self.displacement[self._mean].real
                - self.grid.size * self._target)
        mean += np.where(self.mobile, traction[self._mean].real, 0.0)
        np.copyto(self.force, traction)
        for (i, j), block in self.stiffness.items():
            np.multiply(block, self.displacement[j], out=self._work[i])
            self.force[i] += self._work[i]
        self.force[self._mean] = mean

    def _stiffen(self):
        """mu from the steepest tangent where surfaces overlap."""
        stiffening = 1.0
        if self.grid.minimum(self.gap[0]) < self._harmless:
            steepest = self.grid.maximum(self._steepest(self.gap[:, self.gap[0] < self._harmless]))
            stiffening += max(0.0, steepest - self._tangent) / self._lightest
        if stiffening > self.stiffening:
            self.velocity *= np.sqrt(self.stiffening / stiffening)
        self.stiffening = stiffening

    def energies(self):
        """Power -F . v', and the squares of velocity v' . m mu v' and force F . F/(m mu), sums over
        half spectra."""
        np.multiply(self.velocity, self.mass, out=self._work)
        return (-self.grid.spectral_inner(self.force, self.velocity),
                self.stiffening * self.grid.spectral_inner(self._work, self.velocity),
                -self.grid.spectral_inner(self.force, self.acceleration))

    def frequency_moments(self, before, time_step):
        """Means of the second and fourth power of the frequencies in the last step, weighted by its
        kinetic energy.

        Rayleigh quotients v' K v' / v' M v' and v' K M^-1 K v' / v' M v' with K v' dt = F -
        ``before``, the force before the step, which is overwritten. Both are 0 for a body at rest.
        """
        change, inner = np.subtract(self.force, before, out=before), self.grid.spectral_inner
        np.multiply(self.velocity, self.mass, out=self._work)
        kinetic = self.stiffening * time_step**2 * inner(self._work, self.velocity)
        if kinetic < np.finfo(float).tiny:
            return 0.0, 0.0
        np.multiply(change, self.mobility, out=self._work)
        return time_step * inner(change, self.velocity) / kinetic, inner(self._work,
                                                                         change) / (
            self.stiffening * kinetic)

    def norm(self):
        """``residual_norm`` of the archive at the present state, to be sure rounded up; no
        transform."""
        np.multiply(self.force, 1.0 / self.form.root, out=self._work)
        return self.form.spectral_norm(self._work,
                                       self.grid.count(self.gap[0] < self.form.contact.law.range))

    def leaving(self):
        """The force-controlled component that no traction will balance from here on, or None.

        Normal: pulled, every node beyond the law's range, and still separating. Tangential: all
        nodes within the law's range have slipped so far that friction has levelled off, below the
        prescribed force, and the body still slides on.
        """
        imbalance, velocity = self.force[self._mean].real, self.velocity[self._mean].real
        slip = np.abs(self.displacement[self._mean].real) / self.grid.size
        for i in self.form.forced:
            target = self._target[i]
            if velocity[i] * target <= 0.0 or imbalance[i] * target >= 0.0:
                continue
            if i == 0 and target > 0.0 and self.grid.minimum(
                    self.gap[0]) > self.form.contact.law.range:
                return 0
            if i > 0 and slip[i] > LEVELLED:
                pressed = 0 in self.form.forced and self._target[0] < 0.0
                if slides(self.form.contact.law, self.grid, self.gap, abs(target) * self.grid.size,
                          pressed):
                    return i
        return None


def slides(law, grid, gap, force, pressed):
    """Whether friction has levelled off wherever the law acts, at a sum over nodes below ``force``.

    What is ``pressed`` down where the law acts nowhere will come into contact.

    Parameters
    ----------
    law : Law
    grid : Grid
    gap : array (components, nodes), ranges of the law
    force : of the component, a sum over nodes of tractions in phi_t/delta_t
    pressed : whether the body is pressed down
    """
    within = gap[0] < law.range
    if not within.any():
        return not pressed
    slipped = np.linalg.norm(gap[1:], axis=0) > LEVELLED
    friction = np.linalg.norm(law.traction(gap)[1:], axis=0) * within
    return bool(slipped[within].all()) and grid.sum(friction) < force
