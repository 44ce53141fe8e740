"""The documents: their commands and their Python run, links lead somewhere, pages are up to date.

Blocks of ``sh``, ``opts`` and ``python`` are run page by page, in an empty folder that has options/
(docs/contributing.md tells how to write them); each line of a block of ``text`` has to be among
what they print.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest
from processes import call
from programs import load

import contactsnes
from contactsnes import Scene, table
from contactsnes.output.tables import measured

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted(DOCS.glob("*.md"))]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
INFO = "<!-- checked with info -->"
ON_ARCHIVES = ("plot", "table", "export", "movie", "report")
COMMANDS = ("run", "info", "compare", *ON_ARCHIVES)
WRITERS = {
    "compare": "results", "stress": "results", "benchmark": "results", "hysteresis": "results",
    "sliding": "results", "spots": "results", "costs": "experiments",
    "campaigns/table.py": "certified",
    "paper/pages.py": "gallery", "spheres/page.py": "sphere",
    "surfaces/page.py": "rough", "worth": "rough"}
"""Script -> page between whose marks it writes."""

LONG = ("experiments", "python", "running", "tutorial")
"""Pages that take many seconds: their commands are asked for info, their programs compiled, and all
of them run as a study."""

every_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)


class Block(NamedTuple):
    """A fenced block: its language, its text, and whether its commands are only asked for info."""

    language: str
    text: str
    info: bool


def blocks(page):
    """The fenced blocks of a page."""
    found = []
    lines = None
    before = ""
    for line in page.read_text(encoding="utf-8").splitlines():
        if not line.startswith("```"):
            if lines is not None:
                lines.append(line)
            elif line.strip():
                before = line
        elif lines is None:
            lines, language = [], line[3:].strip()
        else:
            found.append(Block(language, "\n".join(lines), before == INFO))
            lines, before = None, ""
    assert lines is None, f"{page.name} has a block without an end"
    return found


def prose(page):
    """Lines of a page outside its blocks, and outside what scripts write."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    written = r"<!-- \S+ writes from here -->.*?<!-- .*? -->"
    return re.sub(written, "", text, flags=re.S).splitlines()


def words(text):
    """The words of each command of a block."""
    joined = re.sub(r"\\\n\s*", " ", text).splitlines()
    return [shlex.split(line, comments=True) for line in joined if line.strip()]


def without_solving(arguments):
    """What asks for as much as can be known without solving; None where there is nothing to ask."""
    command, *others = arguments
    if command in ON_ARCHIVES or "-help" in others:
        return None if command in ON_ARCHIVES else arguments
    kept, before = [], ""
    for word in others:
        if not (word.startswith("-compare_") or before.startswith("-compare_")):
            kept.append(word)
        before = word
    return ["info", *kept]


def printed_by(done):
    """What a process has printed, which has ended well."""
    assert done.returncode == 0, f"{done.args}\n{done.stdout[-2000:]}\n{done.stderr}"
    return done.stdout


def python(arguments, folder):
    """What a process of Python prints."""
    return printed_by(subprocess.run([sys.executable, *arguments], cwd=folder, env=ENVIRONMENT,
                                     text=True, capture_output=True, timeout=300, check=False))


def run(command, info, folder):
    """What a command of a page prints."""
    program, *arguments = command
    if program == "python3":
        return python(arguments, folder)
    assert program == "contactsnes" and arguments[0] in COMMANDS, command
    arguments = without_solving(arguments) if info else arguments
    return printed_by(call(*arguments, folder=folder)) if arguments else ""


def alike(line, other):
    """Whether two lines have the same words and numbers: those of five digits or more to 1e-3.

    Shorter ones are counts, costs and errors, which depend on PETSc's version: a factor of two.
    """
    def number(word):
        try:
            return float(word.strip("(),;%"))
        except ValueError:
            return None

    one, two = line.split(), other.split()
    if len(one) != len(two):
        return False
    for first, second in zip(one, two):
        values = number(first), number(second)
        if None in values and first != second:
            return False
        if None not in values:
            digits = re.sub(r"e.*|\D", "", first).lstrip("0")
            allowed = 1e-3 if len(digits) >= 5 else 0.5
            if abs(values[0] - values[1]) > allowed * max(map(abs, values)):
                return False
    return True


@pytest.mark.parametrize("page, solved", [
    *(pytest.param(page, page.stem not in LONG, id=page.stem) for page in PAGES),
    *(pytest.param(DOCS / f"{name}.md", True, id=f"{name}-solved", marks=pytest.mark.study)
      for name in LONG)])
