"""A class that satisfies the contract of its group is a plug-in, whatever it is derived from."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import pytest
from pydantic import BaseModel
from rehearsed import flown, short_stage

from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.plugin_groups import PLUGIN_GROUPS
from missionkit.engine.flight_end import FlightEnd
from missionkit.errors import FileError, UsageError
from missionkit.plugin import Plugin

FILE = Path(__file__).with_name("plugins_without_base.py")
FOUND = {
    "guards": {"high_enough", "high_for_long"},
    "behaviors": {"bare_climb"},
    "navigators": {"plain"},
    "detectors": {"blind"},
    "trackers": {"standing"},
    "planners": {"carefree"},
    "controllers": {"drifting"},
    "herding_policies": {"any_robot"},
}
MISSION = """\
navigation: plain
perception: [{use: blind, target: tree}]
tracking: standing
avoid: carefree
targets: {tree: {position: [30, 0, -3]}}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 3}, transitions: [{to: up, when: done}]}
  up:
    kind: gps
    behavior: {use: bare_climb, height: 6}
    transitions: [{to: wait, when: {use: high_enough, height: 5}}]
  wait: {kind: hover, transitions: [{to: land, when: {use: high_for_long, height: 4}}]}
  land: {kind: land}
"""


@pytest.fixture(scope="module")
def catalogue():
    return builtin().with_file(FILE)


@pytest.fixture(scope="module")
def flight(catalogue):
    return flown(short_stage(MISSION, catalogue=catalogue))


@pytest.mark.parametrize("group", PLUGIN_GROUPS)
def test_a_file_adds_plugins_of_every_group(group, catalogue):
    added = catalogue.group(group).keys() - builtin().group(group).keys()
    assert added == FOUND[group]
    assert not any(issubclass(catalogue.group(group)[kind], Plugin) for kind in added)


def test_a_mission_flies_with_all_of_them(flight):
    assert flight.result.flown.end is FlightEnd.LANDED
    assert flight.problems() == []
    assert [to for to, _ in flight.went()][-2:] == ["wait", "land"]
    assert flight.entered("land") - flight.entered("wait") > 3.0  # the dwell time is 2 s


@pytest.mark.parametrize(
    ("line", "says"),
    [
        (
            "    def region(self) -> None:\n        return None\n",
            "HighEnough lacks the method",
        ),
        (
            "    def targets(self) -> tuple[str, ...]:\n        return ()\n",
            "Climb lacks",
        ),
        ("    target: str\n", "Blind lacks the attribute target of a detector"),
        (
            "    def begin(self) -> None:\n        return None\n",
            "Carefree lacks the method begin",
        ),
        (
            "model_config = CONFIG\n",
            "needs model_config = ConfigDict(frozen=True, ",
        ),
    ],
)
def test_a_missing_member_is_named_with_its_place(line, says, tmp_path):
    text = FILE.read_text()
    assert line in text
    path = tmp_path / "mine.py"
    path.write_text(text.replace(line, "\n"))
    with pytest.raises(FileError) as error:
        builtin().with_file(path)
    assert says in str(error.value)
    number = int(str(error.value).split(":")[1])
    assert path.read_text().splitlines()[number - 1].startswith("class ")


class Two(BaseModel):
    """Could be a detector or a navigator."""

    model_config = {"frozen": True, "extra": "forbid", "allow_inf_nan": False}
    kind: ClassVar[str] = "two"
    target: str

    def detect(self, frame, camera, prior):
        return ()

    def build(self, surveyed, mount):
        return None


def test_a_class_that_fits_two_groups_is_not_guessed():
    with pytest.raises(UsageError, match="Two has the methods of a navigator and of a detector"):
        builtin().with_class(Two)


@pytest.mark.parametrize("it", [3, "text", int])
def test_a_class_that_is_not_a_model_is_refused_in_a_sentence(it):
    with pytest.raises(UsageError, match="is not a"):
        builtin().with_class(it)
