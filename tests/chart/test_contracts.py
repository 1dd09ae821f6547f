"""What the kinds of state bring with them, and what they demand."""

from __future__ import annotations

import pytest
from stepping import CATALOGUE, HEAD

from missionkit.behaviors import Hold
from missionkit.chart.load import load, parse
from missionkit.chart.model import expressions as ex
from missionkit.chart.model.contracts import HOVER_FOR, fulfilled, unmet
from missionkit.chart.model.mission import Mission

TARGETS = "targets: {t: {position: [1, 2, 3]}}\n"
SERVO = "behavior: {use: servo, target: t}"


def mission(text: str) -> Mission:
    return parse(HEAD + TARGETS + text, "m.yaml", CATALOGUE)


def ways(text: str) -> dict[str, list[tuple[str, str]]]:
    """Return (to, reason) of each transition after the contracts were carried out."""
    whole = fulfilled(mission(text), CATALOGUE)
    return {
        name: [
            (*one.to, ex.text(one.when) if one.when else f"after {one.after:g}")
            for one in state.transitions
        ]
        for name, state in whole.states.items()
    }


FULL = f"""\
initial: visual
states:
  visual: {{kind: visual, {SERVO}, transitions: [{{to: task, when: a}}]}}
  task: {{kind: task, {SERVO}}}
  search: {{kind: search, behavior: {{use: spiral, target: t}}}}
  gps: {{kind: gps, behavior: {{use: go_to, target: t}}}}
  return: {{kind: return, behavior: {{use: go_to, target: home}}}}
  land: {{kind: land}}
"""


LOST = ("search", "target lost (target t, longer_than 2)")
FAR = ("hover", "goal unreachable")


def test_default_failsafes_become_transitions_after_the_missions_own():
    assert ways(FULL) == {
        "visual": [("task", "a"), LOST, FAR],
        "task": [LOST],
        "search": [("gps", "elapsed (longer_than 30)")],
        "gps": [FAR],
        "return": [("land", "goal unreachable")],
        "land": [],
        "hover": [("return", f"after {HOVER_FOR:g}")],
    }


def test_a_state_that_has_a_way_to_that_kind_already_gets_no_other():
    own = FULL.replace("{to: task, when: a}", "{to: search, when: b, for: 5}")
    assert ways(own)["visual"] == [("search", "b"), FAR]


def test_what_the_mission_lacks_cannot_be_a_way_out():
    lone = "initial: task\nstates: {task: {kind: task, behavior: hold}, land: {kind: land}}\n"
    assert ways(lone) == {"task": [], "land": []}


def test_a_lost_lock_needs_a_target_to_have_been_locked():
    text = FULL.replace(f"visual, {SERVO}", "visual, behavior: hold")
    assert ways(text)["visual"] == [("task", "a"), FAR]


def test_a_hover_is_added_only_where_something_leads_to_it():
    own = FULL + "  wait: {kind: hover}\n"
    assert set(ways(own)) == set(ways(FULL)) - {"hover"} | {"wait"}
    assert ways(own)["gps"] == [("wait", "goal unreachable")]
    assert set(ways("initial: x\nstates: {x: {kind: custom}, land: {kind: land}}\n")) == {
        "x",
        "land",
    }


def test_the_hover_that_is_added_holds_and_finds_another_name_if_its_own_is_taken():
    whole = fulfilled(mission(FULL + "  hover: {kind: custom}\n"), CATALOGUE)
    added = whole.states["hover-failsafe"]
    assert (added.kind, added.behavior.plugin) == ("hover", Hold())
    assert whole.states["gps"].transitions[-1].to == ("hover-failsafe",)


def test_without_a_way_home_the_hover_leads_down():
    text = "initial: g\nstates: {g: {kind: gps, behavior: hold}, land: {kind: land}}\n"
    assert ways(text)["hover"] == [("land", f"after {HOVER_FOR:g}")]


def test_the_mission_itself_is_left_as_it_was():
    before = mission(FULL)
    fulfilled(before, CATALOGUE)
    assert "hover" not in before.states
    assert len(before.states["visual"].transitions) == 1


def told(text: str) -> list[str]:
    return [str(problem) for problem in unmet(mission(text), CATALOGUE)]


def cannot(place: str, state: str, kind: str, other: str) -> str:
    return (
        f"m.yaml:{place}: state {state!r} is of kind {kind!r}, which must be able to reach a "
        f"state of kind {other!r}, but cannot"
    )


def test_the_example_meets_its_contracts(example):
    assert unmet(load(example, CATALOGUE), CATALOGUE) == []


def test_a_mission_without_land_is_told_so_and_nothing_else():
    assert told("initial: x\nstates:\n  x: {kind: custom}\n") == [
        "m.yaml:7:3: no state of kind 'land': where would it end?"
    ]


def test_a_visual_state_without_search_is_told_at_its_kind():
    text = f"""\
initial: v
states:
  v:
    kind: visual
    {SERVO}
    transitions: [{{to: land, when: a}}]
  land: {{kind: land}}
"""
    assert told(text) == [cannot("8:11", "v", "visual", "search")]


def test_a_state_that_cannot_land_is_told_unless_a_failsafe_leads_down():
    text = "initial: x\nstates:\n  x: {kind: custom}\n  y: {kind: idle}\n  land: {kind: land}\n"
    assert told(text) == [cannot("7:13", "x", "custom", "land")]
    assert told(text + "failsafes: [{name: f, when: a, to: land}]\n") == []


def test_a_search_that_leads_nowhere_lacks_everything():
    text = f"""\
initial: s
states:
  s: {{kind: search, behavior: {{use: spiral, target: t}}}}
  v: {{kind: visual, {SERVO}, transitions: [{{to: s, when: a}}, {{to: land, when: b}}]}}
  land: {{kind: land}}
"""
    assert told(text) == [cannot("7:13", "s", "search", kind) for kind in ("visual", "gps", "land")]


@pytest.mark.parametrize(("kind", "lacking"), [("gps", 0), ("return", 0), ("hover", 1)])
def test_default_failsafes_count_as_ways(kind, lacking):
    text = f"initial: x\nstates: {{x: {{kind: {kind}, behavior: hold}}, land: {{kind: land}}}}\n"
    assert told(text) == [cannot("6:20", "x", kind, "land")] * lacking
