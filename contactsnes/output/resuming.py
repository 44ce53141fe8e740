"""Going on from points of an earlier run: what must be the same, what may differ, and their places
on the path.

What decides the states that are there must be the same: the scene, heights by their checksum, where
the path begins and its legs that are done. How states are solved for may differ, and so may legs
that are not begun; the end of the leg under way may, too, where it lies ahead in the same
direction.
"""

import hashlib
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..options.fields import InputError
from ..options.files import is_option, words
from ..scene.load import Load

SOURCES = ("geometry_file",)
"""Attributes of a scene that say where something came from: its checksum decides."""

LACKING = "is complete without what"
"""What is told of an archive that has less than a run asks for."""

ROUNDING = 1e-9
"""Relative distance of loads that are the same."""


class Run(NamedTuple):
    """One of the runs that made an archive: its first point (from 0), its options, versions of
    programs."""

    first: int
    options: str
    versions: str


def runs(file):
    """The runs that an archive, an open file, was made by; older ones tell of the newest only."""
    if "runs" not in file:
        return [Run(0, file.attrs["options"], file.attrs["versions"])]
    texts = (file["runs"][name].asstr() for name in Run._fields[1:])
    return [Run(int(first), *others) for first, *others in zip(file["runs/first"], *texts)]


def checksum(grid, heights):
    """SHA-256 of heights on a grid (array of those that are here), whatever they were stored in;
    None of none."""
    if heights is None:
        return None
    found = hashlib.sha256()
    for rows in grid.in_turn(np.ascontiguousarray(heights, dtype="<f8")):
        found.update(rows)
    return grid.of_first(found.hexdigest())


def entries(text):
    """Name (without dash) -> value of the options in a text, in one line or many; the later
    wins."""
    found, name = {}, ""
    for word in words(text):
        if is_option(word):
            name = word.lstrip("-")
            found[name] = ""
        elif name:
            found[name] = f"{found[name]} {word}".strip()
    return found


def legs(found):
    """The legs of the load path among options, as they are written."""
    path = found.get("load_path", "")
    return [" ".join(leg.split()) for leg in path.split(";")] if path.strip() else []


def _meaning(text):
    """What a text says of quantities, whatever its blanks, order and spelling of numbers."""
    pieces = (piece.split("=") for piece in text.split(","))
    return sorted(tuple(_number(part.strip()) for part in piece) for piece in pieces)


def _number(text):
    """A number in one spelling, or the text."""
    try:
        return repr(float(text))
    except ValueError:
        return text


def differences(scene, options, others, other_options, done):
    """What decides the states of two runs and differs: [(name, there, here), ...].

    Parameters
    ----------
    scene, others : attributes of the scene there and here
    options, other_options : text of the options there and here
    done : number of legs that are done there
    """
    before, now = entries(options), entries(other_options)
    names = [name for name in {**others, **scene} if name not in SOURCES]
    pairs = [(name, *(_without_folder(values.get(name, "not given")) for values in (scene, others)))
             for name in names]
    found = [(name, *(np.asarray(value).tolist() for value in (old, new)))
             for name, old, new in pairs if not _agree(old, new)]
    # (of another scene, the start may be none of this one's)
    if not found and _start(scene, before) != _start(scene, now):
        found.append(("load_start", *(entry.get("load_start", "not given")
                                      for entry in (before, now))))
    texts = []
    for number in range(min(done, len(legs(before)))):
        there, here = ([*legs(entry), "not given"][min(number, len(legs(entry)))]
                       for entry in (before, now))
        texts.append((f"leg {number + 1} of load_path, which is done,", there, here))
    return found + [text for text in texts if _meaning(text[1]) != _meaning(text[2])]


def _start(scene, options):
    """Component -> Control where a path begins, by a scene's attributes and options: what is not
    named, and what is named as it would be anyway, are the same."""
    isolated = bool(np.any(np.isinf(scene.get("period", 0.0))))
    return Load(start=options.get("load_start")).initial(int(scene.get("dimension", 1)), isolated)


def _without_folder(value):
    """A value; of FILE.py:NAME the NAME, since the checksum of the file decides."""
    if isinstance(value, str) and ".py:" in value:
        return value.rpartition(":")[2]
    return value


def _agree(old, new):
    """Whether two attributes are the same; numbers that were derived are so to rounding, which
    machines differ in."""
    old, new = np.asarray(old), np.asarray(new)
    if old.shape != new.shape or {old.dtype.kind, new.dtype.kind} - set("fiu"):
        return np.array_equal(old, new)
    return np.allclose(old, new, rtol=1e-12, atol=0.0)


def changes(options, other_options):
    """What differs in the options there and here and decides no state that is there: sentences."""
    before, now = entries(options), entries(other_options)
    names = [name for name in sorted({**before, **now})
             if not name.startswith("archive_") and before.get(name) != now.get(name)]
    told = {name: [entry.get(name, "not given") or "given" for entry in (now, before)]
            for name in names}
    return [f"-{name} is {here}, before that {there}" for name, (here, there) in told.items()]


def events_of(state):
    """Names of the events that the last point of a path counts as, by its state: a fold beyond
    which a force pulls the body off is a pull-off, too."""
    event = state.get("event")
    pulled = (event == "fold" and state.get("fold_kind") == "pull_off"
              and np.any(np.ravel(state.get("forced", False))[:1]))
    return (event, "pull_off") if pulled else (event,)


