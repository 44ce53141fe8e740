"""Damped motion of the force form in Fourier space: masses, steps and methods, without PETSc.

The balance F(v) = 0 is reached as the rest of m v'' + m c v' = -F(v), with a mass m and a rate c for each wave. The masses are
stiffnesses: the body's, plus the law's reference tangent, so that the fastest motion has about the frequency 1, the unit of time.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from .laws import CUTOFF, SLIP
from .settings import Options, option

RESTING = {1: 0.15, 2: 0.08}
"""Stiffness of the mean displacement of a body in contact over that of the softest wave, by dimension of the interface
(measured: 0.24 where a tenth of a line cell is in contact, less for smaller contacts)."""

LEVELLED = 6.0
"""Slip, in ranges, beyond which friction is what it will remain: exp(-(b - 0.7)^2) < 1e-12 (dimensionless)."""


@dataclass(frozen=True)
class MassOptions(Options):
    """What the masses are made of: options of every method."""

    masses: str = option("fourier", "fourier: stiffness of the wave + tangent; equal: the largest of these for every wave",
                         choices=("equal", "fourier"))
    tangent: float = option(2.0, "reference tangent of the law that the masses allow for; beyond it they grow",
                            "phi/delta^2", above=0)


@dataclass(frozen=True)
class VerletOptions(MassOptions):
    """Options of damped Verlet."""

    prefix: ClassVar[str] = "snes_verlet_"
    title: ClassVar[str] = "Dynamic relaxation: damped Verlet"
    time_step: float = option(1.6, "time step; the fastest motion has about the frequency 1, stable below 2", above=0)
    damping: float = option(None, "rate c of the damping m c v' of the slowest motion", kind="number", minimum=0,
                            default_text="critical, twice its frequency")
    damping_exponent: float = option(0.4, "the rate grows with the frequency of a wave to this power, from the softest wave on",
                                     minimum=0, maximum=1)


@dataclass(frozen=True)
class FireOptions(MassOptions):
    """Options of FIRE; Bitzek's own: growth 1.1, reduction 0.5, delay 5, mixing 0.1, mixing_decay 0.99."""

    prefix: ClassVar[str] = "snes_fire_"
    title: ClassVar[str] = "Dynamic relaxation: FIRE"
    time_step: float = option(0.4, "first time step; the fastest motion has about the frequency 1", above=0)
    largest_time_step: float = option(1.4, "largest time step; stable below about 1.6", above=0)
    growth: float = option(1.2, "factor of the time step after a step downhill", minimum=1)
    reduction: float = option(0.7, "factor of the time step after a step uphill", above=0, below=1)
    delay: int = option(0, "steps downhill before the time step grows", minimum=0)
    mixing: float = option(0.13, "part of the velocity that is turned towards the force, after a stop", minimum=0, below=1)
    mixing_decay: float = option(0.99, "factor of the mixing where the time step grows", above=0, maximum=1)


