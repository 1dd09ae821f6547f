"""A small chart to play with."""

from pathlib import Path

import missionkit
from missionkit.engine.prepared_mission import prepare
from missionkit.page.facts.mission_facts import FlownMission
from missionkit.page.play.play_source import PlaySource
from missionkit.recorder.scenery import Scenery

CHART = """\
missionkit: 1
mission: played
camera: {use: none}
targets: {pole: {position: [6, 0, -2]}}
fence: {north: [-20, 20], east: [-20, 20], height: 30}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.2}, to: home}
  - {name: fence, when: {not: inside_fence}, to: land}
  - {name: link, when: {use: link_lost, longer_than: 3}, unknown: ignore, to: land}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2}
    transitions: [{to: out, when: done}]
  out:
    kind: gps
    behavior: {use: go_to, target: pole}
    transitions:
      - {to: home, when: {use: within, of: pole, radius: 2}, for: 1.5}
      - {to: home, event: back}
  home:
    kind: return
    behavior: {use: go_to, target: home, height: 2}
    transitions: [{to: land, when: done}]
  land: {kind: land}
"""


def play_source(folder: Path) -> PlaySource:
    """Return the source of its page."""
    path = folder / "played.yaml"
    path.write_text(CHART)
    mission = missionkit.load(path)
    plan = prepare(mission.model, mission.catalogue)
    return PlaySource(FlownMission(mission.model, mission.catalogue, plan, Scenery()))
