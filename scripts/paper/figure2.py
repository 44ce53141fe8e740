"""Figure 2: the traction-separation laws.

Normal pressure over the normal gap at three tangential gaps (above), tangential pressure over the
tangential gap at three normal gaps (below), for eq. 3 and for eq. 5 with two residual frictions;
the misprints of eqs. 3b and 5b corrected.
"""

import numpy as np
from style import LAW_NAMES, lettered, panels

from contactsnes.interface.laws import LAWS

LOOKS = (("C0", "-"), ("C1", "--"), ("C2", "-."))
SLIPS, GAPS = (0.0, 0.5, 1.0), (-0.5, 0.0, 0.5)
NAMED = {"mcgarry": LAWS["mcgarry"](), "full": LAWS["modified"](1.0, 0.0),
         "half": LAWS["modified"](0.5, 0.0)}
NEEDED = ()


def draw(results):
    """The figure."""
    figure, axes = panels(2, 3, height=4.2)
    normal, slip = np.linspace(-0.5, 5, 400), np.linspace(-3, 3, 601)
    for (name, law), (above, below) in zip(NAMED.items(), axes.T):
        for (colour, line), held in zip(LOOKS, SLIPS):
            traction = law.traction(np.array([normal, np.full_like(normal, held)]))
            above.plot(normal, traction[0], color=colour, linestyle=line,
                       label=f"$g_t/\\delta_t = {held:g}$")
        for (colour, line), held in zip(LOOKS, GAPS):
            traction = law.traction(np.array([np.full_like(slip, held), slip]))
            below.plot(slip, traction[1], color=colour, linestyle=line,
                       label=f"$g_n/\\delta_n = {held:g}$")
        above.set(xlabel=r"$g_n/\delta_n$", ylim=(-0.9, 0.45))
        below.set(xlabel=r"$g_t/\delta_t$")
    axes[0, 0].set_ylabel(r"$p_{int,n}\,\delta_n/\phi_n$")
    axes[1, 0].set_ylabel(r"$p_{int,t}\,\delta_t/\phi_t$")
    # room for the keys of the lower ones above their curves
    for line, room, place in zip(axes, (0.0, 0.6), ("lower right", "upper left")):
        low = np.min([one.get_ylim() for one in line])
        high = np.max([one.get_ylim() for one in line])
        for one in line:
            one.legend(loc=place)
            one.set_ylim(low, high + room * (high - low))
            one.axhline(0, color="0.7", linewidth=0.4, zorder=0)
    lettered(axes.flat, 2 * [LAW_NAMES[name] for name in NAMED])
    return figure
