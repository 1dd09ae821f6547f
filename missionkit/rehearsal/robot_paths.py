"""Paths of simulated ground robots, for the picture of a run."""

from __future__ import annotations

from missionkit.recorder.scenery import RobotPath, Scenery
from missionkit.sim.herd_grading import DrivenPath
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.simulators import Simulated


def with_paths(scenery: Scenery, vehicle: Simulated) -> Scenery:
    """Return the scenery with the paths that ground robots drove, since the run was resumed.

    Args:
        scenery: of the world.
        vehicle: that was flown there.
    """
    if not isinstance(vehicle, SimulatedVehicle):
        return scenery
    return scenery._replace(paths=tuple(map(_robot_path, vehicle.herd.driven())))


def _robot_path(driven: DrivenPath) -> RobotPath:
    return RobotPath(driven.places, "obstacle" if driven.obstacle else "target", driven.end)
