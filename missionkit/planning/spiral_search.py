"""Where to fly to look for a lost target: the spiral of P1 section 3.4."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Vec3


class Waypoint(NamedTuple):
    """A moment of the pattern, relative to its centre."""

    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED


@dataclass(frozen=True, slots=True)
class SpiralPath:
    """r = r_0 + b θ: outwards to `outer`, then inwards on a mirrored spiral, and again.

    The angle turns at `rate` ω while the ground speed b ω √(1 + (r/b)²) stays under `speed`;
    from there on the ground speed is held, which slows the angle. Neighbouring turns are
    `pitch` = 2π b apart. With x = r/b the length of the curve from the origin is

        s(x) = b/2 (x √(1 + x²) + asinh x).

    Source: P1 section 3.4, correction P1.4.
    """

    speed: float  # m/s
    pitch: float  # m, between turns
    inner: float  # m, r_0
    outer: float  # m
    rate: float  # rad/s, inf for constant ground speed throughout

    @classmethod
    def steady(cls, speed: float, footprint: float, outer: float, inner: float = 0.0) -> SpiralPath:
        """Return the spiral of constant ground speed whose turns are a camera footprint apart.

        Args:
            speed: ground speed (m/s).
            footprint: narrower width of what the camera sees on the ground (m).
            outer: largest radius (m).
            inner: first radius (m), at most half a footprint or the middle is not seen.

        Raises:
            ValueError: a length or speed is not positive, or `inner` >= `outer`.
        """
        return _checked(cls(speed, footprint, inner, outer, math.inf))

    @classmethod
    def paper(
        cls,
        growth: float,
        rate: float,
        *,
        speed: float,
        footprint: float,
        outer: float,
        inner: float = 0.0,
    ) -> SpiralPath:
        """Return P1's r = r_0 + v_r t, θ = ω t, kept within speed limit and footprint.

        Where ω r would exceed the speed limit, ω and v_r slow down together, so the curve stays
        the same. A `growth` that would leave gaps between turns is reduced.

        Args:
            growth: v_r (m/s).
            rate: ω (rad/s).
            speed: limit of the ground speed (m/s).
            footprint: as in `steady` (m).
            outer: largest radius (m).
            inner: r_0 (m).

        Raises:
            ValueError: as `steady`, and for a rate or growth that is not positive.
        """
        if not (growth > 0.0 and 0.0 < rate < math.inf):
            raise ValueError(f"a spiral needs growth and rate above 0, not {growth}, {rate}")
        return _checked(cls(speed, min(footprint, math.tau * growth / rate), inner, outer, rate))

    @property
    def duration(self) -> float:
        """Time of one way, inner to outer radius (s)."""
        slow_end = self._slow_end()
        slow = (slow_end - self.inner / self._b) / self.rate
        return slow + self._length(slow_end, self.outer / self._b) / self.speed

    def at(self, t: float) -> Waypoint:
        """Return where to be `t` seconds after the start; t < 0 counts as 0."""
        way = self.duration
        legs, since = divmod(max(0.0, t), way)
        inward = legs % 2.0 == 1.0
        x = self._unwound(way - since if inward else since)
        span = (self.outer - self.inner) / self._b
        turned = x - self.inner / self._b
        angle = legs * span + (span - turned if inward else turned)
        if self.inner == 0.0:
            angle += math.pi * (legs // 2.0)  # straight on through the centre
        return self._waypoint(x, angle % math.tau, -1.0 if inward else 1.0)

    @property
    def _b(self) -> float:
        return self.pitch / math.tau

    def _slow_end(self) -> float:
        """Return x where holding the angular rate would first exceed the speed."""
        fast = self.speed / (self._b * self.rate)
        x = math.sqrt(max(0.0, fast * fast - 1.0))
        return min(self.outer / self._b, max(self.inner / self._b, x))

    def _length(self, start: float, end: float) -> float:
        """Return the length of the curve between x = start and end (m)."""
        return self._b * (_unit_length(end) - _unit_length(start))

    def _unwound(self, since: float) -> float:
        """Return x = r/b at `since` seconds of the way outwards."""
        first, slow_end = self.inner / self._b, self._slow_end()
        if math.isfinite(self.rate):
            slow = (slow_end - first) / self.rate
            if since <= slow:
                return first + self.rate * since
            since -= slow
        return _inverse_length(_unit_length(slow_end) + self.speed * since / self._b)

    def _waypoint(self, x: float, angle: float, sign: float) -> Waypoint:
        b = self._b
        turn = min(self.rate, self.speed / (b * math.sqrt(1.0 + x * x)))  # rad/s
        c, s = math.cos(angle), math.sin(angle)
        outwards, around = sign * b * turn, b * x * turn
        return Waypoint(
            np.array([b * x * c, b * x * s, 0.0]),
            np.array([outwards * c - around * s, outwards * s + around * c, 0.0]),
        )


def _checked(spiral: SpiralPath) -> SpiralPath:
    finite = math.isfinite(spiral.speed + spiral.pitch + spiral.outer)
    if not (finite and spiral.speed > 0.0 and spiral.pitch > 0.0):
        raise ValueError(f"a spiral needs speed and footprint above 0, not {spiral}")
    if not 0.0 <= spiral.inner < spiral.outer:
        raise ValueError(f"a spiral needs 0 <= inner < outer radius, not {spiral}")
    return spiral


def _unit_length(x: float) -> float:
    """Return the length of r = x from 0 to x: the integral of √(1 + x²)."""
    return 0.5 * (x * math.sqrt(1.0 + x * x) + math.asinh(x))


def _inverse_length(length: float) -> float:
    """Return x with `_unit_length(x) == length`, by Newton's method from above.

    The length exceeds x²/2 and x, so the start is above the root; the function is convex there
    and Newton descends to it monotonically.
    """
    x = min(length, math.sqrt(2.0 * length))
    for _ in range(8):
        x -= (_unit_length(x) - length) / math.sqrt(1.0 + x * x)
    return x
