"""Facts about the ground robots of the IARC's mission 7."""

from __future__ import annotations

import math
from typing import NamedTuple


class GroundRobot(NamedTuple):
    """How a ground robot drives: two wheels, by its firmware's rules.

    Source: P4 section III-C and Table 1; the organisers' firmware (correction P4.4); the radius
    at which obstacle robots circle is that of the competition's rules.
    """

    speed: float = 0.33  # m/s
    wheel_base: float = 0.258  # m
    spin_time: float = 2.456  # s for 180 deg
    reversal_every: float = 20.0  # s
    turn_every: float = 5.0  # s, random turns
    turn_time: float = 0.85  # s
    turn_offset: float = 0.032  # m/s, largest, of each wheel
    circle_radius: float = 5.0  # m, of an obstacle robot's path, clockwise seen from above
    diameter: float = 0.34  # m
    height: float = 0.10  # m, of the plate on top

    @property
    def spin_rate(self) -> float:
        """Turn rate (rad/s) of a spin, clockwise seen from above: Ω of P4 (28)."""
        return math.pi / self.spin_time

    @property
    def circle_rate(self) -> float:
        """Turn rate (rad/s) of an obstacle robot."""
        return self.speed / self.circle_radius

    @property
    def turn_variance(self) -> float:
        """Variance of the heading (rad²/s) that random turns add on average.

        A turn is uniform within ±2 w t/b, P4 (26) with the offset w on both wheels for t.
        """
        largest = 2.0 * self.turn_offset * self.turn_time / self.wheel_base
        return largest * largest / 3.0 / self.turn_every
