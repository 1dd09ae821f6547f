"""Sections of a mission file that stand by themselves."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from missionkit.chart.model.model_base import MissionPart, StateName, TargetName
from missionkit.chart.text.located_data import LocatedList, LocatedTable
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.geodesy import Origin
from missionkit.positions import GroundPosition, Position
from missionkit.units import Degrees, Hertz, Metres, Point, Seconds

Place3 = Annotated[Point, Field(strict=False)]


class VehicleSection(MissionPart):
    """The kind of vehicle, simulated; `--vehicle` replaces a multicopter by a real one."""

    use: Literal["sim", "free_flyer"] = Field(
        default="sim", description="sim: a multicopter; free_flyer: a satellite with thrusters"
    )
    start: GroundPosition | None = Field(
        default=None, description="where a simulated multicopter stands, instead of the world's"
    )

    @model_validator(mode="after")
    def _on_the_ground(self) -> Self:
        if self.start is not None and self.use != "sim":
            raise sentences(sentence(f"a {self.use} has no place on the ground", "start"))
        return self


class OriginSection(MissionPart):
    """Where on the earth the mission's [0, 0, 0] is: the take-off point, WGS 84."""

    lat: Degrees = Field(ge=-90, le=90, description="latitude, north positive")
    lon: Degrees = Field(ge=-180, le=180, description="longitude, east positive")
    alt: Metres = Field(
        ge=-1000, le=10_000, description="altitude of the take-off point above mean sea level"
    )

    @property
    def geodetic(self) -> Origin:
        """The origin that positions are converted with."""
        return Origin(self.lat, self.lon, self.alt)


class TargetPlace(MissionPart):
    """Where a target is, as surveyed."""

    position: Position
    position_sd: Metres = Field(default=1.0, ge=0, description="standard deviation, one axis")
    facing_deg: Degrees | None = Field(
        default=None, description="compass direction in which its marker looks"
    )


def seconds_since_1970(text: str) -> float:
    """Return a date with its time and zone in s since 1970.

    >>> seconds_since_1970("1970-01-02T01:00:00+01:00")
    86400.0

    Raises:
        ValueError: it is none, or without a zone.
    """
    expected = "expected a date with time and zone, such as 2026-06-01T08:00:00Z"
    try:
        date = datetime.fromisoformat(text)
    except ValueError as error:
        raise ValueError(f"{expected}, got {text!r}") from error
    if date.tzinfo is None:
        raise ValueError(f"{expected}: {text!r} has no zone")
    return date.timestamp()


class Settings(MissionPart):
    """How the mission is run."""

    rate: Hertz = Field(default=20.0, ge=5, le=100, description="ticks per second")
    time_limit: Seconds = Field(default=1800.0, gt=0, description="the mission lands after this")
    date: str | None = Field(
        default=None,
        description="when a simulated flight starts, as 2026-06-01T08:00:00Z; else it has no date",
    )

    @field_validator("date")
    @classmethod
    def _a_date(cls, text: str | None) -> str | None:
        if text is not None:
            seconds_since_1970(text)
        return text

    @property
    def utc(self) -> float | None:
        """When a simulated flight starts (s since 1970); None: it has no date."""
        return None if self.date is None else seconds_since_1970(self.date)


class Success(MissionPart):
    """One condition of success, graded against the truth where it is known."""

    visit: StateName | None = Field(default=None, description="must have been entered")
    target: TargetName | None = Field(default=None, description="to be in front of on entry")
    standoff: Place3 = (0.0, 0.0, 0.0)
    turn_deg: Degrees = Field(
        default=0.0, description="of the nose from facing the marker, clockwise"
    )
    position: Metres = Field(default=0.1, gt=0, description="largest distance from the goal")
    yaw_deg: Degrees = Field(default=5.0, gt=0, description="largest heading error")
    done: StateName | None = Field(default=None, description="its behaviour must have finished")
    docked: TargetName | None = Field(
        default=None, description="that it ends docked to, within 'position' and 'attitude_deg'"
    )
    attitude_deg: Degrees = Field(default=5.0, gt=0, description="largest error when docked")
    clearance: Metres | None = Field(
        default=None, ge=0, description="least distance between its surface and obstacles in flight"
    )
    failsafes: int | None = Field(
        default=None, ge=0, description="greatest number that may be taken"
    )
    robots_home: int | None = Field(
        default=None, ge=1, description="least number of ground robots over the goal's side"
    )

    @model_validator(mode="after")
    def _asks_for_something(self) -> Self:
        names = ("visit", "done", "docked", "clearance", "failsafes", "robots_home")
        if all(getattr(self, name) is None for name in names):
            wanted = ", ".join(f"'{name}'" for name in names)
            raise sentences(sentence(f"needs at least one of {wanted}"))
        goal = {"target", "standoff", "turn_deg", "yaw_deg"} & self.model_fields_set
        if self.visit is None and self.docked is None:
            goal |= {"position"} & self.model_fields_set
        if self.visit is None and goal:
            raise sentences(sentence(f"'{min(goal)}' needs 'visit': the state it is measured in"))
        if self.docked is None and "attitude_deg" in self.model_fields_set:
            raise sentences(sentence("'attitude_deg' needs 'docked': the target"))
        return self


def one_or_more(data: object) -> object:
    """Return a list of conditions; one alone may be written without the list."""
    if not isinstance(data, LocatedTable):
        return data
    row = LocatedList(data.place)
    row.put(data, data.place)
    return row
