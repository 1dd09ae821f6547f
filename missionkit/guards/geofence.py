"""Geofences."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    field_validator,
    model_validator,
)
from pydantic_core import CoreSchema
from typing_extensions import override

from missionkit import polygons
from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity
from missionkit.positions import GroundPosition
from missionkit.units import Metres, Point


def _tuple(data: object) -> object:
    return tuple(data) if isinstance(data, list) else data  # strictness is about the numbers


Corners = Annotated[tuple[GroundPosition, ...], BeforeValidator(_tuple)]
NO_POSITION = "the position is not known yet"


def _checked(corners: Corners) -> Corners:
    if wrong := polygons.unfit(corners):
        raise ValueError(wrong)
    return corners


class Hole(BaseModel):
    """Ground to stay away from, up to a `height` above the take-off point; to the sky without.

    Without a height its corners alone may be written.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)
    polygon: Corners = Field(description="corners in order")
    height: Metres | None = Field(default=None, gt=0, description="it may be flown over above")

    @model_validator(mode="before")
    @classmethod
    def _short(cls, data: object) -> object:
        return {"polygon": data} if isinstance(data, list | tuple) else data

    @classmethod
    @override
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Allow the corners alone."""
        whole = handler(schema)
        return {"anyOf": [handler.resolve_ref_schema(whole)["properties"]["polygon"], whole]}

    @field_validator("polygon")
    @classmethod
    def _fit(cls, corners: Corners) -> Corners:
        return _checked(corners)

    def margin(self, point: Point) -> float:
        """Return the distance (m) of a point, NED, from the hole, negative inside."""
        north, east, down = point
        level = -polygons.margin(self.polygon, (north, east))
        if self.height is None:
            return level
        above = -down - self.height
        return math.hypot(level, above) if level > 0.0 and above > 0.0 else max(level, above)


class InsideFence(ComparedGuard):
    """Holds inside a fence: a box or a polygon around the take-off point, up to `height`.

    The box is given by its `north` and `east` ranges; a `polygon` by its corners, in order, and it
    may have `holes`, each with a polygon of its own and perhaps a height above which it may be
    flown over. Without parameters it is the mission's section `fence`.

    The verdict's value is the distance to the nearest wall or the ceiling, negative outside.
    """

    kind: ClassVar[str] = "inside_fence"
    north: tuple[Metres, Metres] | None = Field(default=None, description="south and north limit")
    east: tuple[Metres, Metres] | None = Field(default=None, description="west and east limit")
    polygon: Corners | None = Field(default=None, description="corners in order, instead of a box")
    holes: tuple[Hole, ...] = Field(default=(), description="ground to stay away from")
    height: Metres | None = Field(
        default=None, gt=0, description="the ceiling above the take-off point"
    )

    @field_validator("north", "east")
    @classmethod
    def _ordered(cls, limits: tuple[float, float] | None) -> tuple[float, float] | None:
        if limits is not None and limits[0] >= limits[1]:
            raise ValueError(f"the lower limit {limits[0]:g} must be below the upper {limits[1]:g}")
        return limits

    @field_validator("polygon")
    @classmethod
    def _fit(cls, corners: Corners | None) -> Corners | None:
        return None if corners is None else _checked(corners)

    @model_validator(mode="after")
    def _whole(self) -> Self:
        box = [it for it in ("north", "east") if getattr(self, it) is not None]
        if self.polygon is not None and box:
            raise ValueError(f"give 'polygon' or 'north' and 'east', not 'polygon' and '{box[0]}'")
        if self.polygon is None and len(box) < 2:
            raise ValueError("needs 'polygon', or 'north' and 'east'; or the mission's 'fence'")
        if self.height is None:
            raise ValueError("missing key 'height': the ceiling above the take-off point (m)")
        for number, hole in enumerate(self.holes, 1):
            if not polygons.inside_of(hole.polygon, self.outline()):
                raise ValueError(f"hole {number} lies outside the fence, or partly")
        return self

    @property
    def ceiling(self) -> float:
        """How high it may fly above the take-off point (m)."""
        return math.inf if self.height is None else self.height

    def outline(self) -> tuple[tuple[float, float], ...]:
        """Return the corners, north and east (m)."""
        if self.polygon is not None:
            return self.polygon
        (south, north), (west, east) = self.north or (0.0, 0.0), self.east or (0.0, 0.0)
        return (south, west), (north, west), (north, east), (south, east)

    def margin(self, point: Point) -> float:
        """Return the distance (m) of a point, NED, to what is nearest, negative outside."""
        north, east, down = point
        away = (hole.margin(point) for hole in self.holes)
        return min(self._level(north, east), self.ceiling + down, *away)

    def cuts(self, start: Point, end: Point) -> Iterator[float]:
        """Yield where a line from `start` (0) to `end` (1), m, NED, may cross a wall or a top."""
        tops = [self.ceiling, *(hole.height for hole in self.holes if hole.height is not None)]
        for top in tops:
            step = end[2] - start[2]
            if step and 0.0 < (share := (-top - start[2]) / step) < 1.0:
                yield share
        for corners in (self.outline(), *(hole.polygon for hole in self.holes)):
            yield from polygons.cuts(corners, start[:2], end[:2])

    @override
    def measured(self, seen: Estimate) -> float | str:
        if not seen.health.aligned:
            return NO_POSITION
        north, east, down = seen.position.tolist()
        return self.margin((north, east, down))

    @override
    def text(self) -> str:
        if self.polygon is None:
            return ""
        holes = f", {len(self.holes)} hole{'s' * (len(self.holes) != 1)}" if self.holes else ""
        return f"{len(self.polygon)} corners{holes}, height {self.ceiling:g}"

    @override
    def comparison(self) -> Comparison:
        if self.north is None or self.east is None:
            where = f"{self.text()}; {_mark(self.outline(), self.holes)}"
        else:
            limits = f"{self.north[0]:g} to {self.north[1]:g}, {self.east[0]:g} to {self.east[1]:g}"
            where = f"{limits}, {self.ceiling:g}"
            where += f"; {_mark(self.holes)}" if self.holes else ""
        quantity = Quantity(f"margin to the fence ({where})", -math.inf, unit="m")
        return Comparison(quantity, "at_least", 0.0)

    def _level(self, north: float, east: float) -> float:
        if self.north is None or self.east is None:
            return polygons.margin(self.outline(), (north, east))
        return min(
            north - self.north[0], self.north[1] - north, east - self.east[0], self.east[1] - east
        )


class Inside(ComparedGuard):
    """Holds above a `polygon` on the ground, however high.

    The verdict's value is the distance to the nearest edge, negative outside.
    """

    kind: ClassVar[str] = "inside"
    polygon: Corners = Field(description="corners in order")

    @field_validator("polygon")
    @classmethod
    def _fit(cls, corners: Corners) -> Corners:
        return _checked(corners)

    @override
    def measured(self, seen: Estimate) -> float | str:
        if not seen.health.aligned:
            return NO_POSITION
        north, east, _ = seen.position.tolist()
        return polygons.margin(self.polygon, (north, east))

    @override
    def text(self) -> str:
        return f"{len(self.polygon)} corners"

    @override
    def comparison(self) -> Comparison:
        name = f"margin to the polygon ({self.text()}; {_mark(self.polygon)})"
        return Comparison(Quantity(name, -math.inf, unit="m"), "at_least", 0.0)


def _mark(*shapes: object) -> str:
    """Return a word that tells shapes apart."""
    return f"{zlib.crc32(repr(shapes).encode()):08x}"
