"""Who wins when several reasons to leave hold at once: the pilot, failsafes, I(s), transitions."""

from __future__ import annotations

from itertools import product

import pytest
from stepping import Walk, chart_of

from missionkit.chart.semantics.step import ABORT

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


HEARS_ALL = """\
initial: x
dwell: 0
states:
  x: {kind: custom, transitions: [{to: y, event: "*"}]}
  y: {kind: custom}
  land: {kind: land, transitions: [{to: x, event: "*"}]}
"""


def test_the_operators_landing_does_not_match_a_star():
    walk = Walk(HEARS_ALL)
    walk.run(0.5, ABORT)
    assert walk.went() == [(0.05, "land")]


def test_a_wildcard_takes_all_other_events():
    walk = Walk(HEARS_ALL)
    walk.tick("operator")
    assert walk.state == "y"


RING = """\
initial: x
dwell: {dwell}
states:
  x: {{kind: custom, transitions: [{{to: y, when: a}}]}}
  y: {{kind: custom, transitions: [{{to: z, when: a}}]}}
  z: {{kind: custom, transitions: [{{to: x, when: b}}]}}
  land: {{kind: land}}
"""


def test_a_tick_runs_until_the_chart_is_stable():
    walk = Walk(RING.format(dwell=0))
    walk.run(0.1, "a")
    assert walk.went() == [(0.05, "y"), (0.05, "z")]


def test_the_dwell_lets_one_guard_fire_in_a_tick():
    walk = Walk(RING.format(dwell=0.05))
    walk.run(0.2, "a")
    assert walk.went() == [(0.05, "y"), (0.1, "z")]


def test_nothing_is_kept_of_a_tick_that_does_not_come_to_rest():
    walk = Walk(RING.format(dwell=0))
    walk.tick()
    before = walk.memory
    decision = walk.tick("a", "b")
    (problem,) = walk.contain.take()
    assert (
        problem == "the chart does not come to rest within one tick: ... z -> x -> y -> z -> x -> y"
    )
    assert walk.memory == before
    assert (decision.fired, decision.moves, decision.orders) == ((), (), ())


COUNTING = """\
initial: x
dwell: 0
variables: {n: 0, far: 3000.0}
failsafes: [{name: out, when: b, to: home}]
states:
  x:
    kind: custom
    transitions:
      - {when: {variable: n, below: LIMIT}, do: [{assign: {n: {add: 1}}}, {vehicle: hold}]}
  home:
    kind: return
    behavior: {use: go_to, target: home, height: 5}
    transitions: [{when: {variable: n, below: LIMIT}, do: [{assign: {n: {add: 1}}}]}]
  land: {kind: land}
"""


def test_a_long_way_to_rest_is_taken_in_one_tick():
    walk = Walk(COUNTING.replace("LIMIT", "900"))
    walk.tick()
    assert walk.memory.variables["n"] == 900
    assert not walk.contain.take()


def test_a_tick_without_an_end_and_without_a_circle_is_stopped_too():
    walk = Walk(COUNTING.replace("LIMIT", "3000"))
    assert walk.tick().fired == ()
    assert walk.memory.variables["n"] == 0
    assert walk.contain.take()


def test_a_failsafe_is_taken_although_what_follows_does_not_come_to_rest():
    walk = Walk(COUNTING.replace("LIMIT", "3000"))
    decision = walk.tick("b")
    assert [fired.to for fired in decision.fired] == ["home"]
    assert (walk.state, walk.memory.variables["n"]) == ("home", 0)
    assert walk.contain.take()


def test_guards_that_did_not_decide_are_still_evaluated_and_recorded():
    walk = Walk(CHART)
    decision = walk.tick("a", "c?")
    said = {name: verdict.holds for name, verdict in decision.answers.items()}
    assert said == {
        **{"a": True, "b": False, "c": None},
        **{"ground touched": False, "plugin failed": False, "flag (name broken)": False},
    }
    assert decision.fired[0].verdicts == (("a", decision.answers["a"]),)


@pytest.mark.parametrize("reason", ["when: a", "event: again"])
def test_a_transition_to_the_same_state_leaves_and_enters_it(reason):
    walk = Walk(
        "initial: x\ndwell: 0.1\nstates:\n"
        f"  x: {{kind: custom, transitions: [{{to: x, {reason}}}]}}\n"
        "  land: {kind: land}\n"
    )
    walk.tick()
    assert walk.tick("a", "again").entered
    assert walk.memory.entered_at == 0.1
