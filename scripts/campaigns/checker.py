"""Recomputes what an archive says from its displacements, and tells what is not so. NumPy and h5py
alone, nothing of the package."""

import math
import re
from typing import NamedTuple

import h5py
import numpy as np

from . import physics

TOLERANCE = 1e-8
"""Of residuals (the default of -snes_atol)."""

EVENTS = ("gross_sliding", "pull_off")


class Complaint(NamedTuple):
    """What is wrong: a word for its kind, the number of the point from 1 (0: the path), and a
    sentence."""

    kind: str
    point: int
    text: str


class Path(dict):
    """An archive in scaled units: columns by name, and

    scene : attributes, lengths as tuples
    options : name -> text of the options it was made with
    legs : controls of the start and of each leg, component -> (kind, value or None)
    warnings : what the program said to beware of
    displacement, traction, gap, coordinates : fields of all points, or None
    mean : of displacements, where an archive has those of the nodes where the law acts, or None
    """


def scales(scene):
    """Unit of an archive -> its size in what the archive is written in, by the symbols of the
    dimensionless form."""
    if scene["units"] != "si":
        return {}
    adhesion, modulus, radius = (scene[name] for name in ("work_of_adhesion_normal",
                                                          "contact_modulus", "radius"))
    beta = (radius ** 2 * adhesion / modulus) ** (1.0 / 3.0)
    normal = beta ** 2 / radius
    tangential = math.sqrt(scene["work_of_adhesion_tangential"] / adhesion) * normal
    body = beta ** (scene["dimension"] - 1)
    return {"length": beta, "normal_displacement": normal, "tangential_displacement": tangential,
            "normal_force": modulus * normal * body, "tangential_force": modulus * tangential
            * body, "normal_traction": adhesion / scene["range_normal"],
            "tangential_traction": scene["work_of_adhesion_tangential"] / scene["range_tangential"],
            "energy": modulus * normal ** 2 * body}


OF_COLUMN = {"approach": "normal_displacement",
             "mean_tangential_displacement": "tangential_displacement",
             "minimum_gap": "normal_displacement",
             "maximum_tangential_gap": "tangential_displacement",
             "maximum_pressure": "normal_traction",
             "maximum_tangential_traction": "tangential_traction"}


def size(name, units, dimension):
    """Size of the unit of a column or quantity."""
    name = re.sub("_[xy]$", "", name)
    if name == "contact_area":
        return units.get("length", 1.0) ** dimension
    if name.endswith(("_work", "_energy", "_imbalance")):
        return units.get("energy", 1.0)
    return units.get(OF_COLUMN.get(name, name), 1.0)


def quantity(name):
    """Component and kind ('displacement' or 'force') of a quantity of the load."""
    direction, kind = name.split("_")[:2]
    return {"normal": 0}.get(direction, 2 if name.endswith("_y") else 1), kind


def names(dimension, kind):
    """Columns of displacements or forces, by component."""
    return [f"normal_{kind}", *(f"tangential_{kind}{end}"
                                for end in (("",) if dimension == 1 else ("_x", "_y")))]


def _controls(text, units, dimension):
    found = {}
    for piece in filter(None, map(str.strip, text.split(","))):
        name, value = map(str.strip, piece.split("="))
        component, kind = quantity(name)
        found[component] = kind, None if value == "hold" else float(value) / size(name, units,
                                                                                  dimension)
    return found


def read(path):
    """The `Path` of an archive."""
    with h5py.File(path, "r") as file:
        count = int(file.attrs["points"])
        scene = {name: value.item() if hasattr(value, "item") and np.ndim(value) == 0 else value
                 for name, value in file["scene"].attrs.items()}
        found = Path()
        for name, column in file["branch"].items():
            values = column[:count]
            if "names" in column.attrs:
                words = [word if isinstance(word, str) else word.decode()
                         for word in column.attrs["names"]]
                values = [words[value] for value in values]
            found[name] = values
        found.warnings = str(file.attrs.get("warnings", ""))
        lines = str(file.attrs["options"]).splitlines()
        found.options = {
            line.split(" ")[0][1:]: line.partition(" ")[2].split(" # (source")[0].strip('"')
            for line in lines
        }
        fields, found.displacement, found.mean = file.get("fields"), None, None
        if fields is not None and "displacement" in fields and len(fields["displacement"]) == count:
            found.displacement, found.traction = (fields[name][:count]
                                                  for name in ("displacement", "traction"))
        elif fields is not None and len(fields.get("active/offsets", ())) == count + 1:
            _take_active(found, fields["active"], fields["initial_gap"].shape)
        if found.displacement is not None:
            found.gap = fields["initial_gap"][...]
            found.coordinates = [fields[name][...] for name in "xy" if name in fields]
    return _scaled(found, scene)


