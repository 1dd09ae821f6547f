"""Variables: what the chart counts and remembers."""

from __future__ import annotations

import pytest
from stepping import Walk

from missionkit.chart.model.variables import Variable
from missionkit.chart.semantics.actions_and_events import assigned, in_words, matches
from missionkit.chart.semantics.compiled_chart import Output

CHART = """\
initial: x
dwell: 0
variables:
  tries: {initial: 0, max: 2}
  height: 1.5
  word: red
  other: green
  seen: false
states:
  x:
    kind: logic
    entry: [{assign: {height: 2}}]
    transitions:
      - {event: count, do: [{assign: {tries: {add: 1}}}]}
      - {event: copy, do: [{assign: {word: {copy: other}}}, {assign: {seen: {toggle: true}}}]}
      - {to: land, event: error.execution}
      - to: y
        event: go
        when: {all: [{variable: word, equals: green}, {variable: seen, equals: true}]}
      - {to: z, event: go, when: {variable: height, above: 1.75}}
  y: {kind: logic}
  z: {kind: logic}
  land: {kind: land}
"""


def test_actions_change_variables_and_guards_compare_them():
    walk = Walk(CHART)
    walk.tick("copy", "go")
    assert walk.state == "y"
    assert walk.memory.variables == {
        **{"tries": 0, "height": 2.0, "word": "green", "other": "green", "seen": True}
    }


def test_a_text_that_is_not_equal_does_not_hold():
    walk = Walk(CHART)
    walk.tick("go")
    assert walk.state == "z"


def test_a_value_out_of_range_changes_nothing_and_is_reported():
    walk = Walk(CHART)
    walk.tick("count", "count")
    assert walk.memory.variables["tries"] == 2
    walk.tick("count")
    assert walk.memory.variables["tries"] == 2
    assert walk.state == "land"
    assert walk.problems == [(0.1, "assign tries: 3 is not a valid value of tries; it stays 2")]


@pytest.mark.parametrize(
    ("initial", "good", "bad"),
    [
        (0, [1, -5, 2**53], [1.5, True, "1", 2**53 + 1, float("nan")]),
        (0.5, [1, 2.5], [float("inf"), float("nan"), "1", False]),
        (False, [True], [0, 1, "true"]),
        ("a", ["b", ""], [1, True]),
    ],
)
def test_a_variable_keeps_its_type(initial, good, bad):
    variable = Variable(initial=initial)
    assert all(map(variable.admits, good))
    assert not any(map(variable.admits, bad))


def test_numbers_do_not_overflow():
    variables = {"n": Variable(initial=2.0**1023)}
    values, wrong = assigned(variables, {"n": 2.0**1023}, Output("assign", "n", "add", 2.0**1023))
    assert values == {"n": 2.0**1023}
    assert wrong.startswith("assign n: inf is not a valid value of n")


@pytest.mark.parametrize(
    ("described", "event", "heard"),
    [
        (("a",), "a", True),
        (("a",), "a.b.c", True),
        (("a",), "ab", False),
        (("a.b",), "a", False),
        (("*",), "anything", True),
        (("x", "a"), "a.b", True),
    ],
)
def test_an_event_is_matched_by_its_words(described, event, heard):
    assert matches(described, event) is heard


def test_an_output_is_described():
    records = [
        in_words(Output("assign", "n", operation, operand))
        for operation, operand in (("set", 3), ("add", 1), ("copy", "m"), ("toggle", True))
    ]
    assert records == ["assign n = 3", "assign n add 1", "assign n copy m", "assign n toggled"]


def test_a_text_may_be_one_of_few():
    rule = Variable(initial="safe", one_of=("safe", "bold"))
    assert rule.admits("bold")
    assert not rule.admits("rash")
    assert rule.described == "one of safe, bold"


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"initial": "sade", "one_of": ["safe", "bold"]}, "did you mean 'safe'"),
        ({"initial": 3, "one_of": ["safe"]}, "only a string has 'one_of'"),
    ],
)
def test_a_first_text_that_is_none_of_them_is_refused(given, says):
    with pytest.raises(ValueError, match=says):
        Variable.model_validate(given)
