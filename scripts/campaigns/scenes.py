"""Random scenes over the whole option space: a seed and a number make one, always the same, as
options of ``contactsnes run``."""

import math
from dataclasses import dataclass, field

import numpy as np

SI = {"work_of_adhesion_normal": 0.03, "contact_modulus": 2e6, "radius": 0.01}


@dataclass
class Scene:
    """One scene: its number, its options (name without dash -> value), and what makes it again with
    other ones.

    Attributes
    ----------
    seed, number : of the draw
    options : name -> value; with heights, `geometry_file` is left to ``written``
    steps : steps of each leg, in the unit of what moves; the default steps of the program where
        ``given`` is false
    waves : of heights from a file: rows of wave numbers in each direction, amplitude and phase
    """

    seed: int
    number: int
    options: dict = field(default_factory=dict)
    steps: tuple = ()
    given: bool = True
    waves: np.ndarray = None

    @property
    def plane(self):
        """Whether the interface has two dimensions."""
        return self.options.get("scene_dimension") == 2

    def heights(self, shape):
        """Heights of a file on a grid of a shape, u_n,r."""
        axes = np.meshgrid(*[2.0 * np.pi * (np.arange(n) - n // 2) / n for n in shape],
                           indexing="ij")
        return sum(row[-2] * np.cos(sum(k * x for k, x in zip(row, axes)) + row[-1])
                   for row in self.waves)

    def words(self, folder, **changes):
        """Arguments of ``contactsnes run``, with other options in place of some (None: left out);
        heights are written."""
        options = {**self.options, **changes}
        if self.given or "continuation_initial_step" in changes:
            text = ",".join(f"{step:.6g}" for step in self.steps)
            options = {"continuation_initial_step": text, "continuation_largest_step": text,
                       **options}
        if self.waves is not None:
            shape = self._shape(options["scene_points"])
            path = folder / f"heights-{self.seed}-{self.number}-{'x'.join(map(str, shape))}.npy"
            factor = float(options.pop("heights_unit", 1.0))
            factor *= 1e6 if options.get("scene_heights_unit") == "um" else 1.0
            if not path.exists():
                np.save(path, factor * self.heights(shape))
            options["scene_geometry_file"] = str(path)
        return [word for name, value in options.items() if value is not None
                for word in (f"-{name}", str(value))]

    def stepped(self, factor):
        """Options for steps longer by a factor; nothing is longer than its leg."""
        text = ",".join(f"{factor * step:.6g}" for step in self.steps)
        return {"continuation_initial_step": text, "continuation_largest_step": text}

    def finer(self):
        """Options for twice the points in each direction."""
        if "scene_spacing" in self.options:
            return {"scene_spacing": f"{float(self.options['scene_spacing']) / 2:.12g}"}
        points = ",".join(str(2 * int(n)) for n in str(self.options["scene_points"]).split(","))
        if self.waves is None:
            return {"scene_points": points}
        # Heights are shifted to touch at their highest node, which may be a higher one on the finer
        # grid.
        rise = self.heights(self._shape(points)).max() - self.heights(
            self._shape(self.options["scene_points"])).max()
        offset = float(self.options.get("scene_gap_offset",
                                        0.0)) - float(self.options.get("heights_unit", 1.0)) * rise
        return {"scene_points": points, "scene_gap_offset": repr(offset)}

    def _shape(self, points):
        """Points in each direction of a grid."""
        shape = tuple(map(int, str(points).split(",")))
        return shape * 2 if self.plane and len(shape) == 1 else shape


def create(seed, number, laws=False):
    """The scene of a seed and a number.

    laws : whether its law is one of those besides the paper's; they are drawn apart, so that all
        else is as of the scene without
    """
    draw = np.random.default_rng([seed, number])
    scene = Scene(seed, number)
    kind = draw.random()
    if kind < 0.07:
        _isolated(scene, draw)
    else:
        _cell(scene, draw, kind < 0.25)
    _law(scene, draw)
    if laws:
        _other_law(scene, np.random.default_rng([seed, number, 1]))
    _load(scene, draw)
    _method(scene, draw)
    if draw.random() < 0.12:
        _in_si(scene, draw)
    # drawn apart, so that all else is as without
    on = _choice(np.random.default_rng([seed, number, 2]), None, None, "active", "cell")
    scene.options |= {"archive_fields_on": on} if on else {}
    return scene


def _choice(draw, *values):
    return values[draw.integers(len(values))]


def _log(draw, low, high, digits=3):
    return float(f"{math.exp(draw.uniform(math.log(low), math.log(high))):.{digits}g}")


def _body(draw):
    return {"scene_poisson": _choice(draw, 0.5, 0.5, 0.5, 0, 0.3, round(draw.uniform(0, 0.5), 3)),
            "scene_height": _choice(draw, "inf", "inf", 2000, 50, _log(draw, 2, 200))}


def _isolated(scene, draw):
    """A line alone on its flat."""
    maugis = _log(draw, 0.8, 3)
    scene.options |= {"scene_period": "inf",
                      "scene_spacing": float(f"{draw.uniform(0.4, 1.2) / maugis ** 2:.3g}"),
                      "scene_normal_maugis": maugis, **_body(draw)}


def _cell(scene, draw, plane):
    """A cell with a shape on it, on a grid that resolves it, or nearly so."""
    points = int(_choice(draw, 16, 16, 20, 24, 32) if plane else _choice(draw, 64, 64, 96, 128, 128,
                                                                         192, 256, 320))
    maugis = _log(draw, 0.6, 2.5 if plane else 5)
    fineness = draw.uniform(0.3, 1.2) if draw.random() < 0.85 else draw.uniform(1.2, 3)
    # Contact ends within the cell, with some room.
    # A soft law reaches far, but a contact has nodes enough only where the gap of a parabola
    # changes little from one to the next.
    widest = min(60.0, 0.5 / math.sqrt(maugis) * points) if fineness < 1.2 else 60.0
    period = round(float(np.clip(fineness * points / maugis ** 2,
                                 1.6 * math.sqrt(8 * math.e / maugis), max(widest, 1.0))), 3)
    geometry = _choice(draw, *(["sphere"] * 3 if plane else []), *["cylinder"] * 3, "sinusoid",
                       "sinusoid", "flat", "file", "file", "rough")
    options = {"scene_points": points, "scene_period": period, "scene_normal_maugis": maugis,
               "scene_geometry": geometry, **_body(draw)}
    if plane:
        options = {"scene_dimension": 2, **options}
        if draw.random() < 0.2:
            other = int(_choice(draw, 16, 20, 24, 32))
            across = max(period * other / points, 1.6 * math.sqrt(8 * math.e / maugis))
            options |= {"scene_points": f"{points},{other}",
                        "scene_period": f"{period},{across:.4g}"}
    if geometry == "sinusoid" and draw.random() < 0.7:
        options["scene_amplitude"] = _log(draw, 0.2, 5)
    if geometry == "rough":
        options |= {"scene_rough_slope": _log(draw, 0.2, 1.2),
                    "scene_rough_shortest": float(f"{_choice(draw, 8, 12) * period / points:.3g}"),
                    "scene_rough_hurst": _choice(draw, 0.8, 0.5, 1, 0.3),
                    "scene_rough_seed": int(draw.integers(1000))}
        if draw.random() < 0.3:
            options |= {"scene_rough_on": "flat", "scene_rough_rolloff": round(0.4 * period, 2)}
        if plane and "," in str(options["scene_points"]):
            options |= {"scene_points": points, "scene_period": period}
    if geometry == "file":
        scene.waves = _waves(draw, 2 if plane else 1, period)
    if draw.random() < 0.1:
        options["scene_gap_offset"] = round(draw.uniform(-1, 1), 2)
    scene.options |= options


def _waves(draw, dimension, period):
    """Some waves: any, even ones, and nearly even ones (two spots that are nearly the same)."""
    kind = draw.integers(4)
    if kind == 0:
        waves = [[2 if i == 0 else 0 for i in range(dimension)],
                 [1 if i == 0 else 0 for i in range(dimension)]]
        return np.array([[*waves[0], _log(draw, 0.5, 2), 0.0], [*waves[1], _log(draw, 1e-5, 0.3),
                                                                0.0]])
    count = int(draw.integers(2, 6))
    rows = []
    for _ in range(count):
        wave = draw.integers(-3, 4, dimension) if dimension == 2 else draw.integers(1, 5, 1)
        amplitude = draw.uniform(0.2, 1) * min(2.0, (period / 10.0) ** 2) / max(1.0,
                                                                                float(
            np.linalg.norm(wave)) ** 1.5)
        phase = (0.0 if kind == 1 else draw.uniform(0, 2 * np.pi) if kind == 2
                 else _log(draw, 1e-6, 1e-2))
        rows.append([*wave, amplitude, phase])
    return np.array(rows)


def _law(scene, draw):
    """The law of the interface."""
    options = scene.options
    if draw.random() < 0.25:
        options["scene_law"] = "mcgarry"
        friction = 0.0
    else:
        friction = _choice(draw, 1.0, 1.0, 0.5, 0.0, round(draw.random(), 2))
        options["scene_residual_friction"] = friction
        if draw.random() < 0.3:
            options["scene_residual_adhesion"] = _choice(draw, 0.1, 0.3, 0.7)
    # Friction softens by so much more than adhesion.
    most = options["scene_normal_maugis"] / math.sqrt(max(5.4 * (1 - friction),
                                                          1.0) * (2.0 if scene.plane else 1.0))
    options["scene_tangential_maugis"] = float(f"{most * draw.uniform(0.2, 0.8):.3g}")
    if draw.random() < 0.15:
        options["scene_work_ratio"] = _log(draw, 0.3, 3)
    if draw.random() < 0.15:
        options["scene_contact_threshold"] = _log(draw, 1.5, 6)
    if draw.random() < 0.1:
        options["scene_tangential"] = "on"


def _other_law(scene, draw):
    """A law besides the paper's in place of the one that was drawn, on a grid that resolves it as
    well."""
    options = scene.options
    options["scene_law"] = law = _choice(draw, "xu_needleman", "dugdale", "pressure_friction")
    softer = 1.0
    if law == "xu_needleman":
        for name in ("scene_residual_friction", "scene_residual_adhesion"):
            options.pop(name, None)
        options["scene_xu_needleman_q"] = q = _choice(draw, 1, 1, 0.5, 2, 0.8)
        options["scene_xu_needleman_r"] = _choice(draw, 0, 0, 0.2, 0.5)
        if draw.random() < 0.5:
            options["scene_work_ratio"] = q
    elif law == "dugdale":
        options["scene_dugdale_width"] = width = _choice(draw, 1, 0.7, 0.5, 0.3)
        # its attraction ends with a slope of 1/(4 w), that of a exp(-a) of exp(-2)
        softer = math.sqrt(4 * width * math.exp(-2))
    else:
        options["scene_pressure_friction"] = _choice(draw, 0, 0.1, 0.3, 1)
    for name in ("scene_normal_maugis", "scene_tangential_maugis"):
        options[name] = float(f"{min(softer, 1.0) * options[name]:.3g}")


def _load(scene, draw):
    """Start, legs and their steps."""
    options, isolated = scene.options, "scene_spacing" in scene.options
    side = float(str(options.get("scene_period")).split(",")[0])
    cell = (10.0 if isolated else side) ** (2 if scene.plane else 1)
    deep = round(float(draw.uniform(0.2, 4)), 3)
    force = round(float(draw.uniform(0.3, 6)) * (0.3 * min(cell, 40) / 10 if scene.plane else 1.0),
                  3)
    suffix = _choice(draw, "_x", "_x", "_y") if scene.plane else ""
    maugis, height = options["scene_tangential_maugis"], float(options["scene_height"])
    traction = 0.86 * maugis * min(4.0 / side, 1.0) if not isolated else 0.0
    layer = 0.0 if math.isinf(height) else traction * 2 * height / (1 - options["scene_poisson"])
    slide = float(f"{draw.uniform(0.2, 1.6) * (layer + 1 + 3 / maugis):.3g}")
    drag = float(f"{draw.uniform(0.1, 1.2) * 0.86 * maugis * 4:.3g}")
    press = f"normal_force={force}" if isolated else _choice(draw, f"normal_displacement={deep}",
                                                             f"normal_force={force}")
    shear = (f"tangential_force{suffix}={drag}" if isolated
             else _choice(draw, f"tangential_displacement{suffix}={slide}",
                          f"tangential_displacement{suffix}={slide}",
                          f"tangential_force{suffix}={drag}"))
    back = shear.split("=")[0] + "=" + _choice(draw, "0", "-" + shear.split("=")[1],
                                               f"{float(shear.split('=')[1]) / 2:.3g}")
    pull = (f"normal_force=-{round(draw.uniform(0.1, 3), 2)}" if isolated
            else _choice(draw, f"normal_displacement=-{round(draw.uniform(0.5, 5), 2)}",
                         f"normal_force=-{round(draw.uniform(0.1, 3), 2)}"))
    kinds = [[press], [press, pull], [pull, press], [press, shear], [press, shear, back],
             [press, shear, pull], [f"{press}, {shear}"], [press, _hold(draw, press, isolated),
                                                           shear, pull],
             [press, f"{_hold(draw, press, isolated)}, {shear}"],
             [press, shear, _hold(draw, shear, isolated), pull]]
    legs = kinds[draw.integers(len(kinds))]
    if scene.plane:
        legs = legs[:2]
    if not isolated:
        options["load_start"] = _choice(draw, "normal_displacement=0", "normal_displacement=-0.5",
                                        f"normal_displacement={-draw.uniform(1, 5):.3g}", press)
    options["load_path"] = "; ".join(legs)
    scene.steps = _steps(draw, options.get("load_start", ""), legs, 2 if scene.plane
                         else _choice(draw, 2, 3, 4, 5))
    scene.given = bool(draw.random() < 0.85)
    if draw.random() < 0.1:
        options["load_stop"] = _choice(draw, "gross_sliding", "pull_off", "gross_sliding,pull_off")


def _hold(draw, leg, isolated):
    """A leg that switches the control of another one's quantity, or keeps it."""
    name = leg.split("=")[0]
    other = (name.replace("force", "displacement") if "force" in name
             else name.replace("displacement", "force"))
    return f"{name if isolated else _choice(draw, other, other, name)}=hold"


def _steps(draw, start, legs, parts):
    """A part of the length of each leg, as far as that is known."""
    last, steps = {}, []
    for text in [start, *legs]:
        length = None
        for piece in filter(None, text.split(",")):
            name, value = (part.strip() for part in piece.split("="))
            if value == "hold":
                last.pop(name, None)
                continue
            if length is None and float(value) != last.get(name):
                length = max(abs(float(value) - last.get(name, 0.0)), 1e-3)
            last[name] = float(value)
        steps.append((length or 1.0) / parts)
    return tuple(steps[1:])


def _method(scene, draw):
    """Continuation, form and archive."""
    options, isolated = scene.options, "scene_spacing" in scene.options
    options["continuation_at_fold"] = _choice(draw, *["jump"] * 7, "stop", "trace")
    if draw.random() < 0.12:
        options["continuation_type"] = "arclength"
    if draw.random() < 0.35:
        options["continuation_predictor"] = _choice(draw, "none", "secant", "tangent")
    options["continuation_stability"] = _choice(draw, *["off"] * 6, "sign", "eigenvalue")
    if options["continuation_stability"] != "off" and draw.random() < 0.3:
        options["continuation_at_bifurcation"] = _choice(draw, "stop", "follow")
    if draw.random() < 0.08:
        options["contact_window"] = "off"
    if draw.random() < 0.08:
        options["contact_symmetry"] = "off"
    if not isolated and draw.random() < 0.03:
        options["contact_first"] = "relaxation"
    if not isolated and draw.random() < 0.06:
        options["contact_form"] = "force"
    if not scene.plane and draw.random() < 0.08:
        options["archive_errors"] = "true"


def _in_si(scene, draw):
    """The same scene in metres and newtons."""
    ratio = float(scene.options.pop("scene_work_ratio", 1.0))
    beta = (SI["radius"] ** 2 * SI["work_of_adhesion_normal"] / SI["contact_modulus"]) ** (1 / 3)
    normal = beta ** 2 / SI["radius"]
    tangential = math.sqrt(ratio) * normal
    body = beta if scene.plane else 1.0
    units = {"normal_displacement": normal, "tangential_displacement": tangential,
             "normal_force": SI["contact_modulus"] * normal * body,
             "tangential_force": SI["contact_modulus"] * tangential * body}
    options = {
        "scene_units": "si",
        **{f"scene_{name}": value for name, value in SI.items()},
        "scene_work_of_adhesion_tangential": ratio * SI["work_of_adhesion_normal"],
        **{f"scene_range_{way}": f"{unit / scene.options.pop(f'scene_{way}_maugis'):.12g}"
           for way, unit in (("normal", normal), ("tangential", tangential))},
    }
    lengths = {"scene_period": beta, "scene_spacing": beta, "scene_height": beta,
               "scene_amplitude": normal, "scene_gap_offset": normal, "scene_rough_shortest": beta,
               "scene_rough_rolloff": beta, "scene_rough_slope": normal / beta}
    for name, value in scene.options.items():
        if name in lengths:
            value = ",".join(f"{float(part) * lengths[name]:.12g}"
                             for part in str(value).split(","))
        if name in ("load_start", "load_path"):
            value = _converted(value, units)
        options[name] = value
    scene.steps = tuple(step * units[_moved(leg)]
                        for step, leg in zip(scene.steps, options["load_path"].split(";")))
    if scene.waves is not None:
        options["heights_unit"] = normal
        if draw.random() < 0.5:
            options["scene_heights_unit"] = "um"
    if draw.random() < 0.5:
        _as_measured(options)
    scene.options = options


def _as_measured(options):
    """Young's modulus in place of the contact modulus, and strengths in place of ranges of the
    paper's laws, with the law's peaks of eq. 4."""
    modulus = float(options.pop("scene_contact_modulus"))
    poisson = float(options.get("scene_poisson", 0.5))
    options["scene_young_modulus"] = f"{modulus * (1 - poisson ** 2):.15g}"
    if options.get("scene_law", "modified") not in ("modified", "mcgarry"):
        return
    for way, strength, peak in (("normal", "adhesive", math.exp(-1)),
                                ("tangential", "shear", math.sqrt(2 / math.e))):
        work = float(options[f"scene_work_of_adhesion_{way}"])
        length = float(options.pop(f"scene_range_{way}"))
        options[f"scene_{strength}_strength"] = f"{peak * work / length:.15g}"


def _moved(leg):
    """The quantity, without direction, that a leg moves first."""
    pieces = [piece.split("=") for piece in leg.split(",")]
    name = next((name for name, value in pieces if value.strip() != "hold"), pieces[0][0]).strip()
    return name.removesuffix("_x").removesuffix("_y")


def _converted(text, units):
    """A load with its values in other units."""
    def piece(part):
        name, value = (word.strip() for word in part.split("="))
        return (part.strip() if value == "hold"
                else f"{name}={float(value) * units[_moved(part)]:.12g}")
    return "; ".join(", ".join(map(piece, leg.split(","))) for leg in text.split(";"))
