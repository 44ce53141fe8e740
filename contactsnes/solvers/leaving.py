"""When a body under prescribed forces moves for ever: pulled off, pressed through what slip has
left no repulsion, or beyond its friction."""

import numpy as np

from ..interface.laws.law import slip_of
from .waves import means

LEVELLED = 6.0
"""Slip, in ranges, beyond which friction is what it will remain: exp(-(b - 0.7)^2) < 1e-12
(dimensionless)."""
SUNK = 10.0
"""Overlap, in parts of that from which on tractions are only continued, in which nothing bears what
still sinks."""


def leaving(motion):
    """The force-controlled component of a motion that no traction will balance from here on, or
    None.

    Normal: pulled, every node beyond the law's range, and still separating; or pressed, and `SUNK`.
    Tangential: all nodes within the law's range have slipped so far that friction has levelled off,
    below the prescribed force, and the body still slides on, away from where it stuck.
    """
    form, grid, law = motion.form, motion.grid, motion.form.contact.law
    velocity, force, displacement = (means(grid, spectrum) for spectrum in (
        motion.velocity, motion.force, motion.displacement)) if form.forced else (None,) * 3
    for i in form.forced:
        target = motion.target[i]
        if velocity[i] * target <= 0.0 or force[i] * target >= 0.0:
            continue
        if i == 0 and is_beyond(law, motion.closest(), target):
            return 0
        if i > 0 and slides_away(displacement[i] / grid.size, velocity[i]):
            pressed = 0 in form.forced and motion.target[0] < 0.0
            if slides(law, grid, motion.gap, abs(target) * grid.size, pressed):
                return i
    return None


def is_beyond(law, closest, force):
    """Whether a body is where no traction holds what a force moves: out of the law's range under a
    pull, or pressed through the flat.

    Parameters
    ----------
    law : Law
    closest : float, smallest gap, ranges of the law
    force : float, attraction positive: above 0 a pull
    """
    return closest > law.range if force > 0.0 else closest < SUNK * law.deepest


def slides_away(slip, velocity):
    """Whether a body slides on, away from where it stuck, so far from there that friction has
    levelled off; its mean slip, in ranges, and the velocity of that."""
    return slip * np.sign(velocity) > LEVELLED


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
    if not grid.any(within):
        return not pressed
    slipped = slip_of(gap) > LEVELLED
    friction = slip_of(law.traction(gap)) * within
    return not grid.any(~slipped[within]) and grid.sum(friction) < force
