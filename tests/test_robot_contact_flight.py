"""A robot that is found, followed and turned round, by what the camera shows; the truth judges."""

from __future__ import annotations

import math

import pytest
from rehearsed import MISSIONS

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.ground_robot import GroundRobot
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage
from missionkit.sim.arena import PlacedRobot, Robots
from missionkit.sim.ground_robots import EAST, HEADING, NORTH, SPIN_LEFT
from missionkit.sim.world_files import load_multicopter_world

MISSION = """\
missionkit: 1
mission: turn-it
camera: {use: corners, width: 320, height: 240, focal: 277, mount: {tilt_deg: 90}}
perception: [blob]
tracking: {use: tracker, lost_after: 3}
avoid: none
control: {limits: {speed: 2.13, acceleration: 3.05}}
initial: up
states:
  up: {kind: idle, behavior: {use: take_off, height: 2}, transitions: [{to: follow, when: done}]}
  follow:
    kind: custom
    behavior: shadow
    transitions:
      - {to: meet, when: {use: target_mode, target: tracked, mode: straight, at_least: 0.9}, for: 2}
      - {to: land, after: 30}
  meet:
    kind: custom
    behavior: METHOD
    transitions: [{to: land, when: done}, {to: land, after: 9}]
  land: {kind: land}
"""


@pytest.mark.parametrize(("method", "turn"), [("land_in_front", 180.0), ("touch_top", 45.0)])
def test_a_robot_is_turned_round(method, turn):
    catalogue = builtin()
    mission = parse(MISSION.replace("METHOD", method), "turn.yaml", catalogue)
    world = load_multicopter_world(MISSIONS / "worlds" / "one_robot.yaml")
    alone = Robots(placed=(PlacedRobot(at=(-2.0, 0.8), reversal=20.0),), plates=(225,))
    ready = stage(mission, catalogue, world.model_copy(update={"robots": alone}), 5)
    rows = []

    def watch(record, _):
        robot, here = ready.vehicle.robots[0], ready.vehicle.truth.position
        gap = math.hypot(robot[NORTH] - here[0], robot[EAST] - here[1])
        rows.append((record.now, record.state, math.degrees(robot[HEADING]), gap, -here[2]))

    result = rehearse(ready, (watch,))
    assert result.succeeded
    met = [row for row in rows if row[1] == "meet"]
    assert met[-1][0] - met[0][0] < 8.9  # it was done, and did not give up
    robot = ready.vehicle.robots[0]
    turns_to = math.degrees(robot[HEADING] + GroundRobot().spin_rate * robot[SPIN_LEFT])
    assert turns_to - met[0][2] == pytest.approx(turn, abs=30.0)  # and random turns
    begun = next(row for row in rows if row[0] > met[0][0] and row[2] > met[0][2] + 20.0)
    assert begun[3] < 0.45
    assert begun[4] < 0.15
