"""GMRES with vectors in single precision: PETSc's iterations and answers, and rows that are given
back."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])
from petsc4py import PETSc  # noqa: E402

from contactsnes.branch.branch import Branch  # noqa: E402
from contactsnes.grid.cell import Grid  # noqa: E402
from contactsnes.grid.rounded import LENGTH, Rounded  # noqa: E402
from contactsnes.kernels import krylov as compiled  # noqa: E402
from contactsnes.kernels import library  # noqa: E402
from contactsnes.scene.load import Load  # noqa: E402
from contactsnes.scene.settings import Form, Scene, Steps  # noqa: E402
from contactsnes.solvers import basis, callbacks, krylov  # noqa: E402
from contactsnes.solvers.basis import (  # noqa: E402
    Basis,
    InDouble,
    InSingle,
    Orthogonality,
    Short,
    orthogonalised,
    wide,
)
from contactsnes.solvers.krylov import GMRES, of_ksp  # noqa: E402
from contactsnes.solvers.ritz import ritz_values  # noqa: E402

ALONE = Grid((4,), (1.0,))
WAYS = [True] + [False] * (library.reason() is None)
REASONS = PETSc.KSP.ConvergedReason
SIZE = 300


@pytest.fixture(autouse=True)
def rounding(monkeypatch):
    """Vectors are rounded whatever their size."""
    monkeypatch.setattr(krylov, "WIDE", 1)


@pytest.fixture
def rng():
    return np.random.default_rng(7)


class Varying:
    """A preconditioner that is another one each time it is asked."""

    def __init__(self):
        self.count = 0

    def apply(self, pc, x, y):
        """y = x over a diagonal that varies."""
        self.count += 1
        given = x.getArray(readonly=True)
        y.setArray(given / (1.0 + 0.2 * np.sin(self.count + np.arange(len(given)))))


class Fixed:
    """A preconditioner that is the same linear function whenever it is asked, as ours are."""

    is_ours = True

    def __init__(self):
        self.count = 0

    def apply(self, pc, x, y):
        """y = x over a diagonal."""
        self.count += 1
        given = x.getArray(readonly=True)
        y.setArray(given / (1.0 + 0.2 * np.sin(np.arange(len(given)))))


CONTEXTS = {"varying": Varying, "fixed": Fixed}


def ksp_of(matrix, own, pc="jacobi", **tolerances):
    """A KSP, PETSc's fgmres or a GMRES, for a dense matrix."""
    operator = PETSc.Mat().createDense(matrix.shape, array=matrix, comm=PETSc.COMM_SELF)
    operator.assemble()
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOperators(operator)
    if own is None:
        ksp.setType("fgmres")
        ksp.setGMRESRestart(60)
    else:
        ksp.setType("python")
        ksp.setPythonContext(own)
    ksp.setComputeEigenvalues(True)
    if pc in CONTEXTS:
        ksp.getPC().setType("python")
        ksp.getPC().setPythonContext(CONTEXTS[pc]())
    else:
        ksp.getPC().setType(pc)
    ksp.setFromOptions()
    ksp.setTolerances(**{"rtol": 1e-4, "atol": 1e-50, "max_it": 150, **tolerances})
    ksp.setConvergenceHistory()
    return ksp


def solved(ksp, right, start=None):
    """(solution, norms on the way) of a KSP."""
    b = PETSc.Vec().createWithArray(right.copy(), comm=PETSc.COMM_SELF)
    x = PETSc.Vec().createWithArray(np.zeros(len(right)) if start is None else start.copy(),
                                    comm=PETSc.COMM_SELF)
    ksp.setInitialGuessNonzero(start is not None)
    ksp.solve(b, x)
    return x.getArray().copy(), np.array(ksp.getConvergenceHistory())


@pytest.fixture
def system(rng):
    """The identity and something compact, as Jacobians are, and a right side."""
    basis = np.linalg.qr(rng.normal(size=(SIZE, SIZE)))[0]
    matrix = np.eye(SIZE) + basis @ np.diag(5.0 * 0.85 ** np.arange(SIZE)) @ rng.normal(
        size=(SIZE, SIZE)) / np.sqrt(SIZE)
    return matrix, rng.normal(size=SIZE)


