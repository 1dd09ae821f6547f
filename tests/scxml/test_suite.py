"""Charts of a public SCXML suite, converted mechanically, go where their scripts say."""

from __future__ import annotations

from pathlib import Path

from convert import beyond_plain, convert
from follow import followed

OUTSIDE = Path(__file__).with_name("outside.txt")


def test_plain_chart(plain):
    went, wanted = followed(convert(plain.chart), plain.script)
    assert went == wanted


def test_chart_with_data_conditions_or_sends(more):
    """Go where one of the scripts says.

    Where the suite gives two scripts, its own semantics takes a parallel state for the domain of
    a transition, which the recommendation does not (findLCCA): one of the two is that of the W3C.
    """
    converted = convert(more.chart)
    scripts = [more.script, more.script.get("legacySemantics", more.script)]
    steps = [followed(converted, script) for script in scripts]
    assert any(went == wanted for went, wanted in steps), steps


def test_how_many_charts_there_are(suite):
    own = [case for case in suite if not case.w3c]
    assert len(own) == 127
    assert sum(not beyond_plain(case.chart) for case in own) == 87


def test_why_the_others_are_left_out(suite, update_refs):
    reasons = [(case.name, convert(case.chart).beyond) for case in suite]
    listed = "".join(f"{name}: {'; '.join(why)}\n" for name, why in reasons if why)
    if update_refs:
        OUTSIDE.write_text(listed, encoding="utf-8")
    assert listed == OUTSIDE.read_text(encoding="utf-8")
