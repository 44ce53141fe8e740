"""Tables, figures and movies on a disk that is full: what was there stays, nothing is left half
written."""

import errno
import os

import pytest
from processes import ROOT, call, run

from contactsnes.commands.showing import writing
from contactsnes.options.fields import InputError
from contactsnes.output.tables import replaced

SHOW = """
import resource, sys
from contactsnes.commands.cli import main
sys.dont_write_bytecode = True  # what is imported from here on would be left cut off
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with an archive."""
    path = tmp_path_factory.mktemp("full")
    done = call("run", "-scene_points", "128", "-scene_period", "20", "-scene_normal_maugis", "1",
                "-load_path", "normal_displacement=0.5", "-continuation_initial_step", "0.25",
                "-archive_file", "run.h5", "-archive_fields", "all", folder=path)
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture(scope="module")
def show(tmp_path_factory):
    """A function that shows an archive in a process whose files have a kB, or a few."""
    path = tmp_path_factory.mktemp("show")

    def shown(words, folder, size=1000):
        program = path / f"show{size}.py"
        program.write_text(SHOW.replace("1000", str(size)), encoding="utf-8")
        return run(program, *words, folder=folder)

    return shown


@pytest.mark.parametrize("words, name", ((("table", "run.h5", "-output", "all.csv"), "all.csv"),
                                         (("movie", "run.h5", "-format", "gif", "-frames", "2"),
                                          "run.gif"),
                                         (("export", "run.h5"), "run.vtkhdf"),
                                         (("plot", "run.h5"), "run-approach.png"),
                                         pytest.param(("plot", "run.h5", "-plot_format", "svg"),
                                                      "run-approach.svg", marks=pytest.mark.study),
                                         (("plot", "run.h5", "-plot_format", "pdf"),
                                          "run-approach.pdf")))
def test_what_was_there_stays(folder, show, words, name):
    (folder / name).write_text("of before", encoding="utf-8")
    before = sorted(path.name for path in folder.iterdir())
    done = show(words, folder)
    assert done.returncode == 1 and "what is made of run.h5 cannot be written" in done.stderr
    assert (folder / name).read_text(encoding="utf-8") == "of before"
    assert sorted(path.name for path in folder.iterdir()) == before


def test_a_comparison_names_its_files(show, tmp_path):
    words = ["compare", *(ROOT / "options" / name for name in ("cylinder.opts", "newton.opts")),
             "-scene_points", "64", "-scene_period", "20", "-load_path", "normal_displacement=0.1",
             "-compare_file", "two"]
    # the options, which are read by way of a file in memory, take up to 2 kB
    done = show(words, tmp_path, 4000)
    assert done.returncode == 1 and "the comparison two cannot be written" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] in ([], ["two.csv"])  # which may have room


def test_a_device_and_a_link_are_written_to(tmp_path):
    pipe, linked = tmp_path / "pipe", tmp_path / "linked.txt"
    (tmp_path / "file.txt").write_text("of before", encoding="utf-8")
    linked.symlink_to("file.txt")
    replaced(linked, lambda path: path.write_text("new", encoding="utf-8"))
    assert linked.is_symlink() and (tmp_path / "file.txt").read_text(encoding="utf-8") == "new"
    os.mkfifo(pipe)
    end = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    replaced(pipe, lambda path: path.write_text("told", encoding="utf-8"))
    assert os.read(end, 9) == b"told" and pipe.exists()
    os.close(end)


def test_a_folder_that_takes_no_files_is_named_with_what_to_do():
    """Instead of a file that nobody has named, whose name ends in .partial."""
    def refuse():
        raise PermissionError(errno.EACCES, "Permission denied", "there/run-shear.partial.png")

    with pytest.raises(InputError, match="the folder there takes no files .*-plot_output"):
        writing("run.h5", refuse)
