"""How the ground robots of a world look.

Imported late, as the ground robots are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from missionkit.geometry import Mat, Vec3
from missionkit.ground_robot import GroundRobot
from missionkit.sim.ground_robots import EAST, HEADING, NORTH, OUT
from missionkit.sim.world import World

ROBOT: Final = GroundRobot()


class RobotLook(NamedTuple):
    """A ground robot as a camera sees it at one moment."""

    north: float  # m
    east: float  # m
    heading: float  # rad, clockwise from north
    plate: int  # grey level of the plate's paint
    tower: float = 0.0  # m, height of its top above the ground; 0: none


def looks_of(world: World, robots: Mat) -> list[RobotLook]:
    """Return the robots in play as a camera sees them.

    Args:
        world: says how they are painted, and their towers.
        robots: (R, SIZE) states, see `ground_robots`.
    """
    return looks_at(world, [None if it[OUT] > 0.0 else _pose(it) for it in robots])


def looks_at(world: World, poses: Sequence[tuple[float, float, float] | None]) -> list[RobotLook]:
    """Return robots as a camera sees them.

    Args:
        world: says how they are painted, and their towers.
        poses: north, east (m), heading (rad) of each, in the world's order; None: out of play.
    """
    painted = zip(poses, _painted(world), strict=False)
    return [RobotLook(*pose, *paint) for pose, paint in painted if pose is not None]


def _painted(world: World) -> Iterator[tuple[int, float]]:
    """Yield the plate's grey level and the tower's height (m) of each robot, in order."""
    for n in range(len(world.target_starts)):
        assert world.robots is not None  # noqa: S101 - it has starts
        yield world.robots.plates[n % len(world.robots.plates)], 0.0
    for it in world.obstacle_starts:
        assert world.obstacle_robots is not None  # noqa: S101 - the same
        yield world.obstacle_robots.plate, it.tower


def _pose(state: Vec3) -> tuple[float, float, float]:
    return float(state[NORTH]), float(state[EAST]), float(state[HEADING])
