from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from missionkit.messages import Action, Command, Observation, Setpoint
from missionkit.perception.camera_section import Camera
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.vehicle_parameters import (
    BaroModel,
    GnssModel,
    ImuModel,
    InnerAutopilotModel,
    MagnetometerModel,
    ScanModel,
    Sensors,
)
from missionkit.sim.world import World

TICK = 0.05


class Pilot:
    """Flies a simulated vehicle by hand and keeps what it observed."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self.vehicle = vehicle
        self.seen: list[Observation] = []

    def wait(self, seconds: float, command: Command | None = None) -> None:
        first = round(self.vehicle.now / TICK)
        for tick in range(first + 1, first + 1 + round(seconds / TICK)):
            self.seen.append(self.vehicle.advance(tick * TICK))
            if command is not None:
                self.vehicle.apply(command)

    def act(self, action: Action, height: float | None = None) -> None:
        self.vehicle.apply(Command(action=action, height=height))
        self.wait(TICK)

    def rise(self, height: float = 3.0) -> None:
        self.wait(1.2)
        self.act(Action.ARM)
        self.act(Action.TAKE_OFF, height)
        self.wait(height / 1.5 + 6.0)

    def fly(self, velocity: tuple[float, float, float], seconds: float, spin: float = 0.0) -> None:
        self.wait(seconds, Command(setpoint=Setpoint(np.array(velocity), spin)))

    @property
    def events(self) -> list[str]:
        return [event for seen in self.seen for event in seen.events]


@pytest.fixture
def perfect() -> World:
    """No wind, no noise."""
    return World(
        world="perfect",
        autopilot=InnerAutopilotModel(velocity_sd=0.0, drift=0.0),
        sensors=Sensors(
            imu=ImuModel(
                accel_noise=0, gyro_noise=0, accel_bias=0, gyro_bias=0, accel_walk=0, gyro_walk=0
            ),
            gnss=GnssModel(horizontal_sd=0, vertical_sd=0, drift_sd=0, velocity_sd=0),
            baro=BaroModel(sd=0, drift_sd=0),
            magnetometer=MagnetometerModel(sd=0, hard_iron=0),
            scan=ScanModel(sd=0),
        ),
    )


@pytest.fixture
def pilot() -> Callable[..., Pilot]:
    def make(world: World, *faults: str, seed: int = 1, use: str = "none", **lens: float) -> Pilot:
        camera = Camera.model_validate({"use": use, **lens})
        return Pilot(SimulatedVehicle(world, camera, seed, tuple(map(parse_fault, faults))))

    return make


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20)