@pytest.mark.parametrize("interpreted", WAYS)
@pytest.mark.parametrize("pc", ["jacobi", "varying", "fixed", "none"])
@pytest.mark.parametrize("tolerance, near", [(1e-4, 1e-4), (1e-10, 1e-7)])
def test_iterations_and_norms_are_those_of_petsc(system, interpreted, pc, tolerance, near):
    own, theirs = (ksp_of(system[0], context, pc, rtol=tolerance)
                   for context in (GMRES(ALONE, interpreted, cheap=True), None))
    (found, norms), (expected, known) = (solved(ksp, system[1]) for ksp in (own, theirs))
    assert own.getIterationNumber() == theirs.getIterationNumber() > 8
    assert own.getConvergedReason() == theirs.getConvergedReason() == REASONS.CONVERGED_RTOL
    np.testing.assert_allclose(norms, known, rtol=near, atol=1e-13 * norms[0])
    np.testing.assert_allclose(found, expected, atol=10.0 * near * tolerance * np.abs(found).max()
                               + 1e-2 * tolerance)
    left = np.linalg.norm(system[0] @ found - system[1])
    assert left <= 1.001 * tolerance * np.linalg.norm(system[1])
    assert abs(own.getResidualNorm() - left) < 2e-6 * np.linalg.norm(system[1])
    values, others = (np.sort_complex(ritz_values(ksp)) for ksp in (own, theirs))
    np.testing.assert_allclose(values, others, atol=0.01)
    np.testing.assert_allclose(values.real.min(), others.real.min(), rtol=1e-4)


@pytest.mark.parametrize("cheap", [False, True])
@pytest.mark.parametrize("pc", CONTEXTS)
def test_a_cheap_preconditioner_of_ours_is_asked_once_more_a_cycle(system, options, pc, cheap):
    """In place of keeping what it made of each vector; one that may vary never is."""
    options(ksp_gmres_restart="6")
    own = GMRES(ALONE, True, cheap)
    ksp = ksp_of(system[0], own, pc)
    found, norms = solved(ksp, system[1])
    left = np.linalg.norm(system[0] @ found - system[1])
    assert left <= 1.001e-4 * np.linalg.norm(system[1])
    again, iterations = pc == "fixed" and cheap, ksp.getIterationNumber()
    assert ksp.getPC().getPythonContext().count == iterations + again * -(-iterations // 6)
    assert (own._kept[1][1] is None) == again


@pytest.mark.parametrize("interpreted", WAYS)
def test_cycles_begin_anew_in_double_precision(system, options, interpreted):
    options(ksp_gmres_restart="4")
    own, theirs = (ksp_of(system[0], context)
                   for context in (GMRES(ALONE, interpreted), None))
    (found, norms), (expected, known) = (solved(ksp, system[1]) for ksp in (own, theirs))
    assert own.getIterationNumber() == theirs.getIterationNumber() > 8
    assert np.abs(norms[-1] / known[-1] - 1.0) < 1e-3
    np.testing.assert_allclose(found, expected, atol=1e-5)


@pytest.mark.parametrize("tolerance, kinds", [
    (1e-2, ["Short"]), (1e-4, ["Basis", "Short"]), (1e-8, ["double", "Short"])])
def test_cycles_hold_vectors_in_the_precision_they_ask_for(system, options, monkeypatch,
                                                           tolerance, kinds):
    """Of what a cycle begins with: one that is to reduce it by more than single precision holds is
    in double, the next ones, which begin with less, in single, and then rounded."""
    options(ksp_gmres_restart="6")
    own, seen = GMRES(ALONE, True), []
    bases = own._bases

    def watched(*given):
        space, made = bases(*given)
        seen.append("double" if space._products is basis.InDouble else type(space).__name__)
        return space, made

    monkeypatch.setattr(own, "_bases", watched)
    ksp, theirs = (ksp_of(system[0], context, rtol=tolerance) for context in (own, None))
    theirs.setGMRESRestart(6)
    (found, _), (expected, _) = (solved(each, system[1]) for each in (ksp, theirs))
    assert list(dict.fromkeys(seen)) == kinds
    assert ksp.getIterationNumber() == theirs.getIterationNumber() > 4
    np.testing.assert_allclose(found, expected, atol=10.0 * tolerance)
    left = np.linalg.norm(system[0] @ found - system[1])
    assert left <= 1.001 * tolerance * np.linalg.norm(system[1])


@pytest.mark.parametrize("fell, kinds", [(krylov.FELL, {Short}), (0.0, {Short, None})])
def test_solves_that_tell_nothing_of_modes_are_in_parts(system, monkeypatch, fell, kinds):
    """Whose vectors are rounded, however exact they are to be, as long as that leads on."""
    monkeypatch.setattr(krylov, "FELL", fell)
    ksp, theirs = (ksp_of(system[0], context, rtol=1e-9) for context in (GMRES(ALONE, True), None))
    iterations, seen = of_ksp(ksp)._iterations, []
    monkeypatch.setattr(of_ksp(ksp), "_iterations", lambda *given: seen.append(given[-1])
                        or iterations(*given))
    krylov.tell_modes(ksp, False)
    (found, _), (expected, _) = (solved(each, system[1]) for each in (ksp, theirs))
    assert seen[0] is Short and set(seen) == kinds and len(seen) > 1
    assert ksp.getConvergedReason() == REASONS.CONVERGED_RTOL
    assert ksp.getIterationNumber() <= 1.4 * theirs.getIterationNumber()
    np.testing.assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())
    left = np.linalg.norm(system[0] @ found - system[1])
    assert left <= 1.001e-9 * np.linalg.norm(system[1])
    krylov.tell_modes(ksp, True)
    seen.clear()
    solved(ksp, system[1])
    assert seen == [None]


