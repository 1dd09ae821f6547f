"""Compiling the simulator's kernels, or loading them from their cache, before a flight."""

from __future__ import annotations

from functools import cache

from missionkit.perception.camera_section import Camera
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import World


@cache
def warm_up(*, corners: bool) -> None:
    """Stand in an empty world for a moment, with every sensor on; `corners`: the camera as well."""
    camera = Camera(use="corners" if corners else "none")
    SimulatedVehicle(World(world="empty"), camera, seed=0).advance(0.2)
