"""Compiling the simulator's kernels, or loading them from their cache, before a flight."""

from __future__ import annotations

from missionkit.perception.camera import Camera
from missionkit.sim.vehicle import SimulatedVehicle
from missionkit.sim.world import World


def warm_up() -> None:
    """Stand in an empty world for a moment, with every sensor on."""
    SimulatedVehicle(World(world="empty"), Camera(use="corners"), seed=0).advance(0.2)
