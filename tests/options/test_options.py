"""Options: command line, files, PETSc's database, help."""

import dataclasses
import math
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from contactsnes import Branch
from contactsnes.options import database as options
from contactsnes.options import files
from contactsnes.options.fields import InputError, Options, as_text, option
from contactsnes.options.help import help_text
from contactsnes.scene.load import Load
from contactsnes.scene.settings import OPTION_CLASSES, Form, Output, Scene, Steps


@dataclasses.dataclass(frozen=True)
class CoreOptions(Options):
    """Options of a solver, as the modules of solvers have them."""

    prefix = "pc_core_"
    title = "Core zone"
    smoothing: float = option(0.02, "width of the smoothing", "delta_n", above=0)


@pytest.fixture
def petsc():
    """PETSc's database, with everything that a test puts into it taken out afterwards."""
    from petsc4py import PETSc

    database = PETSc.Options()
    before = options.database()
    yield database
    for name in options.database():
        if name not in before:
            database.delValue(name)


# Command line and files

@pytest.mark.parametrize("argument, is_option", [("-scene_poisson", True), ("-info", True),
                                                 ("--scene", True), ("-e", True), ("-3", False),
                                                 ("-.5", False), ("-1e-3", False), ("-inf", False),
                                                 ("-nan", False), ("scene.opts", False),
                                                 ("-", False), ("", False)])
def test_negative_numbers_are_values(argument, is_option):
    assert options.is_option(argument) == is_option


@pytest.mark.parametrize("line, files, found", [
    ("a.opts -load_x -3 b.opts -flag", ["a.opts", "b.opts"], ["-load_x", "-3", "-flag"]),
    ("-snes_monitor a.opts -x 1", ["a.opts"], ["-snes_monitor", "-x", "1"]),
    ("-archive_resume scene.txt", ["scene.txt"], ["-archive_resume"]),
    ("-archive_resume maybe", [], ["-archive_resume", "maybe"]),
    ("-archive_resume cylindr", ["cylindr"], ["-archive_resume"]),
    ("-continuation_locate_folds 1e-8", [], ["-continuation_locate_folds", "1e-8"]),
    ("-archive_errors 0.5 -contact_cascade true,false", [],
     ["-archive_errors", "0.5", "-contact_cascade", "true,false"]),
    ("-archive_resume false scene.txt", ["scene.txt"], ["-archive_resume", "false"]),
    ("-options_file more.opts", [], ["-options_file", "more.opts"]),
    ("-x 1 two", ["two"], ["-x", "1"])])
def test_arguments_are_files_or_options(line, files, found):
    assert options.split_arguments(line.split()) == (files, found)


def test_two_dashes_are_an_error():
    with pytest.raises(InputError, match="--scene_poisson has two dashes: options "
                       "have one, try -scene_poisson"):
        options.split_arguments(["--scene_poisson", "0.3"])


def test_files_come_first_from_left_to_right(tmp_path):
    one, two = tmp_path / "one.opts", tmp_path / "two.opts"
    one.write_text('# a comment\n\n-load_path "normal_force=25; normal_force=-3"  # '
                   'another\n  -a\t1\r\n-flag\n')
    two.write_text("-prefix_push pre_\n-b -2\n-prefix_pop\n-single 'x y'\n-empty \"\"")
    assert options.petsc_arguments(["-last", "-3", str(one), "-more", str(two)]) == [
        "contactsnes",
        "-load_path",
        "normal_force=25; normal_force=-3",
        "-a",
        "1",
        "-flag",
        "-prefix_push",
        "pre_",
        "-b",
        "-2",
        "-prefix_pop",
        "-single",
        "x y",
        "-empty",
        "",
        "-last",
        "-3",
        "-more",
    ]


@pytest.mark.parametrize("text", ["scene_poisson 0.3", "-a 1 2", "-a -b",
                                  '-load_path "normal_force=1', "--a 1", "-3 1", '-a b"c d"',
                                  "-prefix_push x_\n-a 1", "alias -a -b"])