class Motion:
    """m mu v'' = -F(v) for the force form, all in Fourier space: two transforms a component for each force.

    m(q) = K(q) + tangent, and k_0 + tangent/2 for the mean (0 where it cannot move); K in ranges of the law. mu >= 1 keeps deep
    overlap stable: where the law's steepest tangent exceeds the reference, all masses grow so that the fastest frequency stays.
    When mu grows kinetic energy is kept, when it falls the velocity: no repulsion can throw the body off.

    Parameters
    ----------
    form : ForceForm with its load set
    masses : 'fourier' or 'equal' (then the largest m of the component for every wave)
    tangent : reference tangent, dimensionless

    Attributes
    ----------
    displacement, velocity, force, acceleration : half spectra (components, ...) of v, v', F and -F/(m mu), not normalised
    gap : array (components, nodes), ranges of the law
    stiffening : mu
    steps : number of steps since the beginning
    """

    def __init__(self, form, masses="fourier", tangent=2.0):
        self.form, self.grid, self.transform = form, form.grid, form.convolution.transform
        self._target, spectrum = form.target(), self.transform.spectrum
        self.displacement, self.velocity, self.force, self.acceleration = (np.zeros_like(spectrum) for _ in range(4))
        self._work, self.gap = np.zeros_like(spectrum), np.empty(form.shape)
        self._mean = (slice(None), *[0] * len(self.grid.shape))
        self.stiffness = {key: self.grid.size * block for key, block in form.convolution.blocks.items()}
        self.mobile = np.array([form.rigid_compliance[i] > 0.0 or i in form.forced for i in range(form.components)])
        self.mass = self._masses(masses, tangent)
        self.mobility = 1.0 / np.where(self.mass > 0.0, self.mass, np.inf)
        self._tangent, self._lightest = tangent, self.mass.reshape(form.components, -1)[:, 1:].min()
        self._harmless = self._harmless_gap()
        self.steps, self.stiffening = 0, 1.0

    def _masses(self, kind, tangent):
        """m(q) for each component, an array (components, *half spectrum)."""
        mass = self._own_stiffness() + tangent
        if kind == "equal":
            mass[...] = mass.reshape(len(mass), -1).max(axis=1).reshape(-1, *[1] * len(self.grid.shape))
        else:
            mass[self._mean] = self.form.mean_stiffness + 0.5 * tangent
        mass[self._mean] *= self.mobile
        return mass

    def _harmless_gap(self):
        """Normal gap, at most 0, above which no slip makes the law's tangent exceed the reference."""
        gaps, slips = np.linspace(-5.0, 0.0, 501), np.array([0.0, 0.5 * SLIP, SLIP, 2.0 * SLIP])
        probe = np.zeros((self.form.components, gaps.size, slips.size))
        probe[0], probe[1:2] = gaps[:, None], slips
        steepest = self._steepest(probe.reshape(len(probe), -1)).reshape(probe.shape[1:]).max(axis=1)
        return gaps[steepest <= self._tangent].min(initial=0.0)

    def _steepest(self, gap):
        """Bound of the eigenvalues of the law's tangent at gaps (components, nodes): its largest row sum at each node."""
        return np.abs(self.form.contact.law.tangent(gap)).sum(axis=1).max(axis=0)

    def _own_stiffness(self):
        """K(q) of each component, without coupling, an array (components, *half spectrum)."""
        return np.stack([np.broadcast_to(self.stiffness[i, i].real, self.force.shape[1:]) for i in range(self.form.components)])

    def frequencies(self):
        """Frequencies of the waves beside a contact, where the law does not act; infinite for a mean that cannot move.

        That of a mean that can move is the estimate for a body held by a contact.
        """
        stiffness = self._own_stiffness()
        softest = stiffness.reshape(len(stiffness), -1)[:, 1:].min(axis=1)
        stiffness[self._mean] = self.form.mean_stiffness + RESTING[len(self.grid.shape)] * softest
        frequencies = np.sqrt(stiffness * self.mobility)
        frequencies[self._mean] = np.where(self.mobile, frequencies[self._mean], np.inf)
        return frequencies

    def start(self, displacement):
        """Rest at displacements (components, nodes), ranges of the law; a mean that cannot move is set from the load."""
        self.transform.real.reshape(self.form.shape)[...] = displacement
        self.transform.forward()
        np.copyto(self.displacement, self.transform.spectrum)
        far = self.form.contact.far_displacement(self.form.components, self.form.load)
        self.displacement[self._mean] = np.where(self.mobile, self.displacement[self._mean], self.grid.size * far)
        self.velocity[...] = 0.0
        self.steps, self.stiffening = 0, 1.0
        self._evaluate()

    def advance(self, time_step, kept, impulse):
        """The step of every method: v' = kept v' - impulse F/(m mu), v += time_step v', and the force there.

        ``kept`` and ``impulse`` are numbers, or arrays (components, *half spectrum).
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
        mean = self.form.mean_stiffness * self.displacement[self._mean].real - self.grid.size * self._target
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
        """Power -F . v', and the squares of velocity v' . m mu v' and force F . F/(m mu), sums over half spectra."""
        np.multiply(self.velocity, self.mass, out=self._work)
        return (-self.grid.spectral_inner(self.force, self.velocity), self.stiffening * self.grid.spectral_inner(self._work, self.velocity),
                -self.grid.spectral_inner(self.force, self.acceleration))

    def norm(self):
        """``residual_norm`` of the archive at the present state, to be sure rounded up; no transform."""
        np.multiply(self.force, 1.0 / self.form.root, out=self._work)
        return self.form.spectral_norm(self._work, self.grid.count(self.gap[0] < CUTOFF))

    def leaving(self):
        """The force-controlled component that no traction will balance from here on, or None.

        Normal: pulled, every node beyond the law's range, and still separating. Tangential: all nodes within the law's range
        have slipped so far that friction has levelled off, below the prescribed force, and the body still slides on.
        """
        imbalance, velocity = self.force[self._mean].real, self.velocity[self._mean].real
        slip = np.abs(self.displacement[self._mean].real) / self.grid.size
        for i in self.form.forced:
            target = self._target[i]
            if velocity[i] * target <= 0.0 or imbalance[i] * target >= 0.0:
                continue
            if i == 0 and target > 0.0 and self.grid.minimum(self.gap[0]) > CUTOFF:
                return 0
            if i > 0 and slip[i] > LEVELLED and self._slides(abs(target)):
                return i
        return None

    def _slides(self, mean_traction):
        """Whether friction has levelled off wherever the law acts, below a mean traction over the cell."""
        gap = self.gap[:, self.gap[0] < CUTOFF]
        if gap.size == 0:
            # What is pressed down will come into contact.
            return 0 not in self.form.forced or self._target[0] >= 0.0
        friction = np.linalg.norm(self.form.contact.law.traction(gap)[1:], axis=0)
        slipped = np.linalg.norm(gap[1:], axis=0) > LEVELLED
        return bool(slipped.all()) and self.grid.sum(friction) < mean_traction * self.grid.size


