"""The safe end of a free flyer."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.docking.docking_pose import DockingBehavior
from missionkit.geometry import Vec3, norm
from missionkit.messages import Action, Estimate, Guidance, Step
from missionkit.units import Metres, MetresPerSecond

ASKED_EVERY = 1.0  # s


class Secure(DockingBehavior):
    """Switch the thrusters off where that is safe: docked, or clear of the target and at rest.

    Docked, that is within `capture` of the docked place, it does so at once. Otherwise it backs off
    to `clear` from the target's centre, comes to rest there, slower than `slow`, and then does so.
    Without a position it comes to rest by the velocity that is still known, and asks the vehicle
    once a second to switch off, which it does where that is safe. Done when it has.
    """

    kind: ClassVar[str] = "secure"
    contact: Metres = Field(default=0.10, gt=0, description="docked: between the centres")
    capture: Metres = Field(default=0.015, gt=0)
    clear: Metres = Field(default=0.5, gt=0)
    slow: MetresPerSecond = Field(default=0.002, gt=0)

    @override
    def begin(self, seen: Estimate) -> Any:
        return None, seen.now  # where to back off to, and when it asked last

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        status = seen.status
        if status is not None and not status.in_air and not status.armed:
            return Step(done=True, memory=memory)
        pose = self.pose(seen)
        place, asked_at = memory or (None, seen.now)
        if pose is None or seen.health.diverged:
            return _lost(seen, asked_at)
        if norm(seen.position - pose.at(self.contact)) <= self.capture:
            return Step(action=Action.DISARM, note="docked")
        away = seen.position - pose.centre
        distance = norm(away)
        if place is None or distance < self.clear - self.capture:
            place = self._clear_of(pose.centre, pose.axis, away, distance)
        if distance >= self.clear - self.capture and norm(seen.velocity) < self.slow:
            return Step(action=Action.DISARM, note="clear of the target, at rest", memory=memory)
        guidance = Guidance(place, self.speed, attitude=seen.attitude)
        goal = self.goal(place, seen)
        return Step(guidance, note="backing off", goal=goal, memory=(place, asked_at))

    def _clear_of(self, centre: Vec3, axis: Vec3, away: Vec3, distance: float) -> Vec3:
        """Return where to back off to: out along the docking axis from the corridor, else away."""
        out = axis if distance < self.keep_out or distance == 0.0 else away / distance
        return centre + max(self.clear, distance) * out


def _lost(seen: Estimate, asked_at: float) -> Step:
    """Come to rest, and ask the vehicle once a second to switch its thrusters off."""
    if seen.now - asked_at < ASKED_EVERY:
        return Step(stop=True, note="without a position: coming to rest", memory=(None, asked_at))
    note = "without a position: asking to switch off"
    return Step(action=Action.DISARM, note=note, memory=(None, seen.now))
