"""Geofence."""

from __future__ import annotations

import math
from typing import ClassVar

from pydantic import Field, field_validator
from typing_extensions import override

from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity
from missionkit.units import Metres


class InsideFence(ComparedGuard):
    """Holds inside a box around the take-off point: `north` and `east` ranges, up to `height`.

    The verdict's value is the distance to the nearest wall or the ceiling, negative outside.
    """

    kind: ClassVar[str] = "inside_fence"
    north: tuple[Metres, Metres]
    east: tuple[Metres, Metres]
    height: Metres = Field(gt=0)

    @field_validator("north", "east")
    @classmethod
    def _ordered(cls, limits: tuple[float, float]) -> tuple[float, float]:
        if limits[0] >= limits[1]:
            raise ValueError(f"the lower limit {limits[0]:g} must be below the upper {limits[1]:g}")
        return limits

    @override
    def measured(self, seen: Estimate) -> float | str:
        if not seen.health.aligned:
            return "the position is not known yet"
        north, east, down = seen.position.tolist()
        inside: float = min(
            north - self.north[0],
            self.north[1] - north,
            east - self.east[0],
            self.east[1] - east,
            self.height + down,
        )
        return inside

    @override
    def comparison(self) -> Comparison:
        limits = f"{self.north[0]:g} to {self.north[1]:g}, {self.east[0]:g} to {self.east[1]:g}"
        name = f"margin to the fence ({limits}, {self.height:g})"
        return Comparison(Quantity(name, -math.inf, unit="m"), "at_least", 0.0)