def _take_active(found, active, shape):
    """Fields kept on the nodes where the law acts: no traction elsewhere, and displacements that
    are not known yet (nan)."""
    offsets, components = active["offsets"][...], active["traction"].shape[0]
    for name, beyond in (("displacement", np.nan), ("traction", 0.0)):
        values = np.full((len(offsets) - 1, components, math.prod(shape)), beyond)
        for point, (begin, end) in enumerate(zip(offsets, offsets[1:])):
            values[point][:, active["nodes"][begin:end]] = active[name][:, begin:end]
        setattr(found, name, values.reshape(*values.shape[:2], *shape))
    found.mean = active["mean"][:len(offsets) - 1]


def _completed(found, scene, units):
    """Displacements of all nodes, where an archive has those of some: what their tractions make of
    the body, by the checker's own compliance, about the mean that the archive tells."""
    shape, both = found.gap.shape, ("normal", *["tangential"] * found.gap.ndim)
    isolated = math.inf in scene["period"]
    if isolated and found.gap.ndim == 2:
        found.displacement = None
        return
    axes = tuple(range(1, 1 + found.gap.ndim))
    body = (scene["poisson"], scene["height"], math.sqrt(scene["work_ratio"]))
    symbols = (physics.unbounded(shape[0], found.coordinates[0][1] - found.coordinates[0][0], *body)
               if isolated else physics.compliance(shape, scene["period"], *body))
    maugis = np.array([scene["normal_maugis"], *[scene["tangential_maugis"]] * found.gap.ndim])
    for point, values in enumerate(found.displacement):
        scaled = found.traction[point] * maugis.reshape(-1, *[1] * found.gap.ndim)
        if isolated:
            scaled = np.pad(scaled, ((0, 0), (0, shape[0])))
        made = deformed(scaled, symbols, axes)[..., :shape[-1]]
        for i, component in enumerate(both):
            known = ~np.isnan(values[i])
            # (where nothing acts the body moves as a whole)
            mean = (np.mean((values[i] - made[i])[known]) if isolated and known.any()
                    else found.mean[point, i] / units.get(component + "_displacement", 1.0)
                    - made[i].mean())
            values[i] = np.where(known, values[i], made[i] + mean)


def deformed(scaled, symbols, axes):
    """Displacements under scaled tractions but for their mean."""
    spectrum = np.fft.fftn(-scaled, axes=axes)
    return np.fft.ifftn(np.einsum("ij...,j...->i...", symbols, spectrum), axes=axes).real


