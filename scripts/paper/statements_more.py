"""Sentences of the paper beside its results, and what can be said of them: limits of the model,
misprints, laws of friction, and claims against experiments."""

import figure7
import numpy as np
import poisson
import regimes
from beyond import grid_change
from observed import onset, sheared_part
from runs import LOADS, PERIOD, TANGENTIAL, half_width, turned
from scipy.interpolate import PchipInterpolator
from statement import Number, statement

from contactsnes import reference
from contactsnes.interface.laws.coupled import TANGENTIAL_PEAK


@statement("Sec. 5", "reattachment is not captured by the model", "lambda_t = 0.1, W = 25, "
           "tau_max/2, approach held: the contact slides, and its top is driven back to where the "
           "shear began: displacement at which it jumps back, and what the area then is over that "
           "before the shear, minus 1")
def reattachment(results):
    record = results[turned().name]
    part, forward = sheared_part(record), onset(record)
    back = np.flatnonzero((record["event"] == "fold") & (np.arange(record.points) > forward.point))
    found = [Number("slides at", forward.displacement)]
    if not back.size:
        return found, "confirmed: the contact does not adhere again"
    area = record["contact_area"]
    found += [Number("adheres again at", record["tangential_displacement"][back[0]]),
              Number("area at the end", area[-1] / area[part.start] - 1, spread=1e-9)]
    restored = abs(found[-1].value) < 1e-6
    return found, ("not confirmed: the law has no memory, and the contact adheres again by a jump, "
                   "which is later than the way forth (hysteresis)"
                   + ("; its area is restored" if restored else ""))


@statement("Sec. 5", "the model specifies by construction that the contact area is reduced by the "
           "tangential load", "largest area under shear over that before, minus 1, for each "
           "Poisson ratio, force held; lambda_t = 1, tau_max/2")
def area_shrinks(results):
    found, grown = [], {}
    error = grid_change(results, poisson.run(0.0, 25))[2]
    for force in poisson.FORCES:
        cells = []
        for ratio in poisson.RATIOS:
            record = results[poisson.run(ratio, force).name]
            begun, part = onset(record), sheared_part(record)
            area = record["contact_area"][part.start:begun.point + 1]
            grown[ratio, force] = area.max() / area[0] - 1
            cells.append(Number(f"nu = {ratio:g}", grown[ratio, force], "%", spread=10 * error))
        found.append((f"W = {force:g}", cells))
    more = [f"nu = {ratio:g} at W = {force:g}" for (ratio, force), value in grown.items()
            if value > 1e-4]
    return found, ("confirmed at nu = 1/2; not by construction: the area grows at first for "
                   + ", ".join(more) + ", where pressing alone has made the rim slip"
                   if more else "confirmed")


@statement("Sec. 2.2, after eq. 10", "large values of lambda_t indicate that the elastic "
           "deformation of the body is insignificant beside delta_t", "mean displacement of the "
           "surface at the onset over delta_t, W = 25, tau_max/2")
def reversed_sentence(results):
    found = []
    for maugis in TANGENTIAL:
        record = results[f"half-t{maugis:g}-w25"]
        found.append(Number(f"lambda_t = {maugis:g}",
                            record["mean_tangential_displacement"][onset(record).point] * maugis))
    rises = np.all(np.diff([number.value for number in found]) > 0)
    return found, ("reversed in print: lambda_t is the body's displacement over delta_t, so that "
                   "delta_t is insignificant beside it at large values (as Sec. 4 has it)" if rises
                   else "confirmed")


@statement("Sec. 2.2", "the response is determined by only two parameters, lambda_n and lambda_t",
           "force at the onset at lambda_t = 10, W = 25, for each rho = tau_inf/tau_max; that at "
           "lambda_t = 1, W = 0.8 held, over the one at nu = 1/2 and phi_t = phi_n, minus 1, for "
           "other Poisson ratios and works of adhesion; and the least height over period at which "
           "the onset is a fold, rho = 0.8, lambda_t = 0.1, W = 25 (the paper's: 20)")
