"""A free flyer that exists only here: body, thrusters, sensors, target, faults.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from statistics import NormalDist

import numpy as np
from typing_extensions import override

from missionkit.errors import VehicleError
from missionkit.geometry import Mat
from missionkit.messages import (
    NO_CYCLE,
    Action,
    AnchorRange,
    Command,
    Imu,
    Observation,
    VehicleStatus,
    Wrench,
)
from missionkit.sim import kernel_layout
from missionkit.sim.fault_injection import Fault, InjectedFaults, refuse_foreign
from missionkit.sim.free_flyer import flyer_layout as at
from missionkit.sim.free_flyer.feature_camera import FeatureCamera
from missionkit.sim.free_flyer.flyer_plant import FlyerPlant
from missionkit.sim.free_flyer.nozzle_allocation import NOZZLES
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from missionkit.sim.ground_truth import TrueTrack
from missionkit.sim.random_blocks import streams
from missionkit.sim.sensor_inbox import Inbox
from missionkit.sim.sensors import BatteryGauge, Beat
from missionkit.sim.simulated_port import STRETCH, SimulatedPort

RANDOM_STREAMS = ("start", "imu", "uwb", "camera")
CAMERA_PAYLOAD = "camera"
"""Payload that switches the camera on while a command names it."""


class FreeFlyer(SimulatedPort):
    """A simulated free flyer behind the port `Vehicle`; two runs with one seed are bit-identical.

    Time passes only in `advance`. It flies a `Wrench`, exerted from `latency` after the command
    until the next. It has no inner loop: without a wrench it stops thrusting and drifts.

    Args:
        world: body, anchors, target, sensors.
        seed: of all randomness; every sensor has its own stream.
        faults: what goes wrong, and when.

    Raises:
        UsageError: a fault that a free flyer does not have.
    """

    def __init__(self, world: FreeFlyerWorld, seed: int, faults: Sequence[Fault] = ()) -> None:
        refuse_foreign(faults, world.FAULTS, world.VEHICLE)
        rngs = streams(seed, RANDOM_STREAMS)
        self.world = world
        self.track = TrueTrack()
        self.payload: str | None = None  # actuator that is on
        self._injected = InjectedFaults(tuple(faults), {})
        self._plant = FlyerPlant(world, rngs)
        self._camera = FeatureCamera(world, rngs["camera"])
        self._gauge = BatteryGauge(world.battery)
        self._heartbeat = Beat(5.0)
        self._orders: deque[tuple[int, Action]] = deque()
        self._cycle = NO_CYCLE
        self._anchors = tuple(world.anchors)
        self._inbox = Inbox()
        self._remember()

    @property
    def now(self) -> float:
        """Simulated time (s)."""
        return self._plant.now

    @property
    def ready(self) -> bool:
        """Whether it would arm."""
        return self._plant.ready

    @property
    def impulse(self) -> float:
        """N·s so far, the integral of the force's size."""
        return float(self._plant.memory[at.IMPULSE])

    @property
    def gas(self) -> float:
        """N·s so far, the integral of all nozzles' thrusts: what the tank gave."""
        return float(self._plant.memory[at.GAS])

    @override
    def apply(self, command: Command) -> None:
        """Send a command; it arrives `latency` later.

        Without setpoint and action it stops thrusting. TAKE_OFF and RETURN are refused, as is
        DISARM outside a safe end, which events say.

        Raises:
            VehicleError: the setpoint is not a finite wrench.
        """
        self.payload = command.payload
        action, wanted = command.action, command.setpoint
        if action is None and wanted is None and self._plant.mode == kernel_layout.OFFBOARD:
            action = Action.HOLD
        if action is not None:
            due = self.now + self.world.vehicle.latency
            step = max(self._plant.step + 1, round(due * kernel_layout.RATE))
            self._orders.append((step, action))
        if wanted is not None:
            if not isinstance(wanted, Wrench):
                raise VehicleError(
                    f"a free flyer flies a wrench, not a {type(wanted).__name__}: "
                    "its control needs use: lqr"
                )
            if not np.isfinite((wanted.force, wanted.torque)).all():
                raise VehicleError("a wrench with a number that is not finite")
            self._plant.tell(wanted)

    @override
    def advance(self, until: float) -> Observation:
        """Fly to mission time `until` (s) and return all that arrived on the way."""
        target = round(until * kernel_layout.RATE)
        while self._plant.step < target:
            stop = min(target, self._plant.step + STRETCH, self._camera.beat.next)
            if self._orders:
                stop = min(stop, max(self._orders[0][0], self._plant.step + 1))
            self._fly(stop)
            self._obey()
            self._expose()
            self._telemetry()
            self._remember()
        return self._delivered(until)

    def _delivered(self, now: float) -> Observation:
        self._cycle = self._injected.load(now, self._cycle)
        box, self._inbox = self._inbox, Inbox()
        return Observation(
            now=now,
            imu=tuple(box.imu),
            battery=box.battery,
            status=box.status,
            events=tuple(box.events),
            cycle=self._cycle,
            ranges=tuple(box.ranges),
            features=tuple(box.features),
            utc=self.utc(now),
        )

    def _fly(self, stop: int) -> None:
        plant, faults, now = self._plant, self._injected, self.now
        imu, uwb = plant.step // kernel_layout.IMU_EVERY + 1, plant.first_range
        many = faults.since("uwb_outliers", now)
        share = self.world.sensors.uwb.outliers if many is None else many[0]
        samples, ranges = plant.advance(stop, self._health(now), _quantile(share))
        off = faults.since("gyro_biased", now)
        if off is not None:
            samples[:, 3] += off[0]
        period = kernel_layout.IMU_EVERY / kernel_layout.RATE
        self._inbox.imu += [
            Imu((imu + n) * period, row[:3], row[3:]) for n, row in enumerate(samples)
        ]
        if not faults.active("uwb_lost", now):
            period = plant.range_period
            self._inbox.ranges += [
                AnchorRange((uwb + n) * period, self._anchors[int(which)], distance)
                for n, (which, distance) in enumerate(ranges.tolist())
            ]

    def _health(self, now: float) -> Mat:
        """Return the share of its thrust that each nozzle gives, (10,)."""
        weak = self._injected.since("nozzle_weak", now)
        health = np.full(NOZZLES, 1.0 if weak is None else weak[0])
        for nozzle in self._injected.values("nozzle_stuck", now):
            health[int(nozzle) - 1] = 0.0
        return health

    def _obey(self) -> None:
        while self._orders and self._orders[0][0] <= self._plant.step:
            _, action = self._orders.popleft()
            if not self._plant.order(action):
                self._inbox.events.append(f"{action}_refused")

    def _expose(self) -> None:
        if self._camera.beat.due(self._plant.step):
            on = self.payload == CAMERA_PAYLOAD and not self._injected.active(
                "camera_off", self.now
            )
            frozen = self._injected.active("camera_frozen", self.now)
            seen = self._camera.measure(self.now, self._plant.state, on=on, frozen=frozen)
            if seen is not None:
                self._inbox.features.append(seen)

    def _telemetry(self) -> None:
        plant, now = self._plant, self.now
        sag = self._injected.since("battery_sag", now)
        self._gauge.sag = max(self._gauge.sag, sag[0] if sag else 0.0)
        battery, heartbeat = self._gauge.beat.due(plant.step), self._heartbeat.due(plant.step)
        if self._injected.active("link_lost", now):
            return
        if battery:
            self._inbox.battery = self._gauge.measure(now, self._energy, self.world.vehicle.power)
        if heartbeat:
            mode = kernel_layout.MODES[plant.mode]
            self._inbox.status = VehicleStatus(now, plant.armed, plant.armed, plant.ready, mode)

    @property
    def _energy(self) -> float:
        return self.world.vehicle.power * self.now

    def _remember(self) -> None:
        plant = self._plant
        rest = (
            float(not plant.armed),
            float(plant.armed),
            float(plant.mode),
            float(plant.crashed),
            self._gauge.charge(self._energy),
            float(plant.memory[at.CLEARANCE]),
            self._energy,
        )
        self.track.add(self.now, plant.state, rest)


def _quantile(share: float) -> float:
    """Return the normal number that a share of them is below."""
    if share <= 0.0 or share >= 1.0:
        return -math.inf if share <= 0.0 else math.inf
    return NormalDist().inv_cdf(share)
