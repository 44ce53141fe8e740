"""Moments of a motion, and the works of a step between two of them, found on some nodes at a time:
in no memory to speak of.

A history is the last moments of a motion, oldest first, of which those before the last one are told
by what they differ from it, in single precision: less than predictions and formulas miss, and in
half the memory, which linear systems take besides.
"""

import math
from typing import NamedTuple

import numpy as np

PART = 2 ** 14
"""Nodes whose works are found at a time."""


class Moment(NamedTuple):
    """The unknown of the equations at a time, and tau, None of one that but predictions ask for."""

    time: float
    unknown: np.ndarray
    elastic: np.ndarray = None


def gone_on(history, moment):
    """The history of a motion that has come to a moment, three of them."""
    *earlier, last = history
    before = Moment(last.time, *((old - new).astype(np.float32)
                                 for old, new in zip(last[1:], moment[1:])))
    return [*(one._replace(unknown=one.unknown + before.unknown, elastic=None)
              for one in earlier[-1:]), before, moment]


def combined(history, weights, name="unknown"):
    """Weighted sum of what moments of a history have, the last one among them.

    Parameters
    ----------
    history : its last moments, one to three
    weights : numbers, one of each
    name : 'unknown' or 'elastic'
    """
    *earlier, last = (getattr(one, name) for one in history)
    found = sum(weights) * last
    for weight, change in zip(weights, earlier):
        found += np.multiply(weight, change, dtype=float)
    return found


def step_works(contact, equations, history, moment, step):
    """Works done on the interface and against viscosity in the step from the last moment of a
    motion to another one, array (2, components), phi_i over the area of a node: by Simpson's rule
    on the parabola through the last moments.

    Parameters
    ----------
    contact : Contact
    equations : viscous.Equations of the motion
    history : its last moments
    moment : Moment
    step : float, time between the two
    """
    form, moving, known = equations.form, equations.moving, [*history[-2:], moment]
    times, weights = [one.time for one in known], getattr(form.grid, "weights", None)
    tails = _whole([one.unknown[form.count:] for one in known])
    means, bent = _rates([form.grid.scalars(tail, len(form.forced)) for tail in tails], times, step)
    way = np.zeros((2, form.components, 1))  # of the means, and how their speed changes
    way[:, moving, 0] = means, bent
    fields = [one.unknown[:form.count].reshape(form.shape) for one in known]
    works = np.zeros((2, form.components))
    for first in range(0, form.nodes, PART):
        part = slice(first, first + PART)
        some = _whole([field[:, part] for field in fields])
        done = _on_interface(equations, some, form.initial_gap[part], times, step)
        lost = [form.root * rate - mean
                for rate, mean in zip(_rates(some, times, step), way)]
        creep, bend = _rates(_whole([one.elastic[:, part] for one in known]), times, step)
        creep *= lost[0]
        creep += bend * lost[1] / 3.0
        works += [values.sum(axis=1) if weights is None else values @ weights[part]
                  for values in (done, creep)]
    interface, viscous = form.grid.together(works)
    interface, viscous = step / 6.0 * interface, -step * viscous
    viscous[moving] += (step * contact.grid.size * equations.mass * (means ** 2 + bent ** 2 / 3.0))
    return np.array([interface, viscous])


def _whole(known):
    """What is known at the last two or three moments, where the first of three is told by what it
    differs from the second."""
    return [known[0] + known[1], *known[1:]] if len(known) > 2 else known


def displacements(equations):
    """The function (unknown) that finds displacements (components, nodes of the window) of
    `Equations`, which it does not hold."""
    shape, root, half = equations.form.shape, equations.form.root, equations.half

    def found(unknown):
        field = unknown[:math.prod(shape)].reshape(shape) * root
        return half.unfold(field) if half else field

    return found


def _on_interface(equations, known, initial_gap, times, step):
    """Works on the interface at nodes, six times as much over the step: tractions at begin, middle
    and end times speeds there, array (components, nodes).

    Parameters
    ----------
    equations : as of `step_works`
    known : displacements of the last moments over the form's scale, (components, nodes)
    initial_gap : array (nodes,)
    times, step : as of `_rates`
    """
    root = equations.form.root
    speed, bend = _rates(known, times, step)
    middle = 0.5 * (known[-2] + known[-1]) - 0.25 * step * bend
    begin, middle, end = (_traction(equations, field * root, initial_gap)
                          for field in (known[-2], middle, known[-1]))
    return (4.0 * middle + begin + end) * (speed * root) + (end - begin) * (bend * root)


def _traction(equations, gap, initial_gap):
    """Tractions of the law at displacements, which are overwritten."""
    gap[0] += initial_gap
    return equations.contact.law.traction(gap)


def _rates(known, times, step):
    """Rate in the middle of a step of what is known, and what it differs by at either end, by the
    parabola through the last moments, arrays.

    Parameters
    ----------
    known : list of arrays alike at the last two or three moments
    times : of these
    step : float, time between the last two
    """
    rate = (known[-1] - known[-2]) / step
    if len(known) == 2:
        return rate, np.zeros_like(rate)
    bend = (known[0] - known[1]) / (times[1] - times[0])
    bend += rate
    bend *= step / (times[2] - times[0])
    return rate, bend