def test_what_a_page_tells_to_run_runs(page, solved, tmp_path):
    os.symlink(ROOT / "options", tmp_path / "options")
    found, printed = blocks(page), []
    for block in found:
        if block.language == "opts":
            name = re.match(r"# (\S+\.(opts|csv))", block.text).group(1)
            (tmp_path / name).write_text(block.text + "\n", encoding="utf-8")
    for block in found:
        if block.language == "sh":
            printed += [run(command, block.info or not solved, tmp_path)
                        for command in words(block.text)]
    code = "\n\n".join(block.text for block in found if block.language == "python")
    if not solved:
        compile(code, page.name, "exec")
        return
    if code:
        (tmp_path / "blocks.py").write_text(code, encoding="utf-8")
        printed.append(python(["blocks.py"], tmp_path))
    lines = "\n".join(printed).splitlines()
    told = [line for block in found if block.language == "text" for line in block.text.splitlines()]
    missing = [line for line in told if not any(alike(line, other) for other in [*lines, "..."])]
    assert missing == []


@every_page
def test_other_blocks_have_nothing_to_run_but_scripts(page):
    for block in blocks(page):
        assert block.language in ("", "opts", "python", "sh", "text")
        if block.language == "":
            assert not re.search(r"^(contactsnes|python3?) ", block.text, flags=re.M)
            for script in re.findall(r"(?:^| )(scripts/\S+)", block.text):
                assert os.access(ROOT / script, os.X_OK), script


# Links


def anchors(page):
    """Anchors of the headings of a page, by the rules of GitHub."""
    titles = [line.lstrip("#").strip() for line in prose(page) if re.match("#+ ", line)]
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def links(page):
    """Targets of links and images of a page, as they are written; not those to other sites."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    found = re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r'src="([^"]+)"', text)
    return [link for link in found if "://" not in link]


@every_page
def test_links_lead_somewhere(page):
    missing = []
    for link in links(page):
        name, _, anchor = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        if not target.exists() or anchor and anchor not in anchors(target):
            missing.append(link)
    assert missing == []


def test_every_page_is_linked_from_the_readme():
    linked = {(ROOT / link.partition("#")[0]).resolve() for link in links(ROOT / "README.md")}
    assert [page.name for page in PAGES[1:] if page not in linked] == []


@every_page
def test_lines_are_short(page):
    free = ("|", "<", "#", "!", "-") if page.name == "results.md" else ("|", "<", "#", "!")
    assert [line for line in prose(page) if len(line) > 120 and not line.startswith(free)] == []
    if page.name == "README.md":
        assert len(page.read_text(encoding="utf-8").splitlines()) <= 120


# What pages say


def test_the_page_of_options_is_up_to_date():
    script = load(ROOT / "scripts" / "options-page")
    same = script.PAGE.read_text(encoding="utf-8") == script.page()
    assert same, "docs/options.md is out of date: run scripts/options-page"


def test_every_public_name_is_told_of():
    text = (DOCS / "python.md").read_text(encoding="utf-8")
    code = "\n".join(block.text for block in blocks(DOCS / "python.md"))
    for name in contactsnes.__all__:
        assert f"`{name}`" in text and re.search(rf"\b{name}\b", code), name


def test_every_column_is_told_of():
    text = (DOCS / "running.md").read_text(encoding="utf-8")
    plane = Scene(dimension=2, geometry="sphere", period=20.0)
    columns = {re.sub("_[xy]$", "", name) for scene in (Scene(), plane) for name in table(scene)}
    assert [name for name in sorted(columns) if f"`{name}`" not in text] == []


@pytest.mark.parametrize("script", WRITERS)
def test_marks_of_a_script_stand_once_on_its_page(script):
    source = (ROOT / "scripts" / script).read_text(encoding="utf-8")
    marks = r'^BEGIN(?:, END)? = "(.*)\\n"(?:, |\nEND = )"(.*)\\n"$'
    begin, end = re.search(marks, source, flags=re.M).groups()
    counts = {page.stem: (page.read_text(encoding="utf-8").count(f"{begin}\n"),
                          page.read_text(encoding="utf-8").count(f"{end}\n")) for page in PAGES}
    assert counts.pop(WRITERS[script]) == (1, 1)
    assert set(counts.values()) == {(0, 0)}


def test_files_that_are_named_are_there():
    """Paths of the source, its scripts, tests and examples, in the words of any page."""
    pattern = r"`((?:contactsnes|scripts|tests|options|examples|docs)/[\w./-]*?\w(?:/|\b))`"
    named = {(page.name, path) for page in PAGES
             for path in re.findall(pattern, "\n".join(prose(page)))}
    assert len(named) > 50
    known = ("NAME.opts",)
    assert [(page, path) for page, path in sorted(named) if not path.endswith(known)
            and not (ROOT / path).exists()] == []


def test_results_are_dated(tmp_path):
    file = tmp_path / "results.csv"
    file.write_text("")
    os.utime(file, (2e9, 2e9))
    assert re.fullmatch(r"Measured on 2033-05-1\d( on commit [0-9a-f]{7,})?\.", measured(file))
