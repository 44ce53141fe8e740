"""Stability of a point under its controls: unstable modes and the leading eigenvalue of overdamped motion.

The body is one whose material creeps with the relaxation time 1 (Kelvin and Voigt): M u' = -(K u + t) with M = K for every wave.
So u = v + w, with the mean w of each component whose mean can move, obeys

    v' = -(v + C t),    m_0 w' = -(k_0 (w - far displacement) + mean t),

and small disturbances decay with the eigenvalues s of J (v, w) = (v + C D (v + w), (k_0 w + mean D (v + w)) / m_0), D the law's
tangent. J is the identity plus a compact operator on the nodes where the law acts: its eigenvalues do not depend on the grid, and
are 1 where the law does not act. m_0 is the stiffness of the cell's softest wave, of an isolated contact pi E* on a line (which
every period has) and pi E* beta in the plane. A mean that cannot move (rigid, under displacement control) has no w.
"""

from dataclasses import dataclass, replace
from itertools import zip_longest

import numpy as np
from scipy import linalg
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigs

from . import states
from .forms import DisplacementForm
from .mirrored import EVEN
from .options import read
from .points import NotConverged
from .preconditioners import CoreOptions, CoreZone
from .states import State
from .symmetry import asymmetry, centred, obstacle

SIGN, EIGENVALUE = "sign", "eigenvalue"
ACCURATE = 3e-4
"""Residual |J x - s x| / |x| to which the leading mode is found; the error of its eigenvalue is much smaller."""
DENSE, LARGEST_DENSE = 40, 3000
"""Unknowns up to which all eigenvalues are computed at once, and where the Krylov method fails."""
BASIS, RUNS, NOISE = 3, 25, 0.003
"""Products of a run of ARPACK (four times as many for a first point), most runs, and the part of noise in their starts."""


class Overdamped:
    """J of overdamped motion at a state, its preconditioner, and the mirror images under which it does not change.

    A vector is [(v + w) / root, w of the components whose mean can move], as in `forms.DisplacementForm`.

    Parameters
    ----------
    contact, window, controls : as of `forms.DisplacementForm`
    options : CoreOptions of the preconditioner
    """

    def __init__(self, contact, window, controls, options=CoreOptions()):
        self.form, self.options = DisplacementForm(contact, window, controls), options
        form, grid = self.form, contact.grid
        compliance = form.rigid_compliance.copy()
        free = np.isin(np.arange(form.components), form.forced)
        # Around an isolated contact the rigid compliance is a part of the body's response like any other wave.
        self._inner = compliance if contact.isolated else np.zeros(form.components)
        self.means = np.flatnonzero(free | ((compliance != 0.0) & (not contact.isolated)))
        self._stiffness = np.array([0.0 if free[i] else 1.0 / compliance[i] for i in self.means])
        self._mass = np.array([_mean_mass(contact, form.components, i) for i in self.means])
        self._free = free[self.means]
        self.size = form.count + len(self.means)
        self.zone = None

    def linearise(self, state, load):
        """Take the law's tangent at a state on the window, and make the preconditioner from it."""
        form = self.form
        form.set_load(load)
        form.linearise(form.pack(state.displacement, state.means[form.forced]))
        self.zone = CoreZone(form, self.options)

    def apply(self, vector):
        """J vector: two transforms of the padded window a component."""
        form, result = self.form, np.empty(self.size)
        form.products += 1
        field, means = vector[:form.count].reshape(form.shape), vector[form.count:]
        work = form.stiffen(field, form.work)
        total = form.grid.sum(work) * form.root / form.grid.size
        form.convolution.apply(work, work)
        rates = (self._stiffness * means + total[self.means]) / self._mass
        shift = self._inner * total / form.root
        shift[self.means] += (rates - means) / form.root
        out = result[:form.count].reshape(form.shape)
        np.add(field, work, out=out)
        out += shift[:, None]
        result[form.count:] = rates
        return result

    def precondition(self, vector):
        """About J^-1 vector, by the preconditioner of the form: two transforms of the core a component."""
        form = self.form
        field, rates = vector[:form.count].reshape(form.shape), vector[form.count:]
        right, out = np.zeros(form.size), np.empty(form.size)
        source = right[:form.count].reshape(form.shape)
        source[...] = field
        balance = self._mass * rates
        # What pulls a mean that is held by a spring moves it at once by its compliance.
        held = np.divide(balance, self._stiffness, out=np.zeros_like(balance), where=~self._free)
        source[self.means] += ((held - rates) / form.root)[:, None]
        right[form.count:] = form.row_scale[form.forced] * form.grid.size * balance[self._free]
        self.zone.apply(right, out)
        result = np.empty(self.size)
        result[:form.count] = out[:form.count]
        moved = result[:form.count].reshape(form.shape)
        total = form.grid.sum(form.stiffen(moved, form.work))[self.means] * form.root / form.grid.size
        means = np.divide(balance - total, self._stiffness, out=np.zeros_like(balance), where=~self._free)
        means[self._free] = out[form.count:] + self._inner[self.means][self._free] * balance[self._free]
        result[form.count:] = means
        return result

    def vector(self, mode):
        """The vector of a mode as a state: displacements on the window and means, ranges of the law."""
        return np.append(mode.displacement / self.form.root, mode.means[self.means])

    def state(self, vector):
        """The mode as a state, of a real vector."""
        means = np.zeros(self.form.components)
        means[self.means] = vector[self.form.count:]
        return State(self.form.window, vector[:self.form.count].reshape(self.form.shape) * self.form.root, means)

    def mirror(self, vector, axis):
        """The mirror image of a vector about the apex, along a direction of a centred window."""
        form, image = self.form, vector.copy()
        box = form.window.box(vector[:form.count].reshape(form.shape))
        flipped = np.flip(box, axis + 1)
        if form.window.shape[axis] == form.grid.shape[axis]:
            flipped = np.roll(flipped, 1, axis + 1)
        image[:form.count] = flipped.reshape(-1)
        return image


