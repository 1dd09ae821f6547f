"""A simulated gimbal: it keeps the camera level and turns at a limited rate."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Vec3, conjugate, rotate, vec, yaw_of
from missionkit.messages import GimbalAngles
from missionkit.perception.camera_section import Gimbal as Section
from missionkit.perception.camera_section import Mount


class Turning(NamedTuple):
    """How the gimbal stood at a time, and what it turns to."""

    at: float  # s
    angles: GimbalAngles
    wanted: GimbalAngles


class SimulatedGimbal:
    """Two axes, each of which turns at the same rate until it is where it was ordered to be.

    Args:
        section: limits, rate, and how well it knows how it is turned.
        mount: how it rests.
        rng: of its readings.
    """

    def __init__(self, section: Section, mount: Mount, rng: np.random.Generator) -> None:
        self._section = section
        self._rng = rng
        rest = GimbalAngles(math.radians(-mount.tilt_deg), math.radians(mount.pan_deg))
        self._turning = Turning(0.0, rest, rest)

    def order(self, wanted: GimbalAngles, now: float) -> None:
        """Turn to these angles from `now` (s) on, as far as the limits allow."""
        pitch = _within(wanted.pitch, self._section.pitch_deg)
        yaw = _within(wanted.yaw, self._section.yaw_deg)
        self._turning = Turning(now, self.angles(now), GimbalAngles(pitch, yaw))

    def angles(self, now: float) -> GimbalAngles:
        """Return how it is turned at `now` (s), which is not before the last order."""
        at, (pitch, yaw), wanted = self._turning
        most = math.radians(self._section.rate_deg) * max(0.0, now - at)
        return GimbalAngles(_towards(pitch, wanted.pitch, most), _towards(yaw, wanted.yaw, most))

    def measured(self, now: float) -> GimbalAngles:
        """Return how it believes to be turned at `now` (s)."""
        pitch, yaw = self.angles(now)
        sd = math.radians(self._section.angle_sd_deg)
        off = sd * self._rng.standard_normal(2)
        return GimbalAngles(pitch + float(off[0]), yaw + float(off[1]))

    def turned_state(self, x: Vec3, now: float) -> Vec3:
        """Return a body's state (13,) with the rates of the camera in place of the body's.

        The camera keeps level: it turns with the heading, and by its own motors.

        Args:
            x: (13,), see `kernel_layout`.
            now: s.
        """
        q, rates = x[6:10], x[10:13]
        heading_rate = float(rotate(q, rates)[2])
        here, soon = self.angles(now), self.angles(now + 1e-3)
        pitching, yawing = (1e3 * (b - a) for a, b in zip(here, soon, strict=True))
        yaw = yaw_of(q) + here.yaw
        world = vec(-math.sin(yaw) * pitching, math.cos(yaw) * pitching, heading_rate + yawing)
        turned = x.copy()
        turned[10:13] = rotate(conjugate(q), world)
        return turned


def _within(angle: float, span_deg: tuple[float, float]) -> float:
    low, high = map(math.radians, span_deg)
    return min(high, max(low, angle))


def _towards(now: float, wanted: float, most: float) -> float:
    return now + max(-most, min(most, wanted - now))
