"""The `map:` section of a mission: a file, or polygons."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from missionkit.messages.occupancy import Occupancy
from missionkit.planning.polygon_cells import drawn
from missionkit.positions import GroundPosition
from missionkit.units import Metres, Number

Span = tuple[Metres, Metres]
Polygon = Annotated[tuple[GroundPosition, ...], Field(min_length=3)]
"""Corners: north, east (m)."""

MOST_CELLS = 4_000_000


class MapModel(BaseModel):
    """Unknown keys are errors, values never change."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)


class Weight(MapModel):
    """Ground to avoid unless the detour is long."""

    polygon: Polygon
    cost: Number = Field(ge=1, description="of a metre; 1 elsewhere")


class KnownMap(MapModel):
    """The known map of the ground, in metres north and east of the take-off point."""

    file: str | None = Field(default=None, description="of ROS map_server, beside the mission")
    north: Span | None = Field(default=None, description="first and last metre of the map")
    east: Span | None = None
    resolution: Metres = Field(default=0.1, gt=0, description="edge of a cell")
    polygons: tuple[Polygon, ...] = Field(default=(), description="walls")
    weights: tuple[Weight, ...] = ()

    @model_validator(mode="after")
    def _one_or_the_other(self) -> Self:
        drawn_keys = self.model_fields_set - {"file"}
        if self.file is not None:
            if drawn_keys:
                raise ValueError(
                    f"'file' defines the whole map; leave out {', '.join(sorted(drawn_keys))}"
                )
            return self
        if self.north is None or self.east is None:
            raise ValueError("needs 'file', or 'north' and 'east' for a map of polygons")
        for key, (low, high) in (("north", self.north), ("east", self.east)):
            if high - low < self.resolution:
                raise ValueError(f"{key}: the second number must be larger by a cell at least")
        if self._cells(self.north) * self._cells(self.east) > MOST_CELLS:
            raise ValueError(f"more than {MOST_CELLS} cells; use a larger 'resolution'")
        return self

    def drawn(self) -> Occupancy | None:
        """Return the map of the polygons; None: it is in the file."""
        if self.north is None or self.east is None:
            return None
        return drawn(
            ((self.north[0], self.east[0]), (self.north[1], self.east[1])),
            self.resolution,
            self.polygons,
            [(weight.polygon, weight.cost) for weight in self.weights],
        )

    def _cells(self, span: Span) -> float:
        return (span[1] - span[0]) / self.resolution
