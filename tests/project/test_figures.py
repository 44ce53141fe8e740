"""Figures for print: scripts save them through one home, and they have its letters and size."""

import ast
import subprocess
from pathlib import Path

import matplotlib
import pytest
from matplotlib.image import imread
from matplotlib.text import Text

from contactsnes.output.figures.printed import PAGE, POINTS, PRINTED, lettered, panels, save

ROOT = Path(__file__).resolve().parents[2]


def programs():
    """Paths of the Python programs and modules under scripts."""
    paths = subprocess.run(["git", "ls-files", "scripts"], cwd=ROOT, capture_output=True,
                           text=True).stdout.split() or [
        str(path.relative_to(ROOT)) for path in (ROOT / "scripts").rglob("*") if path.is_file()]
    for path in (ROOT / name for name in paths):
        if path.suffix == ".py" or not path.suffix and "python" in path.read_text(
                encoding="utf-8").split("\n")[0]:
            yield path


def strays(source):
    """Lines of a program that save a figure, or set its letters or dots, by themselves."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(
                node.func, "id", "")
            if name in ("savefig", "print_figure", "imsave", "print_png", "print_pdf") or {
                    "dpi", "fontsize", "labelsize", "title_fontsize"} & {
                    keyword.arg for keyword in node.keywords}:
                found.append(node.lineno)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            names = [getattr(node, "module", "") or "", *(alias.name for alias in node.names)]
            if any(name.split(".")[-1] in ("pyplot", "STYLE") for name in names):
                found.append(node.lineno)
    return found


def test_scripts_save_figures_through_their_home_only():
    files = list(programs())
    assert len(files) > 30
    assert {str(path.relative_to(ROOT)): lines for path in files
            if (lines := strays(path.read_text(encoding="utf-8")))} == {}


@pytest.mark.parametrize("planted", (
    "figure.savefig('a.png')", "save = figure.savefig\nsavefig('a')", "Figure(dpi=150)",
    "axes.text(0, 0, 'a', fontsize=6)", "import matplotlib.pyplot as plt",
    "from matplotlib import pyplot", "from contactsnes.output.figures.style import STYLE"))
def test_a_planted_exception_is_found(planted):
    assert strays(planted)
    assert not strays("from contactsnes.output.figures.printed import save\nsave(figure, 'a')")


def test_a_saved_figure_has_the_letters_and_the_size_of_print(tmp_path):
    (tmp_path / "copies").mkdir()
    with matplotlib.rc_context(PRINTED):
        figure, axes = panels(1, 2, height=2.0)
        lettered(axes.flat, ("first", "second"))
        for one in axes.flat:
            one.plot([1, 2], [3, 4], label="line")
            one.set(xlabel="x", ylabel="y")
            one.legend(title="legend")
    path = save(figure, tmp_path / "a-0.5", tmp_path / "copies")
    assert path == tmp_path / "a-0.5.png"
    assert imread(path).shape[:2] == (400, int(200 * PAGE))
    page = path.with_suffix(".pdf").read_bytes()
    box = page[page.index(b"/MediaBox [") + 11:].split(b"]")[0]
    assert [float(number) for number in box.split()] == pytest.approx([0, 0, 72 * PAGE, 144])
    assert b"CreationDate" not in page and b"/Type3" not in page
    sizes = {text.get_fontsize() for text in figure.findobj(Text) if text.get_text()}
    assert sizes == {POINTS} == {8}
    assert [one.get_title("left") for one in axes.flat] == ["(a)  first", "(b)  second"]
    for kind in (".png", ".pdf"):
        copy = tmp_path / "copies" / f"a-0.5{kind}"
        assert copy.read_bytes() == (tmp_path / f"a-0.5{kind}").read_bytes()


def test_the_map_of_hard_cases_holds_all_cases_within_its_width():
    from types import SimpleNamespace

    from programs import load

    stress = load(ROOT / "scripts" / "stress")
    cases = [SimpleNamespace(axis="long", label="letters " * k) for k in range(1, 8)]
    cases += [SimpleNamespace(axis="random", label=str(k)) for k in range(43)]
    rows = stress.map_rows(cases)
    assert [cell[2] for _, row in rows for cell in row] == list(range(len(cases)))
    for _, row in rows:
        assert sum(row[-1][:2]) <= stress.ACROSS
        assert all(one[0] + one[1] == other[0] for one, other in zip(row, row[1:]))
    names = [name for name, _ in rows]
    assert names[0] == "long" and names[1] == "" and names[-3:] == ["random 0", "random 20",
                                                                    "random 40"]
