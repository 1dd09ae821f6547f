"""The flying part of the simulator: state, kernels and the actions that a free flyer knows.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.docking_geometry import pose_error, turned
from missionkit.geometry import Mat, Vec3, exp, multiply, norm, normalised
from missionkit.messages import Action, Wrench
from missionkit.sim.free_flyer import flyer_layout as at
from missionkit.sim.free_flyer.flyer_steps import fly
from missionkit.sim.free_flyer.nozzle_allocation import NOZZLES, thrusts_for
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from missionkit.sim.kernel_layout import HOLD, IMU_EVERY, LAND, RATE
from missionkit.sim.random_blocks import Normals

READY_AFTER = 1.0  # s, its sensors have settled
HOLDING_SPEED = 0.002  # m/s, relative velocity of holding clear
STEADY_RATE = math.radians(0.2)  # rad/s


class FlyerPlant:
    """Body, thrusters, contact, inertial unit and radio, advanced together by one kernel."""

    def __init__(self, world: FreeFlyerWorld, rngs: dict[str, np.random.Generator]) -> None:
        self.step = 0
        self.state = np.zeros(13)
        self.memory = np.zeros(at.SIZE)
        self._world = world
        self._body, self._dock = at.flyer_constants(world), at.dock_constants(world)
        self._berth = world.berth
        self._imu = Normals(rngs["imu"], 9)
        self._uwb = Normals(rngs["uwb"], 3)
        self._place(rngs["start"].standard_normal(6))
        self.memory[at.DUE_AT] = self.memory[at.CLEARANCE] = math.inf
        biases, sensors = self._imu.take(1)[0], world.sensors
        self.memory[at.ACCEL_BIAS : at.ACCEL_BIAS + 3] = sensors.accelerometer.bias * biases[:3]
        self.memory[at.GYRO_BIAS : at.GYRO_BIAS + 3] = sensors.gyro.bias * biases[3:6]

    def _place(self, noise: Vec3) -> None:
        start = self._world.start
        turn = exp(math.radians(start.attitude_sd_deg) * noise[3:])
        self.state[:3] = np.array(start.position) + start.position_sd * noise[:3]
        self.state[6:10] = normalised(multiply(turned(start.attitude_deg), turn))

    @property
    def now(self) -> float:
        """Simulated time (s)."""
        return self.step / RATE

    @property
    def range_period(self) -> float:
        """Time (s) between ranges."""
        return self._body.range_every / RATE

    @property
    def first_range(self) -> int:
        """Number of the next range, the first one is 1."""
        return self.step // self._body.range_every + 1

    @property
    def mode(self) -> int:
        """One of `kernel_layout.HOLD`, OFFBOARD and LAND."""
        return int(self.memory[at.MODE])

    @property
    def armed(self) -> bool:
        """Whether the thrusters are enabled."""
        return bool(self.memory[at.ARMED])

    @property
    def crashed(self) -> bool:
        """Whether it has touched the target where or faster than it may."""
        return bool(self.memory[at.CRASHED])

    @property
    def ready(self) -> bool:
        """Whether it would arm."""
        return self.now >= READY_AFTER and not self.crashed

    @property
    def captured(self) -> bool:
        """Whether the docking mechanism can take hold."""
        x, hold = self.state, self._world.capture
        position, attitude = pose_error(self._berth, x[:3], x[6:10])
        return bool(
            position <= hold.position
            and attitude <= math.radians(hold.attitude_deg)
            and norm(x[3:6]) <= hold.speed
            and norm(x[10:13]) <= math.radians(hold.rate_deg)
        )

    @property
    def holding_clear(self) -> bool:
        """Whether it is outside the keep-out sphere and does not move relative to the target."""
        x = self.state
        far = norm(x[:3] - self._dock.target) > self._world.keep_out
        return bool(far and norm(x[3:6]) < HOLDING_SPEED and norm(x[10:13]) < STEADY_RATE)

    def advance(self, stop: int, health: Vec3, rare: float) -> tuple[Mat, Mat]:
        """Fly to physics step `stop`; return inertial samples (n, 6) and ranges (k, 2).

        Args:
            stop: number of steps since the start.
            health: (10,) share of its thrust that each nozzle gives.
            rare: normal number below which a range is an outlier.
        """
        every = self._body.range_every
        heard = stop // every - self.step // every if len(self._body.anchors) else 0
        samples, ranges = fly(
            self.state,
            self.memory,
            self.step,
            stop,
            health,
            rare,
            self._body,
            self._dock,
            self._imu.take(stop // IMU_EVERY - self.step // IMU_EVERY),
            self._uwb.take(heard),
        )
        self.step = stop
        return samples, ranges

    def tell(self, wrench: Wrench) -> None:
        """Send a wrench; one still on its way is overtaken."""
        memory, due = self.memory, self.now + self._world.vehicle.latency
        wanted = thrusts_for(self._world.vehicle, wrench.force, wrench.torque)
        memory[at.DUE : at.DUE + NOZZLES] = wanted
        memory[at.DUE_AT] = min(due, memory[at.DUE_AT])

    def order(self, action: Action) -> bool:
        """Carry out an action now; return whether it was accepted.

        ARM enables the thrusters. DISARM is accepted in a safe end alone: where the docking
        mechanism takes hold, or outside the keep-out sphere without relative velocity. HOLD and
        LAND stop thrusting until the next wrench. It cannot take off or return by itself.
        """
        if action is Action.ARM:
            return self._arm()
        if action is Action.DISARM:
            return self._disarm()
        if not self.armed or action not in {Action.HOLD, Action.LAND}:
            return False
        self._idle(HOLD if action is Action.HOLD else LAND)
        return True

    def _arm(self) -> bool:
        if self.ready:
            self.memory[at.ARMED], self.memory[at.DOCKED] = 1.0, 0.0
        return self.ready

    def _disarm(self) -> bool:
        docks = self.captured
        safe = not self.crashed and (docks or self.holding_clear)
        if safe:
            self.memory[at.ARMED] = 0.0
            self.memory[at.DOCKED] = float(docks)
            self._idle(HOLD)
        return safe

    def _idle(self, mode: int) -> None:
        self.memory[at.MODE] = mode
        self.memory[at.DUE_AT] = math.inf  # a wrench sent before must not undo the action
        self.memory[at.SAVED : at.SAVED + NOZZLES] = 0.0
