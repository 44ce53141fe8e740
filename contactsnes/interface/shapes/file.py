"""Heights from a file."""

from ...options.fields import InputError, option
from ..gap import gap_of_heights
from ..heights import read_heights
from .shape import Shape


class File(Shape):
    """max(h) - h of measured heights, known on the grid of their file only."""

    name, meaning = "file", "-scene_geometry_file"
    geometry_file: str = option("", "heights on the grid, highest = nearest the "
                                "flat: FILE.npy, FILE.txt or FILE.h5:dataset", "u_n,r")
    gridded = True
    uses_radius = False

    def check(self, scene):
        """InputError without a file."""
        if not self.geometry_file:
            raise InputError(
                "-scene_geometry is 'file' without a file: name it by -scene_geometry_file")

    def points(self, scene):
        """Those of the file."""
        return read_heights(self.geometry_file).shape

    def heights(self, scene):
        """The heights, u_n,r."""
        return read_heights(self.geometry_file, scene.shape) / scene.scale("u_n,r")[0]

    def gap(self, coordinates, scene):
        """max(h) - h."""
        return gap_of_heights(self.heights(scene))

    def source(self, scene):
        """Option and file."""
        return f"{scene.option_name('geometry_file')} is '{self.geometry_file}'"
