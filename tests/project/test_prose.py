"""Numbers in the sentences of a page are checked against what runs give."""

import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parents[2] / "scripts" / "paper"
before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
sys.path.insert(0, str(HERE))
import prose  # noqa: E402
import statements_more  # noqa: E402

sys.path.remove(str(HERE))
sys.dont_write_bytecode = before


@pytest.mark.parametrize("claim", prose.CLAIMS, ids=lambda claim: claim.pattern[:40])
def test_every_claim_stands_on_the_page(claim):
    shown = prose.printed(claim, prose.PAGE.read_text(encoding="utf-8"))
    assert shown is not None and len(shown) == claim.pattern.count("#")


@pytest.mark.parametrize("shown, value, right", [
    ("2.98", 2.9788, True), ("2.98", 2.9749, True), ("2.98", 2.99, False), ("62", 62.07, True),
    ("62", 63.0, False), ("0.2", 0.2304, True), ("0.2", 0.16, True), ("0.2", 0.3, False)])
def test_a_number_agrees_as_far_as_it_is_printed(shown, value, right):
    assert prose.agrees(shown, value) == right


def test_a_wrong_number_a_missing_run_and_a_lost_sentence_are_told(monkeypatch, tmp_path):
    page = tmp_path / "page.md"
    page.write_text("The force is 2.5 at\nonset, the area 3.\n", encoding="utf-8")
    monkeypatch.setattr(prose, "PAGE", page)

    def found(claims):
        monkeypatch.setattr(prose, "CLAIMS", claims)
        return prose.wrong({})

    assert not found([prose.Claim("force is # at onset, the area #", lambda _: [2.5, 3.0])])
    told, = found([prose.Claim("force is # at onset, the area #", lambda _: [2.5, 4.0])])
    assert "2.5, 3: found 2.5, 4" in told
    told, = found([prose.Claim("force is # at onset", lambda results: results["run"])])
    assert "cannot be checked" in told and "run" in told
    told, = found([prose.Claim("force is no more than #", lambda _: [1.0])])
    assert "stands nowhere" in told


def test_peak_of_the_misprinted_law():
    """sqrt(2/e) at 1/sqrt 2."""
    place, peak = statements_more.printed_peak()
    assert place == pytest.approx(2 ** -0.5, abs=1e-5)
    assert peak == pytest.approx((2.0 / 2.718281828459045) ** 0.5, rel=1e-9)
