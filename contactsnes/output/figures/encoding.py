"""Movies as files: GIF, and MP4 by ffmpeg."""

import subprocess
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib import animation
from PIL import Image

from ...options.fields import InputError
from ..files import check_ending

SHADES, NEAR = 65, 4
"""Colours of a map in a GIF, its middle among them, and how near one of them a colour is that goes
without its own."""


def write_gif(path, rate, scenes):
    """Write scenes as a GIF, whose pictures share their colours.

    Parameters
    ----------
    path : path of the file
    rate : float, pictures a second
    scenes : Scenes
    """
    count = len(scenes.points)
    pictures = scenes.pictures([count - 1, *range(count)])
    colours, palette = _colours(next(pictures), scenes.colormaps), Image.new("P", (1, 1))
    # Pillow looks for the colour that is nearest to the multiples of 4 below a pixel's.
    palette.putpalette([value & ~3 for value in colours])
    first, *others = [Image.fromarray(picture).convert("RGB").quantize(palette=palette, dither=0)
                      for picture in pictures]
    for picture in (first, *others):
        picture.putpalette(colours)
    first.save(path, save_all=True, append_images=others, duration=1000.0 / rate, loop=0)


def _colours(picture, colormaps):
    """256 colours of a picture, three numbers each: white, shades of its maps, and what else there
    is in it."""
    shades = [255 * matplotlib.colormaps[name](np.linspace(0, 1, SHADES))[:, :3]
              for name in colormaps]
    shades = np.concatenate([[[255, 255, 255]], *shades]).round().astype(int)
    found = np.unique(picture[..., :3].reshape(-1, 3), axis=0).astype(int)
    apart = np.abs(found[:, None] - shades).max(axis=2).min(axis=1)
    others = Image.fromarray(found[None, (apart > NEAR) | (apart == apart.max())].astype("u1"))
    return [*shades.ravel().tolist(),
            *others.quantize(256 - len(shades)).getpalette()][:3 * 256]


def write_mp4(path, rate, scenes):
    """Write scenes as an MP4 by ffmpeg; InputError where that fails.

    Parameters
    ----------
    path : path of the file
    rate : float, pictures a second
    scenes : Scenes
    """
    process = None
    for picture in scenes.pictures(range(len(scenes.points))):
        if process is None:
            size = f"{picture.shape[1]}x{picture.shape[0]}"
            process = subprocess.Popen(
                [matplotlib.rcParams["animation.ffmpeg_path"], "-v", "error", "-y", "-f",
                 "rawvideo", "-pix_fmt", "rgba", "-s", size, "-r", str(rate), "-i", "-", "-c:v",
                 "libx264", "-preset", "fast", "-pix_fmt", "yuv420p", str(path)],
                stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            process.stdin.write(picture.tobytes())
        except BrokenPipeError:
            break
    _, told = process.communicate()
    if process.returncode:
        raise InputError(f"ffmpeg cannot write a movie ({told.decode(errors='replace').strip()}): "
                         "take -format gif")


def ending(asked):
    """mp4 where ffmpeg is and nothing else is asked for, else gif."""
    there = animation.FFMpegWriter.isAvailable()
    check_ending(Path(asked.output), "a movie", (".mp4", ".gif"))
    name = Path(asked.output).suffix.lower().lstrip(".")
    wanted = asked.format if asked.format != "auto" else name or ("mp4" if there else "gif")
    if name and name != wanted:
        raise InputError(f"-format is '{wanted}', but -output is '{asked.output}': leave one out")
    if wanted == "mp4" and not there:
        raise InputError("-format is 'mp4', which needs ffmpeg: install it, or take -format gif")
    return wanted
