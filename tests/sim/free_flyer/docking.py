"""A free flyer flown by hand: a small controller that knows the truth."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from missionkit.chart.model_file import load_model
from missionkit.geometry import conjugate, log, multiply, rotate
from missionkit.messages import Action, Command, Observation, Wrench
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.free_flyer.body_model import (
    AccelerometerModel,
    FlyerCamera,
    FlyerSensors,
    FreeFlyerBody,
    GyroModel,
    UwbModel,
)
from missionkit.sim.free_flyer.free_flyer import FreeFlyer
from missionkit.sim.free_flyer.world import FreeFlyerWorld

WORLD = load_model(
    Path(__file__).parents[3] / "missions" / "worlds" / "docking.yaml", FreeFlyerWorld
)
TICK = 0.05
PERFECT = FlyerSensors(
    gyro=GyroModel(noise=0, bias=0),
    accelerometer=AccelerometerModel(noise=0, bias=0),
    uwb=UwbModel(sd=0, outliers=0),
    camera=FlyerCamera(sd=0),
)


def changed(**parts: Any) -> FreeFlyerWorld:
    """Return the docking world with other parts, each a mapping of its keys."""
    return FreeFlyerWorld.model_validate({**WORLD.model_dump(), **parts})


def perfect(**parts: Any) -> FreeFlyerWorld:
    """Return the same without noise, and thrusters that open for any time at all."""
    body = FreeFlyerBody(minimum_pulse=0.0, latency=0.0)
    start = {"position": (0.0, 1.0, 0.0)}
    parts = {"sensors": PERFECT.model_dump(), "vehicle": body.model_dump(), "start": start, **parts}
    return changed(**parts)


class Hand:
    """Flies a free flyer and keeps what it observed."""

    def __init__(self, world: FreeFlyerWorld, *faults: str, seed: int = 1) -> None:
        self.flyer = FreeFlyer(world, seed, tuple(map(parse_fault, faults)))
        self.seen: list[Observation] = []

    def wait(self, seconds: float, command: Callable[[], Command | None] = lambda: None) -> None:
        first = round(self.flyer.now / TICK)
        for tick in range(first + 1, first + 1 + round(seconds / TICK)):
            self.seen.append(self.flyer.advance(tick * TICK))
            order = command()
            if order is not None:
                self.flyer.apply(order)

    def act(self, action: Action) -> None:
        self.flyer.apply(Command(action=action))
        self.wait(TICK)

    def arm(self) -> None:
        self.wait(1.2)
        self.act(Action.ARM)

    def push(self, force: Any, torque: Any, seconds: float) -> None:
        wanted = Command(setpoint=Wrench(np.array(force, float), np.array(torque, float)))
        self.flyer.apply(wanted)
        self.wait(seconds, lambda: wanted)

    def fly(self, place: Any, seconds: float, speed: float = 0.04, turn: Any = None) -> None:
        """Fly towards a place (m) and the docked attitude (or another), camera on."""
        aim = self.flyer.world.berth.pose.rotation if turn is None else turn

        def steer() -> Command:
            state = self.flyer.truth
            gap = 0.4 * (np.array(place) - state.position)
            gap *= min(1.0, speed / max(float(np.linalg.norm(gap)), 1e-9))
            force = rotate(conjugate(state.attitude), 2.0 * (gap - state.velocity))
            left = 0.5 * log(multiply(conjugate(state.attitude), aim))
            left *= min(1.0, 0.15 / max(float(np.linalg.norm(left)), 1e-9))
            return Command(setpoint=Wrench(force, 0.004 * (left - state.rates)), payload="camera")

        self.wait(seconds, steer)

    @property
    def events(self) -> list[str]:
        return [event for seen in self.seen for event in seen.events]

    def place(self, out: float, aside: float = 0.0) -> Any:
        """Return the place `out` of the docked one, along the docking axis (m)."""
        berth = self.flyer.world.berth
        across = rotate(berth.pose.rotation, np.array([1.0, 0.0, 0.0]))
        return berth.pose.translation + out * berth.normal + aside * across