def has_more(options, other_options, events):
    """Whether a path that ended at a point with events goes on by other options.

    Either one of these was its end and none is any more, or it has more legs now.

    Parameters
    ----------
    options, other_options : text of the options there and here
    events : names, as of `events_of`
    """
    before, now = entries(options), entries(other_options)
    return not _ends(now, events) and (_ends(before, events) or len(legs(now)) > len(legs(before)))


def leads_elsewhere(options, other_options, done):
    """Whether the leg under way is another one there and here: a path that an event has ended has
    to be held against it.

    Parameters
    ----------
    options, other_options : text of the options there and here
    done : number of legs that are done there
    """
    there, here = (list(map(_meaning, legs(entries(text))[done:][:1]))
                   for text in (options, other_options))
    return done >= 0 and there != here


def _ends(found, events):
    """Whether options end a path at a point for one of its events."""
    stops = [name.strip() for name in found.get("load_stop", "").split(",")]
    at = {"fold": found.get("continuation_at_fold"),
          "bifurcation": found.get("continuation_at_bifurcation")}
    return any(event in stops or at.get(event) == "stop" for event in events)


def lacking(file, fields, columns):
    """What a complete archive has not and a run asks for, a sentence; empty for nothing.

    Parameters
    ----------
    file : h5py.File, the open archive
    fields : str, the points whose fields are asked for
    columns : iterable of str, names
    """
    kept = ("none", "last", "all")
    fewer = kept.index(file.attrs["fields"]) < kept.index(fields)
    absent = ", ".join(sorted(set(columns) - set(file["branch"])))
    missing = [*[f"-archive_fields {fields} keeps"] * fewer,
               *[f"the columns {absent} tell"] * bool(absent)]
    return (f"{file.filename} {LACKING} {' and '.join(missing)}: it is made anew by "
            "-archive_overwrite, or once it is removed") if missing else ""


def on_path(points, initial, path, controls, told):
    """Points of an earlier run with their places on a path whose legs may end elsewhere than they
    did.

    Parameters
    ----------
    points : of the earlier run, oldest first: all, or the last ones
    initial : component -> Control at the start
    path : the legs, load.TypedLeg
    controls : what controls each component at the start and along each leg
        (``load.controls_along``)
    told : function (controls, load) -> str, loads in words and in the scene's units

    Raises
    ------
    InputError : for a point that does not lie on the path
    """
    placed = []
    for point in points:
        if point.leg > len(path):
            raise InputError("the points to go on from reach leg "
                             f"{point.leg}, but -load_path has {len(path)}: give "
                             "the legs that are done, too")
        under, asked = tuple(point.controls), controls[point.leg][:len(point.controls)]
        if under != asked:
            raise InputError("the points to go on from are under "
                             f"{', '.join(under)} control in leg {point.leg}, but "
                             f"-load_path has {', '.join(asked)} control there: "
                             "legs that are begun must be the same")
        named = initial if point.leg == 0 else path[point.leg - 1].controls
        found = _placed(point, named, told)
        if placed:
            _check_between(placed[-1], found, path)
        placed.append(found)
    return placed


def _check_between(last, point, path):
    """InputError unless points follow each other, a leg was done before points of a later one, and
    those between them move nothing."""
    if point.leg < last.leg or (point.leg == last.leg and not (last.arc or point.arc)
                                and point.position < last.position - ROUNDING):
        raise InputError("the points to go on from are not in their order along the path: give the "
                         "oldest first")
    if 0 < last.leg < point.leg and last.position != 1.0:
        raise InputError(f"the points to go on from leave leg {last.leg} before it ends: "
                         "legs that are done must be the same")
    for number in range(last.leg + 1, point.leg):
        for component, (control, value) in path[number - 1].controls.items():
            reached = [*(last.forces if control == "force" else last.displacements), 0.0,
                       0.0][component]
            if value is not None and not _same(value, reached):
                raise InputError("the points to go on from have none of "
                                 f"leg {number}, which moves: legs that are "
                                 "done must be the same")


def _placed(point, named, told):
    """A point with its place in a leg that ends at named values."""
    load = np.asarray(point.load)
    origin = load if point.leg == 0 or point.origin is None else np.asarray(point.origin)
    end = np.array([named[i].value if i in named and named[i].value is not None else value
                    for i, value in enumerate(origin)])
    way, gone = end - origin, load - origin
    moving = next((i for i in named if i < len(way) and way[i] != 0.0), None)
    position = 0.0 if moving is None else float(gone[moving] / way[moving])
    if abs(position - point.position) <= ROUNDING or point.leg == 0:
        position = point.position
    elif abs(position - 1.0) <= ROUNDING:
        position = 1.0
    aside = not all(_same(*pair) for pair in zip(load, end if point.leg == 0
                                                 else origin + position * way))
    if aside or position > 1.0 or position * point.position < 0.0:
        where = ("beside it" if aside else "beyond its end" if position > 1.0
                 else "behind its beginning")
        raise InputError("a point to go on from lies at "
                         f"{told(point.controls, load)} in leg {point.leg} of "
                         f"-load_path, {where}: legs that are begun must lead "
                         "through their points")
    if position == point.position:
        return point
    return replace(point, position=position, step=point.step * position / point.position)


def _same(one, other):
    """Whether two loads are the same but for rounding."""
    return abs(one - other) <= ROUNDING * max(1.0, abs(one), abs(other))