def two_parameters(results):
    by_friction = []
    for residual in (0, 0.05, 0.5, 1):
        begun = regimes.begun(results, residual, 10, 25).onset
        by_friction.append(Number(f"rho = {residual:g}", begun.force,
                                  spread=regimes.onset_error(results, residual, 10, 25)))
    error = grid_change(results, poisson.run(0.0, 25))[0]

    def changed(ratio, work):
        forces = [onset(results[poisson.run(*case).name]).force
                  for case in ((ratio, 0.8, work), (0.5, 0.8))]
        return Number(f"nu = {ratio:g}, phi_t/phi_n = {work:g}", forces[0] / forces[1] - 1, "%",
                      spread=10 * error)

    by_body, by_work = ([changed(ratio, work) for work in works] for ratio, works in
                        ((poisson.SHOWN, poisson.WORKS), (0.5, poisson.WORKS)))
    least = regimes.least_height(results[regimes.traced(0.8, 0.1, 25).name])
    found = [("rho", by_friction), ("body", [*by_body, *by_work]),
             ("drive", [Number("least H/L", least, spread=0.02 * least)])]
    factor = by_friction[-1].value / by_friction[0].value
    more = [f"rho alone changes the onset by a factor of {factor:.1f}"] * (factor > 1.1)
    more += [f"the height decides whether it is a fold (from {least:.2g} periods on)"] * (
        0.0 < least < np.inf)
    of_body, of_work, without = (np.ptp([number.value for number in numbers])
                                 for numbers in ([by_body[1], by_work[1]], by_body, by_work))
    more += [f"nu = {poisson.SHOWN:g} changes it by {100 * of_body:.2g} %"] * (of_body > 0.01)
    if of_work > 0.01:
        more.append(f"and phi_t/phi_n then by {100 * of_work:.2g} %"
                    + (f" (at nu = 1/2 by {100 * without:.1g} %)"))
    return found, ("not confirmed: " + "; ".join(more) if more else "confirmed")


def printed_peak():
    """(place, height) of the largest tangential traction of eq. 5b, over delta_t and phi_t/delta_t,
    from its values."""
    slips = np.linspace(0.0, 1.0, 200001)
    traction = 2.0 * slips * np.exp(-slips ** 2)
    return slips[np.argmax(traction)], traction.max()


@statement("Secs. 2.1 and 4, captions", "further misprints", "tau_max as printed in the text, "
           "sqrt(1/2) e phi_t delta_t, without its units over phi_t/delta_t; as eq. 4b has it; and "
           "the largest value of 2 s exp(-s^2), s = g_t/delta_t, with its place; tau_max over "
           "p_t,r, which the caption of Fig. 5 takes for 1; approaches of the top, over u_n,r, at "
           "which JKR's contact in the cell carries the loads of 25 and 0.8")
def misprints(results):
    place, peak = printed_peak()
    approaches = [reference.jkr_line_approach(half_width(force), PERIOD) for force in LOADS[::-1]]
    found = [Number("in the text", np.sqrt(0.5) * np.e, exact=True),
             Number("eq. 4b", np.sqrt(2 / np.e), exact=True),
             Number("largest", peak, exact=True), Number("at", place, exact=True),
             Number("tau_max/p_t,r", TANGENTIAL_PEAK, exact=True),
             *(Number(f"approach for W = {force:g}", approach, exact=True) for force, approach
               in zip(LOADS[::-1], approaches))]
    wrong = []
    if not np.isclose(peak, np.sqrt(0.5) * np.e, rtol=1e-6):
        wrong.append("sqrt(1/2) e phi_t delta_t stands for "
                     + ("sqrt(2/e) phi_t/delta_t" if np.isclose(peak, np.sqrt(2 / np.e), rtol=1e-6)
                        else f"{peak:.4g} phi_t/delta_t"))
    if not np.isclose(TANGENTIAL_PEAK, 1.0, rtol=1e-3):
        wrong.append(f"p_t,r = tau_max for {TANGENTIAL_PEAK:.3f} p_t,r = tau_max")
    if np.isclose(place, np.sqrt(0.5), atol=1e-4):
        wrong.append("the limits |g_t| <= delta_t and <= delta_t/sqrt 2 of the two regions for <= "
                     "and > delta_t/sqrt 2, where the peak is")
    if np.allclose(np.log(np.divide((40, 2), approaches)), 0.0, atol=0.4):
        wrong.append("u_app,t/u_n,r = 40 and 2 in Sec. 4, and u_app,n/u_t,r in the caption of "
                     "Fig. 5, for the approaches u_app,n/u_n,r, which give such loads")
    return found, "; ".join(wrong) or "none found"


@statement("Sec. 4", "the force drops at the onset for two reasons: tau_inf < tau_max, and the "
           "loss of area", "logarithm of the drop of the force split into those of the mean "
           "traction and of the area: share of the area; tau_max/2 and tau_max, approach held")
def drop_split(results):
    found, shares = [], {}
    for maugis in (0.1, 1):
        for force in LOADS:
            cells = []
            for law in ("half", "full"):
                record = results[f"{law}-t{maugis:g}-w{force:g}"]
                begun = onset(record)
                if not begun.unstable:
                    continue
                drop = np.log(begun.force / record["tangential_force"][-1])
                area = np.log(begun.area / record["contact_area"][-1])
                shares[maugis, force, law] = area / drop
                cells += [Number("tau_max/2" if law == "half" else "tau_max", area / drop, "%"),
                          Number("drop", 1 - np.exp(-drop), "%")]
            found.append((f"lambda_t = {maugis:g}, W = {force:g}", cells))
    half = [value for (*_, law), value in shares.items() if law == "half"]
    return found, (f"confirmed: with tau_max/2 the area makes {100 * min(half):.0f} to "
                   f"{100 * max(half):.0f} % of the drop, weaker friction the rest")


