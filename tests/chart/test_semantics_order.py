"""Who wins when several reasons to leave hold at once: the pilot, failsafes, I(s), transitions."""

from __future__ import annotations

from itertools import product

import pytest
from stepping import Walk, chart_of

from missionkit.chart.semantics import ABORT

CHART = """\
initial: x
dwell: 0
failsafes:
  - {name: first, when: a, unknown: ignore, to: return}
  - {name: second, when: b, unknown: ignore, to: land}
states:
  x:
    kind: custom
    invariant: {holds: {not: {use: flag, name: broken}}, exit: broken}
    transitions:
      - {to: early, when: c}
      - {to: late, event: d}
  early: {kind: custom}
  late: {kind: custom}
  broken: {kind: custom}
  return: {kind: return, behavior: {use: go_to, target: home}}
  down: {kind: land}
  land: {kind: land}
"""
WINNERS = (  # in order of precedence; an abort leads to the first state of kind land
    (ABORT, ("down", "operator: land")),
    ("a", ("return", "failsafe first")),
    ("b", ("land", "failsafe second")),
    ("broken", ("broken", "invariant broken for 0 s")),
    ("c", ("early", "when c")),
    ("d", ("late", "on d")),
)


def test_of_all_that_holds_the_first_in_rank_wins():
    chart = chart_of(CHART)
    for present in product((False, True), repeat=len(WINNERS)):
        walk = Walk(chart)
        events = [event for (event, _), here in zip(WINNERS, present, strict=True) if here]
        walk.tick(*events)
        expected = [result for event, result in WINNERS if event in events][:1]
        assert [(to, reason) for _, _, to, reason in walk.trace] == expected
        assert walk.state == (expected[0][0] if expected else "x")


def test_one_transition_fires_in_a_tick_and_the_new_state_is_asked_in_the_next():
    walk = Walk("""\
initial: x
dwell: 0
states:
  x: {kind: custom, transitions: [{to: y, when: a}]}
  y: {kind: custom, transitions: [{to: z, when: a}]}
  z: {kind: custom, transitions: [{to: x, when: a}]}
  land: {kind: land}
""")
    walk.run(0.2, "a")
    assert walk.went() == [(0.05, "y"), (0.1, "z"), (0.15, "x"), (0.2, "y")]


def test_guards_that_did_not_decide_are_asked_and_recorded_all_the_same():
    walk = Walk(CHART)
    decision = walk.tick("a", "c?")
    said = {name: verdict.holds for name, verdict in decision.answers}
    assert said == {
        **{"a": True, "b": False, "c": None},
        **{"plugin failed": False, "flag (name broken)": False},
    }
    assert decision.fired.verdicts == (("a", decision.answers[0][1]),)


@pytest.mark.parametrize(("event", "stays"), [("", True), (", event: again", False)])
def test_a_transition_to_the_same_state_re_enters_only_by_event(event, stays):
    walk = Walk(
        "initial: x\ndwell: 0\nstates:\n"
        f"  x: {{kind: custom, transitions: [{{to: x, when: a{event}}}]}}\n"
        "  land: {kind: land}\n"
    )
    walk.tick()
    assert walk.tick("a", "again").entered is not stays
    assert walk.memory.entered_at == (0.0 if stays else 0.1)
