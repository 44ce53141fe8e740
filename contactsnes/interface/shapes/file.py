"""Heights from a file."""

import numpy as np

from ...grid.cell import Grid
from ...options.fields import InputError, as_text, checked, option
from ...system.processes import world
from ..gap import gap_of_heights
from ..heights import EDGES, FILLS, on_nodes, prepared
from ..seams import rms_slope
from ..stored_heights import UNITS, Stored
from .shape import Shape

UNNAMED = "-scene_geometry is 'file' without a file: name it by -scene_geometry_file"


class File(Shape):
    """max(h) - h of measured heights, known on the grid of their file, or fitted to another."""

    name, meaning = "file", "-scene_geometry_file"
    geometry_file: str = option("", "heights on the grid, highest = nearest the "
                                "flat: FILE.npy, FILE.txt, FILE.csv, FILE.xyz or FILE.h5:dataset; "
                                "with SurfaceTopography also files of instruments", "u_n,r")
    heights_size: float | tuple = option(None, "size of the map of heights, which becomes the "
                                         "period", "beta", kind="number", above=0,
                                         many="directions", default_text="that which the file "
                                         "tells, or -scene_period")
    heights_unit: str = option(None, "unit of the heights in the file, and of places in FILE.xyz, "
                               "with -scene_units si", kind="text", choices=tuple(UNITS),
                               default_text="that which the file tells, or m")
    heights_crop: str = option("", "part of the map: first:last nodes, one pair per direction with "
                               "a comma, for instance 0:256,100:356", default_text="all of it")
    heights_fill: str = option("none", "heights that are missing: refused, or the mean, the "
                               "nearest, or interpolated", choices=FILLS)
    heights_edges: str = option("warn", "heights that do not go on at their other end: a warning, "
                                "the mean plane taken out (detrend), tapered besides (window), or "
                                "a low margin around them (pad)", choices=EDGES)
    heights_fit: str = option("exact", "heights on other points than those of the grid: refused, "
                              "or interpolated", choices=("exact", "interpolate"))
    gridded = True
    by_rows = True
    uses_radius = False

    def map(self):
        """The heights as they are used, `stored_heights.Heights`."""
        return prepared(self.geometry_file, self.heights_crop, self.heights_fill,
                        self.heights_edges)

    def unit(self):
        """The unit of the heights of a scene in SI, one of `UNITS`."""
        return self.map().unit or self.heights_unit or "m"

    @classmethod
    def completed(cls, values, scene):
        """Values as they are typed, with period, points and dimension of the map where these are
        not given.

        Parameters
        ----------
        values : mapping of options of the scene that are given
        scene : class of the scene
        """
        own = {name: checked(scene.option_name(name), values[name], scene.rule(name))
               for name in cls.declared() if values.get(name) is not None}
        if not own.get("geometry_file"):
            if values.get("units") == "si":
                raise InputError(UNNAMED)
            return values
        try:
            found = cls(**own).map()
        except (OSError, ValueError) as error:
            raise error if isinstance(error, InputError) else InputError(str(error)) from None
        given = {name for name, value in values.items() if value is not None}
        least = 0 if "points" in given else scene.rule("points")["minimum"]
        shape, dimension = cls._grid(found.values.shape, own, least), found.values.ndim
        if str(values.get("dimension") or dimension) != str(dimension):
            raise InputError(f"{scene.option_name('dimension')} is '{values['dimension']}', but "
                             f"{own['geometry_file']} has heights in {dimension} "
                             f"direction{'s' * (dimension > 1)}: leave it out")
        size = cls._size(found, own, values)
        added = {"dimension": dimension,
                 "points": shape if dimension > 1 else shape[0],
                 **({"period": size} if size else {})}
        return {**values, **{name: value for name, value in added.items() if name not in given}}

    @staticmethod
    def _grid(shape, own, least):
        """Points of a grid for a map: even ones, and as many as the least number."""
        if min(shape) < least:
            raise InputError(f"-scene_geometry_file is '{own['geometry_file']}', a map of "
                             f"{' x '.join(map(str, shape))} heights, and grids have at least "
                             f"{least} points a direction: add -scene_heights_fit interpolate and "
                             "-scene_points")
        even = tuple(n + n % 2 for n in shape)
        if even != shape and own.get("heights_fit") != "interpolate":
            crop = ",".join(f"0:{n - n % 2}" for n in shape)
            raise InputError(f"-scene_geometry_file is '{own['geometry_file']}', a map of "
                             f"{' x '.join(map(str, shape))} heights, and grids have even numbers "
                             f"of points: add -scene_heights_crop {crop}, or -scene_heights_fit "
                             "interpolate")
        return even

    @classmethod
    def _size(cls, found, own, values):
        """The period that a map sets, in what is typed; None where -scene_period does."""
        si = values.get("units") == "si"
        if not si and own.get("heights_unit"):
            raise InputError(f"-scene_heights_unit is '{own['heights_unit']}', but -scene_units is "
                             "'dimensionless', and heights are in u_n,r: add -scene_units si, or "
                             "leave it out")
        if not si and (found.unit or found.metric):
            file = own["geometry_file"]
            told = (f"heights of {file} are in {found.unit}" if found.unit
                    else f"{file} tells its size in metres")
            raise InputError(f"-scene_units is 'dimensionless', but {told}: add -scene_units si")
        if found.unit and UNITS[own.get("heights_unit") or found.unit] != UNITS[found.unit]:
            raise InputError(f"-scene_heights_unit is '{own['heights_unit']}', but the file says "
                             f"{found.unit}: leave it out")
        size = own.get("heights_size")
        given = values.get("period")
        if size is not None:
            if given is not None:
                raise InputError(f"-scene_heights_size is '{as_text(size)}', but -scene_period "
                                 f"'{as_text(given)}' fixes the same: give one of them")
            return cls._of_part(size, found, own)
        if found.metric and si and given is None and not own.get("heights_unit"):
            raise InputError(f"-scene_geometry_file is '{own['geometry_file']}', which tells its "
                             "size, but no unit of its heights: give that by -scene_heights_unit")
        if found.size is not None and given is None:
            told = found.size_in(UNITS[found.unit or own.get("heights_unit", "m")] if si else 1.0)
            return told if len(told) > 1 else told[0]
        if given is None and si:
            raise InputError(f"-scene_geometry_file is '{own['geometry_file']}', a map without "
                             "size: give that of all of it by -scene_heights_size")
        return None

    @classmethod
    def _of_part(cls, size, found, own):
        """The size of what is used of a map, from that of all of it."""
        whole = cls(geometry_file=own["geometry_file"]).whole()
        each = size if isinstance(size, (tuple, list)) else (size,) * len(whole)
        if len(each) > len(whole):
            raise InputError(f"-scene_heights_size is '{as_text(size)}', but "
                             f"{own['geometry_file']} has heights in 1 direction: give one number")
        told = tuple(length * n / count
                     for length, n, count in zip(each, found.values.shape, whole))
        return told if len(told) > 1 else told[0]

    def check(self, scene):
        """InputError without a file, or in a cell of another size than the map's."""
        if not self.geometry_file:
            raise InputError(UNNAMED)
        if self.heights_size is not None:
            own = {name: getattr(self, name) for name in self.declared()}
            try:
                size = self._of_part(self.heights_size, self.map(), own)
            except (OSError, ValueError):
                return  # that is told where the heights are wanted
            if not np.allclose(size, scene.periods, rtol=1e-6):
                typed = as_text(scene.as_typed("heights_size"))
                raise InputError(f"-scene_heights_size is '{typed}', but the period is another: "
                                 "leave it out (from Python: Scene.typed)")

    def points(self, scene):
        """Those of the file."""
        return self.map().values.shape

    def whole(self):
        """How many heights the file has, one a direction, before a part is taken or a margin
        added."""
        return prepared(self.geometry_file, fill="mean").values.shape

    def heights(self, scene, grid=None):
        """The heights, u_n,r; on a grid those at its nodes that are here."""
        unit = UNITS[self.unit()] if scene.units == "si" else 1.0
        known = self.map()
        values = known.values
        grid = Grid(scene.shape, scene.periods) if grid is None else grid
        if isinstance(values, Stored) and values.shape == scene.shape:
            found = values.rows(int(grid.row_numbers[0]), len(grid.row_numbers))
        else:
            found = grid.spread(lambda: on_nodes(known, self.geometry_file, scene.shape,
                                                 self.heights_fit, self.heights_edges))
        return found * (unit / scene.scale("u_n,r")[0])

    def gap(self, coordinates, scene):
        """max(h) - h."""
        return gap_of_heights(self.heights(scene))

    def rows(self, grid, scene):
        """The same by rows."""
        return gap_of_heights(self.heights(scene, grid), grid)

    def about(self, scene, size):
        """Height and slope."""
        def told():
            heights = self.heights(scene)
            return np.std(heights), np.ptp(heights), rms_slope(heights, scene.spacings)

        height, range_, slope = map(float, world.first(told))
        return [f"heights of {self.geometry_file}: root mean square "
                f"{size(height, 'u_n,r', 4)}, from lowest to highest "
                f"{size(range_, 'u_n,r', 4)}, root mean square slope "
                f"{size(slope, 'u_n,r/beta', 4)}"]

    def stated(self, scene):
        """The size that the file itself tells of what is used of it, beta, one a direction; None
        where it tells none."""
        size = self.map().size_in(UNITS[self.unit()] if scene.units == "si" else 1.0)
        return size and tuple(length / scene.scale("beta")[0] for length in size)

    def digit(self, scene):
        """The last digit that the file's numbers have for the largest height, u_n,r."""
        unit = UNITS[self.unit()] if scene.units == "si" else 1.0
        return self.map().digit * unit / scene.scale("u_n,r")[0]

    def source(self, scene):
        """Option and file."""
        return f"{scene.option_name('geometry_file')} is '{self.geometry_file}'"
