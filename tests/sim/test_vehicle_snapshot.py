"""A vehicle that is saved and put back flies on as if nothing had happened, bit by bit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rehearsed import MISSIONS, plain

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.messages import Action, Command, Setpoint
from missionkit.recorder import value_codec
from missionkit.rehearsal.stage import world_of
from missionkit.sim.arena import ObstacleRobots, PlacedObstacle, PlacedRobot, Robots
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.vehicle_snapshot import restore, taken

FAULTS = ("gnss_drift@1+30", "battery_sag=0.1@6", "marker_hidden@flying:3+1", "camera_delayed@5+3")


def built(camera: str) -> SimulatedVehicle:
    mission = load(MISSIONS / "precision_task.yaml", builtin())
    eye = mission.camera.model_copy(update={"use": camera, "width": 160, "height": 120})
    world = world_of(mission, MISSIONS)
    robots = Robots(placed=tuple(PlacedRobot(at=(83.0, 12.0 + k)) for k in (-0.5, 0.1)))
    circling = ObstacleRobots(placed=(PlacedObstacle(at=(83.0, 14.0)),))
    parts = {"start": (80.0, 12.0), "robots": robots, "obstacle_robots": circling}
    world = world.model_copy(update=parts)  # before the marker
    return SimulatedVehicle(world, eye, 5, tuple(map(parse_fault, FAULTS)))


def flown(vehicle: SimulatedVehicle, first: int, last: int) -> list[Any]:
    """Take off, then fly forward; return all that was observed, and the truth."""
    seen = []
    for n in range(first, last):
        seen.append(plain(vehicle.advance(0.05 * n)))
        if n == 30:
            vehicle.apply(Command(action=Action.ARM))
        elif 40 <= n < 120:
            vehicle.apply(Command(action=Action.TAKE_OFF, height=2.5))
            vehicle.entered("flying", 0.05 * n)
        elif n >= 120:
            vehicle.apply(Command(Setpoint(np.array([0.1, 0.0, 0.0]), 0.05)))
    return [*seen, plain(vehicle.truth), plain(vehicle.robots)]


@pytest.mark.parametrize("camera", ["corners", "rendered", "none"])
@pytest.mark.parametrize("at", [10, 31, 130])  # 31: a command is on its way
def test_a_restored_vehicle_flies_on_bit_by_bit(camera, at):
    vehicle = built(camera)
    flown(vehicle, 1, at)
    saved = value_codec.written(taken(vehicle))
    rows = vehicle.track.rows.copy()
    other = built(camera)
    restore(other, value_codec.read(saved))
    other.track.restore(rows)
    assert not len(other.herd.times)
    assert flown(other, at, 180) == flown(vehicle, at, 180)
    assert plain(other.track.rows) == plain(vehicle.track.rows)


def test_a_snapshot_does_not_change_with_the_vehicle():
    vehicle = built("none")
    flown(vehicle, 1, 50)
    saved = taken(vehicle)
    text = value_codec.written(saved)
    flown(vehicle, 50, 100)
    assert value_codec.written(saved) == text
