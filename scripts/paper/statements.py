"""What the paper says of sheared contacts, in numbers."""

import figure7
import numpy as np
import regimes
import remnant
import statements_pressed  # noqa: F401  its statements come first
from beyond import grid_change, sliding
from observed import onset, profile, sheared_part
from runs import LOADS, PERIOD, TANGENTIAL
from scipy.interpolate import PchipInterpolator
from statement import Number, statement

from contactsnes import reference


def case(maugis, force):
    """Label of a tangential parameter and a normal force."""
    return f"lambda_t = {maugis:g}, W = {force:g}"


def strength(label, begun, scale=1.0):
    """The force of an onset, Number."""
    return Number(label, begun.force / scale, spread=begun.force_error / scale)


@statement("Fig. 5b", "the tangential force rises almost linearly with the "
           "displacement: the body's elasticity governs it", "largest difference of "
           "the force from its initial slope times the displacement, "
           "before 90 % of the onset's displacement, over the force "
           "there; tau_max/2")
def linear_rise(results):
    found, slopes = [], {}
    for maugis in TANGENTIAL:
        for force in LOADS:
            record = results[f"half-t{maugis:g}-w{force:g}"]
            begun, part = onset(record), sheared_part(record)
            moved, carried = (record[name][part.start + 1:begun.point]
                              for name in ("tangential_displacement", "tangential_force"))
            early = moved < 0.9 * begun.displacement
            found.append(Number(case(maugis, force),
                                np.max(np.abs(carried[early]
                                              / (carried[0] / moved[0] * moved[early]) - 1)), "%"))
            slopes[maugis, force] = moved[0] / carried[0]
    most = max(number.value for number in found)
    slab = 1.0 / reference.drive_stiffness(PERIOD, 2000.0)
    found += [Number("displacement per unit force: of the slab, 4 H/L", slab, exact=True),
              Number("in all, from", min(slopes.values())),
              Number("to", max(slopes.values()))]
    return found, ((f"confirmed within {100 * most:.2g} %" if most < 0.05 else "not confirmed: "
                    f"{100 * most:.2g} % off")
                   + f", but it is the slab's: {slab:g} of the {min(slopes.values()):.1f} to "
                   f"{max(slopes.values()):.1f} of displacement per unit force, whatever the "
                   "contact does")


@statement("Fig. 5a", "lambda_t = 0.1: sliding begins with an abrupt loss "
           "of area; 10: the least area is reached before; 1: before "
           "it at the high load, not at the low one", "share of the area "
           "lost in all that is still there at the onset, (a - "
           "a_slid)/(a_0 - a_slid); tau_max and tau_max/2")
def least_area(results):
    found, shares = [], {}
    for maugis in TANGENTIAL:
        for force in LOADS:
            for law in ("full", "half"):
                record = results[f"{law}-t{maugis:g}-w{force:g}"]
                begun, first = onset(record), record["contact_area"][sheared_part(record).start]
                shares[maugis, force, law] = (begun.area - regimes.slid_area(results, force)) / (
                    first - regimes.slid_area(results, force))
            found.append((case(maugis, force), [Number(name, shares[maugis, force, law], "%")
                                                for name, law in (("tau_max", "full"),
                                                                  ("tau_max/2", "half"))]))
    early = [(maugis, force) for maugis, force, _ in shares if maugis == 10
             or (maugis, force) == (1, 25)]
    wrong = [case(maugis, force) for (maugis, force, _), value in shares.items()
             if (abs(value) >= 0.02 if (maugis, force) in early else value <= 0.05)]
    return (found, "confirmed" if not wrong else "confirmed except for "
            f"{'; '.join(dict.fromkeys(wrong))}")


@statement("Sec. 4", "the onset is unstable whenever tau_inf < tau_max", "a fold under "
           "prescribed displacement from which the contact goes over to "
           "gross sliding; share of the force that is lost there, W "
           "= 25, tau_max/2; least height over period at which there is a fold")
def unstable_onsets(results):
    stable = []
    smooth = []
    off = []
    drops = []
    for maugis in TANGENTIAL:
        for force in figure7.loads(maugis):
            begun = {law: onset(results[f"{law}-t{maugis:g}-w{force:g}"])
                     for law in ("half", "full")}
            (off if begun["half"] is None else [] if begun["half"].unstable
             else stable).append(case(maugis, force))
            smooth += [case(maugis, force)] * bool(begun["full"] and begun["full"].unstable)
        record = results[f"half-t{maugis:g}-w25"]
        drops.append(Number(f"lambda_t = {maugis:g}",
                            1 - record["tangential_force"][-1] / onset(record).force, "%"))
    for share in (0.8, 0.9):
        for force in LOADS:
            name = regimes.traced(share, 0.1, force).name
            least = regimes.least_height(results[name])
            drops.append(Number(f"least H/L, rho = {share:g}, lambda_t = 0.1, W = {force:g}", least,
                                spread=0.02 * least))
    verdict = "confirmed" if not stable else f"not confirmed: no fold for {'; '.join(stable)}"
    heights = [number.value for number in drops[-4:]]
    verdict += ("; it hinges on the drive: at lambda_t = 0.1 and rho = 0.8 to 0.9 there is a fold "
                f"only under layers higher than {min(heights):.2g} to {max(heights):.2g} periods "
                "(the paper's: 20)")
    peels = f" ({'; '.join(off)}: the contact peels off before it slides)" if off else ""
    return drops, verdict + peels + (
        "; with tau_inf = tau_max it is unstable only where the loss of adhesion is: "
        + "; ".join(smooth) if smooth else "; with tau_inf = tau_max it is stable in all cases")


