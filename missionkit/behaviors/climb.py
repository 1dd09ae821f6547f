"""Straight up or down."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import Vec3, vec
from missionkit.messages import Estimate, Goal, Guidance, Step
from missionkit.planning.route_following import Triple, absent
from missionkit.plugin import Behavior
from missionkit.units import Metres, MetresPerSecond


class Above(NamedTuple):
    """Memory of `climb`."""

    place: Vec3  # (3,), m, NED, where it began
    yaw: float  # rad
    at: float  # s, of the last step
    reached: float  # m, down, at the last step
    returning: bool = False  # to where it was interrupted


class Climb(Behavior):
    """Climb or descend to `height` above the take-off point, straight; done `within` of it.

    The place and the heading stay as they were when the state was entered; after a pause the
    vehicle first returns to where it was interrupted. `control: {limits: …}` bounds `speed`:
    2.5 m/s up and 1.5 m/s down if the mission says nothing else.
    """

    kind: ClassVar[str] = "climb"
    height: Metres
    speed: MetresPerSecond = Field(default=1.5, gt=0)
    within: Metres = Field(default=0.5, gt=0)

    @override
    def begin(self, seen: Estimate) -> Above:
        return Above(seen.position, seen.yaw, seen.now, float(seen.position[2]))

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Above = memory
        north, east, _ = on.place.tolist()
        off = math.dist((north, east, on.reached), seen.position)
        _, returning = absent(on.at, seen.now, off, returning=on.returning)
        down = float(seen.position[2])
        on = on._replace(at=seen.now, returning=returning)
        if not returning:
            on = on._replace(reached=down)
        end = vec(north, east, on.reached if returning else -self.height)
        left = abs(down + self.height)
        done = left <= self.within and abs(float(seen.velocity[2])) < 0.5
        return Step(
            Guidance(end, self.speed, yaw=on.yaw),
            done=done and not returning,
            goal=Goal(end, on.yaw, seen.now),
            note=f"{-down:.1f} m of {self.height:g} m",
            memory=on,
        )

    @override
    def way(self, start: Triple, targets: Mapping[str, Triple]) -> tuple[Triple, ...]:
        return ((start[0], start[1], -self.height),)
