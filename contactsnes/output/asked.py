"""Options of the commands that show archives: plot, table, export, movie and report."""

from dataclasses import dataclass
from typing import ClassVar

from ..options.fields import InputError, Options, option

FORMATS = ("png", "pdf", "svg")
"""Kinds of files of figures."""

STYLES = "name or file of a style of matplotlib"


class _OfPoints(Options):
    """Options one of which, ``points``, names points."""

    def __post_init__(self):
        super().__post_init__()
        whole_numbers(self.option_name("points"), self.points)

    @property
    def chosen(self):
        """The points, a list of int, or None."""
        return whole_numbers(self.option_name("points"), self.points)


@dataclass(frozen=True)
class PlotOptions(_OfPoints):
    """Options of ``contactsnes plot``."""

    prefix: ClassVar[str] = "plot_"
    title: ClassVar[str] = "Figures: contactsnes plot"
    format: str = option("png", "kinds of files", choices=FORMATS, many="list")
    output: str = option("", "folder of the figures", default_text="that of the archive")
    points: str = option("", "points of profiles and maps, from 0 or from the end: 0,5,-1",
                         default_text="begin, events, end, and some between")
    together: str = option("", "the curves of all archives in common figures, NAME-shear.png and "
                           "so on, in place of figures of each",
                           default_text="none: figures of each")
    columns: str = option("", "one more figure: columns, the first along x, the others above each "
                          "other", default_text="none")
    with_: str = option("", "measured points beside the curves: a CSV file whose heading names "
                        "columns, units in brackets (normal_force [mN]), and their errors as "
                        "NAME_error", default_text="none")
    size: float | tuple = option(None, "width of figures, or width and height with a comma", "cm",
                                 kind="number", minimum=2, maximum=100, many="directions",
                                 default_text="8.5, a column of a journal; maps of several points "
                                 "17")
    style: str = option("", STYLES, default_text="a journal's column")

    @property
    def formats(self):
        """Endings of the files."""
        return [f".{name}" for name in dict.fromkeys(self.format.split(","))]


@dataclass(frozen=True)
class TableOptions(Options):
    """Options of ``contactsnes table``."""

    prefix: ClassVar[str] = ""
    title: ClassVar[str] = "Tables: contactsnes table"
    columns: str = option("", "columns, with commas: those of branch/, attributes of the scene as "
                          "scene_NAME, options as they were typed (load_path), and archive, point, "
                          "complete", default_text="all of branch/; before them, of several "
                          "archives, archive and what their scenes and options differ in")
    rows: str = option("all", "all points; or one a run: its last point, that of its first event, "
                       "or of the first event of a kind",
                       choices=("all", "last", "event", "fold", "jump", "gross_sliding", "pull_off",
                                "bifurcation"))
    format: str = option("csv", "kind of file; parquet needs pyarrow, of the extra [table]",
                         choices=("csv", "parquet"))
    units: bool = option(False, "units in the heading of CSV: normal_force [N] (Parquet has them "
                         "in its metadata)")
    output: str = option("", "file of the table: .csv, .txt or .dat; .parquet or .pq",
                         default_text="CSV: standard output; Parquet: beside the archive")

    @property
    def names(self):
        """Columns that are asked for, a list; empty for all."""
        return listed(self.columns)


@dataclass(frozen=True)
class ExportOptions(_OfPoints):
    """Options of ``contactsnes export``."""

    prefix: ClassVar[str] = ""
    title: ClassVar[str] = "Fields for ParaView: contactsnes export"
    points: str = option("", "points, from 0 or from the end: 0,5,-1",
                         default_text="all that have fields")
    precision: str = option("single", "of the fields in the file", choices=("single", "double"))
    output: str = option("", "the file: .vtkhdf or .hdf",
                         default_text="RUN.vtkhdf beside the archive")


@dataclass(frozen=True)
class MovieOptions(Options):
    """Options of ``contactsnes movie``."""

    prefix: ClassVar[str] = ""
    title: ClassVar[str] = "Movies: contactsnes movie"
    format: str = option("auto", "mp4 needs ffmpeg; auto: mp4 where that is, else gif",
                         choices=("auto", "mp4", "gif"))
    seconds: float = option(8.0, "length of the movie", "s", above=0, maximum=600)
    frames: int = option(120, "most points that are shown, spread over those with fields",
                         minimum=2, maximum=10000)
    width: float = option(16.0, "width of a picture", "cm", minimum=4, maximum=60)
    style: str = option("", STYLES, default_text="a journal's column")
    output: str = option("", "the file: .mp4 or .gif",
                         default_text="RUN.mp4 or RUN.gif beside the archive")


@dataclass(frozen=True)
class ReportOptions(Options):
    """Options of ``contactsnes report``."""

    prefix: ClassVar[str] = ""
    title: ClassVar[str] = "Reports: contactsnes report"
    points: int = option(60, "most points of the slider, spread over those with fields",
                         minimum=1, maximum=1000)
    nodes: int = option(160, "most nodes of maps in each direction; profiles of lines have up to 8 "
                        "times as many", minimum=16, maximum=4096)
    output: str = option("", "the file: .html or .htm",
                         default_text="RUN.html beside the archive")


CLASSES = (PlotOptions, TableOptions, ExportOptions, MovieOptions, ReportOptions)


def listed(text):
    """What commas separate in a text, a list without blanks."""
    return [part.strip() for part in text.split(",") if part.strip()]


def whole_numbers(name, text):
    """Whole numbers with commas as a list, None for an empty text; InputError for others.

    Parameters
    ----------
    name : str, the option, with its dash
    text : str
    """
    try:
        return [int(part) for part in text.split(",")] if text else None
    except ValueError:
        raise InputError(f"{name} is '{text}': allowed are whole numbers with commas, "
                         "for instance 0,5,-1") from None
