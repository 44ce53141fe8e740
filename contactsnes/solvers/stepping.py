"""Methods of dynamic relaxation: their options, and how each steps and stops the same Motion;
without PETSc."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..options.fields import Options, option
from .waves import softest


@dataclass(frozen=True)
class MassOptions(Options):
    """What the masses are made of: options of every method."""

    masses: str = option("fourier", "fourier: stiffness of the wave + tangent; "
                         "equal: the largest of these for every wave",
                         choices=("equal", "fourier"))
    tangent: float = option(2.0, "reference tangent of the law that the masses "
                            "allow for; beyond it they grow", "phi/delta^2", above=0)


@dataclass(frozen=True)
class VerletOptions(MassOptions):
    """Options of damped Verlet; longer time steps are cheaper where they settle, but may end in an
    oscillation."""

    prefix: ClassVar[str] = "snes_verlet_"
    title: ClassVar[str] = "Dynamic relaxation: damped Verlet"
    time_step: float = option(1.5, "time step; the fastest motion has about the "
                              "frequency 1, stable below 2", above=0)
    damping: float = option(None, "rate c of the damping m c v' of the slowest motion",
                            kind="number", minimum=0, default_text="critical, twice its frequency")
    damping_exponent: float = option(0.6, "the rate grows with the frequency of a "
                                     "wave to this power, from the "
                                     "softest wave on", minimum=0, maximum=1)


@dataclass(frozen=True)
class FireOptions(MassOptions):
    """Options of FIRE; Bitzek's own: growth 1.1, reduction 0.5, delay 5, mixing 0.1, mixing_decay
    0.99."""

    prefix: ClassVar[str] = "snes_fire_"
    title: ClassVar[str] = "Dynamic relaxation: FIRE"
    time_step: float = option(0.4, "first time step; the fastest motion has about the frequency 1",
                              above=0)
    largest_time_step: float = option(1.4, "largest time step; stable below about 1.6", above=0)
    growth: float = option(1.2, "factor of the time step after a step downhill", minimum=1)
    reduction: float = option(0.7, "factor of the time step after a step uphill", above=0, below=1)
    delay: int = option(0, "steps downhill before the time step grows", minimum=0)
    mixing: float = option(0.1,
                           "part of the velocity that is turned towards the force, after a stop",
                           minimum=0, below=1)
    mixing_decay: float = option(0.99, "factor of the mixing where the time step grows", above=0,
                                 maximum=1)


@dataclass(frozen=True)
class AdaptiveOptions(MassOptions):
    """Options of adaptive dynamic relaxation."""

    prefix: ClassVar[str] = "snes_adaptive_"
    title: ClassVar[str] = "Dynamic relaxation: time step and damping estimated on the way"
    stability: float = option(0.85, "time step over the largest that is stable "
                              "for the fastest frequency seen", above=0, below=1)
    memory: float = option(0.9998, "what remains of the fastest frequency seen, at each step",
                           above=0, maximum=1)
    damping_factor: float = option(0.8, "rate of the damping over the critical one, "
                                   "twice the frequency that the motion has",
                                   minimum=0)
    damping_exponent: float = option(0.2, "the rate grows with the frequency of a "
                                     "wave to this power, from the "
                                     "softest wave on", minimum=0, maximum=1)


@dataclass(frozen=True)
class KineticOptions(MassOptions):
    """Options of kinetic damping."""

    prefix: ClassVar[str] = "snes_kinetic_"
    title: ClassVar[str] = "Dynamic relaxation: kinetic damping"
    time_step: float = option(1.6, "time step; the fastest motion has about the "
                              "frequency 1, stable below 2", above=0)
    damping: float = option(0.7, "rate of viscous damping of the stiffest wave, "
                            "of others in proportion to their frequency",
                            minimum=0)


def graded(motion, exponent):
    """Damping of each wave over that of the slowest motion: its frequency over the softest wave's,
    to a power, at least 1."""
    frequencies = motion.frequencies()
    least = min(softest(motion.grid, frequencies))
    return np.maximum(1.0, np.where(motion.mobility > 0.0, frequencies / least, 1.0)) ** exponent


class DampedVerlet:
    """Verlet's scheme for a started Motion, damped in proportion to the masses (Verlet 1967; Day
    1965 for the damping).

    Where the law's tangent is not symmetric, fast waves need more damping than slow ones: they
    would flutter.
    """

    def __init__(self, motion, options):
        self.motion, self.time_step = motion, options.time_step
        self.damping = (2.0 * motion.slowest if options.damping is None
                        else options.damping)
        half = 0.5 * self.time_step * self.damping * graded(motion, options.damping_exponent)
        self._kept, self._impulse = (1.0 - half) / (1.0 + half), self.time_step / (1.0 + half)

    def step(self):
        """One time step, the damping central in time."""
        self.motion.advance(self.time_step, self._kept, self._impulse)


class FastInertial:
    """FIRE for a started Motion (Bitzek et al. 2006, Phys. Rev. Lett. 97, 170201): steered, and
    stopped where it runs uphill.

    In the metric of the masses (Zhou, Moseler and Mueser 2019, Phys. Rev. B 99, 144103), by
    semi-implicit Euler steps and with half a step back after a stop (Guenole et al. 2020, Comput.
    Mater. Sci. 175, 109584).
    """

    def __init__(self, motion, options):
        self.motion, self.options = motion, options
        self.time_step = options.time_step
        self.mixing = options.mixing
        self.downhill = 0

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


class AdaptiveRelaxation:
    """Damped Verlet for a started Motion that estimates its time step and damping (Underwood 1983;
    Oakley and Knight 1995).

    Underwood, in Computational Methods for Transient Analysis, chapter 5; Oakley and Knight,
    Comput. Methods Appl. Mech. Eng. 126, 67. The frequency to be damped critically is the Rayleigh
    quotient of the last step, which tends to the slowest one as the rest has died out. The fastest,
    from the mean of the fourth power, begins at 1, for which the masses are made: a step that is
    too long excites the fast motion, and so is seen.
    """

    def __init__(self, motion, options):
        self.motion, self.options = motion, options
        self.damping = 0.0
        self.fastest = 1.0
        self.time_step = 2.0 * options.stability
        self._graded, self._before = graded(motion, options.damping_exponent), motion.force.copy()

    def step(self):
        """One time step, and the estimates for the next."""
        motion, options = self.motion, self.options
        motion.damped(self.time_step, self.damping, self._graded)
        square, fourth = motion.frequency_moments(self._before, self.time_step)
        np.copyto(self._before, motion.force)
        self.damping = 2.0 * options.damping_factor * np.sqrt(max(square, 0.0))
        self.fastest = max(fourth**0.25, options.memory * self.fastest)
        self.time_step = 2.0 * options.stability / self.fastest


class KineticDamping:
    """Motion, for a started Motion, that is stopped where its kinetic energy has a peak (Cundall
    1976).

    Cundall, in ISRM Symposium on Numerical Methods in Rock Mechanics; with the restart at the
    peak's own place (Barnes 1999, Int. J. Space Struct. 14, 89), by a parabola through three
    kinetic energies. A stop costs an evaluation of the force. Stops serve the slow motion; what is
    fast, and may flutter where the law's tangent is not symmetric, is damped besides.
    """

    def __init__(self, motion, options):
        self.motion, self.time_step = motion, options.time_step
        frequencies = np.where(motion.mobility > 0.0, motion.frequencies(), 0.0)
        fastest = motion.grid.maximum(frequencies)
        half = 0.5 * options.time_step * options.damping * frequencies / fastest
        self._kept, self._impulse = (1.0 - half) / (1.0 + half), options.time_step / (1.0 + half)
        self._moving, self._earlier = False, 0.0

    def step(self):
        """One time step, or one stop."""
        motion, step = self.motion, self.time_step
        power, kinetic, force = motion.energies()
        ahead = kinetic + 2.0 * step * power + step**2 * force
        if ahead < kinetic:
            curvature = self._earlier - 2.0 * kinetic + ahead
            peak = 0.5 * (self._earlier - ahead) / curvature if curvature < 0.0 else 0.0
            # The last step led from half a step before the energy in the middle to half a step
            # behind it.
            motion.move(-step * np.clip(0.5 - peak, 0.0, 1.0))
            motion.advance(0.0, 0.0, 0.0)
            self._moving, self._earlier = False, 0.0
            return
        # From rest the first velocity is that of half a step.
        motion.advance(step, self._kept, self._impulse if self._moving else 0.5 * self._impulse)
        self._moving, self._earlier = True, kinetic
