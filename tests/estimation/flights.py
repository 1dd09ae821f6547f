"""A flight with a known truth, and sensors whose noise is exactly what the filter assumes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.geometry import (
    Transform,
    conjugate,
    exp,
    from_euler,
    from_matrix,
    log,
    multiply,
    rotate,
    vec,
)
from missionkit.messages import Baro, Detection, Gnss, Imu, Magnetometer, Observation, Sighting

RATE, TICK = 100, 0.05
GRAVITY = vec(0.0, 0.0, 9.80665)
FIELD = vec(math.cos(1.0), 0.0, math.sin(1.0))  # world, 57 deg of dip
FORWARD = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # camera to body
MOUNT = Transform(from_matrix(FORWARD), vec(0.1, 0.0, 0.05))
TRUNK = Transform(from_euler(0.1, 0.2, 0.3), vec(12.0, 2.0, -3.0))  # marker to world
FIX_SD, VELOCITY_SD = vec(0.5, 0.5, 0.8), 0.1
QUIET = VisualInertialEkf(
    accel_bias_walk=0.0, gyro_bias_walk=0.0, target_walk=0.0, fix_drift_sd=0.0, mag_sd=0.05
)


def position(t: float) -> np.ndarray:
    """Rest until 3 s, then an ever stronger figure around 4 m height."""
    s = max(t - 3.0, 0.0)
    ramp = s**3 / (s**3 + 20.0)
    return ramp * vec(5 * math.sin(0.5 * s), 4 * math.sin(0.8 * s), -4 + math.sin(0.6 * s))


def attitude(t: float) -> np.ndarray:
    s = max(t - 3.0, 0.0)
    ramp = s**3 / (s**3 + 20.0)
    return from_euler(
        ramp * 0.2 * math.sin(0.9 * s),
        ramp * 0.2 * math.sin(1.1 * s),
        0.4 + ramp * math.sin(0.3 * s),
    )


def velocity(t: float, h: float = 1e-3) -> np.ndarray:
    return (position(t + h) - position(t - h)) / (2 * h)


def inertial(t: float, h: float = 1e-3) -> tuple[np.ndarray, np.ndarray]:
    """Specific force and turn rate in body axes, by central differences of the truth."""
    accel = (position(t + h) - 2 * position(t) + position(t - h)) / h**2
    turn = log(multiply(conjugate(attitude(t - h)), attitude(t + h))) / (2 * h)
    return rotate(conjugate(attitude(t)), accel - GRAVITY), turn


@dataclass
class Flight:
    """Draws observations of the truth; `noise` scales every error."""

    rng: np.random.Generator
    settings: VisualInertialEkf = QUIET
    noise: float = 1.0
    accel_bias: np.ndarray = field(default_factory=lambda: np.zeros(3))
    gyro_bias: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def draw(self, sd: float | np.ndarray) -> np.ndarray:
        return self.noise * sd * self.rng.standard_normal(3)

    def imu(self, k: int) -> Imu:
        s, t = self.settings, k / RATE
        force, turn = inertial(t)
        scale = math.sqrt(RATE)
        return Imu(
            t,
            force + self.accel_bias + self.draw(s.accel_noise * scale),
            turn + self.gyro_bias + self.draw(s.gyro_noise * scale),
        )

    def gnss(self, t: float) -> Gnss:
        p = position(t) + self.draw(FIX_SD)
        return Gnss(t, p, velocity(t) + self.draw(VELOCITY_SD), FIX_SD, VELOCITY_SD)

    def baro(self, t: float) -> Baro:
        return Baro(t, float(-position(t)[2] + self.draw(self.settings.baro_sd)[0]))

    def mag(self, t: float) -> Magnetometer:
        turned = rotate(exp(vec(0, 0, self.draw(self.settings.mag_sd)[0])), FIELD)
        return Magnetometer(t, rotate(conjugate(attitude(t)), turned))

    def sighting(self, t: float, sd: float = 0.03, angle_sd: float = 0.05) -> Sighting:
        camera = Transform(attitude(t), position(t)) @ MOUNT
        pose = camera.inverse() @ TRUNK
        reach = float(np.linalg.norm(pose.translation))
        u = pose.translation / reach
        across = min(sd, reach * self.settings.bearing_sd)
        error = self.draw(across)
        error += u * (self.draw(sd)[0] - u @ error)
        seen = Transform(
            multiply(pose.rotation, exp(self.draw(angle_sd))), pose.translation + error
        )
        return sighting(t, seen, sd, angle_sd)

    def tick(self, n: int, delay: float = 0.1) -> Observation:
        """Tick n at n·TICK: five samples, a fix every 0.2 s `delay` old, baro and mag at 10 Hz."""
        now, step = n * TICK, round(TICK * RATE)
        return Observation(
            now,
            imu=tuple(self.imu(k) for k in range((n - 1) * step + 1, n * step + 1)),
            gnss=self.gnss(now - delay) if n % 4 == 0 else None,
            baro=self.baro(now) if n % 2 else None,
            mag=None if n % 2 else self.mag(now),
        )


def sighting(
    t: float, pose: Transform, sd: float = 0.03, angle_sd: float = 0.05, *, ambiguous: bool = False
) -> Sighting:
    seen = Detection("DICT_6X6_250", 23, np.zeros((4, 2)), 900.0)
    return Sighting(t, "trunk", 23, pose, sd, angle_sd, 0.2, ambiguous, seen)
