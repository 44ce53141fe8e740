"""PETSc's Mat contexts: the Jacobian of a form, and what is given as a function of arrays."""

from .precision import DOUBLE


def about(form):
    """What -snes_view prints of a form's Jacobian."""
    return (f"  contact Jacobian, {form.name} form: {form.components} component(s) on "
            f"{form.nodes} nodes, {form.size - form.count} scalar unknown(s)")


def form_of(matrix):
    """The form whose Jacobian a matrix is, or None."""
    if matrix.getType() == "python":
        return getattr(matrix.getPythonContext(), "form", None)
    own = matrix.getAttr("callbacks")
    return own.form if own else None


def precision_of(matrix):
    """The Precision of a matrix's products, double where it says nothing."""
    context = matrix.getPythonContext() if matrix.getType() == "python" else None
    return getattr(context, "precision", DOUBLE)


class Jacobian:
    """The exact Jacobian of a form, matrix-free.

    Parameters
    ----------
    form : of the equations
    precision : Precision of its products
    """

    def __init__(self, form, precision=DOUBLE):
        self.form, self.precision = form, precision

    def _single(self):
        """What has a product in single precision where it is to be."""
        return (True,) if self.precision.now() else ()

    def mult(self, mat, x, y):
        """y = J x.

        Parameters
        ----------
        mat : petsc4py Mat
        x, y : petsc4py Vec, of the form's size; y is filled
        """
        self.form.apply_jacobian(x.getArray(readonly=True), y.getArray(), *self._single())

    def multTranspose(self, mat, x, y):
        """y = J^T x.

        Parameters
        ----------
        mat, x, y : as of `mult`
        """
        self.form.apply_transpose(x.getArray(readonly=True), y.getArray(), *self._single())

    def view(self, mat, viewer):
        """What -snes_view prints of the operator."""
        viewer.printfASCII(f"{about(self.form)}, NumPy\n")


class Applied:
    """A linear function (array, array to fill)."""

    def __init__(self, apply):
        self.apply = apply

    def mult(self, mat, x, y):
        """y = A x.

        Parameters
        ----------
        mat : petsc4py Mat
        x, y : petsc4py Vec; y is filled
        """
        self.apply(x.getArray(readonly=True), y.getArray())


class Corrected:
    """A correction (change, unknown, array to fill)."""

    def __init__(self, apply):
        self.apply = apply

    def multAdd(self, mat, x, y, z):
        """z = y + A x, which depends on y.

        Parameters
        ----------
        mat : petsc4py Mat
        x, y, z : petsc4py Vec, the change, the unknown and the result; z is filled
        """
        self.apply(x.getArray(readonly=True), y.getArray(readonly=True), z.getArray())
