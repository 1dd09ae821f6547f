"""Requirements in flight: what the record shows, and where a broken one leads."""

from __future__ import annotations

import pytest
from stepping import HEAD, Walk, chart_of

from missionkit.chart.semantics.requirement_watch import results

CHART = """\
initial: x
dwell: 0
variables: {n: 5}
failsafes: [{name: out, when: c, to: home}]
states:
  x:
    kind: custom
    transitions: [{to: y, event: go}, {event: less, do: [{assign: {n: {add: -1}}}]}]
  y: {kind: custom, transitions: [{to: x, event: go}]}
  safe: {kind: hover, behavior: hold, transitions: [{to: x, event: go}]}
  home:
    kind: return
    behavior: {use: go_to, target: home, height: 5}
    transitions: [{to: land, when: done}]
  land: {kind: land}
requirements:
"""


def walk_of(requirement: str) -> Walk:
    return Walk(f"{CHART}  - {{name: it, {requirement}}}\n")


def shown(walk: Walk, *events: str):
    return walk.tick(*events).answers["requirement it"]


def test_never_is_open_until_it_is_broken_for_good():
    walk = walk_of("never: {in: y}")
    assert [shown(walk, event).holds for event in ("", "go", "go", "")] == [
        None,
        False,
        False,
        False,
    ]


def test_the_least_margin_so_far_is_shown():
    walk = walk_of("always: {variable: n, at_least: 4}")
    assert [shown(walk, event).margin for event in ("", "less", "", "less")] == [
        1.0,
        0.0,
        0.0,
        -1.0,
    ]
    assert shown(walk).holds is False


def test_existence_counts_down():
    walk = walk_of("existence: {enter: y}, within: 0.2")
    assert shown(walk).why == "open, 0.2 s left"
    walk.run(0.25)
    assert shown(walk).holds is False
    early = walk_of("existence: {enter: y}, within: 0.2")
    assert shown(early, "go").holds is True
    assert shown(early, "go").why == "fulfilled"


def test_what_must_come_before_may_come_in_the_same_tick():
    walk = walk_of("precedence: a, before: {enter: y}")
    assert [shown(walk, *events).holds for events in (("a", "go"), ("go",), ("go",))] == [None] * 3
    late = walk_of("precedence: a, before: {enter: y}, within: 0.1")
    assert [shown(late, event).holds for event in ("a", "", "", "go")] == [None, None, None, False]


def test_a_state_that_is_left_in_the_same_tick_was_entered():
    walk = walk_of("never: {enter: y}")
    shown(walk)
    assert shown(walk, "go", "go").holds is False
    assert walk.state == "x"


def test_a_response_is_due_after_its_call():
    walk = walk_of("response: {when: a, then: {in: y}, within: 0.2}")
    assert shown(walk, "a").why == "open, 0.2 s left"
    walk.run(0.15)
    assert shown(walk, "go").why == "open"
    walk.tick("go")
    walk.tick("a")
    walk.run(0.5)
    assert shown(walk).holds is False


def test_scopes():
    walk = walk_of("never: b, after: a, before: {enter: y}")
    shown(walk, "b")
    shown(walk, "a")
    shown(walk, "go")
    assert shown(walk, "b").holds is True
    other = walk_of("never: b, while: {in: y}")
    shown(other, "b")
    assert shown(other, "go").holds is None
    assert shown(other, "b").holds is False


def test_what_is_unknown_leaves_it_open():
    walk = walk_of("existence: a, within: 0.1")
    for event in ("", "a?", "", ""):
        verdict = shown(walk, event)
    assert verdict.holds is None


def test_nothing_counts_before_its_guards_have_answered():
    walk = walk_of("never: a")
    assert [shown(walk, event).holds for event in ("a?", "a?", "", "")] == [None] * 4
    (result,) = results(walk.chart.watch.requirements, walk.memory.monitors)
    assert result.fulfilled is True
    silent = walk_of("never: a")
    shown(silent, "a?")
    (result,) = results(silent.chart.watch.requirements, silent.memory.monitors)
    assert result.fulfilled is None


def test_a_broken_requirement_leads_away_once_until_it_is_whole_again():
    walk = walk_of("always: {not: b}, while: {in: x}, broken: {to: safe, after: 0.1}")
    walk.tick("b")
    walk.tick()
    assert shown(walk, "b").why == "broken, leads to safe in 0.1 s"
    walk.tick("b")
    assert walk.trace == []
    walk.tick("b")
    assert walk.trace == [(0.25, "x", "safe", "requirement it broken for 0.1 s")]
    walk.tick("go")
    walk.run(1.0)
    assert walk.state == "x"
    walk.run(2.0, "b")
    assert walk.state == "safe"


def test_a_requirement_that_is_broken_for_good_leads_away_once():
    walk = walk_of("existence: {enter: y}, within: 0.1, broken: {to: safe}")
    walk.run(0.3)
    assert walk.state == "safe"
    walk.tick("go")
    walk.run(1.0)
    assert walk.state == "x"


def test_a_failsafe_goes_before_and_nothing_leads_back_from_home():
    walk = walk_of("never: b, broken: {to: safe}")
    walk.tick("b")
    walk.tick("c")
    assert walk.trace == [(0.1, "x", "home", "failsafe out")]
    walk.run(0.5, "b")
    assert walk.state == "home"


def test_named_guards_are_opened_for_their_margins():
    head = HEAD.replace(
        "guards: {", "guards: {both: {all: [{variable: n, at_least: 4}, {not: a}]}, "
    )
    walk = Walk(chart_of(f"{CHART}  - {{name: it, always: both}}\n", head=head))
    assert shown(walk).margin == pytest.approx(1.0)


RESTLESS = """\
initial: p
dwell: 0
states:
  p: {kind: custom, transitions: [{to: q, when: a}]}
  q: {kind: custom, transitions: [{to: r, when: a}]}
  r: {kind: custom, transitions: [{to: p, when: a}]}
  land: {kind: land}
requirements:
  - {name: it, never: {not: {in: p}}}
  - {name: entry, never: {enter: q}}
"""


def test_what_was_undone_did_not_happen():
    walk = Walk(RESTLESS)
    walk.tick()
    answers = walk.tick("a").answers
    assert walk.contain.take()
    assert answers["in p"].holds
    assert (answers["requirement it"].holds, answers["requirement entry"].holds) == (None, None)


def test_what_healed_before_its_time_bound_leads_nowhere_afterwards():
    walk = walk_of("always: {not: b}, within: 0.3, broken: {to: safe, after: 0.2}")
    walk.tick()
    walk.tick("b")
    walk.run(1.0)
    assert (shown(walk).holds, walk.trace) == (False, [])


def test_a_guard_that_remembers_and_stands_in_a_requirement_alone():
    walk = walk_of("never: {use: tally, name: go, count: 3}")
    assert [shown(walk, "go").holds for _ in range(4)] == [None, None, False, False]


def test_a_latch_has_an_enter_of_its_own():
    latch = "{hysteresis: {use: battery_below, floor: 0.5}, enter: 0.4, exit: 0.6}"
    walk = walk_of(f"never: {latch}")
    assert shown(walk).holds is None
