"""Wheels and source distributions: what is in them, and that they bring the scenes and methods of
options/ along."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import numpy as np
import pytest
from processes import ROOT

import contactsnes

pytest.importorskip("wheel")

SOURCES = ("setup.py", "setup.cfg", "pyproject.toml", "README.md", "LICENSE", "contactsnes",
           "options")
SCENES = {path.name for path in (ROOT / "options").glob("*.opts")}
MODULES = {path.relative_to(ROOT).as_posix() for ending in ("py", "c", "h")
           for path in (ROOT / "contactsnes").rglob(f"*.{ending}")}


def run(*words, folder, **variables):
    """What a program writes, with other variables of its environment; it has to end well."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment.update(variables)
    done = subprocess.run([*map(str, words)], cwd=folder, env=environment, capture_output=True,
                          text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def built(sources, folder, **variables):
    """The names of what is in the wheel of a tree, and its path, built without a network."""
    run(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation",
        "--wheel-dir", folder, sources, folder=folder, **variables)
    (found,) = Path(folder).glob("*.whl")
    with zipfile.ZipFile(found) as archive:
        return set(archive.namelist()), found


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """A copy of what a distribution is made of."""
    folder = tmp_path_factory.mktemp("sources")
    for name in SOURCES:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name,
                            ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, folder)
    return folder


@pytest.fixture(scope="module")
def unpacked(sources, tmp_path_factory):
    """What comes out of a source distribution."""
    folder = tmp_path_factory.mktemp("distribution")
    run(sys.executable, "setup.py", "--quiet", "sdist", "--dist-dir", folder, folder=sources)
    (packed,) = folder.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        archive.extractall(folder)
    return folder / packed.name.removesuffix(".tar.gz")


def test_distributions_bring_modules_and_scenes_along(unpacked, tmp_path):
    """A wheel by way of a source distribution, on a machine without a compiler: it has all but the
    compiled kernels."""
    names, _ = built(unpacked, tmp_path, CC="false")
    scenes = {name.rsplit("/", 1)[1] for name in names if name.startswith("contactsnes/scenes/")}
    assert scenes >= SCENES and MODULES <= names
    others = {name.split("/")[0] for name in names} - {"contactsnes"}
    assert [name for name in others if not name.endswith(".dist-info")] == []


def test_the_oldest_python_is_the_same_for_all_tools():
    """What pip demands, what the set-up takes, and what the check of style takes for granted."""
    asked = re.search(r"^python_requires = >=3\.(\d+)$", (ROOT / "setup.cfg").read_text(), re.M)[1]
    taken = (ROOT / "scripts" / "setup").read_text()
    assert f'target-version = "py3{asked}"' in (ROOT / "pyproject.toml").read_text()
    assert f"sys.version_info >= (3, {asked})" in taken
    assert f"PYTHON names no Python 3.{asked} or newer" in taken
    assert re.search(r"python3\.\{[\d,]*," + asked + r"\}", taken)


@pytest.mark.skipif(not shutil.which("bash"), reason="no bash")
def test_the_set_up_leaves_the_standard_library_to_pip(tmp_path):
    """Directories that an environment names besides its own are packages' alone: pip takes all of
    them from the path of what it builds apart, which would find no module at all."""
    text = (ROOT / "scripts" / "setup").read_text()
    function = re.search(r"^seen_by\(\) \{.*?^\}$", text, re.M | re.S)[0]
    own = tmp_path / "packages"
    own.mkdir()
    told = subprocess.run(["bash", "-c", f'{function}\nseen_by "$0"', sys.executable],
                          env={**os.environ, "PYTHONPATH": str(own)}, capture_output=True,
                          text=True, check=True).stdout.splitlines()
    standard = set(run(sys.executable, "-ISc", "import sys; print(*sys.path, sep='\\n')",
                       folder=tmp_path).splitlines())
    assert str(own) in told and standard and not standard & set(told)
    assert any(Path(place, "numpy").is_dir() for place in told)


@pytest.mark.study
@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
@pytest.mark.parametrize("editable", [False, True])
def test_an_installed_program_finds_its_scenes(unpacked, sources, tmp_path, editable):
    """In an environment of its own that sees the packages of this one, from any folder."""
    names, wheel = built(unpacked, tmp_path)
    assert any(name.startswith("contactsnes/kernels/_compiled.") for name in names)
    place = tmp_path / "environment"
    venv.create(place, with_pip=False)
    python = place / "bin" / "python"
    (library,) = place.glob("lib/python*/site-packages")
    paths = [path for path in sys.path if path and Path(path).is_dir()
             and not Path(contactsnes.__file__).is_relative_to(path)]
    library.joinpath("base.pth").write_text("\n".join(paths), encoding="utf-8")
    target = ["--editable", sources] if editable else [wheel]
    run(python, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation",
        "--force-reinstall", "--no-index", *target, folder=tmp_path)
    home = run(python, "-c", "import contactsnes; print(contactsnes.__file__)", folder=tmp_path)
    assert Path(home.strip()).is_relative_to(sources if editable else place)
    command = (python, "-m", "contactsnes")
    told = run(*command, "info", "cylinder.opts", "fire.opts", folder=tmp_path)
    assert "force form" in told
    run(*command, "run", "cylinder.opts", "-scene_points", "512", "-scene_normal_maugis", "2",
        "-load_path", "normal_displacement=1", "-archive_file", "run.h5", folder=tmp_path)
    assert np.max(contactsnes.read(tmp_path / "run.h5")["normal_displacement"]) == 1.0
    run(*command, "compare", "cylinder.opts", "newton.opts", "-scene_points", "512",
        "-scene_normal_maugis", "2", "-load_path", "normal_displacement=1", "-compare_repeats", "1",
        folder=tmp_path)
