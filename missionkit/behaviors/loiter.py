"""Staying at a place for a time."""

from __future__ import annotations

import math
from typing import Any, ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import Vec3, norm
from missionkit.messages import Estimate, Goal, Guidance, Step
from missionkit.planning.route_following import absent
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, Seconds


class Waiting(NamedTuple):
    """Memory of `loiter`."""

    place: Vec3  # (3,), m, NED, to stay at
    yaw: float  # rad
    at: float  # s, of the last step
    since: float | None = None  # s, when it came to rest there, and later by what does not count
    returning: bool = False  # after an interruption


class Loiter(Behavior):
    """Stay where the state was entered for `seconds`, at rest; then done.

    The time counts from when the vehicle is `within` of the place, nearly at rest: one that
    arrives fast comes back first. A pause does not count, nor the way back after it.
    `heading_deg` turns the nose; otherwise it stays.
    """

    kind: ClassVar[str] = "loiter"
    seconds: Seconds = 10.0
    heading_deg: Degrees | None = Field(default=None, description="where the nose points")
    within: Metres = Field(default=1.0, gt=0)

    @override
    def begin(self, seen: Estimate) -> Waiting:
        yaw = seen.yaw if self.heading_deg is None else math.radians(self.heading_deg)
        return Waiting(seen.position, yaw, seen.now)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Waiting = memory
        off = norm(on.place - seen.position)
        lost, returning = absent(on.at, seen.now, off, returning=on.returning)
        on = on._replace(at=seen.now, returning=returning)
        if on.since is not None:
            on = on._replace(since=on.since + lost)
        elif off <= self.within and norm(seen.velocity) < 0.5:
            on = on._replace(since=seen.now)
        left = self.seconds if on.since is None else self.seconds - (seen.now - on.since)
        return Step(
            Guidance(on.place, 1.0, yaw=on.yaw),
            done=left <= 0.0,
            goal=Goal(on.place, on.yaw, seen.now),
            note=f"{max(0.0, left):.0f} s left",
            memory=on,
        )