def _mean_mass(contact, components, i):
    """m_0 of a component, in ranges of the law."""
    if contact.isolated:
        return np.pi / (contact.ranges[i] ** 2 * contact.grid.area)
    return 1.0 / (contact.grid.size * np.max(contact.operator(components).blocks[i, i]))


@dataclass(frozen=True)
class Modes:
    """Eigenvalues by their real parts (a complex pair once, with positive imaginary part), modes x of length 1 and J x - s x as rows.

    The unstable ones and, of each symmetry, the next ``certain`` (two where there is none: the edges of contact have one each), all
    of which are to be accurate, and a further one that only tells where to look.
    """

    values: np.ndarray
    vectors: np.ndarray
    defects: np.ndarray
    certain: np.ndarray

    @property
    def residuals(self):
        """|J x - s x| of each."""
        return np.linalg.norm(self.defects, axis=1)

    @property
    def unstable(self):
        """Number of eigenvalues with negative real part, both of a complex pair counted."""
        negative = self.values.real < 0.0
        return int(np.sum(negative)) + int(np.sum(negative & (self.values.imag > 0.0)))

    @property
    def leading(self):
        """The eigenvalue of smallest real part."""
        return complex(self.values[0])


class Space:
    """Vectors with their products with J, split by symmetry, and what the projection of J on them has for modes.

    Parameters
    ----------
    operator : with ``size``, ``apply`` and ``mirror``
    axes : directions in which J does not change under ``mirror``
    """

    def __init__(self, operator, axes=()):
        self.operator, self.axes = operator, axes
        self._sectors = [([], []) for _ in range(2 ** len(axes))]

    def product(self, vector):
        """J vector, kept."""
        image = self.operator.apply(vector)
        for (basis, images), part, its in zip(self._sectors, self._parts(vector), self._parts(image)):
            _append(basis, images, part, its, np.linalg.norm(vector))
        return image

    def _parts(self, vector):
        """The vector's even and odd parts in each direction."""
        found = [vector]
        for axis in self.axes:
            pairs = [(part, self.operator.mirror(part, axis)) for part in found]
            found = [0.5 * (part + sign * image) for part, image in pairs for sign in (1.0, -1.0)]
        return found

    def modes(self):
        """Modes of J projected on the space, for each symmetry that occurs."""
        certain = 1 if self.axes else 2
        return [_projected(np.array(basis), np.array(images), certain) for basis, images in self._sectors if basis]


