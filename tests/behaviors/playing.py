"""Playing a behaviour against a list of estimates."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from samples import calm

from missionkit.geometry import from_euler, vec
from missionkit.goal_pose import facing
from missionkit.messages import Estimate, Step, Target, VehicleStatus
from missionkit.plugin import Behavior

TICK = 0.05


def play(behavior: Behavior, story: Iterable[Estimate]) -> list[Step]:
    """Return every step; the behaviour begins at the first estimate."""
    steps: list[Step] = []
    memory: Any = None
    for count, seen in enumerate(story):
        if count == 0:
            memory = behavior.begin(seen)
        steps.append(behavior.step(seen, memory))
        memory = steps[-1].memory
    return steps


def status(now: float = 10.0, *, armed=True, in_air=True, ready=True, mode="offboard"):
    return VehicleStatus(now, armed, in_air, ready, mode)


def marker(*place: float, faces_deg: float = 180.0, seen_at: float | None = 10.0) -> Target:
    """A target whose upright marker faces `faces_deg`: south by default."""
    attitude = facing(math.radians(faces_deg))
    return Target("trunk", vec(*place), 0.05, attitude, 0.02, seen_at)


def at(now: float, *place: float, yaw: float = 0.0, **changes: Any) -> Estimate:
    return calm(now=now, position=vec(*place), attitude=from_euler(0.0, 0.0, yaw), **changes)
