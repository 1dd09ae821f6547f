from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError

from missionkit.behaviors.go_to import GoTo
from missionkit.behaviors.hold import Hold
from missionkit.chart.load import load, parse
from missionkit.chart.model.actions import Log, Raise
from missionkit.chart.model.guard_expressions import Named, Use
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import Place
from missionkit.guards.state_progress import Done

SMALLEST = """\
missionkit: 1
mission: smallest
initial: idle
states:
  idle:
    kind: idle
    transitions:
      - {to: land, when: done, for: 2, do: [{log: bye}, {raise: over}]}
  land: {kind: land}
"""


@pytest.fixture
def smallest(catalogue: Catalogue) -> Mission:
    return parse(SMALLEST, "m.yaml", catalogue)


def test_the_example_is_a_mission(example: Path, catalogue: Catalogue):
    mission = load(example, catalogue)
    assert list(mission.states) == ["idle", "gps", "visual", "search", "task", "return", "land"]
    assert mission.params["cruise"] == 5.0
    gps = mission.states["gps"]
    assert gps.behavior.plugin == GoTo(target="trunk", standoff=(6.0, 0.0, 0.0), speed=5.0)
    assert gps.transitions[1].after == 120
    assert mission.failsafes[0].place() == Place(str(example), 22, 5)
    assert mission.camera.focal == 554


def test_omitted_keys_have_their_defaults(smallest: Mission):
    assert smallest.dwell == 2.0
    assert smallest.settings.rate == 20.0
    assert smallest.navigation.kind == "visual_inertial_ekf"
    assert smallest.avoid is not None
    assert smallest.avoid.kind == "potential_field"
    assert smallest.success == ()


def test_a_state_without_behavior_has_its_kinds(smallest: Mission):
    assert smallest.states["idle"].behavior == Use("hold", Hold(), Place("m.yaml", 6, 11))


def test_a_transition_knows_its_place_in_the_file(smallest: Mission):
    (transition,) = smallest.states["idle"].transitions
    assert transition.when == Use("done", Done(), Place("m.yaml", 8, 26))
    assert transition.for_ == 2.0
    assert transition.do == (
        Log("bye", Place("m.yaml", 8, 45)),
        Raise("over", Place("m.yaml", 8, 57)),
    )
    assert transition.place() == Place("m.yaml", 8, 9)
    assert transition.place("to") == Place("m.yaml", 8, 14)
    assert transition.place("after") == transition.place()


def test_a_named_guard_hides_a_plugin_of_that_name(catalogue: Catalogue):
    text = SMALLEST + "guards: {done: {not: ready}}\n"
    (transition,) = parse(text, "m.yaml", catalogue).states["idle"].transitions
    assert transition.when == Named("done", Place("m.yaml", 8, 26))


def test_avoidance_can_be_switched_off(catalogue: Catalogue):
    assert parse(SMALLEST + "avoid: none\n", "m.yaml", catalogue).avoid is None


def test_a_mission_cannot_be_changed(smallest: Mission):
    with pytest.raises(ValidationError, match="frozen"):
        smallest.dwell = 0.0
