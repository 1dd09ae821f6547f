"""P4's own policy: the robot nearest to the goal line that does not drive towards it."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import Annotated, ClassVar

from pydantic import Field

from missionkit.geometry import wrap
from missionkit.messages.herd import HerdChoice, HerdView
from missionkit.planning.herding.arena_frame import to_arena
from missionkit.plugin import Plugin
from missionkit.units import Degrees


class NearestToGoal(Plugin):
    """Choose the robot nearest to the goal line of those that do not drive towards it.

    A robot drives towards the goal line if its heading is within `off_deg` of the direction to it.
    Values are minus the distance to the goal line (m). It lands in front and touches no tops.

    Source: P4 section V.
    """

    kind: ClassVar[str] = "nearest_to_goal"
    off_deg: Annotated[Degrees, Field(gt=0, lt=180)] = 90.0

    def choose(self, view: HerdView) -> HerdChoice:
        """Return the robot that is next."""
        values = {
            robot.name: to_arena(view.arena, robot.position)[0] - 0.5 * view.arena.side
            for robot in view.robots
            if abs(wrap(robot.heading - view.arena.goal)) > math.radians(self.off_deg)
        }
        if not values:
            return HerdChoice(None, "wait")
        best = max(values, key=values.__getitem__)
        return HerdChoice(best, "front", values=MappingProxyType(values))
