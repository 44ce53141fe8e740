"""The waves that a motion of the force form is followed on: those of the whole cell, or the cosines
of fields that are even about its apex."""

import numpy as np


def means(grid, spectrum):
    """Values at q = 0 of spectra (components, *waves), real, in all processes."""
    return grid.together(grid.zero_wave(spectrum).real.reshape(len(spectrum), -1).sum(axis=1))


def set_means(grid, spectrum, values):
    """Set the values at q = 0 of spectra, where they are here.

    Parameters
    ----------
    grid : Grid
    spectrum : array (components, *waves)
    values : array (components,)
    """
    grid.zero_wave(spectrum)[...] = np.reshape(values, (-1, *[1] * (spectrum.ndim - 1)))


def softest(grid, array):
    """The smallest value of each of some arrays over waves (components, *waves), but for q = 0."""
    flat = array.reshape(len(array), -1)[:, int(grid.zero_wave(array).size > 0):]
    return np.array([grid.minimum(part) for part in flat])


class CellWaves:
    """Half spectra of fields on the whole cell.

    Parameters
    ----------
    form : ForceForm

    Attributes
    ----------
    transform : of all components
    grid : whose reductions run over the nodes
    initial_gap : array (nodes), delta_n
    stiffness, compliance : {(i, j): K or C / N}, N nodes of the cell, on the waves
    weights : array of the waves: how many waves of the cell each stands for
    """

    def __init__(self, form):
        self.transform, self.grid = form.convolution.transform, form.grid
        self.initial_gap = form.initial_gap
        # row after row, as the transform has waves
        self.stiffness, self.compliance = (
            {key: np.multiply(factor, block, order="C") for key, block in own.blocks.items()}
            for factor, own in ((form.grid.size, form.convolution), (1.0, form.compliance)))
        self.respond = form.compliance.multiply
        self.weights = np.full(self.transform.spectrum.shape[1:], 2.0)
        self.weights[..., list(form.grid.lone_columns())] = 1.0

    def fold(self, values):
        """Values (..., nodes of the cell) at these nodes."""
        return values

    unfold = fold

    def inner(self, first, second):
        """Real inner product of spectra (components, *waves): a sum over the waves of the cell."""
        return self.grid.spectral_inner(first, second)


class EvenWaves:
    """Cosines of even fields on half a line or a quarter of a plane, whose spectra are real.

    Parameters
    ----------
    form : ForceForm

    Attributes
    ----------
    as those of `CellWaves`
    """

    def __init__(self, form):
        window = form.half
        self.transform = window.placed(form.contact.kernels.even(form.grid, window.extents,
                                                                 form.components))
        self.grid, self.initial_gap = window.grid, window.fold(form.initial_gap)
        self.fold, self.unfold = window.fold, window.unfold
        own, inside = self.transform, tuple(slice(0, n) for n in window.extents)
        self.stiffness, self.compliance = (
            {(i, i): factor * own.ordered(convolution.blocks[i, i].real[inside])
             for i in range(form.components)}
            for factor, convolution in ((form.grid.size, form.convolution), (1.0, form.compliance)))
        # waves stand for as many of the cell as nodes do
        self.weights = own.ordered(window.wave_weights())

    def respond(self, spectrum):
        """Multiply a spectrum by C / N, in place."""
        for (i, _), symbol in self.compliance.items():
            spectrum[i] *= symbol

    def inner(self, first, second):
        """Inner product of spectra (components, *waves): a sum over the waves of the cell."""
        return float(self.grid.together(np.vdot(first, second * self.weights)))