@statement("Sec. 4", "tau_inf hardly influences the incipient loading before "
           "gross sliding", "largest difference of the areas with tau_inf = "
           "tau_max and tau_max/2 at the same displacement, before the "
           "earlier onset; and forces at the two onsets, W = 25")
def residual_friction(results):
    found = []
    for maugis in TANGENTIAL:
        full, half = (results[f"{law}-t{maugis:g}-w25"] for law in ("full", "half"))
        ends = [onset(one) for one in (full, half)]
        grid = np.linspace(0, 0.999 * min(one.displacement for one in ends), 200)
        curves = []
        for one in (full, half):
            part = sheared_part(one)
            stop = onset(one).point + 1
            moved, keep = np.unique(one["tangential_displacement"][part.start:stop],
                                    return_index=True)
            curves.append(PchipInterpolator(moved,
                                            one["contact_area"][part.start:stop][keep])(grid))
        found.append((f"lambda_t = {maugis:g}",
                      [Number("areas", np.max(np.abs(curves[0] / curves[1] - 1)), "%"),
                       strength("onset with tau_max", ends[0]),
                       strength("with tau_max/2", ends[1])]))
    most = max(numbers[0].value for _, numbers in found)
    apart = [heading for heading, numbers in found if numbers[1].value > 1.05 * numbers[2].value]
    return found, (f"confirmed within {100 * most:.2g} % for the area" if most < 0.02
                   else "not confirmed for the area") + (
        f"; the force at the onset differs for {', '.join(apart)}" if apart else "")


@statement("Fig. 5a", "the area is constant after gross sliding has begun",
           "relative change of the area from the jump to the end, tau_max/2")
def constant_area(results):
    found = []
    for maugis, force in ((0.1, 0.8), (0.1, 25), (1, 0.8), (1, 25), (10, 25)):
        record = results[f"half-t{maugis:g}-w{force:g}"]
        after = record["contact_area"][np.flatnonzero(record["event"] == "jump")[-1]:]
        found.append(Number(case(maugis, force), np.ptp(after) / after[-1], "%"))
    most = max(number.value for number in found)
    return found, f"confirmed within {100 * most:.1g} %" if most < 1e-2 else "not confirmed"


@statement("Sec. 4", "with some remnant adhesion results do not change "
           "qualitatively, but the area stabilises at a slightly "
           "higher value", "area in sliding for remnant adhesions of 0.2 and "
           "0.4 over that without, minus 1, normal forces of 25 and "
           "0.8 held, lambda_t = 1, tau_max/2")
def remnant_adhesion(results):
    found, kinds = [], set()
    change = grid_change(results, remnant.run(0.4, 0.8))[1]
    for force in LOADS[::-1]:
        records = [results[remnant.run(share, force).name] for share in (0.0, 0.2, 0.4)]
        areas = [sliding(record) for record in records]
        kinds |= {onset(record).unstable for record in records}
        found += [Number(f"W = {force:g}, {share:g}", area / areas[0] - 1, "%", change)
                  for share, area in zip((0.2, 0.4), areas[1:])]
    same = "onsets keep their kind" if len(kinds) == 1 else "some onsets change their kind"
    most = max(number.value for number in found)
    higher = all(number.value > 0 for number in found)
    return found, (f"{'confirmed' if higher and len(kinds) == 1 else 'not confirmed'}: {same}"
                   + (f", and the area is higher, by up to {100 * most:.0f} %"
                      + " (not slightly where the load is small)" * (most > 0.2) if higher
                      else ", and the area is not higher everywhere"))


@statement("Fig. 5c", "the mean displacement of the surface over delta_t is "
           "large for lambda_t = 10 and small for 0.1", "its value at the "
           "onset, W = 25, tau_max/2")
def mean_slip(results):
    found = []
    for maugis in TANGENTIAL:
        record = results[f"half-t{maugis:g}-w25"]
        found.append(Number(f"lambda_t = {maugis:g}",
                            record["mean_tangential_displacement"][onset(record).point] * maugis))
    return found, "confirmed" if found[0].value < 1 and found[-1].value > 10 else "not confirmed"


@statement("Fig. 5d-f", "the tangential traction has a spike at the edge "
           "for lambda_t = 10, a shallower one for 1, and is "
           "constant for 0.1", "largest traction over that at the centre, at "
           "the point whose force is nearest to half of that at "
           "the onset, W = 25, tau_max/2")
def spikes(results):
    found = []
    for maugis in TANGENTIAL:
        record = results[f"half-t{maugis:g}-w25"]
        begun, part = onset(record), sheared_part(record)
        force = record["tangential_force"][part.start:begun.point + 1]
        _, _, _, _, traction = profile(record,
                                       part.start
                                       + int(np.argmin(np.abs(force - 0.5 * begun.force))))
        found.append(Number(f"lambda_t = {maugis:g}",
                            traction.max() / traction[traction.size // 2]))
    values = [number.value for number in found]
    return found, "confirmed" if values[0] < 1.15 and (np.diff(values)
                                                       > 1).all() else "not confirmed"
