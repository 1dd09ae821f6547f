"""Contracts of the state kinds: the failsafes they add, and the transitions they demand."""

from __future__ import annotations

import pytest
from stepping import CATALOGUE, HEAD

from missionkit.behaviors.hold import Hold
from missionkit.chart.checks import findings
from missionkit.chart.load import load, parse
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import HOVER_FOR, fulfilled, unmet

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
        "task": [("visual", "disturbed"), LOST],
        "search": [("gps", "elapsed (longer_than 30)")],
        "gps": [FAR],
        "return": [("land", "goal unreachable")],
        "land": [],
        "hover": [("return", f"after {HOVER_FOR:g}")],
    }


def test_a_state_with_a_transition_to_that_kind_gets_no_second_one():
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


POLES = """\
initial: pole-1
states:
%s
  away: {kind: custom, transitions: [{to: land, after: 5}]}
  land: {kind: land}
"""
POLE = """\
  pole-%(n)d:
    initial: fly-%(n)d
    transitions: [{to: %(to)s, after: 300}]
    states:
      fly-%(n)d:
        kind: gps
        behavior: {use: go_to, target: t}
        transitions: [{to: see-%(n)d, when: a}]
      see-%(n)d: {kind: visual, behavior: {use: servo, target: t}}
      look-%(n)d:
        kind: search
        behavior: {use: spiral, target: t}
        transitions: [{to: see-%(n)d, when: a}]
"""
THREE = POLES % "".join(
    POLE % {"n": n, "to": f"pole-{n + 1}" if n < 3 else "away"} for n in (1, 2, 3)
)


def leads(text: str, path=None) -> dict[str, dict[str, str]]:
    """Return where each state's default failsafes and its invariant lead."""
    whole = fulfilled(mission(text) if path is None else load(path, CATALOGUE), CATALOGUE)
    return {
        name: {way.name: way.to[0] for way in state.transitions if way.name is not None}
        | ({} if state.invariant.exit is None else {"broken": state.invariant.exit})
        for name, state, _ in whole.walk()
    }


def test_a_search_begun_at_the_third_pole_leads_back_to_the_third_pole():
    found = leads(THREE)
    for n in (1, 2, 3):
        assert found[f"look-{n}"] == {"search-timeout": f"fly-{n}"}
        assert found[f"see-{n}"]["lock-lost"] == found[f"see-{n}"]["broken"] == f"look-{n}"


def test_side_by_side_the_one_for_the_same_target_is_nearest_then_the_one_with_fewest_steps():
    flat = """\
targets: {t: {position: [1, 2, 3]}, u: {position: [5, 2, 3]}}
initial: a
states:
  a: {kind: gps, behavior: {use: go_to, target: u}, transitions: [{to: look, when: x}]}
  b: {kind: gps, behavior: {use: go_to, target: t}}
  c: {kind: gps, behavior: {use: go_to, target: t}, transitions: [{to: look, when: x}]}
  look: {kind: search, behavior: {use: spiral, target: t}}
  land: {kind: land}
"""
    head = HEAD + flat.replace("when: x", "when: a")
    whole = fulfilled(parse(head, "m.yaml", CATALOGUE), CATALOGUE)
    assert whole.states["look"].transitions[-1].to == ("c",)


@pytest.mark.parametrize(
    ("pause", "taken"),
    [
        ("{kind: hover, transitions: [{to: gps, event: resume}, {to: land, after: 90}]}", False),
        ("{kind: hover, behavior: hold, transitions: [{to: gps, event: resume}]}", False),
        ("{kind: hover, transitions: [{to: land, after: 90}]}", True),
    ],
)
def test_an_unreachable_goal_does_not_lead_to_the_operators_pause(pause, taken):
    text = f"""\
initial: gps
states:
  gps:
    kind: gps
    behavior: {{use: go_to, target: t}}
    transitions: [{"{to: pause, event: hold-on}" if not taken else "{to: land, after: 300}"}]
  pause: {pause}
  land: {{kind: land}}
"""
    found = leads(text)
    assert found["gps"]["unreachable"] == found["gps"]["broken"] == ("pause" if taken else "hover")
    assert ("hover" in found) is not taken


def test_a_hover_that_is_entered_for_another_reason_is_not_taken_one_for_goals_is():
    text = """\
initial: one
states:
  one:
    kind: gps
    behavior: {use: go_to, target: t}
    transitions: [{to: wait, when: a}, {to: two, after: 5}]
  two:
    kind: gps
    behavior: {use: go_to, target: t}
    transitions: [{to: stuck, when: {any: [goal_unreachable, b]}, for: 3}]
  wait: {kind: hover, transitions: [{to: land, after: 5}]}
  stuck: {kind: hover, transitions: [{to: land, after: 5}]}
  land: {kind: land}
"""
    found = leads(text)
    assert found["one"] == {"unreachable": "stuck", "broken": "stuck"}
    assert found["two"] == {"broken": "stuck"}


