"""Random nested charts are always in a legal configuration, the one that SCXML says."""

from __future__ import annotations

import json
from itertools import pairwise
from random import Random

from hypothesis import Phase, given, note, settings
from hypothesis import strategies as st
from random_charts import COUNT, EVENTS, Data, lines, random_chart, walk
from reference_scxml import Interpreter, UnsettledError
from stepping import Walk

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.entry_exit_sets import Move
from missionkit.chart.semantics.macrostep import MOST_MICROSTEPS
from missionkit.chart.semantics.step import ChartMemory, Decision

CATALOGUE = builtin()
TICKS = 12
picks = st.builds(Random, st.integers(0, 2**32 - 1))
randomly = settings(
    deadline=None,
    max_examples=100,
    derandomize=True,
    database=None,
    phases=[Phase.generate],  # a smaller seed does not make a smaller chart
)


def noted(document: Data) -> Data:
    note(json.dumps(document))
    return document


def walk_of(document: Data) -> Walk:
    mission = parse(json.dumps(document), "random.yaml", CATALOGUE)
    return Walk(compile_mission(mission, CATALOGUE), status=None)


def heard(pick: Random) -> list[str]:
    return [pick.choice(EVENTS) for _ in range(pick.choice((0, 1, 1, 1, 2)))]


@given(picks)
@randomly
def test_the_configuration_is_legal(pick):
    document = noted(random_chart(pick))
    stepped = walk_of(document)
    for _ in range(TICKS):
        decision = stepped.tick(*heard(pick))
        check_memory(document, stepped.memory)
        for move in decision.moves:
            check_configuration(document, move.active)
            check_orders(document, move)
        if stepped.contain.take():
            return


@given(picks)
@randomly
def test_a_chart_goes_where_the_recommendation_says(pick):
    document = noted(random_chart(pick))
    stepped, decision = started(document)
    try:
        reference = Interpreter(document, MOST_MICROSTEPS)
        compare(reference, stepped, decision)
        for _ in range(TICKS):
            events = heard(pick)
            decision = stepped.tick(*events)
            reference.external_event(*events)
            compare(reference, stepped, decision)
    except UnsettledError:
        (problem,) = stepped.contain.take()
        assert problem.startswith("the chart does not come to rest within one tick")


def test_events_of_the_beginning_come_in_the_order_of_entry():
    say: Data = {"to": ["late"], "event": ["done.state.one"], "do": [{"log": "done came first"}]}
    wait: Data = {"to": ["late"], "event": ["r"], "do": [{"log": "r came first"}]}
    one = {"initial": {"to": ["f"]}, "states": {"f": {"final": True}}}
    two = {"kind": "logic", "entry": [{"raise": "r"}]}
    both = {"parallel": True, "transitions": [say, wait], "states": {"one": one, "two": two}}
    document = beginning("both", {"both": both, "late": {"kind": "logic"}})
    assert said(started(document)[1]) == ["done came first"]


def test_a_condition_sees_values_assigned_on_first_entry():
    counted: Data = {"to": ["end"], "when": {"variable": "count", "at_least": 1}}
    first = {"kind": "logic", "entry": [COUNT], "transitions": [counted]}
    document = beginning("first", {"first": first, "end": {"kind": "logic"}})
    assert started(document)[0].memory.active == ("end",)


def beginning(name: str, states: Data) -> Data:
    head = {"missionkit": 1, "mission": "small", "dwell": 0, "variables": {"count": 0}}
    return {**head, "initial": {"to": [name]}, "states": states}


def started(document: Data) -> tuple[Walk, Decision]:
    stepped = walk_of(document)
    return stepped, stepped.tick()


def compare(reference: Interpreter, stepped: Walk, decision: Decision) -> None:
    """Check that chart and reference stand, did and remember the same."""
    memory = stepped.memory
    assert list(memory.active) == reference.active()
    assert [name for move in decision.moves for name in move.exited] == reference.exited
    entered = [entry.name for move in decision.moves for entry in move.entries]
    assert entered == reference.entered
    assert said(decision) == reference.said
    assert memory.variables == reference.variables
    remembered = {name: list(each) for name, each in memory.history.items()}
    assert remembered == reference.history_value
    assert memory.ended is not reference.running
    assert not stepped.contain.take()


def said(decision: Decision) -> list[str]:
    outputs = [output for fired in decision.fired for output in fired.outputs]
    return [output.removeprefix("log ") for output in outputs if output.startswith("log ")]


def check_memory(document: Data, memory: ChartMemory) -> None:
    check_configuration(document, memory.active)
    assert set(memory.entered) == set(memory.active)
    assert memory.pilot == commanding(document, memory.active)


def check_configuration(document: Data, active: tuple[str, ...]) -> None:
    states = document["states"]
    order, around = dict(walk(states)), lines(states)
    assert list(active) == [name for name in order if name in active]
    assert len(set(active)) == len(active)
    assert len([name for name in states if name in active]) == 1
    for name in active:
        data, inside = order[name], order[name].get("states", {})
        assert "history" not in data
        assert set(around[name]) <= set(active)
        if data.get("parallel"):
            regions = {child for child, inner in inside.items() if "history" not in inner}
            assert regions <= set(active)
        elif inside:
            assert len([child for child in inside if child in active]) == 1


def check_orders(document: Data, move: Move) -> None:
    """States are left from the inside out and entered from the outside in."""
    places = {name: place for place, (name, _) in enumerate(walk(document["states"]))}
    left = [places[name] for name in move.exited]
    entered = [places[entry.name] for entry in move.entries]
    assert all(one > other for one, other in pairwise(left))
    assert all(one < other for one, other in pairwise(entered))
    assert {entry.name for entry in move.entries} <= set(move.active)


def commanding(document: Data, active: tuple[str, ...]) -> str:
    """Return the innermost active state with a behaviour, the first of two as deep."""
    around = lines(document["states"])
    able = [name for name, data in walk(document["states"]) if "behavior" in data]
    able = [name for name in able if name in active]
    return max(able, key=lambda name: len(around[name]), default="")
