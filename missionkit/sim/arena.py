"""The arena of a world file, and the ground robots that drive in it.

Positions are north and east of the take-off point (m), headings clockwise from north (deg).
"""

from __future__ import annotations

import itertools
import math
from typing import Annotated, Final, Literal, Self

from pydantic import Field, model_validator

from missionkit.sim.vehicle_parameters import ParameterModel
from missionkit.units import Degrees, Metres, Seconds, Spot

MOST_ROBOTS: Final = 50
HIT_RADIUS: Final = 0.2  # m, of an obstacle robot with its tower: a vehicle that touches it crashes
Grey = Annotated[int, Field(ge=0, le=255)]
Tower = Annotated[Metres, Field(gt=0.1, le=5.0)]


class Arena(ParameterModel):
    """A square with sides along north and east.

    A target robot whose middle crosses a side is out of play and taken off the floor: `home` over
    the side `goal`, `lost` over another.
    """

    centre: Spot = (0.0, 0.0)
    side: Metres = Field(default=20.0, gt=0)
    goal: Literal["north", "east", "south", "west"] = "north"

    def holds(self, spot: Spot) -> bool:
        """Say whether a spot is inside."""
        return max(abs(a - b) for a, b in zip(spot, self.centre, strict=True)) <= 0.5 * self.side


class PlacedRobot(ParameterModel):
    """A target robot where it starts."""

    at: Spot
    heading_deg: Degrees = 0.0
    reversal: Seconds | None = Field(
        default=None, ge=0, le=20, description="until its first reversal; random if absent"
    )


class PlacedObstacle(ParameterModel):
    """An obstacle robot where it starts; it circles to its right."""

    at: Spot
    heading_deg: Degrees = 0.0
    tower: Tower = 1.5


class Robots(ParameterModel):
    """Target robots: on a ring around the arena's centre, heading outwards, or as `placed`."""

    count: int = Field(default=10, ge=1, le=MOST_ROBOTS, description="on the ring")
    ring: Metres = Field(default=1.0, gt=0, description="its radius")
    placed: Annotated[tuple[PlacedRobot, ...], Field(max_length=MOST_ROBOTS)] = ()
    plates: Annotated[tuple[Grey, ...], Field(min_length=1)] = Field(
        default=(150, 95), description="grey levels of the plates on top, in turn"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.placed and self.model_fields_set & {"count", "ring"}:
            raise ValueError("give either count and ring, or placed")
        return self

    def starts(self, centre: Spot) -> tuple[PlacedRobot, ...]:
        """Return where they start.

        Args:
            centre: of the ring.
        """
        return self.placed or tuple(
            PlacedRobot(at=spot, heading_deg=turn)
            for spot, turn in ring(centre, self.ring, self.count)
        )


class ObstacleRobots(ParameterModel):
    """Obstacle robots, which circle to their right: around the arena's centre, or as `placed`."""

    count: int = Field(default=4, ge=1, le=MOST_ROBOTS, description="on the circle")
    circle: Metres = Field(default=5.0, ge=0.5, description="radius of every one's path")
    towers: Annotated[tuple[Tower, ...], Field(min_length=1)] = Field(
        default=(1.0, 1.35, 1.65, 2.0), description="heights above the ground, in turn"
    )
    placed: Annotated[tuple[PlacedObstacle, ...], Field(max_length=MOST_ROBOTS)] = ()
    plate: Grey = Field(default=205, description="grey level of the plate on top")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.placed and self.model_fields_set & {"count", "towers"}:
            raise ValueError("give either count and towers, or placed")
        return self

    def starts(self, centre: Spot) -> tuple[PlacedObstacle, ...]:
        """Return where they start.

        Args:
            centre: of the circle.
        """
        if self.placed:
            return self.placed
        places = ring(centre, self.circle, self.count)
        return tuple(
            PlacedObstacle(at=spot, heading_deg=turn + 90.0, tower=tower)
            for (spot, turn), tower in zip(places, itertools.cycle(self.towers), strict=False)
        )


def ring(centre: Spot, radius: float, count: int) -> list[tuple[Spot, float]]:
    """Return evenly spaced places on a ring, the first in the north, and their headings outwards.

    Args:
        centre: of the ring.
        radius: m.
        count: of places.

    Returns:
        place (m) and heading (deg) of each, clockwise.
    """
    north, east = centre
    turns = [360.0 * n / count for n in range(count)]
    return [
        (
            (
                north + radius * math.cos(math.radians(turn)),
                east + radius * math.sin(math.radians(turn)),
            ),
            turn,
        )
        for turn in turns
    ]
