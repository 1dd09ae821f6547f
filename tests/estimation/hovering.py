"""A simulated flight for navigators that look down: take off to 2 m, then fly as commanded."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.messages import Action, Command, Observation, Setpoint
from missionkit.perception.camera_section import Camera
from missionkit.sim.ground_truth import TrueState
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.vehicle_parameters import (
    BaroModel,
    FlowModel,
    ImuModel,
    InnerAutopilotModel,
    MagnetometerModel,
    RangeModel,
    Sensors,
)
from missionkit.sim.world import World

QUIET_IMU = ImuModel(
    accel_noise=0, gyro_noise=0, accel_bias=0, gyro_bias=0, accel_walk=0, gyro_walk=0
)
QUIET = Sensors(
    imu=QUIET_IMU,
    baro=BaroModel(sd=0, drift_sd=0),
    magnetometer=MagnetometerModel(sd=0, hard_iron=0),
    flow=FlowModel(sd=(0, 0), scale=0, gyro_sd=0, gyro_bias=0, lost=0),
    range=RangeModel(sd=0),
)
LEGS = ((0.5, 0.0, 0.0), (0.0, 0.5, 0.0), (-0.5, 0.2, 0.0), (0.0, -0.5, -0.2))
HERE = Transform(IDENTITY, vec(0.0, 0.0, 0.0))


def world(sensors: Sensors = QUIET) -> World:
    return World(
        world="hall",
        sensors=sensors,
        autopilot=InnerAutopilotModel(velocity_sd=0.0),
        start_yaw_deg=50.0,
    )


def observed(
    seconds: float, sensors: Sensors = QUIET, seed: int = 1, *, still: bool = False
) -> Iterator[tuple[Observation, TrueState]]:
    """Rest, take off at 5 s, from 15 s on fly legs of 5 s; satellites are left out."""
    vehicle = SimulatedVehicle(world(sensors), Camera(use="none"), seed)
    for tick in range(1, round(seconds / 0.05) + 1):
        seen = replace(vehicle.advance(tick * 0.05), gnss=None)
        if tick == 100:
            vehicle.apply(Command(action=Action.ARM))
        elif tick == 102:
            vehicle.apply(Command(action=Action.TAKE_OFF, height=2.0))
        elif tick >= 300 and not still:
            leg = LEGS[(tick - 300) // 100 % len(LEGS)]
            vehicle.apply(Command(Setpoint(np.array(leg), 0.2)))
        yield seen, vehicle.truth


def through(
    navigator: Any,
    flight: Iterable[tuple[Observation, TrueState]],
    change: Callable[[Observation], Observation] = lambda seen: seen,
) -> tuple[Any, TrueState]:
    """Return the memory after a flight, and the truth then."""
    known, last = navigator.begin(), None
    for seen, truth in flight:
        known, last = navigator.propagate(known, change(seen)), truth
    assert last is not None
    return known, last