@statement("Sec. 4", "the area decays at a slower pace for lambda_t = 1 than for 10, and rapidly "
           "for 0.1", "share of the initial area lost at a displacement of the top of 80 (W = 25) "
           "and 30 (W = 0.8), tau_max/2")
def pace(results):
    found, right = [], []
    for force, moved in ((25, 80.0), (0.8, 30.0)):
        cells = []
        for maugis in TANGENTIAL:
            record = results[f"half-t{maugis:g}-w{force:g}"]
            part = slice(sheared_part(record).start, onset(record).point + 1)
            drive, keep = np.unique(record["tangential_displacement"][part], return_index=True)
            area = record["contact_area"][part][keep]
            cells.append(Number(f"lambda_t = {maugis:g}",
                                1 - PchipInterpolator(drive, area)(moved) / area[0], "%"))
        right.append(cells[1].value < cells[2].value < cells[0].value)
        found.append((f"W = {force:g}", cells))
    return found, "confirmed" if all(right) else "confirmed in part"


@statement("eq. 11", "w_t = tau_fit a_r + alpha w_n; in the case of a smooth body only the first "
           "term is present", "least squares of both terms over the onsets at all loads: "
           "tau_fit/tau_max and alpha with their 95 % intervals")
def two_terms(results):
    found, alphas = [], {}
    for maugis in TANGENTIAL:
        peak = reference.peak_tangential_traction(maugis)
        for law, name in (("half", "tau_max/2"), ("full", "tau_max")):
            data = [(onset(results[f"{law}-t{maugis:g}-w{force:g}"]), force)
                    for force in figure7.loads(maugis)]
            data = [(one.area, one.force, force) for one, force in data if one]
            areas, forces, loads = map(np.array, zip(*data))
            matrix = np.column_stack([areas, loads])
            fit, rest, *_ = np.linalg.lstsq(matrix, forces, rcond=None)
            spread = 1.96 * np.sqrt(float(rest[0]) / max(len(data) - 2, 1)
                                    * np.diag(np.linalg.inv(matrix.T @ matrix)))
            alphas[maugis, law] = fit[1], spread[1]
            found.append((f"lambda_t = {maugis:g}, {name}",
                          [Number("tau_fit", fit[0] / peak, spread=spread[0] / peak),
                           Number("alpha", fit[1], spread=spread[1])]))
    sure = [f"{maugis:g}" for (maugis, law), (alpha, spread) in alphas.items()
            if law == "half" and abs(alpha) > 2 * spread]
    return found, (f"not confirmed for lambda_t = {', '.join(sure)}: a smooth body has a second "
                   "term, too, since the area that adhesion adds is lost before sliding"
                   if sure else "confirmed: the second term is no larger than its error")


@statement("Sec. 4", "tau_fit scales as phi_n^(1/3)", "exponent of tau_fit in the work of adhesion "
           "at fixed ranges delta_n = delta_t, both works alike: 1/3 of the unit and 2/3 of the "
           "slope of tau_fit with lambda_t, which grows as phi^(2/3), between lambda_t = 0.1, 1, "
           "10; tau_max/2")
def fixed_ranges(results):
    slopes = [figure7.onset_line(results, "half", maugis)[:2] for maugis in TANGENTIAL]
    found = []
    for (low, error), (high, other), names in zip(slopes, slopes[1:], ("0.1 to 1", "1 to 10")):
        power = np.log10(high / low)
        spread = np.hypot(error / low, other / high) / np.log(10)
        found.append(Number(f"lambda_t = {names}", 1 / 3 + 2 / 3 * power, spread=2 / 3 * spread))
    return found, ("not confirmed at given ranges of the law, which are what a surface has: about "
                   f"phi^{np.mean([number.value for number in found]):.1f}")


@statement("Secs. 4 to 6", "results replicate experiments qualitatively: power law of the area, "
           "onset at a constant tau_fit, drop of force and area, best at lambda_t near 1; the area "
           "goes on to decay with a faster drive; Savkoor's model is too rapid", "no data of "
           "experiments are given in numbers", )
def experiments(results):
    return [Number("", 0.0, exact=True)][:0], ("not testable here: a fair test takes the areas and "
                                               "forces that were measured, and rho and delta_t of "
                                               "those surfaces")
