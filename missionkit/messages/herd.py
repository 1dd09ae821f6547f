"""What a herding policy sees of the arena, and what it chooses."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple

Interaction = Literal["front", "top", "wait"]
"""Land in front of the robot (it turns by 180 deg), touch its top (45 deg clockwise), or wait."""


class Arena(NamedTuple):
    """A square of floor; robots that cross one of its sides, the goal line, count."""

    side: float = 20.0  # m
    north: float = 0.0  # m, of its centre
    east: float = 0.0  # m
    goal: float = 0.0  # rad, clockwise from north: direction of the goal line from the centre


class HerdState(NamedTuple):
    """What a robot may be doing."""

    position: tuple[float, float]  # m, north and east
    heading: float  # rad, clockwise from north
    spin_left: float  # s
    reversal_in: float  # s


class HerdRobot(NamedTuple):
    """What is known of one ground robot."""

    name: str
    position: tuple[float, float]  # m, north and east
    heading: float  # rad, clockwise from north
    spin_left: float = 0.0  # s, until the spin that it is in ends; 0: it drives
    reversal_in: float | None = None  # s, until it next reverses by its clock; None: not known
    position_sd: float = 0.0  # m, one axis
    heading_sd: float = 0.0  # rad
    in_view: bool = True
    states: tuple[HerdState, ...] = ()  # equally likely; none: what the above says
    found: float = 1.0  # chance that it is near its position at all


class HerdObstacle(NamedTuple):
    """An obstacle robot: how it moves now."""

    position: tuple[float, float]  # m, north and east
    heading: float  # rad, clockwise from north
    speed: float = 0.33  # m/s
    turn_rate: float = 0.0  # rad/s, clockwise


class HerdView(NamedTuple):
    """What a herding policy knows at a decision."""

    time_left: float  # s, of the mission
    arena: Arena
    position: tuple[float, float, float]  # m, NED, of the vehicle
    velocity: tuple[float, float, float]  # m/s, NED
    robots: tuple[HerdRobot, ...]
    obstacles: tuple[HerdObstacle, ...] = ()
    chosen: str | None = None  # robot of the last choice


class HerdChoice(NamedTuple):
    """Which robot is next, what to do with it, and how much that is worth."""

    robot: str | None  # None: none is worth the flight
    action: Interaction
    start_in: float = 0.0  # s, until the descent begins
    values: Mapping[str, float] = MappingProxyType({})  # of each robot, by name

    @property
    def margin(self) -> float | None:
        """How much the best value exceeds the next best; None: there are not two."""
        best = sorted(self.values.values(), reverse=True)[:2]
        return best[0] - best[1] if len(best) == 2 else None

    def text(self, most: int = 2) -> str:
        """Return the best `most` values: "robot_4: +0.31, robot_7: +0.22"."""
        ranked = sorted(self.values.items(), key=lambda it: (-it[1], it[0]))
        finite = [it for it in ranked if math.isfinite(it[1])]
        return ", ".join(f"{name}: {value:+.2f}" for name, value in finite[:most])
