"""Take-off."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field
from typing_extensions import override

from missionkit.messages import CONTROL_RESUMED, Action, Estimate, Step
from missionkit.plugin import Behavior
from missionkit.units import Metres

CLIMBING = "take_off"  # the autopilot's mode


class TakeOff(Behavior):
    """Wait until ready and placed, arm, and let the autopilot climb to `height`.

    Requests are repeated until the vehicle's own status confirms them. Done within `within` of
    the height, or when the autopilot, which has its own idea of the height, stops climbing. `by`
    a pilot nothing is commanded: he arms and climbs by hand, and it is done once he has given
    control, by the key for it, in the air.
    """

    kind: ClassVar[str] = "take_off"
    height: Metres = Field(default=5.0, gt=0)
    within: Metres = Field(default=0.5, gt=0)
    by: Literal["autopilot", "pilot"] = "autopilot"

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        status = seen.status
        lost = _lost(seen)
        if lost and (status is None or not status.in_air):
            return Step(note=lost)
        if self.by == "pilot":
            return _by_hand(seen)
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


def _lost(seen: Estimate) -> str:
    """Return what the estimate lacks to take off, "" if nothing."""
    if not seen.health.aligned:
        return "waiting for the estimate to align"
    if not seen.health.placed:
        return "waiting for a position: none has been accepted lately"
    if seen.health.diverged:
        return "waiting for the estimate: it has diverged"
    return ""


def _by_hand(seen: Estimate) -> Step:
    """Wait until a pilot in the air has given control."""
    if seen.status is None or not seen.status.in_air:
        return Step(note="waiting for the pilot to take off")
    if CONTROL_RESUMED in seen.events:
        return Step(done=True)
    height = -float(seen.position[2])
    return Step(note=f"a pilot flies, {height:.1f} m up: waiting for control")
