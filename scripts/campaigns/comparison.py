"""Compares two archives of one scene: ends of legs, events and their loads, energy lost. NumPy and
h5py alone."""

import numpy as np

from . import checker

EXACT = ("fold", "jump")
"""Events whose loads do not depend on the steps."""


class Story:
    """What a path says, however it was stepped: ends of its legs, and its events."""

    def __init__(self, path):
        self.path = checker.read(path)
        dimension = self.path.dimension
        self.names = [*checker.names(dimension, "displacement"), *checker.names(dimension, "force"),
                      "contact_area"]
        self.legs = np.asarray(self.path["leg"], dtype=int)
        self.events = [point for point, event in enumerate(self.path["event"]) if event != "none"]
        self.count = len(self.legs)

    def values(self, point):
        """Numbers of a point: displacements, forces, area."""
        return np.array([self.path[name][point] for name in self.names])

    def end(self, leg):
        """The last point of a leg, or None."""
        members = np.flatnonzero(self.legs == leg)
        return int(members[-1]) if members.size else None

    def known(self, name):
        """Whether a column says of every point that it is good (1); True where nobody asked."""
        return bool(np.all(np.asarray(self.path[name]) != 0))

    @property
    def balanced(self):
        """Energy lost, nan where unknown."""
        return float(self.path["dissipated_work"][-1])


def far(first, second, tolerance, scale):
    """The largest difference in units of what is allowed; nan stands for what is not defined."""
    difference = np.abs(first - second) / (tolerance * np.maximum(scale,
                                                                  np.maximum(np.abs(first),
                                                                             np.abs(second))))
    return float(np.nanmax(difference, initial=0.0))


def compare(one, other, tolerance=1e-6, fold=1e-6, finished=True):
    """What two stories do not agree on: a list of sentences, each one kind of disagreement.

    Parameters
    ----------
    one, other : Story
    tolerance : relative (absolute below one) of force, area and displacement at ends of legs
    fold : the same of loads at folds and jumps
    finished : whether both paths were followed to their ends; else the legs that both have finished
        are compared
    """
    found = []
    common = min(one.legs[-1], other.legs[-1]) - (not finished)
    stopped = finished and (one.path["event"][-1] != "none" or other.path["event"][-1] != "none")
    for leg in range(common + 1):
        ends = one.end(leg), other.end(leg)
        if None in ends or (stopped and leg == common):
            continue
        worst = far(one.values(ends[0]), other.values(ends[1]), tolerance, 1.0)
        if worst > 1.0:
            found.append(f"end of leg {leg}: {_told(one, other, *ends)}")
            break
    names = [_events(story, common) for story in (one, other)]
    if stopped:
        names = [_before_the_end(story, own) for story, own in zip((one, other), names)]
    # Longer steps find gross sliding and loss of contact later, perhaps behind the fold that they
    # would come before.
    exact, others = ([[name for name, _ in own if (name[1] in EXACT) is is_exact] for own in names]
                     for is_exact in (True, False))
    if exact[0] != exact[1] or sorted(others[0]) != sorted(others[1]):
        found.append("events: " + " / ".join(" ".join(f"{leg}:{event}"
                                                      for (leg, event, _), _ in own) or "none"
                                             for own in names))
        return found
    for (name, first), (_, second) in zip(*([(name, point) for name, point in own
                                             if name[1] in EXACT] for own in names)):
        if far(*[_load(story, point) for story, point in ((one, first), (other, second))], fold,
               1.0) > 1.0:
            found.append(f"{name[1]} of leg {name[0]}: {_told(one, other, first, second)}")
            break
    if not found and finished:
        lost = one.balanced, other.balanced
        if abs(lost[0] - lost[1]) > max(1e-3, 10 * tolerance) * max(1.0, abs(lost[0])):
            found.append(f"energy lost: {lost[0]:.6g} / {lost[1]:.6g}")
    return found


def _events(story, common):
    """((leg, event, kind), point) of a story as far as a leg."""
    return [((int(story.legs[point]), story.path["event"][point], story.path["fold_kind"][point]),
             point) for point in story.events if story.legs[point] <= common]


def _before_the_end(story, events):
    """Events without the fold whose point is also the one with the event that ended the path, as
    `-load_stop` asks: shorter steps may have met that event, and ended, before the fold."""
    last = story.count - 1
    ending = story.path.options.get("load_stop", "none").split(",")
    if story.path["event"][last] in EXACT or story.path["event"][last] not in ending:
        return events
    return [(name, point) for name, point in events
            if name[1] != "fold" or not np.array_equal(story.values(point), story.values(last))]


def _load(story, point):
    """Controlled values of a point."""
    leg, controls = story.legs[point], {}
    for named in story.path.legs[:leg + 1]:
        controls |= {i: kind for i, (kind, _) in named.items()}
    names = {kind: checker.names(story.path.dimension, kind) for kind in ("displacement", "force")}
    return np.array([story.path[names[kind][i]][point] for i, kind in sorted(controls.items())])


def _told(one, other, first, second):
    """The numbers that differ most."""
    values = one.values(first), other.values(second)
    worst = int(np.nanargmax(np.abs(values[0] - values[1]) / np.maximum(1.0, np.abs(values[0]))))
    return f"{one.names[worst]} {values[0][worst]:.10g} / {values[1][worst]:.10g}"
