"""What the paper says of its laws and of contacts without shear, in numbers."""

import figure3
import numpy as np
from observed import pressed_area, profile, sheared_part
from runs import LOADS, NORMAL, PERIOD, TANGENTIAL
from scipy.integrate import quad
from statement import Number, statement

from contactsnes import Scene, reference
from contactsnes.interface.laws import LAWS
from contactsnes.interface.laws.coupled import TANGENTIAL_PEAK
from contactsnes.scene.resolution import resolution


@statement("eq. 4, Fig. 2", "the peaks are phi_n/(e delta_n) at g_n = delta_n "
           "and sqrt(2/e) phi_t/delta_t at g_t = delta_t/sqrt 2",
           "largest tractions of eqs. 3 and 5 on a fine grid of "
           "gaps over these, minus 1; with the factor 2 that eq. "
           "3b lacks in print, eq. 5b without sgn(g_t) in its first "
           "branch, and exp(-(...)^2) in its second")
def peaks(results):
    gap, zero = np.linspace(0, 4, 40001), np.zeros(40001)
    found = []
    for name, law in (("eq. 3", LAWS["mcgarry"]()), ("eq. 5", LAWS["modified"](0.5, 0.0))):
        normal = law.traction(np.array([gap, zero]))[0].max()
        tangential = law.traction(np.array([zero, gap]))[1].max()
        found += [Number(f"{name} normal", normal * np.e - 1, exact=True),
                  Number("tangential", tangential / TANGENTIAL_PEAK - 1, exact=True)]
    holds = max(abs(number.value) for number in found) < 1e-6
    return (found, "confirmed, with the misprints of eqs. 3b and 5b "
            "corrected" if holds else "not confirmed")


@statement("Sec. 2.1", "the first, reversible region of eq. 5 has the "
           "finite energy phi_t", "work of eqs. 3 and 5 in pure slip at "
           "no gap: to the peak of the traction at delta_t/sqrt 2, to delta_t, and from the peak "
           "to infinity above tau_inf = tau_max/2; over phi_t; by quadrature")
def reversible_work(results):
    found = []
    for name, law, least in (("eq. 3", LAWS["mcgarry"](), 0.0),
                             ("eq. 5", LAWS["modified"](0.5, 0.0), 0.5 * TANGENTIAL_PEAK)):
        def traction(slip, law=law):
            return law.traction(np.array([[0.0], [slip]]))[1, 0]

        rising = quad(traction, 0, np.sqrt(0.5))[0]
        range_ = quad(traction, 0, np.sqrt(0.5))[0] + quad(traction, np.sqrt(0.5), 1.0)[0]
        falling = quad(lambda slip, least=least, traction=traction: traction(slip) - least,
                       np.sqrt(0.5), 20, limit=200)[0]
        found += [Number(f"{name} to the peak", rising, exact=True),
                  Number("to delta_t", range_, exact=True),
                  Number("beyond the peak", falling, exact=True)]
    holds = abs(found[3].value - 1) < 0.01
    return found, "confirmed" if holds else (
        "not confirmed: phi_t is the whole work of eq. 3. To delta_t, the limit that the text "
        f"gives, it takes {found[1].value:.3g} of it, to delta_t/sqrt 2, the limit of eq. 5b, "
        f"{found[0].value:.3g}; neither is phi_t")


@statement("Fig. 3", "the area converges for large thresholds; e delta_n gives "
           "results similar to JKR's", "width where the gap is below the "
           "threshold over JKR's width in the cell, minus 1, mean "
           "over 0 < W < 25, lambda_n = 10")
def thresholds(results):
    forces, widths = figure3.widths(results["pressed-n10"])
    inside = (forces > 0) & (forces <= 25.001)
    exact = np.array([2 * reference.jkr_line_half_width(force, PERIOD) for force in forces[inside]])
    found = [Number(f"{threshold:.3g} delta_n", np.mean(width[inside] / exact - 1), "%")
             for threshold, width in widths.items()]
    values = np.array([number.value for number in found])
    growth = np.diff(values) / np.diff(figure3.THRESHOLDS)
    at = figure3.THRESHOLDS.index(np.e)
    similar = (f"confirmed for e delta_n within {100 * abs(values[at]):.1f} %"
               if abs(values[at]) < 0.02 else "not confirmed for e delta_n")
    slower = growth[-1] < growth[at]
    return found, similar + ("; beyond it the width grows ever more slowly" if slower
                             else "; not that the width converges: it grows by "
                             f"{100 * growth[at]:.2f} % a delta_n beyond e "
                             f"delta_n, and by {100 * growth[-1]:.2f} % beyond "
                             "8, as it must where the gap opens as the "
                             "root of the distance, as a crack's does")


@statement("Fig. 3", "beyond 8 and 10 delta_n the normal traction has fallen "
           "to 1 % and 0.1 % of its peak; a rectangle of the "
           "height sigma_max and the width e delta_n has the work phi_n",
           "eq. 3a")
def law_ends(results):
    found = [Number(f"{gap} delta_n", gap * np.exp(1.0 - gap), "%", exact=True) for gap in (8, 10)]
    found += [Number("work of the rectangle over phi_n", 1.0, exact=True),
              Number("work of the law up to e delta_n", quad(lambda a: a * np.exp(-a), 0, np.e)[0],
                     exact=True)]
    near = all(0.5 < number.value / said < 2 for number, said in zip(found, (0.01, 0.001)))
    return found, ("confirmed as orders of magnitude" if near
                   else "not confirmed") + ", and the rectangle exactly"


@statement("Sec. 3, Fig. 4a", "for lambda_n = 3, 10 and 20 areas differ by less than 5 %",
           "(largest - least area of the three) over the least, where 0.8 <= W <= 25")
