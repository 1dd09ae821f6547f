"""Being pushed about."""

from __future__ import annotations

import math
from typing import ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import norm
from missionkit.guards.distances import GOAL_DISTANCE
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Degrees, Metres

TILT_QUANTITY = Quantity("tilt", most=180.0, unit="deg")


class Disturbed(Guard):
    """Holds when something pushes the vehicle: `error` off its goal, or tilted by `tilt_deg`.

    For work at a place: a vehicle that holds one against the wind tilts by atan(drag / weight)
    and is off by what its controller lags behind. Without a goal the tilt alone decides; unless
    that holds, the guard is then unknown.
    """

    kind: ClassVar[str] = "disturbed"
    error: Metres = Field(default=0.25, gt=0)
    tilt_deg: Degrees = Field(default=20.0, gt=0, le=90)

    @override
    def check(self, seen: Estimate) -> Verdict:
        tilt = tilt_deg(seen)
        leaning = Verdict.above(tilt, self.tilt_deg, "tilt, deg")
        if seen.goal is None:
            return leaning if leaning.holds else Verdict.unknown("the behaviour has no goal yet")
        error = norm(seen.position - seen.goal.position)
        if tilt / self.tilt_deg > error / self.error:
            return leaning
        return Verdict.above(error, self.error, "off the goal, m")

    @override
    def region(self) -> Region:
        off, leaning = Interval.above(self.error), Interval.above(self.tilt_deg)
        return Region(({GOAL_DISTANCE: off}, {TILT_QUANTITY: leaning}))


def tilt_deg(seen: Estimate) -> float:
    """Return the angle (deg) between the vehicle's axis and the vertical."""
    _, i, j, _ = seen.attitude.tolist()
    return math.degrees(math.acos(max(-1.0, min(1.0, 1.0 - 2.0 * (i * i + j * j)))))
