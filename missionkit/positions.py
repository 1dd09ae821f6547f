"""Positions as mission files write them: in metres, or in latitude and longitude.

    [north, east, down]                            metres from the origin
    {lat: 47.3, lon: 8.5, above_home: 20}          degrees, WGS 84, and a height (m)

The reference of a height is always named: `above_home`, above the take-off point; `agl`, above the
ground, which is taken as flat and level with the take-off point; or `amsl`, above mean sea level.
On the ground plane, a corner of a polygon for example, a position is `[north, east]` or
`{lat:, lon:}`.

A field of type `Position` or `GroundPosition` accepts both forms and holds metres: conversion
happens here, when a mission is loaded, with the `origin` of the validation context; its list `amsl`
collects the positions whose height is above mean sea level.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    TypeAdapter,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema
from typing_extensions import override

from missionkit.geodesy import Origin
from missionkit.units import Degrees, Metres, Point, Spot

DECIMALS = 6  # of a metre; what lies behind them is rounding, and unreadable in messages
HEIGHTS = ("agl", "amsl", "above_home")
UNNAMED = ("alt", "altitude", "height")  # heights without a reference
NO_ORIGIN = (
    "a position in latitude and longitude needs the mission's 'origin: {lat:, lon:, alt:}', "
    "where its take-off point is"
)


UNREADABLE = Origin(0.0, 0.0, 0.0)
"""Stands for an origin that is written wrongly, which is reported where it stands."""
FARTHEST = 100_000.0  # m from the origin


@dataclass(frozen=True)
class ConversionContext:
    """What a validation of positions needs as its context."""

    origin: Origin | None
    amsl: list[GeodeticPosition] = field(default_factory=list)  # found above mean sea level


class GeodeticSpot(BaseModel):
    """A place on the map, WGS 84."""

    model_config = ConfigDict(
        frozen=True, defer_build=True, extra="forbid", strict=True, allow_inf_nan=False
    )
    lat: Degrees = Field(ge=-90, le=90, description="latitude, north positive")
    lon: Degrees = Field(ge=-180, le=180, description="longitude, east positive")

    def metres(self, origin: Origin) -> tuple[float, ...]:
        """Return north, east (m) of the origin."""
        north, east, _ = origin.local(self.lat, self.lon, origin.altitude)
        return round(float(north), DECIMALS) + 0.0, round(float(east), DECIMALS) + 0.0


class GeodeticPosition(GeodeticSpot):
    """A place on the map and a height, with what the height is measured from."""

    agl: Metres | None = Field(
        default=None, description="height above the ground, flat at the take-off point's level"
    )
    amsl: Metres | None = Field(default=None, description="height above mean sea level")
    above_home: Metres | None = Field(default=None, description="height above the take-off point")

    @model_validator(mode="before")
    @classmethod
    def _named(cls, data: dict[str, object]) -> dict[str, object]:
        unnamed = [key for key in UNNAMED if key in data]
        if unnamed:
            raise ValueError(
                f"'{unnamed[0]}' does not say what the height is measured from: use one of "
                f"{', '.join(HEIGHTS)}"
            )
        return data

    @model_validator(mode="after")
    def _one_height(self) -> Self:
        given = [name for name in HEIGHTS if getattr(self, name) is not None]
        if not given:
            raise ValueError(
                "its height is missing: add one of agl, amsl, above_home (m), which names what it "
                "is measured from"
            )
        if len(given) > 1:
            raise ValueError(f"give one height, not {' and '.join(given)}")
        return self

    @override
    def metres(self, origin: Origin) -> tuple[float, ...]:
        """Return north, east, down (m) of the origin."""
        above = self.agl if self.above_home is None else self.above_home
        down = origin.altitude - self.amsl if self.amsl is not None else -(above or 0.0)
        return (*super().metres(origin), down)


class Converted(tuple[float, ...]):
    """Metres that were written in latitude and longitude, with what was written."""

    written: GeodeticSpot

    def __new__(cls, metres: tuple[float, ...], written: GeodeticSpot) -> Self:
        """Return the metres as a tuple that remembers."""
        converted = super().__new__(cls, metres)
        converted.written = written
        return converted

    @override
    def __reduce__(self) -> tuple[type[Converted], tuple[tuple[float, ...], GeodeticSpot]]:
        return Converted, (tuple(self), self.written)


class PositionForms:
    """Marks a field that holds metres and may be written in degrees."""

    def __init__(self, geodetic: type[GeodeticSpot], says: str) -> None:
        self.geodetic = geodetic
        self.written_as: tuple[type[BaseModel], ...] = (geodetic,)
        self.says = says

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Accept both forms, return metres."""

        def validate(
            data: object, metres: ValidatorFunctionWrapHandler, info: ValidationInfo
        ) -> object:
            if isinstance(data, list):
                return metres(tuple(data))  # strictness is about the numbers
            if not isinstance(data, Mapping):
                return metres(data)
            written = self.geodetic.model_validate(dict(data))
            if info.context is None or info.context.origin is None:
                raise ValueError(NO_ORIGIN)
            if wrong := _misplacement(info.context.origin, written):
                raise ValueError(wrong)
            if isinstance(written, GeodeticPosition) and written.amsl is not None:
                info.context.amsl.append(written)
            return Converted(written.metres(info.context.origin), written)

        return core_schema.with_info_wrap_validator_function(validate, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Describe both forms."""
        geodetic = self.geodetic.model_json_schema()
        heights = [{"required": [name]} for name in HEIGHTS if name in geodetic["properties"]]
        one = {"oneOf": heights} if heights else {}
        return {"anyOf": [handler(schema), {**geodetic, **one}]}


def _misplacement(origin: Origin, written: GeodeticSpot) -> str:
    away = origin.distance(written.lat, written.lon)
    if away <= FARTHEST or origin is UNREADABLE:
        return ""
    return (
        f"it lies {away / 1e3:,.0f} km from the mission's origin: check 'lat' and 'lon', their "
        "order and signs"
    )


Position = Annotated[
    Point,
    PositionForms(
        GeodeticPosition,
        "[north, east, down] (m) or {lat:, lon:, and agl:, amsl: or above_home:}",
    ),
]
"""North, east, down (m), also written {lat:, lon:, agl: | amsl: | above_home:}."""
GroundPosition = Annotated[Spot, PositionForms(GeodeticSpot, "[north, east] (m) or {lat:, lon:}")]
"""North, east (m), also written {lat:, lon:}."""


class PlaceForms:
    """Marks a field that holds metres with or without a height, or the name of a target.

    The form of what is written says which it is, so that a mistake in it gets one answer.
    """

    written_as: tuple[type[BaseModel], ...] = (GeodeticPosition,)
    says = (
        "[north, east] or [north, east, down] (m), {lat:, lon:} with or without a height, or the "
        "name of a target"
    )

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Accept each form, return metres or the name."""

        def validate(
            data: object, name: ValidatorFunctionWrapHandler, info: ValidationInfo
        ) -> object:
            if isinstance(data, Mapping):
                level = not any(key in data for key in (*HEIGHTS, *UNNAMED))
            elif isinstance(data, list | tuple):
                if len(data) not in {2, 3}:
                    raise ValueError(f"expected {self.says}, got a list of {len(data)}")
                data, level = list(data), len(data) == 2
            else:
                return name(data)
            form = _LEVEL if level else _WITH_HEIGHT
            return form.validate_python(data, strict=True, context=info.context)

        return core_schema.with_info_wrap_validator_function(validate, handler(str))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Describe each form."""
        forms = (_LEVEL.json_schema(), _WITH_HEIGHT.json_schema())
        return {"anyOf": [*forms, handler(schema)]}


_LEVEL: TypeAdapter[Spot] = TypeAdapter(GroundPosition)
_WITH_HEIGHT: TypeAdapter[Point] = TypeAdapter(Position)
Place = Annotated[Spot | Point | str, PlaceForms()]
"""North, east (m) with or without down, also written {lat:, lon:}, or the name of a target."""