def _append(basis, images, vector, image, scale):
    """Append a vector, made orthonormal to a basis, and its image; not what is hardly new."""
    for _ in range(2):
        for known, its in zip(basis, images):
            part = known @ vector
            vector, image = vector - part * known, image - part * its
    norm = np.linalg.norm(vector)
    if norm > 1e-7 * scale:
        basis.append(vector / norm)
        images.append(image / norm)


def _projected(basis, images, certain=1):
    """Modes of the projection on an orthonormal basis (rows)."""
    values, coefficients = linalg.eig(basis @ images.T)
    kept = np.flatnonzero(values.imag >= 0.0)
    kept = kept[np.argsort(values[kept].real)]
    certain += np.sum(values[kept].real < 0.0)
    kept = kept[:certain + 1]
    coefficients = coefficients[:, kept].T
    vectors = coefficients @ basis
    return Modes(values[kept], vectors, coefficients @ images - values[kept, None] * vectors, np.arange(len(kept)) < certain)


def joined(parts):
    """Modes of all symmetries together, in the order of their real parts."""
    order = np.argsort(np.concatenate([part.values.real for part in parts]))
    return Modes(*(np.concatenate([getattr(part, name) for part in parts])[order] for name in ("values", "vectors", "defects", "certain")))


def leading_modes(operator, axes=(), start=(), accurate=ACCURATE):
    """Unstable modes and the first stable ones of an `Overdamped` operator J with preconditioner P: `Modes` of each symmetry.

    ARPACK looks for the modes of P^-1 (J - s) of smallest real part, s the leading eigenvalue as far as it is known: that operator
    has no large eigenvalues, and where s is an eigenvalue of J it has the same mode. J's own modes are those of its projection on
    all vectors that ARPACK multiplied (the inverse-free preconditioned Krylov method of Golub and Ye 2002, SIAM J. Sci. Comput. 24,
    312), split by symmetry. Again, from these, until residuals say that the signs are certain and the leading one is accurate.

    Parameters
    ----------
    operator : Overdamped
    axes : directions in which the state is even
    start : list of vectors to begin with, each a sum of modes of a point nearby that differ in symmetry
    accurate : residual of the leading mode; None where signs alone are asked for

    Raises
    ------
    NotConverged : where residuals stay large
    """
    if operator.size <= DENSE:
        return [_all_modes(operator)]
    space, random = Space(operator, axes), np.random.default_rng(1)
    for vector in start:
        space.product(vector)
    # A first point has two runs from noise: two modes with nearly the same eigenvalue look like one to a single run.
    cold = 0 if start else 2
    vectors, shift = _ahead(space, accurate) if start else ([], 0.0)
    for run in range(RUNS):
        noise = random.standard_normal(operator.size)
        begin = sum(vectors, (NOISE if vectors else 1.0) / np.linalg.norm(noise) * noise)
        _krylov(space, shift, begin, BASIS * (4 if run < cold else 1))
        if run + 1 < cold:
            continue
        found = space.modes()
        if _settled(joined(found), accurate):
            return found
        vectors, shift = _ahead(space, accurate)
    if operator.size <= LARGEST_DENSE:
        return [_all_modes(operator)]
    modes = joined(space.modes())
    raise NotConverged(f"the modes of the point were not found: eigenvalue {modes.leading:.3g}, residual {modes.residuals[0]:.1g} "
                       f"after {RUNS} runs of ARPACK")


def _real(vectors):
    """Real and imaginary parts of vectors, a list without what vanishes."""
    parts = [part for vector in vectors for part in (vector.real, vector.imag)]
    return [part for part in parts if part.any()]


