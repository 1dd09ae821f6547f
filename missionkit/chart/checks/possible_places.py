"""Which distances one place can have at the same time, by the triangle inequality.

A place that is `a` from A and `b` from B, which are D apart, exists if and only if D <= a + b,
a <= D + b and b <= D + a. Where a marker may correct a surveyed position, that may be off by
`SURVEY_SIGMAS` of its standard deviations; tracked targets move and say nothing here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple

from missionkit.chart.model.mission import Mission
from missionkit.guards.distances import distance_to
from missionkit.messages.region import Box, Boxes, Interval, Quantity
from missionkit.units import Point

SURVEY_SIGMAS = 3.0


class Spot(NamedTuple):
    """A fixed place that distances are measured to."""

    name: str
    position: Point  # m, NED
    off: float  # m, by which it may be corrected in flight


class Places:
    """The fixed places of a mission."""

    def __init__(self, mission: Mission) -> None:
        seen = {str(getattr(use.plugin, "target", "")) for use in mission.perception}
        spots = []
        for name, target in mission.targets.items():
            off = SURVEY_SIGMAS * target.position_sd if name in seen else 0.0
            spots.append(Spot(name, target.position, off))
        self.spots: Mapping[Quantity, Spot] = {distance_to(spot.name): spot for spot in spots}

    def possible(self, boxes: Boxes) -> Boxes:
        """Return the boxes without those whose distances no place has."""
        if all(self.conflict(box) == "" for box in boxes):
            return boxes
        return tuple(box for box in boxes if self.conflict(box) == "")

    def conflict(self, box: Box) -> str:
        """Return why no place has the distances of a box, "" if there may be one."""
        asked = [quantity for quantity in box if quantity in self.spots]
        if len(asked) < 2:
            return ""
        near = [(self.spots[each], span) for each in asked if (span := box[each]) is not None]
        for (one, here), (other, there) in combinations(near, 2):
            apart = math.dist(one.position, other.position)
            if _apart(apart, here, there, one.off + other.off):
                return f"{one.name!r} and {other.name!r} are {apart:.4g} m apart"
        return ""


def _apart(apart: float, here: Interval, there: Interval, off: float) -> bool:
    """Say whether no place is so far from two that are `apart` (m), known up to `off` (m)."""
    return (
        here.high + there.high < apart - off
        or here.low > apart + off + there.high
        or there.low > apart + off + here.high
    )