class DampedVerlet:
    """Verlet's scheme for a started Motion, damped in proportion to the masses (Verlet 1967; Day 1965 for the damping).

    Where the law's tangent is not symmetric, fast waves need more damping than slow ones: they would flutter.
    """

    def __init__(self, motion, options):
        frequencies = motion.frequencies()
        self.motion, self.time_step = motion, options.time_step
        self.damping = 2.0 * frequencies.min() if options.damping is None else options.damping
        softest = frequencies.reshape(len(frequencies), -1)[:, 1:].min()
        ratios = np.maximum(1.0, np.where(motion.mobility > 0.0, frequencies / softest, 1.0))
        half = 0.5 * self.time_step * self.damping * ratios**options.damping_exponent
        self._kept, self._impulse = (1.0 - half) / (1.0 + half), self.time_step / (1.0 + half)

    def step(self):
        """One time step, the damping central in time."""
        self.motion.advance(self.time_step, self._kept, self._impulse)


class FastInertial:
    """FIRE for a started Motion (Bitzek et al. 2006, Phys. Rev. Lett. 97, 170201): steered, and stopped where it runs uphill.

    In the metric of the masses (Zhou, Moseler and Mueser 2019, Phys. Rev. B 99, 144103), by semi-implicit Euler steps and
    with half a step back after a stop (Guenole et al. 2020, Comput. Mater. Sci. 175, 109584).
    """

    def __init__(self, motion, options):
        self.motion, self.options = motion, options
        self.time_step, self.mixing, self.downhill = options.time_step, options.mixing, 0

    def step(self):
        """One time step."""
        motion, options = self.motion, self.options
        power, velocity, force = motion.energies()
        if power < 0.0:
            self.downhill, self.mixing = 0, options.mixing
            self.time_step *= options.reduction
            motion.move(-0.5 * self.time_step)
            motion.advance(self.time_step, 0.0, self.time_step)
            return
        self.downhill += 1
        if self.downhill > options.delay:
            self.time_step = min(self.time_step * options.growth, options.largest_time_step)
            self.mixing *= options.mixing_decay
        step, force = self.time_step, max(force, np.finfo(float).tiny)
        turned = self.mixing * np.sqrt((velocity + 2.0 * step * power + step**2 * force) / force)
        motion.advance(step, 1.0 - self.mixing, (1.0 - self.mixing) * step + turned)