def _ahead(space, accurate):
    """Steps P^-1 (J x - s x) of unit length, from modes that are not accurate yet, and the shift of the leading one."""
    modes = joined(space.modes())
    loose = modes.certain & (modes.residuals > 0.1 * (accurate or ACCURATE))
    steps = [space.operator.precondition(residual) for residual in _real(modes.defects[loose])]
    return [step / np.linalg.norm(step) for step in steps], min(modes.leading.real, 0.5)


def _krylov(space, shift, begin, basis):
    """ARPACK's search for modes of P^-1 (J - shift), to a loose tolerance of its own: ``space`` keeps all products on the way."""
    operator = space.operator

    def product(vector):
        return vector - operator.precondition(space.product(vector) - shift * vector)

    size = operator.size
    try:
        eigs(LinearOperator((size, size), matvec=product, dtype=float), k=1, which="LR", v0=begin, ncv=basis, tol=0.1, maxiter=1,
             return_eigenvectors=False)
    except (ArpackNoConvergence, ArpackError):
        pass  # what it has tried serves as well


def _settled(modes, accurate):
    """Whether residuals are small enough for the signs of all eigenvalues, and for the leading one."""
    signs = np.all((modes.residuals < 0.5 * np.abs(modes.values.real))[modes.certain])
    return signs and (accurate is None or modes.residuals[0] <= accurate)


def _all_modes(operator):
    """All modes by a dense matrix, whatever their symmetry; of the stable ones the first."""
    images = np.array([operator.apply(unit) for unit in np.eye(operator.size)])
    return _projected(np.eye(operator.size), images)


class Stability:
    """Marks points as stable or not: finds their modes, from those of the last point.

    Parameters
    ----------
    contact : Contact
    kind : 'sign' or 'eigenvalue'
    prefix : of the options of the preconditioner
    """

    def __init__(self, contact, kind, prefix=""):
        self.contact, self.kind, self.options = contact, kind, read(CoreOptions, prefix)
        self._operator = self._last = None

    def __call__(self, point):
        """The point with ``stable``, ``unstable_modes`` and, if asked for, ``leading_eigenvalue`` and ``mode``."""
        modes = self.modes(point, ACCURATE if self.kind == EIGENVALUE else None)
        stable = int(modes.leading.real > 0.0 and point.event != "fold")
        found = replace(point, stable=stable, unstable_modes=modes.unstable)
        if self.kind == SIGN:
            return found
        return replace(found, leading_eigenvalue=modes.leading, mode=self._operator.state(modes.vectors[0].real))

    def modes(self, point, accurate=ACCURATE):
        """`Modes` of a point."""
        state, axes = self._even(point.state)
        operator = self._operator
        if operator is None or operator.form.window != state.window or operator.form.controls != tuple(point.controls):
            operator = self._operator = Overdamped(self.contact, state.window, point.controls, self.options)
        operator.linearise(state, point.load)
        found = leading_modes(operator, axes, self._start(state), accurate)
        # Modes of different symmetries can be told apart again: one vector carries one of each.
        sums = [sum(vectors) for vectors in zip_longest(*(_real(part.vectors) for part in found), fillvalue=0.0)]
        self._last = state, [operator.state(vector) for vector in sums]
        return joined(found)

    def _start(self, state):
        """Modes of the last point as vectors on the window of a state, moved with the edges of contact."""
        if self._last is None or len(self._last[0].displacement) != len(state.displacement):
            return []
        origin, modes = self._last
        return [self._operator.vector(states.carried(self.contact, mode, origin, state)) for mode in modes]

    def _even(self, state):
        """The state, on a centred window if it is even, and the directions in which it is."""
        if obstacle(self.contact.scene, len(state.displacement)) is not None or not asymmetry(state.window, state.displacement) <= EVEN:
            return state, ()
        window = centred(state.window)
        return State(window, states.onto(state, window), state.means), tuple(range(len(window.shape)))
