"""Landing."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from missionkit.geometry import Vec3
from missionkit.messages import Action, Estimate, Step, VehicleStatus
from missionkit.plugin import Behavior
from missionkit.units import Metres, Seconds

SLOW = 0.7  # m/s, level: the autopilot may land
PUSHED_DISTANCE = 1.2  # m, from what stands beside it, that wind may push it on its way down
VAGUE = 3.0  # m, sd of the position with which an autopilot may drift as it descends
CLEARING = 8.0  # s, at most, to get away from what stands too near
RETREAT_SPEED, LEAST_RETREAT, RETREAT_RATE = 1.0, 0.2, 1.0  # m/s at most and at least, and 1/s
FOLLOWING = "offboard"  # the autopilot's mode while it flies our setpoints


class Land(Behavior):
    """Let the autopilot land here; done when it stands on the ground, disarmed.

    A vehicle that still moves comes to rest first, for `brake` at most: an autopilot that has
    lost its position descends wherever it drifts. A velocity of zero is flown by what is still
    known, its inertial sensors and its attitude. If the estimate has diverged, how fast it moves
    is not known either, and it brakes for half of that. It first gets away from obstacles nearer
    than 1.2 m, or than `room` where the position is known to 3 m at best and the autopilot may
    drift, for 8 s at most; with a `room` of 0 from none.
    """

    kind: ClassVar[str] = "land"
    brake: Seconds = 4.0
    room: Metres = 2.0

    @override
    def begin(self, seen: Estimate) -> float:
        return seen.now

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        status = seen.status
        if status is not None and not status.in_air and not status.armed:
            return Step(done=True, memory=memory)
        if memory is not None and self._moving(seen, since=memory):
            return Step(stop=True, note="stopping before landing", memory=memory)
        if memory is not None and (away := self._retreat(seen, since=memory)) is not None:
            return Step(stop=True, retreat=away, note="making room to land", memory=memory)
        return Step(action=Action.LAND)

    def _moving(self, seen: Estimate, since: float) -> bool:
        if not _steered(seen.status):
            return False
        if seen.health.diverged:
            return seen.now - since < 0.5 * self.brake
        speed = math.hypot(seen.velocity[0], seen.velocity[1])
        return speed > SLOW and seen.now - since < self.brake

    def _retreat(self, seen: Estimate, since: float) -> Vec3 | None:
        """Return a velocity (3,), m/s, NED, away from what stands too near; None if nothing does.

        A scan is seen from the vehicle: it holds though the position does not.
        """
        known = not seen.health.diverged and seen.health.position_sd <= VAGUE
        room = min(self.room, PUSHED_DISTANCE) if known else self.room
        late = seen.now - since > self.brake + CLEARING
        if late or seen.obstacles is None or not _steered(seen.status):
            return None
        away = seen.position[:2] - seen.obstacles[:, :2]
        gaps = np.hypot(away[:, 0], away[:, 1])
        near = np.flatnonzero((gaps < room) & (gaps > 0.0))
        if not len(near):
            return None
        nearest = near[gaps[near].argmin()]
        speed = min(RETREAT_SPEED, RETREAT_RATE * (room - gaps[nearest]) + LEAST_RETREAT)
        return np.append(speed / gaps[nearest] * away[nearest], 0.0)


def _steered(status: VehicleStatus | None) -> bool:
    return status is not None and status.in_air and status.mode == FOLLOWING
