"""Sensors outside the kernels: fix, external pose, barometer, magnetometer, battery gauge.

Each is given the true state (see `kernel_layout`) and draws from its own stream.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from missionkit.geometry import Vec3, conjugate, exp, multiply, norm, normalised, rotate, vec
from missionkit.messages import Baro, Battery, ExternalPose, Gnss, Magnetometer
from missionkit.sim.kernel_layout import RATE, gauss_markov
from missionkit.sim.random_blocks import Normals
from missionkit.sim.vehicle_parameters import (
    BaroModel,
    BatteryModel,
    ExternalPoseModel,
    GnssModel,
    MagnetometerModel,
)


class Beat:
    """Says when something with a rate is due, in physics steps."""

    def __init__(self, rate: float) -> None:
        self.every = max(1, round(RATE / rate))
        self._next = self.every

    @property
    def next(self) -> int:
        """Physics step of the next beat."""
        return self._next

    def due(self, step: int) -> bool:
        """Tell whether the next beat has come by `step`; if so, wait for the one after."""
        if step < self._next:
            return False
        self._next = step - step % self.every + self.every
        return True


class GnssSensor:
    """Position and velocity; the correlated error is in its stationary state from the start."""

    def __init__(self, model: GnssModel, rng: np.random.Generator) -> None:
        self.beat = Beat(model.rate)
        self.latency = model.latency
        self._noise = Normals(rng, 9, 200)
        self._keep, self._kick = gauss_markov(
            model.drift_sd, model.drift_tau, self.beat.every / RATE
        )
        white = vec(model.horizontal_sd, model.horizontal_sd, model.vertical_sd)
        self._white = white
        self._velocity_sd = model.velocity_sd
        self._sd = np.sqrt(white**2 + model.drift_sd**2)
        self._drift = model.drift_sd * self._noise.take(1)[0, :3]

    def measure(self, at: float, x: Vec3, offset: Vec3) -> Gnss:
        """Return the fix valid at `at` (s); `offset` (3,), m, NED, is a fault's.

        Args:
            at: s.
            x: (13,) true state.
            offset: (3,), m, NED; zero without a fault.
        """
        noise = self._noise.take(1)[0]
        self._drift = self._keep * self._drift + self._kick * noise[6:]
        position = x[:3] + self._drift + self._white * noise[:3] + offset
        velocity = x[3:6] + self._velocity_sd * noise[3:6]
        return Gnss(at, position, velocity, self._sd, self._velocity_sd)


class ExternalPoseSensor:
    """Pose with white noise, from a system outside the vehicle."""

    def __init__(self, model: ExternalPoseModel, rng: np.random.Generator) -> None:
        self.beat = Beat(model.rate)
        self._model = model
        self._noise = Normals(rng, 6, 200)
        self._waiting: deque[ExternalPose] = deque()

    def expose(self, at: float, x: Vec3, *, lost: bool) -> None:
        """Measure the pose at `at` (s), which arrives later; nothing while `lost`.

        Args:
            at: s.
            x: (13,) true state.
            lost: by a fault.
        """
        model, noise = self._model, self._noise.take(1)[0]
        position = x[:3] + model.position_sd * noise[:3]
        attitude = normalised(multiply(x[6:10], exp(model.angle_sd * noise[3:])))
        sds = model.position_sd, model.angle_sd
        if not lost:
            self._waiting.append(ExternalPose(at, position, attitude, *sds))

    def deliver(self, now: float) -> ExternalPose | None:
        """Return the newest pose that has arrived by `now` (s), if any; older ones are lost."""
        newest: ExternalPose | None = None
        while self._waiting and self._waiting[0].at + self._model.latency <= now + 1e-9:
            newest = self._waiting.popleft()
        return newest


class BaroSensor:
    """Height with white noise and drift."""

    def __init__(self, model: BaroModel, rng: np.random.Generator) -> None:
        self.beat = Beat(model.rate)
        self._noise = Normals(rng, 2, 500)
        self._sd = model.sd
        self._keep, self._kick = gauss_markov(
            model.drift_sd, model.drift_tau, self.beat.every / RATE
        )
        self._drift = 0.0
        self._last: float | None = None  # m

    def measure(self, at: float, x: Vec3, *, stuck: bool) -> Baro:
        """Return the height at `at` (s); one that is `stuck` repeats the last.

        Args:
            at: s.
            x: (13,) true state.
            stuck: by a fault.

        Returns:
            m above the world's origin.
        """
        white, walk = self._noise.take(1)[0].tolist()
        self._drift = self._keep * self._drift + self._kick * walk
        if not stuck or self._last is None:
            self._last = -float(x[2]) + self._drift + self._sd * white
        return Baro(at, self._last)


class MagnetometerSensor:
    """Direction of the field in body axes, with constant hard iron."""

    def __init__(self, model: MagnetometerModel, rng: np.random.Generator) -> None:
        self.beat = Beat(model.rate)
        self._noise = Normals(rng, 3, 500)
        self._sd = model.sd
        dip = math.radians(model.inclination_deg)
        self._field = vec(math.cos(dip), 0.0, math.sin(dip))
        self._iron = model.hard_iron * self._noise.take(1)[0]

    def measure(self, at: float, x: Vec3) -> Magnetometer:
        """Return the unit field (FRD) at `at` (s)."""
        true = rotate(conjugate(x[6:10]), self._field)
        field = true + self._iron + self._sd * self._noise.take(1)[0]
        return Magnetometer(at, field / norm(field))


class BatteryGauge:
    """Charge left after the energy taken, and terminal voltage under load."""

    def __init__(self, model: BatteryModel) -> None:
        self.beat = Beat(1.0)
        self.sag = 0.0  # charge lost to a fault
        self._model = model
        self._joules = 3600.0 * model.capacity

    def charge(self, energy: float) -> float:
        """Return the charge, 0 to 1, after `energy` (J)."""
        return max(0.0, self._model.charge - energy / self._joules - self.sag)

    def measure(self, at: float, energy: float, power: float) -> Battery:
        """Return the reading at `at` (s) with `power` (W) being taken.

        Args:
            at: s.
            energy: taken so far, J.
            power: W.
        """
        charge = self.charge(energy)
        idle = 13.2 + 3.6 * charge  # V, four cells
        return Battery(at, charge, idle - self._model.resistance * power / idle)