def test_few_unknowns_are_not_rounded(system, monkeypatch):
    monkeypatch.setattr(krylov, "WIDE", SIZE + 1)
    own, seen = GMRES(ALONE, True), []
    iterations = own._iterations
    monkeypatch.setattr(own, "_iterations", lambda *given: seen.append(given[-1])
                        or iterations(*given))
    solved(ksp_of(system[0], own, rtol=1e-2), system[1])
    assert set(seen) == {krylov.Basis}


def test_what_a_solve_begins_with_counts(system):
    exact = np.linalg.solve(*system)
    ksp = ksp_of(system[0], GMRES(ALONE, True), atol=1e-3)
    found, norms = solved(ksp, system[1], exact + 1e-5)
    assert norms[0] == pytest.approx(1e-5 * np.linalg.norm(system[0].sum(axis=1)), rel=1e-3)
    assert ksp.getIterationNumber() == 0 and np.array_equal(found, exact + 1e-5)
    found, _ = solved(ksp, system[1], exact + 0.1)
    left = np.linalg.norm(system[0] @ found - system[1])
    assert left < max(1e-3, 1.001e-4 * np.linalg.norm(system[1]))


def test_it_ends_at_the_limit_and_where_nothing_is_left(system):
    ksp = ksp_of(system[0], GMRES(ALONE, True), max_it=3)
    solved(ksp, system[1])
    assert ksp.getConvergedReason() == REASONS.DIVERGED_MAX_IT and ksp.getIterationNumber() == 3
    ksp = ksp_of(2.0 * np.eye(SIZE), GMRES(ALONE, True), pc="none", rtol=1e-12)
    found, _ = solved(ksp, system[1])
    assert ksp.getIterationNumber() == 1 and ksp.getConvergedReason() > 0
    np.testing.assert_allclose(found, 0.5 * system[1], rtol=1e-12)
    assert not solved(ksp, 0.0 * system[1])[0].any() and ksp.getIterationNumber() == 0
    singular = ksp_of(np.zeros((SIZE, SIZE)), GMRES(ALONE, True), pc="none")
    solved(singular, system[1])
    assert singular.getConvergedReason() < 0


PRODUCTS = [basis.InSingle] + [compiled] * (len(WAYS) > 1)


