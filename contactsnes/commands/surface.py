"""The surface of a scene, drawn before it is solved: ``contactsnes plot SCENE.opts``."""

from pathlib import Path

import numpy as np

from ..interface import gap, shapes
from ..options.fields import InputError
from .cautions import of_surface
from .session import start_petsc
from .speech import complain


def plot_surface(arguments, asked):
    """Draw the gap of the scene that arguments stand for, as `PlotOptions` ask; the exit status."""
    from ..output.figures.surface import draw_surface

    scene = start_petsc(arguments).scene
    if scene.isolated:
        raise InputError("-scene_period is 'inf': what is drawn is the gap over a cell; give it a "
                         "finite period")
    axes = [(np.arange(n) - n // 2) * spacing for n, spacing in zip(scene.shape, scene.spacings)]
    nodes = np.meshgrid(*axes, indexing="ij", sparse=True)
    shape, (length, unit), (height, depth) = (shapes.of(scene), scene.scale("beta"),
                                              scene.scale("u_n,r"))
    try:
        found = gap.initial_gap(shape, nodes, scene)
    except (OSError, ValueError) as error:
        raise error if isinstance(error, InputError) else InputError(str(error)) from None
    files = [argument for argument in arguments if argument.endswith(".opts")]
    stem = Path(files[0]).stem if files else scene.geometry
    title = Path(scene.geometry_file).name if scene.geometry == "file" else scene.geometry
    if asked.output and not Path(asked.output).is_dir():
        raise InputError(f"-plot_output is '{asked.output}': there is no such folder: create "
                         "it, or name another")
    files = [Path(asked.output) / f"{stem}-surface{suffix}" for suffix in asked.formats]
    draw_surface(files, [length * axis for axis in axes], height * found, (unit, depth),
                 f"{title}, {' x '.join(map(str, scene.shape))} points", asked)
    print(*files, sep="\n")
    for sentence in of_surface(scene):
        complain("warning", sentence)
    return 0
