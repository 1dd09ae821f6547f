"""Variables that give parameters of behaviours: checked at load, read at entry, kept meanwhile."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.chart.load import load, parse
from missionkit.chart.model.guard_expressions import use_text
from missionkit.engine.act import act
from missionkit.engine.behavior_parameters import ParameterizedMemory
from missionkit.engine.prepared_mission import begin, prepare
from missionkit.errors import FileError
from missionkit.messages import Battery, Estimate, Health
from missionkit.plugin_containment import Containment
from missionkit.recorder import value_codec

TEXT = """\
missionkit: 1
mission: steps
camera: {use: none}
variables:
  height: VARIABLE
initial: up
states:
  up:
    kind: idle
    behavior: {use: take_off, height: 5}
    transitions: [{to: climb, when: done}]
  climb:
    kind: custom
    behavior: {use: climb, height: {variable: height}, speed: 2}
    transitions:
      - {to: climb, event: more, do: [{assign: {height: {add: 5.0}}}]}
      - {to: land, when: done, for: 1}
  land: {kind: land}
"""
RANGE = "{initial: 2.0, min: 0, max: 3}"
HEIGHT, SPEED = "height: {variable: height}, speed: 2", "height: 9, speed: {variable: height}"
INNER = """\
variables: {height: {initial: 4.0, min: 1, max: 9}}
initial: over
states:
  over: {kind: custom, behavior: {use: climb, height: {variable: height}}}
"""
GOOD = "{initial: 10.0, min: 5, max: 30}"


def loaded(catalogue, variable=GOOD):
    return parse(TEXT.replace("VARIABLE", variable), "steps.yaml", catalogue)


@pytest.mark.parametrize(
    ("variable", "says"),
    [
        ("10.0", "needs 'min' and 'max'"),
        ("{initial: 10.0, min: 5}", "needs 'min' and 'max'"),
        ("high", "needs 'one_of'"),
        ("{initial: high, one_of: [high, low]}", "a number"),
        ("true", "height"),
    ],
)
def test_a_variable_that_could_be_wrong_is_refused(catalogue, variable, says):
    with pytest.raises(FileError) as caught:
        loaded(catalogue, variable)
    assert "height" in str(caught.value)
    assert says in str(caught.value)


def test_every_bound_is_tried(catalogue):
    with pytest.raises(FileError, match=r"with height = 0\.0, which its range allows: speed"):
        parse(TEXT.replace("VARIABLE", RANGE).replace(HEIGHT, SPEED), "steps.yaml", catalogue)


def test_an_unknown_variable_has_its_place_and_the_nearest_name(catalogue):
    with pytest.raises(FileError, match=r"unknown variable 'hight'.*height"):
        parse(
            TEXT.replace("VARIABLE", GOOD).replace("variable: height", "variable: hight"),
            "steps.yaml",
            catalogue,
        )


def seen(now, state="climb"):
    return Estimate(
        now=now,
        position=np.array([0.0, 0.0, -5.0]),
        velocity=np.zeros(3),
        attitude=np.array([1.0, 0.0, 0.0, 0.0]),
        rates=np.zeros(3),
        health=Health(True, False, now, None, 0.3, 0),
        battery=Battery(now, 0.9, 16.0),
        home=np.zeros(3),
        state=state,
    )


def test_the_value_at_the_entry_counts_until_the_state_is_left(catalogue):
    plan = prepare(loaded(catalogue), catalogue)
    acting = begin(plan).acting

    def height(acting, values, now):
        acting, _, step = act(plan, acting, seen(now), (), Containment(), "", values)
        return acting, -float(step.guidance.position[2])

    acting, first = height(acting, {"height": 12.0}, 1.0)
    acting, later = height(acting, {"height": 25.0}, 1.05)
    assert (first, later) == (12.0, 12.0)
    assert isinstance(acting.behavior, ParameterizedMemory)
    kept = value_codec.read(value_codec.written(acting.behavior))
    resumed, after = height(acting._replace(behavior=kept), {"height": 25.0}, 1.1)
    assert after == 12.0
    entered = resumed._replace(behavior=None, begun=False)
    assert height(entered, {"height": 25.0}, 1.15)[1] == 25.0


def test_in_an_included_file_it_is_the_variable_of_that_file(catalogue, tmp_path):
    (tmp_path / "inner.yaml").write_text(INNER)
    text = TEXT.replace("VARIABLE", GOOD).replace(
        "  land:", "  inner: {include: inner.yaml}\n  land:"
    )
    (tmp_path / "steps.yaml").write_text(text)
    mission = load(tmp_path / "steps.yaml", catalogue)
    assert mission.states["climb"].behavior.variables == (("height", "height"),)
    inner = mission.states["inner"].states["inner/over"].behavior
    assert inner.variables == (("height", "inner/height"),)
    assert inner.plugin.height == 4.0
    assert "height of the variable inner/height" in use_text(inner)