def rows_of(given, kind):
    """Rows of a kind that hold vectors, and what they hold."""
    if kind == "single":
        rows = list(given.astype(np.float32))
        return rows, np.array(rows, dtype=float)
    rows, held = [Rounded.of(given.shape[1]) for _ in given], given.copy()
    for row, vector in zip(rows, held):
        basis.rounded(vector, row)
    return rows, held


@pytest.mark.parametrize("size", [1, 1023, 1024, 5000, 3 * basis.PIECE + 17])
@pytest.mark.parametrize("count", [1, 4, 7])
@pytest.mark.parametrize("kind", ["single", "rounded"])
def test_rows_of_few_digits(rng, size, count, kind):
    """Products of all rows, and of the first, in double precision; those of rounded ones in the
    library in single."""
    rows, wide = rows_of(rng.normal(size=(count, size)), kind)
    vector, factors = rng.normal(size=size), rng.normal(size=count)
    for products in PRODUCTS:
        error = 3e-7 if kind == "rounded" and products is compiled else 1e-13
        kept = products.Rows(rows)
        for some in (count, max(1, count - 2)):
            lengths = np.linalg.norm(wide[:some], axis=1) * np.linalg.norm(vector)
            *found, square = products.inner_products(kept, vector, some)
            assert np.all(np.abs(wide[:some] @ vector - found) <= 10.0 * error * lengths)
            assert square == pytest.approx(vector @ vector, rel=1e-12)
            changed = vector.copy()
            square = products.add_rows(kept, factors[:some], changed)
            within = error * (np.abs(vector) + np.abs(factors[:some]) @ np.abs(wide[:some]))
            assert np.all(np.abs(changed - vector - factors[:some] @ wide[:some]) <= within)
            assert square == pytest.approx(changed @ changed, rel=1e-12)
        np.testing.assert_array_equal(products.inner_products(kept, vector),
                                      products.inner_products(rows, vector, count))


def test_rows_that_come_later_are_known(rng):
    """Where rows begin is kept, for as many as there were."""
    vector, given = rng.normal(size=3000), rng.normal(size=(3, 3000)).astype(np.float32)
    for products in PRODUCTS:
        rows = products.Rows()
        for place, row in enumerate(given):
            rows.append(row)
            *found, _ = products.inner_products(rows, vector)
            np.testing.assert_allclose(found, given[:place + 1].astype(float) @ vector, rtol=1e-12)


