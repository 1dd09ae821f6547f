"""A file as a state."""

from __future__ import annotations

from pathlib import Path

import pytest
from stepping import CATALOGUE, Walk

from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.semantics.chart_compiler import compile_mission

PART = """\
params: {pad: home, wait: 5.0}
variables: {passes: 0}
guards: {over: {use: flag, name: over}, ready: {all: [over, outside]}}
initial: near
states:
  near:
    kind: custom
    entry: [{assign: {passes: {add: 1}}}]
    transitions:
      - {to: low, when: ready}
      - {to: away, after: $wait}
      - {to: near, event: done.state.near, when: {in: near}}
  low:
    kind: gps
    behavior: {use: go_to, target: $pad, height: 2}
    transitions:
      - {to: [end], event: settled, do: [{assign: {passes: {copy: passes}}}]}
      - {to: near, when: {all: [{variable: passes, below: 3}, {not: over}]}}
  end: {final: true}
"""
MISSION = """\
missionkit: 1
mission: twice
dwell: 0
params: {long: 9.0}
targets: {north: {position: [1, 2, 0]}, south: {position: [3, 4, 0]}}
guards: {outside: {use: flag, name: outside}}
initial: first
states:
  first:
    include: charts/part.yaml
    with: {pad: north}
    transitions: [{to: second, when: done}]
  second:
    include: charts/part.yaml
    with: {pad: south, wait: $long}
    summary: the same again
    transitions: [{to: land, when: done}]
  away: {kind: custom}
  land: {kind: land}
"""


@pytest.fixture
def mission(tmp_path: Path) -> Mission:
    (tmp_path / "charts").mkdir()
    (tmp_path / "charts" / "part.yaml").write_text(PART)
    (tmp_path / "m.yaml").write_text(MISSION)
    return load(tmp_path / "m.yaml", CATALOGUE)


def test_names_of_the_file_get_the_states_name_in_front(mission: Mission):
    assert list(mission.by_name()) == [
        *("first", "first/near", "first/low", "first/end"),
        *("second", "second/near", "second/low", "second/end"),
        *("away", "land"),
    ]
    assert set(mission.guards) == {
        *("outside", "first/over", "first/ready", "second/over", "second/ready")
    }
    assert set(mission.variables) == {"first/passes", "second/passes"}
    near = mission.by_name()["second/near"].state.transitions
    assert [way.targets for way in near] == [("second/low",), ("away",), ("second/near",)]
    assert near[2].event == ("done.state.second/near",)


def test_parameters_are_those_of_the_state_that_includes(mission: Mission):
    tree = mission.by_name()
    pads = [tree[f"{name}/low"].state.behavior.plugin.target for name in ("first", "second")]
    waits = [tree[f"{name}/near"].state.transitions[1].after for name in ("first", "second")]
    assert (pads, waits) == (["north", "south"], [5.0, 9.0])


def test_places_are_in_the_file_that_was_included(mission: Mission):
    assert mission.by_name()["second/end"].state.place().line == 19
    assert mission.by_name()["second/end"].state.place().file.endswith("charts/part.yaml")
    assert [path.name for path in mission.included] == ["part.yaml", "part.yaml"]


def test_both_fly_one_after_the_other(mission: Mission):
    walk = Walk(compile_mission(mission, CATALOGUE))
    walk.tick("over", "outside")
    assert walk.state == "first/low"
    walk.tick("settled", "over")
    assert walk.state == "second/near"
    assert dict(walk.memory.variables) == {"first/passes": 1, "second/passes": 1}
    walk.run(9.2)
    assert walk.state == "away"


def test_files_include_files_beside_them(tmp_path: Path):
    (tmp_path / "outer.yaml").write_text(
        "initial: a\nstates: {a: {include: inner.yaml, transitions: [{to: out, event: go}]}}\n"
    )
    (tmp_path / "inner.yaml").write_text("initial: b\nstates: {b: {kind: custom}}\n")
    (tmp_path / "m.yaml").write_text(
        "missionkit: 1\nmission: m\ninitial: x\n"
        "states: {x: {include: outer.yaml}, out: {kind: land}}\n"
    )
    mission = load(tmp_path / "m.yaml", CATALOGUE)
    assert list(mission.by_name()) == ["x", "x/a", "x/a/b", "out"]
    assert mission.initial.to == ("x",)