def test_bad_file_is_an_error_that_names_it(tmp_path, text):
    path = tmp_path / "bad.opts"
    path.write_text("-good 1\n" + text)
    with pytest.raises(InputError) as error:
        options.petsc_arguments([str(path)])
    assert str(path) in str(error.value) and "\n" not in str(error.value)


def test_comments_begin_outside_of_quotes(tmp_path):
    path = tmp_path / "one.opts"
    path.write_text("""-a "x # 1" # it's "so"
        # -b 2
        -c x#y
        -d 'n#1'#n
        -e#f
        -g 1 #""")
    assert files.read_file(path) == ["-a", "x # 1", "-c", "x", "-d", "n#1", "-e", "-g", "1"]


@pytest.mark.parametrize("value", ["it's.h5", "run#1.h5", "back\\slash.h5", 'say "x.h5', "'x", '"x',
                                   "ends here'", "a=1; b=2 # 3", "a\tb", 'x"y', "x'y z", "#"])
def test_values_are_written_so_that_they_are_read_back(tmp_path, value):
    path, path_text = tmp_path / "one.opts", '-load_path "a=1; b=2"'
    path.write_text(f"-a {files.quoted(value)}\n{path_text}\n")
    expected = ["-a", value, "-load_path", "a=1; b=2"]
    assert files.words(path.read_text()) == files.read_file(path) == expected
    assert files.words(f"-a {value}\n{path_text}")[-1] == "a=1; b=2", "as older archives have it"


def test_file_that_cannot_be_read_is_an_error_that_names_it(tmp_path):
    binary = tmp_path / "binary.opts"
    binary.write_bytes(bytes(range(128, 256)))
    for path in (tmp_path / "absent.opts", tmp_path, binary):
        with pytest.raises(InputError, match="cannot be read") as error:
            options.read_file(path)
        assert str(path) in str(error.value)


