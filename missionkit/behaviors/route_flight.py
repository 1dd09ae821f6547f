"""What behaviours that fly a route have in common: from a step along it to guidance."""

from __future__ import annotations

import math
from typing import Literal, TypeAlias

from missionkit.geometry import Vec3, vec
from missionkit.messages import Estimate, Goal, Guidance, Step
from missionkit.planning.route_following import (
    Followed,
    OnRoute,
    Route,
    Triple,
    follow,
)

Heading: TypeAlias = Literal["course", "free"]
"""Where the nose points: along the route, or where it pointed when the state was entered."""


def begun(seen: Estimate, leg: int = 0) -> OnRoute:
    """Return the memory at the start of a route: where the vehicle is, now."""
    return OnRoute(triple(seen.position), seen.now, leg)


def triple(position: Vec3) -> Triple:
    """Return a position (3,) as plain numbers."""
    north, east, down = position.tolist()
    return north, east, down


def guided(
    route: Route, on: OnRoute, seen: Estimate, yaw: float | None = None
) -> tuple[Step, Followed]:
    """Return the step of a behaviour that does no more than fly a route, done at its end.

    Args:
        route: one point at least.
        on: its memory.
        seen: the estimate at this tick.
        yaw: rad, where the nose points; `None`: along the route.
    """
    it = follow(route, on, seen)
    if yaw is None:
        yaw = it.course
    goal = Goal(vec(*route[it.on.leg].position), None, seen.now)
    note = f"{it.on.leg + 1} of {len(route)}"
    if it.on.returning:
        note = f"returning to where it was interrupted, before {note}"
    step = Step(
        Guidance(it.position, it.speed, it.velocity, yaw),
        done=it.reached is not None and it.reached + 1 == len(route),
        goal=goal,
        note=note,
        memory=it.on,
    )
    return step, it


def bearing(origin: Vec3, to: Vec3, least: float = 0.5) -> float | None:
    """Return the heading (rad) from one place to another, None if they are nearer than `least`.

    Args:
        origin: (3,), m, NED.
        to: (3,), m, NED.
        least: m, level.
    """
    north, east, _ = (to - origin).tolist()
    return math.atan2(east, north) if math.hypot(north, east) >= least else None
