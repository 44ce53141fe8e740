"""C of the laws: the file is that of the formulas, and computes what NumPy's programs do."""

import ctypes
import ctypes.util
import platform
import shutil
import subprocess

import numpy as np
import pytest
from scipy.special import erf, erfc

from contactsnes import Law, option
from contactsnes.interface.formula import Formula, Tractions
from contactsnes.interface.laws import LAWS
from contactsnes.kernels import law_text

compiler = shutil.which("cc") or shutil.which("gcc")
compiled = pytest.mark.skipif(compiler is None, reason="there is no C compiler (cc or gcc)")
FLAGS = {"plain": ("-O0",), "vectors": ("-O3", "-fno-math-errno", "-fno-trapping-math")}
UNDERFLOW = 0x10
"""FE_UNDERFLOW of x86-64 (<fenv.h>)."""

OTHERS = {"modified": (0.3, 0.2), "dugdale": (0.4, 0.1, 0.3), "pressure_friction": (0.5, 0.2, 0.7),
          "xu_needleman": (0.6, 0.4)}


def built(text, folder, flags=("-O2",)):
    """A library of C, whose text has to pass the compiler without a warning."""
    (folder / "laws.c").write_text(text, encoding="utf-8")
    subprocess.run([compiler, "-std=c99", "-Wall", "-Wextra", "-Werror", *flags, "-shared", "-fPIC",
                    folder / "laws.c", "-o", folder / "laws.so", "-lm"], check=True)
    return ctypes.CDLL(str(folder / "laws.so"))


@pytest.fixture(scope="module", params=FLAGS)
def library(request, tmp_path_factory):
    return built(law_text.package(), tmp_path_factory.mktemp("laws"), FLAGS[request.param])


def computed(library, name, kind, values, *inputs):
    """What a function of a kind of the library makes of a law's parameters and gap (and slip)."""
    count = len(inputs[0])
    outputs = np.full((len(law_text.OUTPUTS[kind]), count), np.nan)
    arrays = [np.array([*values, 0.0]), *inputs, *outputs]
    function = getattr(library, name + kind)
    function.restype = None
    function(ctypes.c_long(count), *(ctypes.c_void_p(array.ctypes.data) for array in arrays))
    return outputs


def compared(library, name, law):
    """All functions against the programs, at gaps from -40 to 40 and slips from 0 to 8."""
    rng = np.random.default_rng(3)
    a = np.concatenate([rng.uniform(-40.0, 40.0, 2000), rng.uniform(-1.0, 3.0, 1000),
                        [0.0, law.deepest, 1e-9]])
    b = np.concatenate([rng.uniform(0.0, 8.0, len(a) - 200), rng.uniform(0.0, 1e-6, 100),
                        np.zeros(100)])
    programs = Tractions(law.formula)
    for kind in law_text.OUTPUTS:
        inputs, given = ((a,), (a,)) if kind == "_normal" else ((a, b), (a, b * b))
        found = computed(library, name, kind, law.formula.values, *inputs)
        meant = programs.program(len(inputs) == 2, True, True).run(*given)
        for values, expected in zip(found, meant):
            np.testing.assert_allclose(values, expected, rtol=1e-13, atol=1e-14)


@compiled
@pytest.mark.parametrize("name", LAWS)
def test_c_computes_what_numpy_does(library, name):
    for law in (LAWS[name](), LAWS[name](*OTHERS.get(name, ()))):
        compared(library, f"law_{name}", law)


@compiled
@pytest.mark.skipif(platform.machine() != "x86_64", reason="has its own numbers of exceptions")
@pytest.mark.parametrize("name", LAWS)
def test_exponentials_that_underflow_are_left_out(library, name):
    floats = ctypes.CDLL(ctypes.util.find_library("m"))
    law = LAWS[name]()
    far, near = np.linspace(800.0, 1000.0, 64), np.ones(64)
    for kind in law_text.OUTPUTS:
        for inputs in [(far,)] if kind == "_normal" else [(far, 0.0 * near), (near, 0.06 * far)]:
            floats.feclearexcept(UNDERFLOW)
            found = computed(library, f"law_{name}", kind, law.formula.values, *inputs)
            assert not floats.fetestexcept(UNDERFLOW)
            assert np.all(np.isfinite(found))


@compiled
def test_a_table_has_all_laws(library):
    class Row(ctypes.Structure):
        """A row of the table."""

        _fields_ = [("name", ctypes.c_char_p), *((kind, ctypes.c_void_p)
                                                 for kind in ("sheared", "tractions", "normal")),
                    ("parameters", ctypes.POINTER(ctypes.c_char_p))]

    rows = (Row * (len(LAWS) + 1)).in_dll(library, "traction_laws")
    assert [row.name.decode() for row in rows[:-1]] == list(LAWS) and rows[-1].name is None
    for row, cls in zip(rows, LAWS.values()):
        names = Formula(cls()).parameters
        assert [row.parameters[i].decode() for i in range(len(names))] == list(names)
        assert row.parameters[len(names)] is None


def test_the_file_is_current():
    assert law_text.FILE.read_text(encoding="utf-8") == law_text.package(), (
        "python -m contactsnes.kernels.law_text writes it anew")


class Everything(Law):
    """Every operation of formulas."""

    share = option(0.7, "share (law Everything)")
    power = option(1.5, "power (law Everything)", above=0)

    def tractions(self, a, b):
        """No law of nature."""
        c, d = np.clip(a, -2.0, 2.0), 1.0 + b
        inside = (c > 0.0) & (b <= 1.0) | ~((b < 2.0) & (c != 1.0))
        normal = a * np.exp(-a) + np.where(inside, np.sinh(c) - np.cosh(c), np.sin(c) * np.cos(c))
        friction = np.log(d) + np.log1p(b) + np.sqrt(d) + d**self.power + np.arctan(c) * np.abs(c)
        return (normal + self.share * np.tanh(c) + np.expm1(-d) + (c == 1.0),
                friction + np.minimum(c, 1.0) * (c >= 0.5) + erf(c) + erfc(b))


@compiled
def test_c_of_every_operation(tmp_path):
    law = Everything()
    text = law_text.functions(law.formula, "law_own")
    assert law.formula.parameters == ("share", "power")
    for called in law_text.CALLED.values():
        assert f"{called}(" in text, called
    compared(built(law_text.head(text) + text, tmp_path, FLAGS["vectors"]), "law_own", law)
