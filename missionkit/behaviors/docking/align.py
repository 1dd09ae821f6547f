"""Third stage of docking: in front of the face."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.docking.docking_pose import DockingBehavior, looking_at
from missionkit.behaviors.docking.keep_out import way_round
from missionkit.geometry import norm
from missionkit.messages import Estimate, Guidance, Step
from missionkit.units import Metres


class Align(DockingBehavior):
    """Fly to the point in front of the docking face, turned as it will dock; done `within` of it.

    The point is as far from the target's centre as the vehicle was on entry, or at `distance` if
    that is given, but outside `keep_out`; the way there leads round that sphere.

    Source: P3 section V, third guidance mode: "directly in front of the docking face".
    """

    kind: ClassVar[str] = "align"
    distance: Metres | None = Field(default=None, gt=0, description="absent: as on entry")
    within: Metres = Field(default=0.03, gt=0)

    @override
    def begin(self, seen: Estimate) -> Any:
        pose = self.pose(seen)
        return None if pose is None else norm(seen.position - pose.centre)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        pose = self.pose(seen)
        if pose is None:
            return self.lost(memory)
        entered = norm(seen.position - pose.centre) if memory is None else memory
        out = entered if self.distance is None else self.distance
        place = pose.at(max(out, self.keep_out))
        way = way_round(seen.position, place, pose.centre, self.keep_out)
        return Step(
            Guidance(way, self.speed, attitude=pose.attitude),
            done=norm(seen.position - place) <= self.within,
            goal=self.goal(place, seen),
            payload=self.camera,
            memory=entered,
        )


class LookAt(DockingBehavior):
    """Fly to the point in front of the docking face and look at the target on the way.

    Its attitude is the one turned least from docked with which the camera looks at the target's
    centre, so that the last metres are flown on what the camera sees; at the point itself it is
    turned as it will dock. Done `within` of the point. The way leads round `keep_out`.

    With `beside`, the point may be so far off the docking axis, towards the vehicle: a corner cut
    within the docking corridor.
    """

    kind: ClassVar[str] = "look_at"
    distance: Metres = Field(default=0.2, gt=0, description="of the point, from the centre")
    beside: Metres = Field(default=0.0, ge=0, description="of the point, at most, from the axis")
    within: Metres = Field(default=0.03, gt=0)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        pose = self.pose(seen)
        if pose is None:
            return self.lost(memory)
        place = pose.beside(seen.position, max(self.distance, self.keep_out), self.beside)
        way = way_round(seen.position, place, pose.centre, self.keep_out)
        attitude = looking_at(pose, seen.position)
        return Step(
            Guidance(way, self.speed, attitude=attitude),
            done=norm(seen.position - place) <= self.within,
            goal=self.goal(place, seen),
            payload=self.camera,
            memory=memory,
        )
