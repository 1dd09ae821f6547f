"""A landing deck that stands above the ground, leans, or drives."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from missionkit.sim.printed_marker import PrintedMarker
from missionkit.sim.vehicle_parameters import ParameterModel
from missionkit.units import Degrees, Metres, MetresPerSecond, Spot

THICK = 0.05  # m
Speed = Annotated[MetresPerSecond, Field(ge=-5, le=5)]


class DeckMarker(PrintedMarker):
    """A marker that lies on the deck, face up; its upper edge points where the deck leans from."""

    offset: Spot = Field(
        default=(0.0, 0.0), description="from the middle: up the slope, and to its right"
    )
    roll_deg: Degrees = Field(default=0.0, description="turns it clockwise, seen from above")


class Deck(ParameterModel):
    """A square deck. It keeps its attitude and height; its course may turn.

    `facing_deg` is the heading of its normal's level part: it leans that way by `tilt_deg`.
    """

    at: Spot = Field(description="its middle at the start")
    height: Metres = Field(ge=0.1, le=20, description="of its middle above the ground")
    size: Metres = Field(gt=0, le=100, description="side, along north and east")
    tilt_deg: Degrees = Field(default=0.0, ge=0, le=15, description="by which it leans")
    facing_deg: Degrees = Field(default=180.0, description="heading that it leans towards")
    velocity: tuple[Speed, Speed] = Field(default=(0.0, 0.0), description="at the start")
    turn_rate_deg: Degrees = Field(
        default=0.0, ge=-90, le=90, description="per second, of its course, clockwise"
    )
    markers: tuple[DeckMarker, ...] = Field(default=(), description="each lies on those before it")

    @model_validator(mode="after")
    def _above_ground(self) -> Self:
        if 0.5 * self.size * (abs(self.slope[0]) + abs(self.slope[1])) >= self.height:
            raise ValueError(f"at {self.height:g} m a corner of the deck is below the ground")
        return self

    @property
    def moves(self) -> bool:
        """Whether it drives."""
        return self.velocity != (0.0, 0.0)

    @property
    def slope(self) -> Spot:
        """How much farther down it is for a metre to the north and to the east."""
        lean, facing = math.tan(math.radians(self.tilt_deg)), math.radians(self.facing_deg)
        return lean * math.cos(facing), lean * math.sin(facing)

    def velocity_at(self, now: float) -> Spot:
        """Return how it drives (m/s, north and east) at `now` (s)."""
        north, east = self.velocity
        turned = math.radians(self.turn_rate_deg) * now
        c, s = math.cos(turned), math.sin(turned)
        return c * north - s * east, s * north + c * east

    def shift(self, now: float) -> Spot:
        """Return how far (m, north and east) it has driven by `now` (s).

        The integral of the velocity turned by the course's rate ω: a straight line or a circle.
        """
        north, east = self.velocity
        rate = math.radians(self.turn_rate_deg)
        along, across = now, 0.0
        if abs(rate) > 1e-9:
            along, across = math.sin(rate * now) / rate, (1.0 - math.cos(rate * now)) / rate
        return along * north - across * east, along * east + across * north