PART = """\
initial: fly
states:
  fly: {kind: gps, behavior: {use: go_to, target: t}, transitions: [{to: look, after: 9}]}
  look: {kind: search, behavior: {use: spiral, target: t}}
"""


def included(folder, part: str):
    (folder / "part.yaml").write_text(part)
    path = folder / "m.yaml"
    path.write_text(
        HEAD
        + TARGETS
        + """\
initial: far
states:
  far: {kind: gps, behavior: {use: go_to, target: t}, transitions: [{to: work, when: a}]}
  work: {include: part.yaml, transitions: [{to: home, after: 60}]}
  home: {kind: return, behavior: {use: go_to, target: home}, transitions: [{to: land, when: b}]}
  land: {kind: land}
"""
    )
    return path


def test_an_included_file_keeps_its_states_and_gets_its_own_hover(tmp_path):
    found = leads("", included(tmp_path, PART))
    assert found["work/look"] == {"search-timeout": "work/fly"}
    assert found["work/fly"] == {"unreachable": "work/hover", "broken": "work/hover"}
    assert found["far"] == {"unreachable": "hover", "broken": "hover"}
    whole = fulfilled(load(tmp_path / "m.yaml", CATALOGUE), CATALOGUE).by_name()
    assert whole["work/hover"].parent == "work"
    assert whole["work/hover"].state.transitions[0].to == ("home",)


def test_nothing_leads_out_of_an_included_file_and_that_is_reported(tmp_path):
    alone = """\
initial: look
states:
  look: {kind: search, behavior: {use: spiral, target: t}}
"""
    path = included(tmp_path, alone)
    assert leads("", path)["work/look"] == {}
    found = [it for it in findings(load(path, CATALOGUE), CATALOGUE) if it.code == "default-way"]
    assert [it.message for it in found] == [
        "state 'work/look': the default failsafe 'search-timeout' leads nowhere: 'far', of kind "
        "'gps', is in another file"
    ]


def test_the_mission_itself_is_left_as_it_was():
    before = mission(FULL)
    fulfilled(before, CATALOGUE)
    assert "hover" not in before.states
    assert len(before.states["visual"].transitions) == 1


def messages_of(text: str) -> list[str]:
    return [str(problem) for problem in unmet(mission(text), CATALOGUE)]


def cannot(place: str, state: str, kind: str, other: str) -> str:
    return (
        f"m.yaml:{place}: state {state!r} is of kind {kind!r}, which must be able to reach a "
        f"state of kind {other!r}, but cannot"
    )


def test_the_example_meets_its_contracts(example):
    assert unmet(load(example, CATALOGUE), CATALOGUE) == []


def test_a_mission_without_land_gets_only_that_problem():
    assert messages_of("initial: x\nstates:\n  x: {kind: custom}\n") == [
        "m.yaml:7:3: no state of kind 'land': the mission needs one to end in"
    ]


def test_a_visual_state_without_search_is_reported_at_its_kind():
    text = f"""\
initial: v
states:
  v:
    kind: visual
    {SERVO}
    transitions: [{{to: land, when: a}}]
  land: {{kind: land}}
"""
    assert messages_of(text) == [cannot("8:11", "v", "visual", "search")]


def test_a_state_that_cannot_land_is_reported_unless_a_failsafe_lands():
    text = "initial: x\nstates:\n  x: {kind: custom}\n  y: {kind: idle}\n  land: {kind: land}\n"
    assert messages_of(text) == [cannot("7:13", "x", "custom", "land")]
    assert messages_of(text + "failsafes: [{name: f, when: a, to: land}]\n") == []


def test_a_search_without_transitions_lacks_every_required_one():
    text = f"""\
initial: s
states:
  s: {{kind: search, behavior: {{use: spiral, target: t}}}}
  v: {{kind: visual, {SERVO}, transitions: [{{to: s, when: a}}, {{to: land, when: b}}]}}
  land: {{kind: land}}
"""
    assert messages_of(text) == [
        cannot("7:13", "s", "search", kind) for kind in ("visual", "gps", "land")
    ]


@pytest.mark.parametrize(("kind", "lacking"), [("gps", 0), ("return", 0), ("hover", 1)])
def test_default_failsafes_count_as_ways(kind, lacking):
    text = f"initial: x\nstates: {{x: {{kind: {kind}, behavior: hold}}, land: {{kind: land}}}}\n"
    assert messages_of(text) == [cannot("6:20", "x", kind, "land")] * lacking
