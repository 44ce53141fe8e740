"""The works of a step of a motion, in little more memory than its moments have."""

import numpy as np


def step_works(contact, equations, history, moment, step):
    """Works done on the interface and against viscosity in the step from the last moment of a
    motion to another one, array (2, components), phi_i over the area of a node: by Simpson's rule
    on the parabola through the last moments.

    Parameters
    ----------
    contact : Contact
    equations : viscous.Equations of the motion
    history : list of its last overdamped.Moment, oldest first
    moment : overdamped.Moment, with gap and traction, as the last one has them
    step : float, time between the two
    """
    grid, moving = equations.form.grid, equations.moving
    speed, bend = _rates("unknown", history, moment, step)
    # (scalars are views, and the memory of the speed is used again)
    means, bent = (equations.form.scalars(rates).copy() for rates in (speed, bend))
    velocity, turn = equations.displacement(speed), equations.displacement(bend)
    tractions = _simpson(equations, history[-1], moment, speed, bend, step)
    del speed, bend  # their memory is that of what follows
    tractions *= velocity
    turned = moment.traction - history[-1].traction
    turned *= turn
    tractions += turned
    interface = step / 6.0 * grid.sum(tractions)
    del tractions, turned
    velocity[moving] -= means[:, None]
    turn[moving] -= bent[:, None]
    creep, creep_bend = _rates("elastic", history, moment, step)
    creep *= velocity
    creep_bend *= turn
    creep_bend /= 3.0
    creep += creep_bend
    viscous = -step * grid.sum(creep)
    viscous[moving] += (step * contact.grid.size * equations.mass * (means ** 2 + bent ** 2 / 3.0))
    return np.array([interface, viscous])


def _simpson(equations, last, moment, speed, bend, step):
    """Tractions at begin and end of a step and four times those in its middle, summed up; ``speed``
    and ``bend`` are overwritten."""
    middle = np.add(last.unknown, moment.unknown, out=speed)
    middle *= 0.5
    bend *= 0.25 * step
    middle -= bend
    tractions = equations.traction(middle)
    tractions *= 4.0
    tractions += last.traction
    tractions += moment.traction
    return tractions


def _rates(name, history, moment, step):
    """Rate in the middle of a step to a moment of what moments have under a name, and what it
    differs by at either end, by the parabola through the last moments, arrays."""
    last = history[-1]
    rate = getattr(moment, name) - getattr(last, name)
    rate /= step
    if len(history) == 1:
        return rate, np.zeros_like(rate)
    first = history[-2]
    bend = getattr(first, name) - getattr(last, name)
    bend /= last.time - first.time
    bend += rate
    bend *= step / (moment.time - first.time)
    return rate, bend
