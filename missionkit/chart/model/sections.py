"""Sections of a mission file that stand by themselves."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from missionkit.chart.model.part import Part, StateName, TargetName
from missionkit.units import Degrees, Hertz, Metres, Point, Seconds

Place3 = Annotated[Point, Field(strict=False)]


class Vehicle(Part):
    """What flies; `--vehicle` replaces it."""

    use: Literal["sim"] = "sim"


class TargetPlace(Part):
    """Where a target is, as surveyed: north, east, down of the take-off point."""

    position: Place3
    position_sd: Metres = Field(default=1.0, ge=0, description="standard deviation, one axis")
    facing_deg: Degrees | None = Field(
        default=None, description="compass direction in which its marker looks"
    )


class Settings(Part):
    """How the mission is run."""

    rate: Hertz = Field(default=20.0, ge=5, le=100, description="ticks per second")
    time_limit: Seconds = Field(default=1800.0, gt=0, description="the mission lands after this")


class Success(Part):
    """What counts as success, graded against the truth where it is known."""

    visit: StateName
    target: TargetName | None = None
    standoff: Place3 = (0.0, 0.0, 0.0)
    position: Metres = Field(default=0.1, gt=0, description="largest distance from the goal")
    yaw_deg: Degrees = Field(default=5.0, gt=0, description="largest heading error")
