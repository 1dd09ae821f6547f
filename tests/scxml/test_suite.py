"""Charts of a public SCXML suite, converted mechanically, go where their scripts say."""

from __future__ import annotations

from pathlib import Path

from follow import followed

from missionkit.interchange.charts.scxml_chart import beyond_plain, convert, sends_at_once

OUTSIDE = Path(__file__).with_name("outside.txt")


def test_plain_chart(plain):
    went, wanted = followed(convert(plain.chart), plain.script)
    assert went == wanted


def test_chart_with_data_conditions_or_sends(more):
    """Go where one of the scripts says.

    Where the suite gives two scripts, its own semantics takes a parallel state for the domain of
    a transition, which the recommendation does not (findLCCA): one of the two is that of the W3C.
    It may also look at the first configuration before what was sent without delay is handled.
    """
    converted = convert(more.chart)
    scripts = [more.script, more.script.get("legacySemantics", more.script)]
    steps = [followed(converted, script) for script in scripts]
    first = int(sends_at_once(more.chart))
    assert any(went == wanted or went[first:] == wanted[first:] for went, wanted in steps), steps


def test_which_tests_of_the_recommendation_on_sending_and_failing_are_followed(suite):
    followed_too = {case.name for case in suite if not convert(case.chart).beyond}
    tests = (159, 175, 185, 194, 208, 423, 579)
    assert followed_too >= {f"w3c-ecma/test{number}.txml" for number in tests}


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
