"""Height above the ground below."""

from __future__ import annotations

import math
from typing import ClassVar, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.geometry import rotate, vec
from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity
from missionkit.units import Metres, Seconds

QUANTITY = Quantity("height above the ground", unit="m")
STEEPEST = 0.7  # cosine of the tilt, 45 deg, beyond which the sensor looks elsewhere


class HeightAboveGround(ComparedGuard):
    """Holds while the range finder says that the ground is at most, or at least, so far below.

    The distance along the body's axis times the cosine of the tilt, of level ground. Unknown
    without a range finder, if its reading is older than `max_age`, and while the vehicle leans by
    more than 45 deg.
    """

    kind: ClassVar[str] = "height_above_ground"
    at_least: Metres | None = Field(default=None, description="least height")
    at_most: Metres | None = Field(default=None, description="greatest height")
    max_age: Seconds = 1.0

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.at_least is None) == (self.at_most is None):
            raise ValueError("expected one of 'at_least' and 'at_most'")
        return self

    @override
    def measured(self, seen: Estimate) -> float | str:
        if seen.range is None:
            return "no range finder has measured it yet"
        if seen.now - seen.range.at > self.max_age:
            return f"the range reading is {seen.now - seen.range.at:.1f} s old"
        upright = float(rotate(seen.attitude, vec(0.0, 0.0, 1.0))[2])
        if upright < STEEPEST:
            return f"the vehicle leans by {math.degrees(math.acos(max(-1.0, upright))):.0f} deg"
        return seen.range.distance * upright

    @override
    def comparison(self) -> Comparison:
        if self.at_most is not None:
            return Comparison(QUANTITY, "at_most", self.at_most, "height, m")
        return Comparison(QUANTITY, "at_least", self.at_least or 0.0, "height, m")
