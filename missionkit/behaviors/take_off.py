"""Take-off."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.messages import Action, Estimate, Step
from missionkit.plugin import Behavior
from missionkit.units import Metres

CLIMBING = "take_off"  # the autopilot's mode


class TakeOff(Behavior):
    """Wait until ready and placed, arm, and let the autopilot climb to `height`.

    Requests are repeated until the vehicle's own status confirms them. Done within `within` of
    the height, or when the autopilot, which has its own idea of the height, stops climbing.
    """

    kind: ClassVar[str] = "take_off"
    height: Metres = Field(default=5.0, gt=0)
    within: Metres = Field(default=0.5, gt=0)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        status = seen.status
        if status is None or not status.in_air:
            if not seen.health.aligned:
                return Step(note="waiting for the estimate to align")
            if not seen.health.placed or seen.health.diverged:
                return Step(note="waiting for a position: none has been accepted lately")
        if status is None or not status.armed:
            if status is None or not status.ready:
                return Step(note="waiting for the vehicle's own checks")
            return Step(action=Action.ARM, note="arming")
        height = -float(seen.position[2])
        climbed = height >= self.height - self.within
        if status.in_air and (climbed or (memory and status.mode != CLIMBING)):
            return Step(done=True, memory=memory)
        climbing = status.in_air and status.mode == CLIMBING
        return Step(
            action=None if climbing else Action.TAKE_OFF,
            height=self.height,
            note=f"climbing, {height:.1f} m",
            memory=bool(memory) or climbing,
        )
