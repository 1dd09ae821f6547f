from __future__ import annotations

import pytest

from missionkit.chart.text.parameter_expansion import Expanded, expand
from missionkit.chart.text.yaml_reader import read
from missionkit.errors import Place


def expanded(text: str, **overrides: str) -> Expanded:
    return expand(read(text, "m.yaml"), overrides)


def test_a_parameter_replaces_whole_values_and_keeps_their_place():
    found = expanded("params: {v: 2, p: [1, 2]}\na: $v\nb: [$v, x$v]\nc: {d: $p}\n")
    assert found.problems == ()
    assert {key: found.data[key] for key in "abc"} == {"a": 2, "b": [2, "x$v"], "c": {"d": [1, 2]}}
    assert found.data.value_places["a"] == Place("m.yaml", 2, 4)
    assert found.origins[Place("m.yaml", 2, 4)] == "v"


def test_the_command_line_overrides_in_yaml():
    found = expanded("params: {v: 2}\na: $v\n", v="[1, no, 0x10]")
    assert found.data["a"] == [1, "no", 16]
    assert found.data["params"] == {"v": [1, "no", 16]}


def test_two_dollars_stand_for_one():
    assert expanded("a: $$v\nb: $ 5\n").data == {"a": "$v", "b": "$ 5"}


@pytest.mark.parametrize(
    ("text", "overrides", "message"),
    [
        (
            "params: {cruise: 2}\na: $cruse\nb: $cruise\n",
            {},
            "m.yaml:2:4: unknown parameter $cruse; did you mean 'cruise'? Known: cruise",
        ),
        ("a: $v\n", {}, "m.yaml:1:4: unknown parameter $v; none are known here"),
        (
            "params: {v: 2}\na: 1\n",
            {},
            "m.yaml:1:10: parameter 'v' is never used; write $v where it belongs",
        ),
        (
            "x: 1\nparams: {v: 2}\na: $v\n",
            {"w": "1"},
            "m.yaml:2:1: --set w: no such parameter; known: v",
        ),
        ("params: {v: 2}\na: $v\n", {"v": ""}, "m.yaml:1:1: --set v=: no value"),
        (
            "params: {v: 2}\na: $v\n",
            {"v": ".nan"},
            "m.yaml:1:1: --set v=.nan: .nan is not a finite number",
        ),
        (
            "params: {v: $w, w: 1}\na: [$v, $w]\n",
            {},
            "m.yaml:1:13: parameter 'v' cannot be another parameter, $w",
        ),
    ],
)
def test_mistakes(text: str, overrides: dict[str, str], message: str):
    assert [str(problem) for problem in expanded(text, **overrides).problems] == [message]