def _scaled(found, scene):
    """The path in scaled units."""
    dimension, units = int(scene["dimension"]), scales(scene)
    length = units.get("length", 1.0)
    for name in ("period", "points", "spacing", "amplitude"):
        if name in scene:
            factor = 1.0 if name == "points" else length
            if name == "amplitude":
                factor = units.get("normal_displacement", 1.0)
            scene[name] = tuple(np.broadcast_to(np.atleast_1d(scene[name]), dimension) / factor)
    scene["height"] = float(scene["height"]) / length
    scene["gap_offset"] = scene["gap_offset"] / units.get("normal_displacement", 1.0)
    if units:
        scene["normal_maugis"] = units["normal_displacement"] / scene["range_normal"]
        scene["tangential_maugis"] = units["tangential_displacement"] / scene["range_tangential"]
        scene["work_ratio"] = (scene["work_of_adhesion_tangential"]
                               / scene["work_of_adhesion_normal"])
    for name in found:
        if len(found[name]) and not isinstance(found[name][0], str):
            found[name] = np.asarray(found[name]) / size(name, units, dimension)
    if found.displacement is not None:
        both = ("normal", *["tangential"] * dimension)
        for i, component in enumerate(both):
            found.displacement[:, i] /= units.get(component + "_displacement", 1.0)
            found.traction[:, i] /= units.get(component + "_traction", 1.0)
        found.gap = found.gap / units.get("normal_displacement", 1.0)
        found.coordinates = [x / length for x in found.coordinates]
    if found.mean is not None:
        _completed(found, scene, units)
    found.scene = scene
    found.units = units
    found.dimension = dimension
    found.isolated = math.inf in scene["period"]
    resting = "force" if found.isolated else "displacement"
    start = ({i: (resting, 0.0) for i in range(1 + dimension)}
             | _controls(found.options.get("load_start", ""), units, dimension))
    found.legs = [start, *(_controls(text, units, dimension)
                           for text in found.options.get("load_path", "").split(";"))]
    return found


