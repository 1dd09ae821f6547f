"""Last stage of docking: straight in along the docking axis."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.docking.docking_pose import DockingBehavior
from missionkit.geometry import norm
from missionkit.messages import Estimate, Guidance, Step
from missionkit.units import Degrees, Metres, Radians


class Dock(DockingBehavior):
    """Fly in along the docking axis until docked; done `within` and `within_rad` of that.

    It moves in only while it is within `corridor` of the axis, or a cone of `corridor_deg` about
    that, and waits at its distance to get back there.

    Source: P3 sections V and VI-A.
    """

    kind: ClassVar[str] = "dock"
    contact: Metres = Field(default=0.10, gt=0, description="docked: between the centres")
    corridor: Metres = Field(default=0.03, gt=0, description="sideways error that it moves in with")
    corridor_deg: Degrees = Field(
        default=0.0, ge=0, lt=60, description="half-angle by which the corridor widens outwards"
    )
    within: Metres = Field(default=0.006, gt=0)
    within_rad: Radians = Field(default=0.05, gt=0)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        pose = self.pose(seen)
        if pose is None:
            return self.lost(memory)
        away = seen.position - pose.centre
        along = float(away @ pose.axis)
        sideways = norm(away - along * pose.axis)
        docked = pose.at(self.contact)
        flare = math.tan(math.radians(self.corridor_deg))
        inside = sideways <= self.corridor + flare * max(0.0, along - self.contact)
        place = docked if inside else pose.at(max(along, self.contact))
        near = norm(seen.position - docked) <= self.within
        return Step(
            Guidance(place, self.speed, attitude=pose.attitude),
            done=near and pose.misalignment(seen.attitude) <= self.within_rad,
            goal=self.goal(docked, seen),
            note="" if inside else f"{100.0 * sideways:.1f} cm beside the docking axis: waiting",
            payload=self.camera,
            memory=memory,
        )