def test_a_bare_name_is_that_of_a_file_that_comes_with_the_package(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (folder,) = files.folders()
    assert files.read_file("newton.opts") == files.read_file(folder / "newton.opts")
    (tmp_path / "newton.opts").write_text("-own 1\n")
    assert files.read_file("newton.opts") == ["-own", "1"]
    (tmp_path / "other.opts").write_text("-options_file fire.opts\n")
    assert files.read_file("other.opts") == files.read_file(folder / "fire.opts")


@pytest.mark.parametrize("name, words", [("cylindr.opts", "did you mean cylinder.opts"),
                                         ("options/cylinder.opts", "did you mean cylinder.opts?"),
                                         ("own/one.opts", "did you mean own/ones.opts"),
                                         ("qzx.opts", "give a file of lines")])
def test_a_file_that_is_nowhere_is_told_with_names_like_it(tmp_path, monkeypatch, name, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "ones.opts").write_text("")
    with pytest.raises(InputError, match="cannot be read") as error:
        files.read_file(name)
    assert words in str(error.value) and str(tmp_path) not in str(error.value)


def test_petsc_starts_with_files_and_command_line(tmp_path):
    """The later wins, in a fresh PETSc, as when PETSc reads the same files itself."""
    one, two = tmp_path / "one.opts", tmp_path / "two.opts"
    one.write_text('-scene_poisson 0.1\n-scene_period 50 # beta\n-load_path '
                   '"normal_force=1; normal_force=-2"\n-both 1\n')
    two.write_text("-scene_poisson 0.2\n-prefix_push scene_\n-gap_offset "
                   "-0.5\n-prefix_pop\n-archive_file a.h5\n-archive_resume\n")
    script = ("import sys, petsc4py\nfrom contactsnes.options import database as "
              "options\nfrom contactsnes.scene import "
              "settings\npetsc4py.init({})\nprint(sorted(options.database().items()))")
    run = lambda vector, arguments: subprocess.run([sys.executable, "-c", script.format(vector),
                                                    *map(str, arguments)], capture_output=True,
                                                   text=True, check=True).stdout.splitlines()[0]
    ours = run("options.petsc_arguments(sys.argv[1:])", ["-both", "-3", one, "-scene_poisson",
                                                         "0.3", two])
    petsc = run("['x', '-options_file', sys.argv[1], '-options_file', sys.argv[2], *sys.argv[3:]]",
                [one, two, "-both", "-3", "-scene_poisson", "0.3"])
    assert ours == petsc == str([("archive_file", "a.h5"), ("archive_resume", ""), ("both", "-3"),
                                 ("load_path", "normal_force=1; normal_force=-2"),
                                 ("scene_gap_offset", "-0.5"), ("scene_period", "50"),
                                 ("scene_poisson", "0.3")])


# The database

def test_database_keeps_whole_values_and_marks_nothing_used(petsc):
    path = "; ".join(f"normal_force={value}" for value in range(300))
    petsc["ksp_Contactsnes_long"] = path
    petsc["contactsnes_odd"] = "a -b # (c) d"
    petsc["contactsnes_flag"] = ""
    found = options.database()
    assert (found["ksp_contactsnes_long"] == path and found["contactsnes_odd"] == "a -b # (c) d"
            and found["contactsnes_flag"] == "")
    assert "b" not in found
    assert "-ksp_contactsnes_long" in options.unused_options()
    petsc.getString("ksp_contactsnes_long")
    assert "-ksp_contactsnes_long" not in options.unused_options()


def test_the_database_is_read_where_the_working_folder_is_gone(petsc, tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    petsc["contactsnes_here"] = "1"
    assert options.database()["contactsnes_here"] == "1"
    with pytest.raises(FileNotFoundError):
        os.getcwd()


def test_database_text_is_an_options_file(petsc, tmp_path):
    petsc["contactsnes_path"] = "normal_force=25; normal_force=-3"
    petsc["contactsnes_flag"] = ""
    petsc["contactsnes_value"] = -3
    text = options.database_text()
    assert text.index("-contactsnes_flag\n") < text.index(
        '-contactsnes_path "normal_force=25; normal_force=-3"\n')
    path = tmp_path / "all.opts"
    path.write_text(text)
    found = options.read_file(path)
    assert found[found.index("-contactsnes_path") + 1] == "normal_force=25; normal_force=-3"
    assert found[found.index("-contactsnes_value") + 1] == "-3"


def test_nothing_set_gives_the_defaults(petsc):
    for cls in OPTION_CLASSES:
        assert options.read(cls, "contactsnes_absent_") == cls()


def random_instance(cls, random):
    """An allowed instance with a random subset of fields off their defaults."""
    def value(rule):
        if rule["kind"] == "flag":
            return True
        if rule["choices"]:
            return random.choice(rule["choices"])
        if rule["kind"] == "integer":
            return 2 * random.randint(8, 5000)
        if rule["kind"] == "text":
            return random.choice(("a b=-3; c", "x.h5:data", "plain", "-2"))
        if rule["infinite"] and random.random() < 0.3:
            return math.inf
        low = next((rule[key] for key in ("minimum", "above") if rule[key] is not None), -10)
        high = next((rule[key] for key in ("maximum", "below") if rule[key] is not None), 1e3)
        return low + (high - low) * random.uniform(1e-3, 0.999)

    values, share = {}, random.uniform(0.0, 0.5)  # of many fields few go together
    for field in dataclasses.fields(cls):
        rule = field.metadata
        if random.random() < share:
            many = rule["many"] in ("directions", "legs") and random.random() < 0.5
            values[field.name] = tuple(value(rule) for _ in range(2)) if many else value(rule)
    return cls(**values)


@pytest.mark.parametrize("cls", [*OPTION_CLASSES, CoreOptions])
def test_what_is_written_as_options_is_read_back_equal(petsc, cls):
    generator = random.Random(cls.prefix)
    done = 0
    while done < 40:
        try:
            instance = random_instance(cls, generator)
        except InputError:
            continue  # fields that do not go together
        prefix = f"contactsnes_{cls.prefix}{done}_"
        for field in dataclasses.fields(cls):
            value = getattr(instance, field.name)
            if value != field.default:
                petsc[f"{prefix}{cls.prefix}{field.name}"] = as_text(value)
        assert options.read(cls, prefix) == instance
        for name in dataclasses.fields(cls):  # the database holds 512
            petsc.delValue(f"{prefix}{cls.prefix}{name.name}")
        done += 1


@pytest.mark.parametrize("text, value", [("", True), ("true", True), ("Yes", True), ("1", True),
                                         ("off", False), ("0", False)])
def test_flags(petsc, text, value):
    petsc["contactsnes_f_archive_resume"] = text
    assert options.read(Output, "contactsnes_f_").resume is value


@pytest.mark.parametrize("cls, name, text", [(Scene, "poisson", "soft"),
                                             (Scene, "poisson", "0.3 0.4"),
                                             (Scene, "poisson", "0.3,0.4"), (Scene, "poisson", ""),
                                             (Scene, "points", "autos"), (Scene, "points", "1e3"),
                                             (Scene, "points", "64,,64"),
                                             (Scene, "dimension", "2.0"), (Scene, "height", "high"),
                                             (Scene, "height", "1e400"),
                                             (Scene, "law", ""), (Scene, "period", "infinite"),
                                             (Output, "resume", "maybe"), (Output, "file", ""),
                                             (Load, "stop", "never"), (Load, "path", ""),
                                             (Steps, "initial_step", "1,x"),
                                             (Form, "form", "Force")])
def test_wrong_types_are_named_with_value_and_what_is_allowed(petsc, cls, name, text):
    petsc[f"contactsnes_w_{cls.prefix}{name}"] = text
    with pytest.raises(InputError) as error:
        options.read(cls, "contactsnes_w_")
    sentence = str(error.value)
    assert (f"-contactsnes_w_{cls.prefix}{name}" in sentence and text in sentence
            and "allowed is" in sentence and "\n" not in sentence)


def test_paths_may_be_objects():
    assert Scene(geometry="file", geometry_file=Path("maps") / "h.npy").geometry_file \
        == str(Path("maps") / "h.npy")
    assert Form(cache=Path("kept")) == Form(cache="kept")


def test_names_are_not_case_sensitive(petsc):
    petsc["contactsnes_c_Scene_Poisson"] = 0.25
    assert options.read(Scene, "contactsnes_c_").poisson == 0.25


@pytest.mark.parametrize("name, guess", [("scene_poison", "-scene_poisson"),
                                         ("load_paths", "-load_path"),
                                         ("continuation_first_step", "-continuation_"),
                                         ("contact_windows", "-contact_window"),
                                         ("archive_overwriet", "-archive_overwrite"),
                                         ("scene_poisson=0.3", "-scene_poisson"),
                                         ("scene_maugis", "-scene_normal_maugis"),
                                         ("scene_friction_residual", "-scene_residual_friction"),
                                         ("scene_unit", "-scene_units"),
                                         ("contact_threshold", "-scene_contact_threshold"),
                                         ("pc_core_smooth", "-pc_core_smoothing"),
                                         ("scene_zzzz", "")])
def test_unknown_names_are_errors_with_the_nearest_valid_one(petsc, name, guess):
    petsc["scene_poisson"] = 0.3
    petsc["pc_core_smoothing"] = 1
    petsc["snes_rtol"] = 1
    petsc["mine"] = 1
    options.check_names([CoreOptions])
    petsc[name] = 1
    with pytest.raises(InputError) as error:
        options.check_names([CoreOptions])
    assert f"-{name} is no option" in str(error.value) and guess in str(error.value)


def test_names_inside_values_are_not_taken_for_options(petsc):
    petsc["contactsnes_value"] = "1 -scene_nonsense 2"
    options.check_names()
    assert options.database()["contactsnes_value"] == "1 -scene_nonsense 2"
    petsc["scene_nonsense"] = 2
    with pytest.raises(InputError, match="-scene_nonsense is no option"):
        options.check_names()


@pytest.mark.parametrize("name, text, allowed", [
    ("snes_atol", "-1", "at least 0 and below 1"), ("snes_atol", "nan", "at least 0 and below 1"),
    ("snes_atol", "1e300", "below 1"), ("snes_atol", "1e-8,1e-9", "a number"),
    ("snes_rtol", "-1", "at least 0"), ("snes_stol", "-1", "at least 0"),
    ("snes_max_it", "0", "a whole number at least 1"), ("snes_max_it", "1e3", "a whole number"),
    ("snes_max_funcs", "-5", "or -1 for none"), ("snes_lag_jacobian", "0", "at least 1, or -2"),
    ("snes_divergence_tolerance", "nan", "above 0, or -1"), ("snes_ksp_ew_rtol0", "2", "below 1"),
    ("snes_ksp_ew_alpha", "0", "above 1 and at most 2"), ("snes_ksp_ew_version", "9", "1 to 4"),
    ("snes_linesearch_damping", "-1", "above 0"), ("ksp_rtol", "2", "below 1"),
    ("ksp_atol", "-1", "at least 0"), ("ksp_max_it", "-3", "at least 0"),
    ("ksp_gmres_restart", "0", "at least 1"), ("snes_ngmres_m", "-2", "at least 1"),
    ("first_snes_atol", "-1", "at least 0"), ("sub_0_npc_ksp_rtol", "abc", "a number")])
def test_numbers_of_petscs_options_are_refused_by_name(petsc, name, text, allowed):
    petsc[name] = text
    with pytest.raises(InputError) as error:
        options.check_values(())
    assert str(error.value).startswith(f"-{name} is '{text}': allowed is ")
    assert allowed in str(error.value) and "or try " in str(error.value)


def test_numbers_that_petsc_can_use_are_left_to_it(petsc):
    for name, text in (("snes_atol", "1e-50"), ("ksp_atol", "0"), ("snes_max_funcs", "unlimited"),
                       ("snes_divergence_tolerance", "-1"), ("snes_lag_preconditioner", "-2"),
                       ("ksp_rtol", ".5"), ("snes_max_it", "1"), ("mine_snes_atol", "-1")):
        petsc[name] = text
    options.check_values(())


@pytest.mark.parametrize("name, guess", [("snes_type", "newtonls"), ("arc_ksp_type", "fgmres")])
def test_types_that_petsc_has_not_are_refused_for_a_script_too(petsc, name, guess):
    petsc[name] = guess + "x"
    with pytest.raises(InputError, match=f"^-{name} is '{guess}x', a type that .* {guess}[?]"):
        Branch(Scene(points=64, period=20.0, normal_maugis=1.0), Load(path="normal_displacement=1"))


def test_a_linear_solve_that_nothing_ends_is_refused(petsc):
    """Without norms PETSc takes ten thousand iterations for each of Newton's."""
    petsc["first_ksp_norm_type"] = "none"
    with pytest.raises(InputError, match="^-first_ksp_norm_type is 'none': .*first_ksp_max_it 20"):
        options.check_values(())
    petsc["first_ksp_max_it"] = "20"
    options.check_values(())


@pytest.mark.parametrize("kind", [None, "gmres", "bcgs"])
def test_a_linear_solve_that_its_number_of_iterations_fails_is_refused(petsc, kind):
    """Of most methods PETSc calls that a failure: each step then ended far from a solution."""
    petsc["ksp_norm_type"], petsc["ksp_max_it"] = "none", "20"
    if kind:
        petsc["ksp_type"] = kind
    with pytest.raises(InputError, match="methods but richardson.* add -ksp_type richardson "):
        options.check_values(())
    for kind in ("richardson", "gcr"):
        petsc["ksp_type"] = kind
        options.check_values(())


@pytest.mark.parametrize("name, text", [("snes_type", "aspin"), ("npc_snes_type", "aspin"),
                                        ("ksp_type", "pipelcg"), ("pc_type", "kaczmarz"),
                                        ("fas_levels_1_pc_type", "jacobi"),
                                        ("arc_pc_type", "Redistribute")])
def test_methods_that_petsc_would_crash_with_are_refused(petsc, name, text):
    petsc[name] = text
    with pytest.raises(InputError, match=f"^-{name} is '{text}': it .*; leave it out$"):
        options.check_values(())


def test_values_of_petscs_options_may_not_be_left_out(petsc):
    petsc["ksp_rtol"] = ""
    with pytest.raises(InputError, match="^-ksp_rtol has no value: allowed is a number"):
        options.check_values(())


def test_what_petsc_refuses_is_told_with_the_option_it_is_about(petsc):
    from petsc4py import PETSc

    petsc["ksp_type"] = "nonsense"
    solver = PETSc.KSP().create()
    with pytest.raises(PETSc.Error) as error:
        solver.setFromOptions()
    solver.destroy()
    assert "PETSc: -ksp_type is 'nonsense': Unable to find" in options.petsc_sentence(error.value)
    petsc.delValue("ksp_type")
    assert "nonsense': " not in options.petsc_sentence(error.value)


@pytest.mark.parametrize("kind", ["ilu", "lu"])
def test_what_needs_entries_that_a_matrix_has_not_is_told_in_words(petsc, kind):
    from petsc4py import PETSc

    petsc["pc_type"] = kind
    matrix = PETSc.Mat().create()
    matrix.setSizes((2, 2))
    matrix.setType("shell")
    matrix.setUp()
    solver = PETSc.PC().create()
    solver.setFromOptions()
    solver.setOperators(matrix)
    with pytest.raises(PETSc.Error) as error:
        solver.setUp()
    solver.destroy()
    matrix.destroy()
    told = options.petsc_sentence(error.value)
    assert f"-pc_type is '{kind}': it asks for entries" in told and "leave it out" in told


def test_unused_options_of_petsc_are_found(petsc):
    from petsc4py import PETSc

    petsc["snes_max_it"] = 3
    petsc["snes_maxit"] = 4
    petsc["ksp_nonsense"] = 1
    petsc["mine"] = 1
    snes = PETSc.SNES().create(PETSc.COMM_SELF)
    snes.setFromOptions()
    snes.destroy()
    assert sorted(options.unused_options()) == ["-ksp_nonsense", "-snes_maxit"]


# Help

def test_help_has_every_option_with_unit_default_and_range():
    text = " ".join(help_text([CoreOptions], width=100).split())
    for cls in (*OPTION_CLASSES, CoreOptions):
        for field in dataclasses.fields(cls):
            rule = field.metadata
            assert f" {cls.option_name(field.name)} {rule['meaning']}" in text
            assert rule["unit"] in text and (f"default {rule['default_text']}" in text
                                             or not rule["default_text"])


@pytest.mark.parametrize("width", [60, 80, 132])
def test_help_fits_the_terminal(width, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    assert max(map(len, help_text().splitlines())) <= width


def test_help_and_arguments_work_before_petsc_starts():
    script = ("import sys\nfrom contactsnes.options import database as "
              "options, help\nfrom contactsnes.scene import settings\nhelp.help_text(); "
              "options.petsc_arguments(['-a', '1'])\nassert not "
              "any(name.startswith('petsc4py') for name in sys.modules)")
    subprocess.run([sys.executable, "-c", script], check=True)


# Names and values under the prefixes of solvers inside others, and from Python

MISSPELT = {"scxene_range_normal": "did you mean -scene_range_normal",
            "laod_path": "did you mean -load_path", "scene_typo": "-scene_typo is no option",
            "contact_frm": "did you mean -contact_form",
            "pc_core_widht": "did you mean -pc_core_width",
            "first_snes_fire_growht": "did you mean -first_snes_fire_growth",
            "jump_snes_regularised_stifness": "-jump_snes_regularised_stiffness",
            "jump_motion_kik": "did you mean -jump_motion_kick",
            "arc_pc_core_treshold": "did you mean -arc_pc_core_threshold",
            "npc_snes_regularised_gab": "did you mean -npc_snes_regularised_gap",
            "sub_0_pc_core_widht": "did you mean -sub_0_pc_core_width",
            "sub_1_npc_pc_core_widht": "-sub_1_npc_pc_core_width",
            "fas_coarse_pc_core_widht": "-fas_coarse_pc_core_width",
            "fas_levels_1_pc_core_widht": "-fas_levels_1_pc_core_width",
            "error_pc_core_widht": "-error_pc_core_width",
            "frist_snes_fire_growth": "did you mean -first_snes_fire_growth",
            "mine_pc_core_widht": "did you mean -mine_pc_core_width",
            "snse_atol": "did you mean -snes_atol?", "kps_rtol": "did you mean -ksp_rtol?",
            "jmp_ksp_rtol": "did you mean -jump_ksp_rtol?"}
REFUSED = {"jump_snes_regularised_stiffness": "0.1", "first_snes_fire_growth": "0.5",
           "sub_0_pc_core_threshold": "3", "fas_levels_2_pc_core_width": "wide"}


def bare_branch():
    from contactsnes import Branch, Load, Scene

    return Branch(Scene(points=64, period=20.0, normal_maugis=1.0), Load(path="normal_force=1"))


@pytest.mark.parametrize("name", MISSPELT)
def test_misspelt_names_from_python_are_refused(options, name):
    options(**{name: "1"})
    with pytest.raises(InputError, match=MISSPELT[name]):
        bare_branch()


@pytest.mark.parametrize("name", REFUSED)
def test_values_under_nested_prefixes_are_refused(options, name):
    options(**{name: REFUSED[name]})
    with pytest.raises(InputError, match=f"-{name} is '{REFUSED[name]}': allowed is"):
        bare_branch()


def test_names_under_prefixes_are_taken(options):
    options(first_snes_fire_growth="1.2", jump_snes_regularised_stiffness="0.3",
            sub_0_pc_core_width="4", mine_pc_core_width="4", jump_snes_atol="1e-9",
            fas_levels_pc_core_threshold="0.2", my_snes_fire_growth="1.2", my_ksp_rtol="0.1",
            sub_pc_type="lu", mg_levels_ksp_max_it="2", ts_type="euler", tao_atol="1")
    bare_branch()


def test_the_database_is_read_alike_from_memory_and_from_disk(options, monkeypatch):
    from contactsnes.options.database import database

    options(scene_geometry_file="two words -scene_points 3", scene_law="modified", empty="")
    found = database()
    assert found["scene_geometry_file"] == "two words -scene_points 3" and found["empty"] == ""
    monkeypatch.delattr("os.memfd_create", raising=False)
    assert database() == found


def test_heights_stand_beside_the_file_that_names_them(tmp_path, monkeypatch):
    (tmp_path / "own").mkdir()
    (tmp_path / "own/scene.opts").write_text("-scene_geometry_file heights.txt\n-scene_x h.txt\n")
    (tmp_path / "own/heights.txt").write_text("0 1 2\n")
    monkeypatch.chdir(tmp_path)
    assert files.read_file("own/scene.opts") == ["-scene_geometry_file", "own/heights.txt",
                                                 "-scene_x", "h.txt"]
    (tmp_path / "heights.txt").write_text("3 4 5\n")  # that of the working folder wins
    assert files.read_file("own/scene.opts")[1] == "heights.txt"


@pytest.mark.parametrize("name, value, told", [
    ("height", "tall", "or inf; try 2000$"), ("law", "modifed", "try modified$"),
    ("adhesive_strength", "none", "allowed is a number above 0$"),
    ("adhesive_strength", "2kPa", "allowed is a number above 0, typed without its unit$"),
    ("adhesive_strength", "2e3 Pa", "typed without its unit$"),
    ("amplitude", "x", r"above 0; left out, it is \(L/2 pi\)\^2, of curvature 1$"),
])
def test_what_is_advised_in_place_of_a_bad_value_is_allowed(name, value, told):
    with pytest.raises(InputError, match=told):
        Scene.typed(**{name: value})
