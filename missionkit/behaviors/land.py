"""Landing."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from typing_extensions import override

from missionkit.messages import Action, Estimate, Step
from missionkit.plugin import Behavior
from missionkit.units import Seconds

SLOW = 0.7  # m/s, level: the autopilot may land
FOLLOWING = "offboard"  # the autopilot's mode while it flies our setpoints


class Land(Behavior):
    """Let the autopilot land here; done when it stands on the ground, disarmed.

    A vehicle that still moves comes to rest first, for `brake` at most: an autopilot that has
    lost its position descends wherever it drifts. A velocity of zero is flown by what is still
    known, its inertial sensors and its attitude. If the estimate has diverged, how fast it moves
    is not known either, and it brakes for half of that.
    """

    kind: ClassVar[str] = "land"
    brake: Seconds = 4.0

    @override
    def begin(self, seen: Estimate) -> float:
        return seen.now

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        status = seen.status
        if status is not None and not status.in_air and not status.armed:
            return Step(done=True, memory=memory)
        if memory is not None and self._moving(seen, since=memory):
            return Step(stop=True, note="coming to rest before landing", memory=memory)
        return Step(action=Action.LAND)

    def _moving(self, seen: Estimate, since: float) -> bool:
        status = seen.status
        if status is None or not status.in_air or status.mode != FOLLOWING:
            return False
        if seen.health.diverged:
            return seen.now - since < 0.5 * self.brake
        speed = math.hypot(seen.velocity[0], seen.velocity[1])
        return speed > SLOW and seen.now - since < self.brake
