"""Events between two points of a branch, and the points at which they happen, by bracketed roots of
what tells of them."""

from dataclasses import replace

from .limit_points import FOLD_TOLERANCE
from .points import NotConverged

MOST = 60
"""Most points that a search makes: enough to halve its bracket to rounding."""


def locate(system, leg, event, before, after):
    """The first point with an event between two points of a branch, one without and one with it.

    The regula falsi, as Illinois has it, along the chord between the points; to FOLD_TOLERANCE of
    the load that moves, or of the law's range.

    Parameters
    ----------
    system, leg : System, Leg
    event : its name
    before, after : points of the branch
    """
    chord = before.state, after.state
    left = (0.0, before, system.margin(before, event))
    right = (system.chord_length(*chord), after, system.margin(after, event))
    scale, kept = abs(leg.direction[leg.moving]), None
    for _ in range(MOST):
        (begin, first, lack), (end, last, margin) = left, right
        width = scale * abs(last.position - first.position) / max(
            abs(leg.load(last.position)[leg.moving]), 1e-3)
        if width < FOLD_TOLERANCE or 0.0 <= margin < FOLD_TOLERANCE:
            break
        part = min(max(-lack / (margin - lack), 0.01), 0.99)
        place = begin + part * (end - begin)
        try:
            point = system.solve_arc(chord, place,
                                     system.extrapolate([first, last], [1.0 - part, part]),
                                     first.position + part * (last.position - first.position), leg)
        except NotConverged as error:
            system.log(f"the event {event} is located to {width:.2g} of its load only: {error}")
            break
        found = place, point, system.margin(point, event)
        # An end that is kept again weighs half.
        if found[2] >= 0.0:
            left = (begin, first, 0.5 * lack) if kept == "left" else left
            right, kept = found, "left"
        else:
            right = (end, last, 0.5 * margin) if kept == "right" else right
            left, kept = found, "right"
    return right[1]


def events_between(previous, point):
    """Names of the events that a point has besides its own: first gross sliding, first loss of
    contact."""
    if previous is None:
        return []
    found = []
    if point.sliding and not previous.sliding:
        found.append("gross_sliding")
    if previous.in_contact and not point.in_contact:
        found.append("pull_off")
    return found


def with_events(previous, point):
    """The point, then a copy for every further event at the same load; a point without an event
    takes the first."""
    names = events_between(previous, point)
    if not point.event and names:
        point = replace(point, event=names[0])
    yield point
    yield from further_events(previous, point)


def further_events(previous, point):
    """Copies of a point, at no cost, for the events that it has besides the one that it carries."""
    names = events_between(previous, point)
    for name in names[names.index(point.event) + 1 if point.event in names else 0:]:
        yield replace(point, event=name, fold_kind="", fold_precision=0.0, tangents=(),
                      spent={key: 0 * value for key, value in point.spent.items()})


def pulled_off(point):
    """Whether a point is the fold beyond which a force that is prescribed pulls the body off."""
    return point.event == "fold" and point.fold_kind == "pull_off" and point.controls[0] == "force"
