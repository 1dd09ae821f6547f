"""A vehicle that circles over the arena of ground robots, against real time."""

from __future__ import annotations

import math
from pathlib import Path
from statistics import median
from typing import Literal

from benchmarks.measure import Table, timed
from missionkit.geometry import vec
from missionkit.messages import Action, Command, Setpoint
from missionkit.perception.camera_section import Camera, Mount
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.simulators import simulated
from missionkit.sim.world_files import load_multicopter_world

WORLD = Path("missions/worlds/iarc7.yaml")
LENGTH = 60.0  # s
REPEATS = 3
TICK = 0.05  # s
Eyes = Literal["none", "corners", "rendered"]
NAMES: dict[Eyes, str] = {
    "none": "no camera",
    "corners": "boxes without images",
    "rendered": "rendered camera, 320x240 at 20 Hz",
}


def tables() -> list[Table]:
    """Time a minute of simulation with each kind of camera."""
    rows = [_row(eyes) for eyes in NAMES]
    note = (
        f"Medians of {REPEATS}. {LENGTH:g} s at 2.5 m with 14 robots in the world; x on one core: "
        "simulated time over processor time."
    )
    return [Table("Arena of ground robots", ("camera", "CPU, s", "x on one core"), rows, note)]


def _row(eyes: Eyes) -> tuple[str, ...]:
    cpu = median(timed(_circle, _flying(eyes, seed))[1].cpu for seed in range(REPEATS))
    return NAMES[eyes], f"{cpu:.2f}", f"{LENGTH / cpu:.0f}"


def _flying(eyes: Eyes, seed: int) -> SimulatedVehicle:
    """Return a vehicle that has taken off."""
    look = Mount(position=(0.0, 0.0, 0.0), tilt_deg=90.0)
    camera = Camera(use=eyes, width=320, height=240, focal=277.0, mount=look)
    vehicle = simulated(load_multicopter_world(WORLD), camera, seed, ())
    assert isinstance(vehicle, SimulatedVehicle)  # noqa: S101 - of a multicopter's world
    vehicle.advance(1.2)
    vehicle.apply(Command(action=Action.ARM))
    vehicle.advance(1.3)
    vehicle.apply(Command(action=Action.TAKE_OFF, height=2.5))
    vehicle.advance(5.0)
    return vehicle


def _circle(vehicle: SimulatedVehicle) -> None:
    for tick in range(1, round(LENGTH / TICK) + 1):
        turn = 0.01 * tick
        vehicle.apply(Command(Setpoint(vec(math.cos(turn), math.sin(turn), 0.0), 0.0)))
        vehicle.advance(5.0 + TICK * tick)
