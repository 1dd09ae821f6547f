"""Take-off."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import Vec3, vec
from missionkit.messages import CONTROL_RESUMED, Action, Estimate, Guidance, Step, VehicleStatus
from missionkit.plugin import Behavior
from missionkit.units import Metres

CLIMBING_MODE, TOP_MODE, STEERED_MODE = "take_off", "hold", "offboard"  # the autopilot's modes
EARLY_END_HEIGHT, EARLY_END_SHARE = 1.0, 0.4
"""m, and part of the height, by which the autopilot may end a climb early."""
STALLED_AFTER, LEAST_RISE = 8.0, 0.2
"""s without a rise (m) after which a climb in the air has stalled."""
FINISHING_SPEED = 1.0  # m/s, to finish a climb


class Climb(NamedTuple):
    """Memory of `take_off`."""

    begun: bool = False  # the autopilot has climbed
    highest: float = 0.0  # m
    rose_at: float | None = None  # s, when it was that high first
    over: Vec3 | None = None  # (3,), m, NED: cut short, to be finished at this place


class TakeOff(Behavior):
    """Wait until ready and placed, arm, and let the autopilot climb to `height`.

    Requests are repeated until the vehicle's own status confirms them. Done within `within` of
    the height, or when the autopilot, which has its own idea of the height, holds at most 1 m
    (at most 40 %) short of it. A climb that a pilot or the autopilot cut short lower down, or that
    stalled, is finished by guidance once missionkit has control: some autopilots take off from the
    ground only. `by` a pilot nothing is commanded: he arms and climbs by hand, and it is done once
    he has given control, by the key for it, in the air.
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
                return Step(note="waiting for the vehicle's arming checks")
            return Step(action=Action.ARM, note="arming")
        return self._climb(seen, memory or Climb(), status)

    def _climb(self, seen: Estimate, climb: Climb, status: VehicleStatus) -> Step:
        """Answer while armed."""
        height = -float(seen.position[2])
        if not status.in_air:
            return self._climbing(height, Climb())._replace(action=Action.TAKE_OFF)
        ended = climb.begun and climb.over is None and status.mode == TOP_MODE
        short = min(EARLY_END_HEIGHT, EARLY_END_SHARE * self.height) if ended else 0.0
        if height >= self.height - max(short, self.within):
            return Step(done=True, memory=climb)
        climb = _followed(climb, height, seen.now)
        if climb.over is not None or _cut_short(climb, status.mode, seen):
            return self._finished_by_guidance(seen, climb, status.mode)
        if status.mode == CLIMBING_MODE:
            return self._climbing(height, climb._replace(begun=True))
        return self._climbing(height, climb)._replace(action=Action.TAKE_OFF)

    def _climbing(self, height: float, climb: Climb) -> Step:
        return Step(height=self.height, note=f"climbing, {height:.1f} m", memory=climb)

    def _finished_by_guidance(self, seen: Estimate, climb: Climb, mode: str) -> Step:
        """Climb on, straight up from where the vehicle is when it begins to follow setpoints."""
        if lost := _lost(seen):
            return Step(note=lost, memory=climb)
        over = climb.over
        if over is None or mode != STEERED_MODE:
            over = vec(float(seen.position[0]), float(seen.position[1]), -self.height)
        note = f"the climb was interrupted: continuing it, {-float(seen.position[2]):.1f} m"
        guidance = Guidance(over, FINISHING_SPEED)
        return Step(guidance, note=note, memory=climb._replace(over=over), takes_over=True)


def _followed(climb: Climb, height: float, now: float) -> Climb:
    """Note how high it is, and since when."""
    if climb.rose_at is not None and height < climb.highest + LEAST_RISE:
        return climb
    return climb._replace(highest=height, rose_at=now)


def _cut_short(climb: Climb, mode: str, seen: Estimate) -> bool:
    """Return whether the autopilot climbs no more."""
    stalled = climb.rose_at is not None and seen.now - climb.rose_at > STALLED_AFTER
    stopped = climb.begun and mode != CLIMBING_MODE
    return stopped or stalled or CONTROL_RESUMED in seen.events


def _lost(seen: Estimate) -> str:
    """Return what the estimate lacks to take off, "" if nothing."""
    if not seen.health.aligned:
        return "waiting for the estimate to align"
    if not seen.health.placed:
        return "waiting for a position fix: none was accepted recently"
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
    return Step(note=f"a pilot is flying, {height:.1f} m up: waiting for control")
