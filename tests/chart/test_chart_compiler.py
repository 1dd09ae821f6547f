"""From the model to the chart."""

from __future__ import annotations

import pytest
from samples import calm
from stepping import CATALOGUE, chart_of

from missionkit.chart.load import load
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.compiled_chart import Chart, Output
from missionkit.messages import Action


@pytest.fixture(scope="module")
def precise(example) -> Chart:
    return compile_mission(load(example, CATALOGUE), CATALOGUE)


def every_transition(chart: Chart):
    own = [one for state in chart.states.values() for one in state.transitions]
    return [*own, *chart.failsafes]


def test_every_transition_leads_somewhere_and_has_its_own_number(precise: Chart):
    everything = every_transition(precise)
    assert len({one.number for one in everything}) == len(everything)
    assert {to for one in everything for to in one.to} <= set(precise.states)
    assert precise.initial == "idle"
    assert precise.land == "land"


def test_transitions_say_when_they_fire_and_which_guards_they_read(precise: Chart):
    visual = precise.states["visual"].transitions
    assert [(*one.to, one.text) for one in visual] == [
        ("task", "when converged (position 0.07, yaw_deg 4) for 1 s"),
        ("search", "when target lost (target trunk, longer_than 2)"),
        ("return", "after 90 s"),
        ("hover", "unreachable, when goal unreachable"),
    ]
    assert visual[0].reads == ("converged (position 0.07, yaw_deg 4)",)
    assert visual[2].reads == ()
    gps = precise.states["gps"].transitions[0]
    assert gps.text == "when marker-sure and trunk-in-range and near-goal"
    assert gps.reads == ("marker-sure", "trunk-in-range", "near-goal")


def test_failsafes_come_in_order_and_those_for_stuck_plugins_last(precise: Chart):
    assert [(one.text, *one.to, one.hold, one.unknown_takes) for one in precise.failsafes] == [
        ("failsafe battery", "return", 0.0, True),
        ("failsafe empty", "land", 0.0, False),
        ("failsafe link", "land", 0.0, True),
        ("failsafe lost", "land", 1.0, True),
        ("failsafe fence", "return", 0.0, True),
        ("failsafe ground touched", "land", 0.0, False),
        ("failsafe plug-in failed", "return", 3.0, False),
        ("failsafe plug-in failed", "land", 6.0, False),
    ]


def test_stuck_plugins_lead_to_land_where_there_is_no_way_home():
    chart = chart_of("initial: x\nstates: {x: {kind: custom}, down: {kind: land}}\n")
    assert [one.to for one in chart.failsafes] == [("down",)] * 3
    assert chart.land == "down"


def test_a_violated_invariant_takes_the_exit_of_its_kind_or_of_the_mission():
    text = """\
initial: g
targets: {t: {position: [1, 2, 3]}}
states:
  g: {kind: gps, behavior: {use: go_to, target: t}}
  h: {kind: gps, behavior: {use: go_to, target: home}, invariant: {holds: a, exit: land}}
  x: {kind: custom, invariant: {holds: a}}
  land: {kind: land}
"""
    states = chart_of(text).states
    exits = {name: (state.violated_to, state.tolerated) for name, state in states.items()}
    assert exits["g"] == ("hover", 1.0)
    assert exits["h"] == ("land", 1.0)
    assert exits["x"] == (None, 0.0)
    assert {name: state.target for name, state in states.items() if name} == {
        **{"g": "t", "h": None, "x": None, "land": None, "hover": None}
    }


TEXTS = """\
initial: x
dwell: 1.5
states:
  x:
    kind: custom
    entry: [{log: hello}, {raise: in}]
    exit: [{log: bye}]
    transitions:
      - to: y
        name: quick
        when: {any: [a, {not: b}]}
        for: 0.5
        after: 3
        event: go
        do: [{raise: e}]
      - {to: land, when: {hysteresis: a, enter: 1, exit: 0}, emergency: true}
  y: {kind: custom, dwell: 0}
  land: {kind: land}
"""


def test_everything_a_transition_says_is_carried_over():
    chart = chart_of(TEXTS)
    x = chart.states["x"]
    first, second = x.transitions
    assert first.text == "quick, when a or not b for 0.5 s, after 3 s, on go"
    assert (first.hold, first.after, first.events, first.patient) == (0.5, 3.0, ("go",), False)
    assert first.outputs == (Output("raise", "e"),)
    assert first.reads == ("a", "b")
    assert second.text == "when a from 1 until 0"
    assert second.reads == ("a from 1 until 0",)
    assert not second.patient
    assert (x.entry, x.exit) == (
        (Output("log", "hello"), Output("raise", "in")),
        (Output("log", "bye"),),
    )
    assert [chart.states[name].dwell for name in ("x", "y", "land")] == [1.5, 0.0, 1.5]


def test_a_chart_outputs_plain_strings_that_can_be_saved():
    chart = chart_of(TEXTS)
    x = chart.states["x"]
    said = [output.text for output in (*x.entry, *x.exit, *x.transitions[0].outputs)]
    for one in every_transition(chart):
        said += [*one.to, one.text, *one.reads, *one.events]
    assert {type(text) for text in said} == {str}


def test_a_chart_is_shared_by_many_flights_and_compiles_the_same_twice(example):
    first, second = (compile_mission(load(example, CATALOGUE), CATALOGUE) for _ in range(2))
    texts = [[(one.number, one.text) for one in every_transition(c)] for c in (first, second)]
    assert texts[0] == texts[1]
    assert [slot.name for slot in first.slots] == [slot.name for slot in second.slots]
    land = first.states["land"].behavior
    assert land.step(calm(), None).action is Action.LAND
