"""A file as a state."""

from __future__ import annotations

from pathlib import Path

import pytest
from stepping import CATALOGUE, Walk

from missionkit.chart.load import load
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.errors import FileError

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


REQUIRING = """\
requirements:
  - {name: low-first, precedence: {enter: low}, before: {in: end}}
  - {name: not-long, response: {when: over, then: {in: away}, within: 5}, broken: {to: near}}
  - {name: stays, always: {not: {variable: passes, above: 3}}, while: outside, after: {enter: near}}
"""


def test_requirements_of_a_file_speak_of_its_own_states(tmp_path: Path):
    (tmp_path / "charts").mkdir()
    (tmp_path / "charts" / "part.yaml").write_text(PART + REQUIRING)
    deep = "initial: part\nstates:\n  part: {include: charts/part.yaml}\n"
    (tmp_path / "deep.yaml").write_text(deep)
    third = "  third: {include: deep.yaml}\n"
    own = "requirements: [{name: ends, existence: {in: land}}]\n"
    (tmp_path / "m.yaml").write_text(MISSION + third + own)
    mission = load(tmp_path / "m.yaml", CATALOGUE)
    names = [each.name for each in mission.requirements]
    assert names[:4] == ["ends", "first/low-first", "first/not-long", "first/stays"]
    assert names[-1] == "third/part/stays"
    at = {each.name: each for each in mission.requirements}
    low, long, stays = (at[f"third/part/{name}"] for name in ("low-first", "not-long", "stays"))
    assert [getattr(it, "state", "") for it in low.moments()] == [
        "third/part/low",
        "third/part/end",
    ]
    assert [str(ex.text(it)) for it in long.moments()] == ["part/over", "in away"]
    assert long.broken is not None
    assert long.broken.to == "third/part/near"
    assert [str(ex.text(it)) for it in stays.guards()] == ["not part/passes above 3", "outside"]


def test_requirements_of_a_file_are_a_list(tmp_path: Path):
    (tmp_path / "charts").mkdir()
    (tmp_path / "charts" / "part.yaml").write_text(PART + "requirements: {name: it}\n")
    (tmp_path / "m.yaml").write_text(MISSION)
    with pytest.raises(FileError, match="'requirements': expected a list"):
        load(tmp_path / "m.yaml", CATALOGUE)