class Checker:
    """Checks the points of an archive.

    Parameters
    ----------
    path : of the archive
    status : exit status of the run, or None if it was killed
    tolerance : of residuals, where the run had another -snes_atol
    """

    def __init__(self, path, status=0, tolerance=None):
        self.path = read(path)
        self.status = status
        self.complaints = []
        self.scene = self.path.scene
        self.dimension = self.path.dimension
        self.isolated = self.path.isolated
        self.count = len(self.path["leg"])
        self.tolerance = tolerance or float(self.path.options.get("snes_atol", TOLERANCE))
        self.ranges = np.array([self.scene["normal_maugis"],
                                *[self.scene["tangential_maugis"]] * self.dimension])
        self.ratio = math.sqrt(self.scene["work_ratio"])
        self.weights = np.array([1.0, *[self.scene["work_ratio"]] * self.dimension])
        self.fields = self.path.displacement is not None and self.count > 0
        if self.fields:
            self._prepare()

    def _prepare(self):
        """Grid, gaps and tractions of all points."""
        path = self.path
        self.shape, each = path.gap.shape, (-1, *[1] * self.dimension)
        self.spacings = [x[1] - x[0] for x in path.coordinates]
        self.node = float(np.prod(self.spacings))
        self.area = self.node * path.gap.size
        gaps = path.displacement.copy()
        gaps[:, 0] += path.gap
        self.gaps = gaps * self.ranges.reshape(each)
        self.near = physics.near(self.scene)
        self.deepest = -30.0 * physics.overlap_unit(self.scene)
        with np.errstate(over="ignore", invalid="ignore"):
            self.law = np.array([physics.tractions(self.scene, gap[0], gap[1:])
                                 for gap in self.gaps])
        self.scaled = self.law * self.ranges.reshape(each)

    def say(self, kind, point, text):
        """Take down a complaint; of one kind the first only."""
        if all(other.kind != kind for other in self.complaints):
            self.complaints.append(Complaint(kind, point, text))

    def run(self):
        """All complaints."""
        if self.count == 0:
            return self.complaints
        self._columns()
        self._loads()
        if self.fields:
            self._geometry()
            for point in range(self.count):
                self._point(point)
            self._residuals()
            self._events()
            self._energies()
        return self.complaints

    # columns alone

    def _columns(self):
        """Numbers are numbers, and a fold is known as closely as it has to be."""
        for name in ("leg", "normal_force", "contact_area", "minimum_gap", "maximum_pressure",
                     "residual_norm"):
            if not np.all(np.isfinite(self.path[name])):
                self.say("not a number", int(np.argmin(np.isfinite(self.path[name]))) + 1,
                         f"{name} is not finite")
        worst = int(np.argmax(self.path["residual_norm"]))
        if not self.path["residual_norm"][worst] <= 1.0001 * self.tolerance:
            self.say("not converged", worst + 1,
                     f"residual_norm {self.path['residual_norm'][worst]:.3g}")
        steps = np.diff(self.path["leg"])
        if np.any(steps < 0):
            self.say("legs", int(np.argmin(steps)) + 2, "the number of the leg falls")
        leaves = {"fold", *["bifurcation"] * (self.path.options.get("continuation_at_bifurcation")
                                              == "follow")}
        for point, (event, kind) in enumerate(zip(self.path["event"], self.path["fold_kind"])):
            if (event == "fold") != bool(kind):
                self.say("fold_kind", point + 1, f"{event} with the kind '{kind}'")
            if event == "jump" and leaves.isdisjoint(self.path["event"][max(0, point - 3):point]):
                self.say("jump", point + 1, "no fold before the jump")
            precision = self.path.get("fold_precision")
            if (event == "fold" and precision is not None and self.dimension == 1
                and not precision[point] <= 1e-8):
                self.say("fold_precision", point + 1, f"a fold known to {precision[point]:.2g}")

    def _loads(self):
        """Controlled values along legs and at their ends."""
        columns = {kind: [self.path[name] for name in names(self.dimension, kind)]
                   for kind in ("displacement", "force")}
        controls = dict(self.path.legs[0])
        self._expect(0, {i: control for i, control in controls.items()}, columns)
        before = 0
        for number, named in enumerate(self.path.legs[1:], start=1):
            members = np.flatnonzero(self.path["leg"] == number)
            held = {i: (kind, columns[kind][i][before]) if kind != controls[i][0] or value is None
                    else controls[i] for i, (kind, value) in named.items()}
            start = {i: (kind, columns[kind][i][before])
                     for i, (kind, _) in {**controls, **held}.items()}
            controls = {**start, **{i: (kind, start[i][1] if value is None else value)
                                    for i, (kind, value) in named.items()}}
            moving = [i for i in controls if controls[i][1] != start[i][1]]
            if members.size:
                self._along(members, start, controls, moving, columns)
                before = members[-1]
            over = self.status == 0 and not self._stopped()
            if over or np.any(self.path["leg"] > number):
                if moving or not members.size:
                    self._expect(int(before), controls, columns)
        return controls

    def _stopped(self):
        """Whether the last point is one where the path was asked to end; it may have further
        events."""
        options = self.path.options
        loads = [name for kind in ("displacement", "force") for name in names(self.dimension, kind)]
        events = {self.path["event"][point] for point in range(max(self.count - 4, 0), self.count)
                  if all(np.array_equal(*self.path[name][[point, -1]], equal_nan=True)
                         for name in loads)}
        return (not events.isdisjoint(options.get("load_stop", "none").split(","))
                or ("fold" in events and (options.get("continuation_at_fold") == "stop"
                                          or "pull_off" in options.get("load_stop", "")))
                or (events | {*self.path["event"][-2:]}) >= {"bifurcation"}
                and options.get("continuation_at_bifurcation") == "stop")

    def _allowed(self, kind, value):
        """How closely a controlled value has to be met."""
        return (1e-11 * (1.0 + abs(value)) if kind == "displacement"
                else 2.0 * self.tolerance * max(1.0, abs(value)))

    def _expect(self, point, controls, columns):
        """Controlled values at a point; at the first those of -load_start."""
        for i, (kind, value) in controls.items():
            found = columns[kind][i][point]
            if np.isnan(found) and self.isolated:
                continue
            if not abs(found - value) <= self._allowed(kind, value):
                self.say("end of leg", point + 1, f"{names(self.dimension, kind)[i]} is "
                         f"{found:.12g}, asked for {value:.12g}")

    def _along(self, members, start, end, moving, columns):
        """Points of a leg lie on the straight line between its ends."""
        direction = np.array([end[i][1] - start[i][1] if i in moving else 0.0 for i in end])
        values = np.array([columns[end[i][0]][i][members] for i in end])
        first = np.array([start[i][1] for i in end])
        lead = int(np.argmax(np.abs(direction)))
        place = (values[lead] - first[lead]) / direction[lead] if moving else np.zeros(len(members))
        missed = np.abs(values - first[:, None] - direction[:, None] * place)
        for row, i in enumerate(end):
            allowed = np.array([2.0 * self._allowed(end[i][0], value) for value in values[row]])
            if moving and end[list(end)[lead]][0] == "force":
                allowed = (allowed + np.abs(direction[row] / direction[lead]) * 2.0 * self.tolerance
                           * np.maximum(1.0, np.abs(values[lead])))
            wrong = ~(missed[row] <= allowed) & ~np.isnan(values[row])
            if wrong.any():
                point = int(np.argmax(wrong))
                self.say("controlled value", int(members[point]) + 1,
                         f"{names(self.dimension, end[i][0])[i]} is "
                         f"{values[row][point]:.12g}, off its leg by "
                         f"{missed[row][point]:.2g}")
        plain = (self.path.options.get("continuation_type") != "arclength"
                 and self.path.options.get("continuation_at_fold") != "trace")
        if plain and moving and (place.max() > 1.0 + 1e-6 or place.min() < -1e-6
                                 or np.any(np.diff(place) < -1e-6)):
            self.say("off the leg", int(members[0]) + 1, "points do not go forward on their leg")

    # one point

    def _geometry(self):
        """The initial gap, where a formula gives it."""
        gap = physics.initial_gap(self.scene, self.path.coordinates)
        if gap is not None and not np.allclose(gap, self.path.gap, rtol=1e-9,
                                               atol=1e-9 * (1.0 + np.abs(gap).max())):
            self.say("initial gap", 0, f"differs by {np.abs(gap - self.path.gap).max():.3g}")

    def _point(self, point):
        """Tractions, forces, displacements, gaps and area of a point."""
        path, gap = self.path, self.gaps[point]
        if gap[0].min() < self.deepest:
            return self.say("too deep", point + 1, f"a gap of {gap[0].min():.3g} ranges")
        law, largest = self.law[point], max(1.0, np.abs(self.law[point]).max())
        missed = np.abs(law - path.traction[point]).max()
        if not missed <= 1e-7 * largest:
            self.say("traction", point + 1, f"is off the law's by {missed:.3g}")
        forces = (self.ranges * self.node * law.reshape(len(law),
                                                        -1).sum(axis=1)
                  * np.array([-1.0, *[1.0] * self.dimension]))
        for name, force in zip(names(self.dimension, "force"), forces):
            self._same(name, point, force, 2.0 * self.tolerance * max(1.0, abs(force))
                       + 1e-9 * self.area * largest * self.ranges.max())
        if not self.isolated:
            means = (path.displacement[point].reshape(len(law),
                                                      -1).mean(axis=1)
                     * np.array([-1.0, *[1.0] * self.dimension]))
            soft = physics.mean_compliance(self.scene["poisson"], self.scene["height"])
            slips = ("",) if self.dimension == 1 else ("_x", "_y")
            for i, name in enumerate(["approach", *("mean_tangential_displacement" + end
                                                    for end in slips)]):
                doubt = 1e-9 * (1.0 + abs(means[i])) + 10.0 * self.tolerance / self.ranges[i]
                self._same(name, point, means[i], doubt)
                layer = soft[min(i, 1)] / self.area
                force = path[names(self.dimension, "force")[i]][point]
                # (a force that is controlled errs in proportion to its size)
                self._same(names(self.dimension, "displacement")[i], point,
                           means[i] + layer * force,
                           doubt + 2.0 * self.tolerance * max(1.0, abs(force)) * layer)
        self._same("minimum_gap", point, gap[0].min() / self.ranges[0],
                   1e-9 * (1.0 + np.abs(gap[0]).max()))
        self._same("maximum_pressure", point, max(0.0, -law[0].min()), 1e-7 * largest)
        self._area(point, gap[0])

    def _same(self, name, point, value, allowed):
        found = self.path[name][point]
        if not abs(found - value) <= allowed:
            self.say(name, point + 1, f"is {found:.12g}, recomputed {value:.12g}")

    def _area(self, point, gap):
        """Length or area in contact, whose edge lies between nodes: in the plane as closely as
        nodes inside tell."""
        inside = gap < self.scene["contact_threshold"]
        border = np.zeros_like(inside)
        for axis in range(gap.ndim):
            for way in (1, -1):
                border |= inside != np.roll(inside, way, axis)
        found = self.path["contact_area"][point]
        if found == 0.0 and gap.min() > self.scene["contact_threshold"] - 1e-7:
            return  # no contact without a node in it
        if self.dimension == 1:
            edges = np.flatnonzero(inside != np.roll(inside, 1))
            # A parabola has a kink where the cell closes.
            closing = np.minimum(edges, gap.size - edges) < 3
            estimate = self._length(gap)
            allowed = self.node * (0.05 * len(edges) + np.sum(closing)) + 1e-9
        else:
            estimate, allowed = self.node * inside.sum(), self.node * (0.5 * border.sum() + 1.0)
        if not abs(found - estimate) <= allowed:
            self.say("contact_area", point + 1,
                     f"is {found:.9g}, recomputed {estimate:.9g} +- {allowed:.2g}")

    def _length(self, gap):
        """Length below the threshold of the cubic through four neighbours of each interval, on 16
        parts of it."""
        level, parts = self.scene["contact_threshold"], np.arange(1, 16) / 16.0
        low, high = np.minimum(gap, np.roll(gap, -1)), np.maximum(gap, np.roll(gap, -1))
        total = self.node * np.sum(high < level)
        for node in np.flatnonzero((low < level) & (high >= level)):
            four = gap[(node + np.arange(-1, 3)) % gap.size]
            if self.isolated and not 0 < node < gap.size - 2:
                continue
            curve = np.polynomial.Polynomial(np.linalg.solve(np.vander([-1.0, 0.0, 1.0, 2.0],
                                                                       increasing=True), four))
            values = np.array([four[1], *curve(parts), four[2]]) - level
            ends = values[:-1], values[1:]
            below = np.where(ends[0] * ends[1] < 0,
                             np.maximum(-ends[0],
                                        -ends[1]) / np.abs(ends[0] - ends[1]
                                                           + (ends[0] == ends[1])),
                             (ends[0] < 0) * 1.0)
            total += self.node * float(np.mean(below))
        return total

    # equilibrium

    def _residuals(self):
        """Imbalance of displacements and tractions where the law acts, in ranges of the law."""
        if self.isolated:
            return self._residuals_unbounded()
        symbols = physics.compliance(self.shape, self.scene["period"], self.scene["poisson"],
                                     self.scene["height"], self.ratio)
        for point in range(self.count):
            self._imbalance(point, self._deformed(self.scaled[point], symbols))
        return None

    def _deformed(self, scaled, symbols):
        """Displacements under tractions but for their mean."""
        return deformed(scaled, symbols, tuple(range(1, 1 + self.dimension)))

    def _residuals_unbounded(self):
        """The same for an isolated contact, against the mean where the law acts."""
        if self.dimension == 2:
            return
        nodes = self.shape[0]
        symbols = physics.unbounded(nodes, self.spacings[0], self.scene["poisson"],
                                    self.scene["height"], self.ratio)
        for point in range(self.count):
            padded = np.pad(self.scaled[point], ((0, 0), (0, nodes)))
            self._imbalance(point, self._deformed(padded, symbols)[:, :nodes], mean=False)

    def _imbalance(self, point, deformed, mean=True):
        """Compare displacements with those that the tractions make."""
        if self.gaps[point, 0].min() < self.deepest:
            return
        difference = self.path.displacement[point] - deformed
        active = self.gaps[point, 0] < self.near
        if not active.any():
            active[...] = True
        bonded = self._sheared(point)
        for i in range(1 + self.dimension if bonded else 1):
            part = difference[i]
            wrong = (part - (part.mean() if mean else part[active].mean())) * self.ranges[i]
            floor = (1e-13 * self.ranges[i] * np.abs(self.path.displacement[point, i]).max() + 1e-10
                     + self._rounding(point))
            norm, largest = math.sqrt(np.mean(wrong[active] ** 2)), np.abs(wrong[active]).max()
            told = self.path["residual_norm"][point]
            if ("largest_residual" in self.path and largest > self.path["largest_residual"][point]
                + 3.0 * told + floor):
                self.say("largest_residual", point + 1, f"recomputed {largest:.3g} in "
                         f"component {i}, told "
                         f"{self.path['largest_residual'][point]:.3g}")
            # The mean runs over the window's nodes, which may be the whole cell.
            if (norm > 1.1 * told * math.sqrt((1 + self.dimension) * wrong.size / active.sum())
                + floor or norm > 100.0 * self.tolerance + floor):
                self.say("residual", point + 1, f"recomputed {norm:.3g} ranges (largest "
                         f"{largest:.3g}) in component {i}, told {told:.3g}")

    def _rounding(self, point):
        """What the last bit of stored displacements makes, in deep overlap, of those under the
        tractions: ranges."""
        deepest = min(0.0, self.gaps[point, 0].min()) / physics.overlap_unit(self.scene)
        longest = max(points * spacing for points, spacing in zip(self.shape, self.spacings))
        stiffest = ((1.0 - deepest) * math.exp(-deepest) / physics.overlap_unit(self.scene)
                    * self.ranges[0] ** 2 * longest / math.pi)
        return (2.0 * np.finfo(float).eps * self.ranges[0] * np.abs(self.path.displacement[point,
                                                                                           0]).max()
                * stiffest)

    def _sheared(self, point):
        """Whether a point has tangential unknowns: where asked for, or where body or load make
        them."""
        if self.scene["tangential"] != "auto":
            return self.scene["tangential"] == "on"
        resting = ("force" if self.isolated else "displacement", 0.0)
        named = any(control != resting for i, control in self.path.legs[0].items() if i)
        return named or self._coupled() or any(max(leg) > 0
                                               for leg in self.path.legs[1:int(
            self.path["leg"][point]) + 1])

    def _coupled(self):
        """Whether the body moves sideways under normal tractions by more than rounding."""
        if self.scene["poisson"] < 0.5:
            return True
        if self.isolated:
            return math.isfinite(self.scene["height"])
        q = 2.0 * np.pi / max(self.scene["period"])
        return abs(physics.plane_strain(q, 0.5, self.scene["height"])[0, 1]) * q / 2.0 > 1e-14

    # events and energies

    def _groups(self):
        """Lists of points of one state: copies carry further events."""
        groups = [[0]]
        for point in range(1, self.count):
            same = np.array_equal(self.path.displacement[point], self.path.displacement[point - 1])
            if same and self.path["leg"][point] == self.path["leg"][point - 1]:
                groups[-1].append(point)
            else:
                groups.append([point])
        return groups

    def _events(self):
        """Gross sliding and loss of contact stand where they happen, once, and nowhere else."""
        level = self.scene["contact_threshold"]
        before = None
        doubtful = False
        groups = self._groups()
        for number, group in enumerate(groups):
            gap = self.gaps[group[0]]
            slip = np.sqrt(np.sum(gap[1:] ** 2, axis=0))
            touching = gap[0] < level
            now = bool(touching.any() and np.all(slip[touching] > physics.PEAK_SLIP)), bool(
                touching.any())
            # An event that is located to the last bit may be told on either side of it.
            open_before = doubtful
            doubtful = min(np.abs(gap[0] - level).min(),
                           np.abs(slip - physics.PEAK_SLIP).min()) < 1e-7
            wanted = (set() if before is None
                      else {event for event, is_so in zip(EVENTS,
                                                          (now[0] and not before[0], before[1]
                                                           and not now[1])) if is_so})
            found = {self.path["event"][point] for point in group} & set(EVENTS)
            last = number == len(groups) - 1 and self._stopped()
            if found != wanted and not (doubtful or open_before) and not (last and found < wanted):
                self.say("event", group[0] + 1,
                         f"{sorted(found) or 'none'} told, {sorted(wanted) or 'none'} found")
            before = now

    def stored(self, point):
        """Elastic energy, and energy of the interface or nan where there is slip."""
        forces = np.array([self.path[name][point] for name in names(self.dimension, "force")])
        layer = np.array([physics.mean_compliance(self.scene["poisson"],
                                                  self.scene["height"])[min(i, 1)]
                          for i in range(1 + self.dimension)]) / self.area
        means = self.path.displacement[point].reshape(1 + self.dimension,
                                                      -1).mean(axis=1).reshape(-1,
                                                                               *[1]
                                                                               * self.dimension)
        waves = -0.5 * self.node * np.sum((self.scaled[point] * (self.path.displacement[point]
                                                                 - means)).reshape(len(forces), -1),
                                          axis=1)
        elastic = float(self.weights @ (waves + 0.5 * layer * forces ** 2))
        gap = self.gaps[point]
        if np.any(np.abs(gap[1:][:, gap[0] < self.near]) > 1e-6):
            return elastic, math.nan
        return elastic, self.node * float(np.sum(physics.potential(self.scene, gap[0])))

    def _energies(self):
        """Energies by their definitions; steps lose nothing, and jumps do."""
        if self.isolated:
            return
        energies = np.array([self.stored(point) for point in range(self.count)])
        scale = 1.0 + sum(np.nanmax(np.abs(column), initial=0.0) for column in energies.T)
        # what solves leave of displacements, times forces
        left = 2.0 * self.tolerance * sum(
            w * np.abs(self.path[d] * self.path[f])
            for w, d, f in zip(self.weights, *(names(self.dimension, kind)
                                               for kind in ("displacement", "force"))))
        for column, values in zip(("elastic_energy", "interfacial_energy"), energies.T):
            told = self.path[column]
            known = ~np.isnan(values) & ~np.isnan(told)
            wrong = np.abs(told - values) > 1e-6 * scale + left
            if np.any(wrong & known):
                point = int(np.argmax(wrong & known))
                self.say(column, point + 1, f"is {told[point]:.9g}, recomputed {values[point]:.9g}")
        self._balance(energies.sum(axis=1), np.abs(energies[:, 0]), scale, left)

    def _balance(self, energy, elastic, scale, left):
        """Works between neighbours where all energy is known: the loads' work is stored, but for
        what a jump loses."""
        loads = [[self.path[name] for name in names(self.dimension, kind)]
                 for kind in ("displacement", "force")]
        lost = self.path["dissipated_work"]
        doubts = sum(w * np.abs(np.diff(d) * np.diff(f)) for w, d, f in zip(self.weights, *loads))
        # Where a force has an extremum in a step, only its neighbours show how much it varies.
        if self.count > 2:
            # Events at one load have no work: behind a jump the step to its fold is the neighbour.
            before = doubts.copy()
            for step in np.flatnonzero(doubts[1:] <= 1e-9 * scale) + 1:
                before[step] = before[step - 1]
            doubts = np.maximum.reduce([doubts, np.append(doubts[1:], 0.0),
                                        np.append(0.0, before[:-1])])
            for w, d, f in zip(self.weights, *loads):
                steps = np.diff(d)
                slopes = np.divide(np.diff(f), steps, out=np.zeros_like(steps), where=steps != 0.0)
                doubts += 0.5 * w * steps ** 2 * np.append(np.abs(np.diff(slopes)), 0.0)
        for point in range(1, self.count):
            external = sum(w * (d[point] - d[point - 1]) * 0.5 * (f[point] + f[point - 1])
                           for w, d, f in zip(self.weights, *loads))
            doubt = doubts[point - 1]
            balance = external - (energy[point] - energy[point - 1])
            is_jump, change = self.path["event"][point] == "jump", lost[point] - lost[point - 1]
            if np.isnan(change):
                continue
            if not is_jump and abs(change) > 1e-9 * scale:
                self.say("dissipation", point + 1, f"{change:.3g} is lost in a step")
            if is_jump and change < -1e-5 * (1.0 + elastic[point]) - left[point]:
                self.say("dissipation", point + 1, f"a jump gains {-change:.3g}")
            if np.isnan(balance):
                continue
            if not is_jump and abs(balance) > 0.6 * doubt + 1e-6 * scale:
                self.say("balance", point + 1, f"{balance:.3g} is missing in a "
                         f"step, whose works are known to {doubt:.2g}")
            if is_jump and abs(balance - change) > 1e-5 * scale:
                self.say("dissipation", point + 1, f"a jump loses {balance:.6g}, told {change:.6g}")


def check(path, status=0, tolerance=None):
    """Complaints about an archive, a list."""
    return Checker(path, status, tolerance).run()