def normal_maugis(results):
    forces = np.linspace(0.8, 25, 60)
    areas = np.array([pressed_area(results[f"pressed-n{maugis}"], forces) for maugis in NORMAL])
    spread = areas.max(axis=0) / areas.min(axis=0) - 1
    falls = (np.diff(areas, axis=0) < 0).all()
    found = [Number(f"W = {force:g}", np.interp(force, forces, spread), "%")
             for force in (25, 10.4, 0.8)]
    near = forces[spread < 0.05]
    verdict = ("confirmed" if near.size == forces.size
               else f"confirmed for W > {near[0]:.1f}; at smaller loads lambda_n = 3 is further off"
               if near.size else "not confirmed")
    return found, verdict + ("; the area falls with lambda_n towards JKR's" if falls
                             else "; the area does not fall with lambda_n everywhere")


@statement("Sec. 3, Fig. 4b", "pressures are JKR's except at the edge, where "
           "the peak is lower and broader for smaller lambda_n",
           "largest difference from JKR's pressure for |x| < 0.8 a over "
           "its largest value; largest tension, E* beta/R; and length "
           "over which the tension is above half of that; W = 10.4")
def pressures(results):
    half, found = reference.jkr_line_half_width(10.4, PERIOD), []
    for maugis in NORMAL:
        record = results[f"pressed-n{maugis}"]
        x, _, _, traction, _ = profile(record,
                                       int(np.argmin(np.abs(record["normal_force"] - 10.4))))
        inner = np.abs(x) < 0.8 * half
        exact = reference.jkr_line_pressure(x[inner], half, PERIOD)
        fine = np.linspace(0.7 * half, 1.3 * half, 20001)
        tension = np.interp(fine, x, traction)
        found.append((f"lambda_n = {maugis}",
                      [Number("", np.max(np.abs(-traction[inner] * maugis - exact)) / exact.max(),
                              "%"), Number("tension", np.max(tension) * maugis),
                       Number("length", np.mean(tension > 0.5 * tension.max()) * np.ptp(fine),
                              spread=2 * np.ptp(fine) / fine.size)]))
    differences, tensions, lengths = np.transpose([[number.value for number in numbers]
                                                   for _, numbers in found])
    holds = (differences.max() < 0.01 and (np.diff(tensions) > 0).all()
             and (np.diff(lengths) < 0).all())
    return found, "confirmed" if holds else "not confirmed"


@statement("Sec. 3", "2^13 points discretise the surface for lambda_n = 10",
           "spacing over the largest one that resolves the law "
           "(`contactsnes info`), for normal loading and for shear with "
           "tau_max/2; and the area and the normal displacement at W "
           "= 10.4 with the change on 2^14 points")
def paper_grid(results):
    ratios = [max(resolution(Scene(points=8192), False))]
    ratios += [max(resolution(Scene(points=8192, tangential_maugis=maugis, residual_friction=0.5),
                              True)) for maugis in TANGENTIAL]
    names = ["pressed", *(f"lambda_t = {maugis:g}" for maugis in TANGENTIAL)]
    record = results["pressed-n10"]
    point = int(np.argmin(np.abs(record["normal_force"] - 10.4)))
    found = [Number(name, ratio, exact=True) for name, ratio in zip(names, ratios)]
    found += [Number("area", record["contact_area"][point]),
              Number("displacement", record["normal_displacement"][point])]
    good, bad = ([name for name, ratio in zip(names, ratios) if (ratio <= 1) == resolved]
                 for resolved in (True, False))
    return found, f"confirmed for {', '.join(good)}" + (
        f"; not for {', '.join(bad)}, whose slip front needs more" if bad else "")


@statement("Sec. 4", "u_app,n = 40 and 2 give the forces 25 and 0.8",
           "force at these approaches of the top under several readings: L = 100, nu = 1/2, g_0 = "
           "x^2/2 as described; the same after adhesion is gone, in sliding; a cell of 139 beta "
           "and a body of nu = 0.4987 or 0.499, both from an overlap of about one u_n,r (g_0 lower "
           "by 1, 0.98, 1); and the approaches of the forces")
def approaches(results):
    names = {"as described": "", "L = 139, overlap": "-period139-gap_offset-1",
             "nu = 0.4987, overlap": "-poisson0.4987-gap_offset-0.98",
             "nu = 0.499, overlap": "-poisson0.499-gap_offset-1"}
    forces = {name: [results[f"approach-{d}{end}"]["normal_force"][-1] for d in (40, 2)]
              for name, end in names.items()}
    forces["as described, sliding"] = [results[f"slid-{d}"]["normal_force"][-1] for d in (40, 2)]
    found = [(name, [Number(f"at {d}", value) for d, value in zip((40, 2), pair)])
             for name, pair in forces.items()]
    moved = []
    for force in LOADS[::-1]:
        record = results[f"half-t1-w{force:g}"]
        moved.append(Number(f"W = {force:g}",
                            record["normal_displacement"][sheared_part(record).start]))
    gives = {name: (abs(high - 25) <= 0.5, abs(low - 0.8) <= 0.05)
             for name, (high, low) in forces.items()}
    both = [name for name, pair in gives.items() if all(pair)]
    one = [f"{name} (at {2 if low else 40})" for name, (high, low) in gives.items() if high != low]
    return [*found, ("approaches", moved)], (
        ("confirmed" if "as described" in both else "not confirmed for the cell as described")
        + f"; both forces come out of {', '.join(both) or 'no reading'}; one of them of "
        f"{', '.join(one) or 'none'}. Results here are those of the forces, which do not depend on "
        "it")
