"""Numbers that stand in the sentences of docs/incipient-sliding.md, and what is found for them."""

import re
from typing import NamedTuple

import regimes
import statements
import statements_more
import statements_residual
import statements_theory
from runs import LOADS, PERIOD, ROOT
from statement import evaluated

from contactsnes import reference

PAGE = ROOT / "docs" / "incipient-sliding.md"
NUMBER = r"([0-9]+(?:\.[0-9]+)?)"


class Claim(NamedTuple):
    """A sentence with numbers.

    pattern : the sentence or a part of it, # for each number
    found : function of results that gives the numbers in their order
    """

    pattern: str
    found: object

    @property
    def expression(self):
        """Regular expression of the pattern: a group for each number, any white space for
        blanks."""
        text = re.escape(" ".join(self.pattern.split()))
        return re.compile(text.replace("\\ ", r"\s+").replace("\\#", "#").replace("#", NUMBER))


def of(statement, *places, scale=1.0):
    """A function of results: sizes of the numbers of a statement at (heading, label)."""
    def values(results):
        known = statement.numbers(results)
        return [scale * abs(known[place]) for place in places]
    return values


def ends(statement, chosen, scale=1.0):
    """The same: the least and the largest of those at the headings that are chosen."""
    def values(results):
        known = [scale * abs(value) for (heading, _), value in statement.numbers(results).items()
                 if chosen(heading)]
        return [min(known), max(known)]
    return values


def held(results):
    """What a sliding contact carries over rho lambda_t at W = 25, and at lambda_t = 10, rho =
    1/2."""
    width = regimes.friction_width(results, 25) * reference.peak_tangential_traction(1.0)
    return [width, 5.0 * width]


def onset_at(results, residual, maugis, force):
    """Force and area at an onset of the map, and the force over that of the spike."""
    begun = regimes.begun(results, residual, maugis, force)
    return begun.onset.force, begun.onset.area, begun.ratio


def gone_on(results):
    """Normal force in sliding at a held approach, W = 0.8 before."""
    return [results["half-t10-w0.8"]["normal_force"][-1]]


def off_front(results):
    """Largest distance in percent of an onset of a stiff interface with some residual friction from
    the front's force, W = 25."""
    half = 0.5 * regimes.friction_width(results, 25)
    return [100.0 * max(abs(onset_at(results, residual, maugis, 25)[0] / reference.front_onset(
        half, residual * reference.peak_tangential_traction(maugis),
        reference.front_work(residual), PERIOD)[1] - 1.0)
        for maugis in (6, 10, 14) for residual in (0.05, 0.1, 0.2))]


CLAIMS = (
    Claim("λ_t below # at W = 25 and # at W = 0.8",
          lambda results: [regimes.stiff_from(results, force) for force in LOADS[::-1]]),
    Claim("between # and # % of the area that slip can take goes in the jump itself",
          ends(statements.least_area, lambda heading: heading.startswith("lambda_t = 0.1"), 100)),
    Claim("which is # ρ λ_t at W = 25, so # at λ_t = 10", held),
    Claim("Equilibria slide at #, # times the force at which the spike reached",
          lambda results: [onset_at(results, 0.5, 10, 25)[place] for place in (0, 2)]),
    Claim("force (# at ρ = 0), the least area is reached there (#, for # in sliding)",
          lambda results: [*onset_at(results, 0, 10, 0.8)[:2], regimes.slid_area(results, 0.8)]),
    Claim("decay is # to # in every window of a fit",
          lambda results: statements_residual.ten_at(results, 0, 0.8)),
    Claim("exponents are # to # as long as a tenth of the loss is lost",
          lambda results: statements_residual.exponent_ends(results, 0.1)),
    Claim("spread to # and # where half is",
          lambda results: statements_residual.exponent_ends(results, 0.5)),
    Claim("by # times there, by # at 10",
          of(statements_theory.fracture, ("law", "lambda_t = 1"), ("law", "lambda_t = 10"))),
    Claim("(within # % at λ_t = 0.1, # τ_max)", lambda results: [
        value for place, scale in (("off", 100.0), ("", 1.0)) for value in of(
            statements_residual.onset_lines, ("lambda_t = 0.1, rho = 1/2", place),
            scale=scale)(results)]),
    Claim("With ρ = 1/2 it is # τ_max at λ_t = 1 and # at 10",
          of(statements_residual.onset_lines, ("lambda_t = 1, rho = 1/2", ""),
             ("lambda_t = 10, rho = 1/2", ""))),
    Claim("a layer of more than # periods at ρ = 0.8 and # at 0.9",
          of(statements.unstable_onsets, *(("", f"least H/L, rho = {share}, lambda_t = 0.1, W = 25")
                                           for share in (0.8, 0.9)))),
    Claim("at up to # % less than at a held height",
          of(statements_theory.control, ("lambda_t = 10, W = 0.8", "onset"), scale=100)),
    Claim("raises W to #", gone_on),
    Claim("at W = 25 within # %",
          of(statements_theory.control, ("lambda_t = 10, W = 25", "onset"), scale=100)),
    Claim("by #, # and # % at ν = 0.4, 0.3 and 0, W = 25",
          of(statements_more.area_shrinks, *(("W = 25", f"nu = {ratio:g}")
                                             for ratio in (0.4, 0.3, 0.0)), scale=100)),
    Claim("the contact slides at U = #; driven back, it adheres again by a jump at #",
          of(statements_more.reattachment, ("", "slides at"), ("", "adheres again at"))),
    Claim("meet the front's largest force within # %", off_front),
)


def printed(claim, text):
    """Numbers of a claim as the text prints them; None where the sentence is not there."""
    match = claim.expression.search(text)
    return match and match.groups()


def agrees(shown, value):
    """Whether a number as it is printed is a value, rounded to its digits: to one more in the last,
    since a value may lie at the border."""
    digits = len(shown.partition(".")[2])
    return abs(float(shown) - value) < 0.51 * 10.0 ** -digits + 1e-9


def wrong(results):
    """Sentences on the numbers of the page that are not what is found."""
    text, told = PAGE.read_text(encoding="utf-8"), []
    for claim in CLAIMS:
        shown = printed(claim, text)
        values, missing = evaluated(claim.found, results)
        if missing is not None:
            told.append(f'"{claim.pattern}" cannot be checked: {missing}')
        elif shown is None:
            told.append(f'"{claim.pattern}" stands nowhere')
        elif not all(map(agrees, shown, values)):
            told.append(f'"{claim.pattern}" has {", ".join(shown)}: found '
                        + ", ".join(f"{value:.5g}" for value in values))
    return [f"docs/incipient-sliding.md: {line}" for line in told]
