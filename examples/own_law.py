"""A law of one's own: attraction as the package's, and a friction that saturates without a peak.

    python examples/own_law.py [FOLDER]      figure: own_law.png, in FOLDER or results/"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

from contactsnes import Branch, Load, Scene, option
from contactsnes.interface.laws.coupled import Coupled


class Saturating(Coupled):
    """t_n = a exp(-a) exp(-b^2), t_t = s b / sqrt(1 + b^2) exp(-a); in overlap neither fades."""
    strength = option(0.5, "friction at large slip (law Saturating)", "phi_t/delta_t", above=0)
    decoupled_in_overlap, gap_corners, slip_peak = True, (0.0,), 1.0

    def friction(self, slip):
        return self.strength / (1 + slip**2)**0.5  # T(b)/b, from which the tangent is made

    def friction_energy(self, slip):
        return self.strength * ((1 + slip**2)**0.5 - 1)


def main(folder="results", strengths=(0.2, 0.4)):
    """Draw tangential forces against displacements; both, for each strength."""
    axes = Figure().add_subplot(xlabel="displacement ($u_{t,r}$)", ylabel="force ($w_{t,r}$)")
    load = Load("normal_displacement=2", "tangential_displacement=60")
    for law in map(Saturating, strengths):
        _, *points = Branch(Scene(points=128, period=20, height=80, normal_maugis=1), load, law=law)
        axes.plot(*zip(*((point.displacements[1], point.forces[1]) for point in points)), "o-")
    Path(folder).mkdir(exist_ok=True)
    axes.figure.savefig(Path(folder, "own_law.png"))
    return [line.get_data() for line in axes.lines]


if __name__ == "__main__":
    print(__doc__) if {"-h", "--help"} & {*sys.argv} else main(*sys.argv[1:])