@pytest.mark.parametrize("size", [1, 1023, 1024, 5000])
def test_vectors_are_rounded_by_pieces(rng, size):
    """To half a part of 32767 of the largest number of a piece; what is rounded stays as it is."""
    given = rng.normal(size=size) * np.repeat([1e-30, 1.0, 1e20, 3.0, 7.0], LENGTH)[:size]
    given[1024:1030] = 0.0
    for products in PRODUCTS:
        vector, row = given.copy(), Rounded.of(size)
        products.rounded(vector, row)
        for first in range(0, size, LENGTH):
            piece = slice(first, first + LENGTH)
            largest = np.abs(given[piece]).max()
            assert np.abs(vector - given)[piece].max() <= 0.5001 * largest / basis.SHORTEST
            assert row.scales[first // LENGTH] == largest / basis.SHORTEST
        np.testing.assert_array_equal(row.wide(), vector)
        again, same = vector.copy(), Rounded.of(size)
        products.rounded(again, same)
        np.testing.assert_array_equal(same.numbers, row.numbers)
        np.testing.assert_allclose(again, vector, rtol=1e-15)
        products.rounded(scaled := given.copy(), same, 0.3)
        np.testing.assert_array_equal(same.numbers, row.numbers)
        np.testing.assert_allclose(scaled, 0.3 * vector, rtol=1e-15)
        np.testing.assert_array_equal(same.wide(), scaled)
        products.rounded(nothing := np.zeros(size), same)
        assert not nothing.any() and not same.numbers.any()


@pytest.mark.parametrize("interpreted", WAYS)
@pytest.mark.parametrize("kind", (Short, Basis, float))
def test_rows_stay_orthogonal_where_little_is_left_of_vectors(rng, monkeypatch, interpreted,
                                                              kind):
    """A three hundredth of each, in a solve that stagnates: what rounding left of products grew by
    that with each row, and the residual was not what a cycle claimed."""
    parts = ((float, InDouble) if kind is float else
             (np.float32, InSingle if interpreted else compiled))
    found = []
    for skew in (np.inf, basis.SKEW):
        monkeypatch.setattr(basis, "SKEW", skew)
        space = (Basis if kind is float else kind)(*parts, ALONE, 20 * LENGTH)
        orthogonality = Orthogonality(space.kind)
        vector, rows = rng.normal(size=20 * LENGTH), []
        for place in range(24):
            space.keep(place, vector, 1.0 / np.linalg.norm(vector))
            rows.append(np.array(wide(space.rows[place]) if kind is not float
                                 else space.rows[place]))
            part = rng.normal(size=place + 1) / np.sqrt(place + 1)
            vector = 300.0 * part @ np.array(rows)
            fresh = rng.normal(size=len(vector))
            vector += fresh / np.linalg.norm(fresh)
            column = orthogonalised(space, place + 1, vector, orthogonality.bound)
            orthogonality.after(column)
        products = np.array(rows) @ np.transpose(rows)
        found.append(np.abs(products - np.diag(np.diag(products))).max())
    assert found[0] > 0.5 > 0.05 > found[1]


@pytest.mark.filterwarnings("error")
def test_vectors_of_nothing_tell_nothing_of_rows():
    orthogonality = Orthogonality(np.float32)
    for column in (np.zeros(3), np.array([np.nan, 1.0]), np.array([1.0, 0.0])):
        orthogonality.after(column)
    assert orthogonality.bound == basis.CANCELLED


def test_what_is_no_number_stays_none_when_it_is_rounded():
    for number in (np.nan, np.inf):
        for products in PRODUCTS:
            vector = np.ones(3000)
            vector[1500] = number
            with np.errstate(invalid="ignore"):
                products.rounded(vector, Rounded.of(3000))
            assert not np.isfinite(vector[1500]) and np.isfinite(vector[:1024]).all()


SPHERE = {"points": 96, "period": 12.0, "normal_maugis": 2.0, "dimension": 2,
          "geometry": "sphere"}
PATHS = {"normal": ("normal_displacement=1.6", {}), "force": ("normal_force=3", {}),
         "sheared": ("tangential_displacement_x=1.5", {"tangential_maugis": 1.0}),
         "arc length": ("normal_displacement=-3", {})}
OTHERS = {("off", "normal"), ("off", "force"), ("off", "arc length")}
"""Paths of NumPy's forms that are no other kind than the one with sliding: a study."""


def path(kernels="auto", way="normal", symmetry="off"):
    """(points, log, branch) of a sphere pressed, sheared or pulled off."""
    told, (leg, more) = [], PATHS[way]
    branch = Branch(Scene(**SPHERE, **more), Load(start="normal_displacement=1", path=leg),
                    Steps(initial_step=0.2, largest_step=0.2), log=told.append,
                    form=Form(kernels=kernels, linear_precision="single", symmetry=symmetry))
    return list(branch), told, branch


@pytest.mark.parametrize("symmetry, way", [("auto", "normal"), ("off", "normal"),
                                           ("off", "arc length")])
def test_preconditioners_in_patches_are_asked_again(monkeypatch, symmetry, way):
    """Even planes have none of them, and nodes of which the core takes most."""
    monkeypatch.setattr(krylov, "LARGE", 1)
    asked, asks = set(), GMRES._asks_again
    monkeypatch.setattr(GMRES, "_asks_again", lambda own, pc: asked.add(asks(own, pc))
                        or asks(own, pc))
    path(way=way, symmetry=symmetry)
    assert asked == {symmetry == "off"}


def test_lines_keep_that_of_petsc(monkeypatch):
    """Their vectors are short, and the way into Python is not."""
    monkeypatch.setattr(krylov, "LARGE", 1)
    branch = Branch(Scene(points=256), Load("normal_displacement=1", "normal_displacement=2"),
                    form=Form(linear_precision="single"))
    list(branch)
    assert branch.corrector.snes.getKSP().getType() == "fgmres"


@pytest.mark.parametrize("way, kernels", [
    pytest.param(way, kernels, marks=pytest.mark.study if (kernels, way) in OTHERS else ())
    for way in PATHS for kernels in ("auto", "off")])
def test_paths_are_those_of_petsc(monkeypatch, options, kernels, way):
    monkeypatch.setattr(krylov, "LARGE", 1)
    found, told, branch = path(kernels, way)
    assert of_ksp(branch.corrector.snes.getKSP())
    options(ksp_type="fgmres")
    expected, also, branch = path(kernels, way)
    assert of_ksp(branch.corrector.snes.getKSP()) is None
    assert told == also and len(found) == len(expected) > 2
    for point, other in zip(found, expected):
        np.testing.assert_allclose(point.load, other.load, rtol=1e-7)
        np.testing.assert_allclose(point.forces, other.forces, rtol=1e-6, atol=1e-7)
        assert point.event == other.event
        for name in ("nonlinear_iterations", "linear_iterations"):
            assert abs(point.spent[name] - other.spent[name]) <= 1 + 0.03 * other.spent[name]
        if point.event is None and not np.isnan(other.softest):
            # (that of what the last step left over, which rounded vectors change a little)
            assert point.softest == pytest.approx(other.softest, rel=0.03)


def test_vectors_are_made_when_they_are_asked_for_and_given_back(monkeypatch):
    monkeypatch.setattr(krylov, "LARGE", 1)
    most = []

    make = krylov.Basis.make

    def made(self, place):
        make(self, place)
        most.append((len(self.rows), type(self), place))

    monkeypatch.setattr(krylov.Basis, "make", made)
    points, _, branch = path()
    assert max(rows for rows, _, _ in most) == 1 + max(place for _, _, place in most) < 20
    assert {kind for _, kind, _ in most} <= {krylov.Basis, krylov.Short}
    assert of_ksp(branch.corrector.snes.getKSP())._kept == (None, None)


@pytest.mark.parametrize("search", ["basic", "none", "bt"])
def test_full_steps_and_linear_solves_take_turns_in_a_vector(monkeypatch, options, search):
    """Other line searches need their own; the way is the same with it and without."""
    monkeypatch.setattr(krylov, "LARGE", 1)
    options(snes_linesearch_type=search)
    found, _, branch = path()
    own = of_ksp(branch.corrector.snes.getKSP())
    if search == "bt" or library.reason() is not None:
        assert own.idle is None
        return
    # of PETSc's two none is counted by it
    assert own.idle.getRefCount() == 3 and own.idle.getSize() == branch.corrector.form.size
    monkeypatch.setattr(callbacks, "share_work", lambda snes, form: None)
    expected, _, other = path()
    assert of_ksp(other.corrector.snes.getKSP()).idle is None and len(found) == len(expected) > 2
    for point, like in zip(found, expected):
        np.testing.assert_array_equal(point.state.displacement, like.state.displacement)
        assert point.spent["linear_iterations"] == like.spent["linear_iterations"]
    vector = own.idle
    branch.corrector.release()
    assert not vector


def test_small_solves_and_those_in_double_precision_are_petscs(monkeypatch):
    _, _, branch = path()
    assert branch.corrector.snes.getKSP().getType() == "fgmres"
    monkeypatch.setattr(krylov, "LARGE", 1)
    branch = Branch(Scene(**SPHERE), Load(start="normal_displacement=1",
                                          path="normal_displacement=1.2"),
                    form=Form(linear_precision="double"))
    list(branch)
    assert branch.corrector.snes.getKSP().getType() == "fgmres"


def test_a_type_of_the_users_is_taken(monkeypatch, options):
    monkeypatch.setattr(krylov, "LARGE", 1)
    options(ksp_type="bcgs")
    points, _, branch = path()
    assert branch.corrector.snes.getKSP().getType() == "bcgs" and len(points) > 2


def test_trust_regions_have_that_of_petsc(monkeypatch, options):
    """They ask a linear solve for its solution after each iteration."""
    monkeypatch.setattr(krylov, "LARGE", 1)
    options(snes_type="newtontr")
    points, _, branch = path()
    assert branch.corrector.snes.getKSP().getType() == "fgmres" and len(points) > 2
