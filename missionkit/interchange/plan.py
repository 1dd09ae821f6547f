"""A neutral plan: what the files of ground stations have in common.

Places are degrees, WGS 84, with heights in metres that name their reference; angles are degrees,
clockwise from north; speeds m/s. Each action knows the item of the file that it came from, so that
the ledger can say what became of it.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias

Reference: TypeAlias = Literal["above_home", "amsl", "agl", "ellipsoid", "none"]
"""What a height is measured from; `none`: there is no height."""
DEGREE_DIGITS, METRE_DIGITS = 9, 4  # 0.1 mm


class LatLon(NamedTuple):
    """A place on the map."""

    lat: float  # deg
    lon: float  # deg


class Place(NamedTuple):
    """A place on the map and a height."""

    lat: float  # deg
    lon: float  # deg
    height: float = 0.0  # m
    reference: Reference = "none"

    @property
    def spot(self) -> LatLon:
        """The place without its height."""
        return LatLon(self.lat, self.lon)


class Home(NamedTuple):
    """Where the vehicle takes off."""

    lat: float  # deg
    lon: float  # deg
    alt: float  # m above mean sea level


class TakeOff(NamedTuple):
    """Climb from the ground."""

    height: float  # m
    reference: Reference
    spot: LatLon | None  # where the file has it
    item: int


class Waypoint(NamedTuple):
    """Fly to a place."""

    place: Place
    item: int
    speed: float | None = None
    wait: float = 0.0  # s, at rest there
    heading: float | None = None  # None: along the course
    photo: bool = False  # the camera is on while it waits
    look_at: Place | None = None
    stop: bool = False


class Turns(NamedTuple):
    """Circle round a place."""

    place: Place
    radius: float  # m
    turns: float
    item: int
    clockwise: bool = True
    speed: float | None = None


class Survey(NamedTuple):
    """Photograph an area by parallel lines."""

    polygon: tuple[LatLon, ...]
    height: float  # m
    reference: Reference
    item: int
    spacing: float | None = None  # m; None: as the camera asks
    angle: float | None = None  # heading of the lines
    turn_around: float = 0.0  # m
    speed: float | None = None
    expanded: tuple[LatLon, ...] = ()  # the way that the file itself has, to compare with
    exact: bool = False  # the file has nothing that the lines of a mission could differ from


class Corridor(NamedTuple):
    """Photograph along a line."""

    line: tuple[LatLon, ...]
    breadth: float  # m
    height: float  # m
    reference: Reference
    item: int
    spacing: float | None = None  # m
    turn_around: float = 0.0  # m
    speed: float | None = None
    expanded: tuple[LatLon, ...] = ()
    exact: bool = False


class Return(NamedTuple):
    """Fly home and land."""

    item: int


class Land(NamedTuple):
    """Land at a place, or where the vehicle is."""

    spot: LatLon | None
    item: int


Action: TypeAlias = TakeOff | Waypoint | Turns | Survey | Corridor | Return | Land


class Fence(NamedTuple):
    """Ground to stay inside of and ground to stay out of."""

    outline: tuple[LatLon, ...]  # none: anywhere
    holes: tuple[tuple[tuple[LatLon, ...], int], ...]  # corners, and the item they came from
    height: float | None  # m above home; None: the file has no ceiling
    item: int = -1  # that the outline came from


class Rally(NamedTuple):
    """A place to gather at in an emergency."""

    place: Place
    item: int


class Plan(NamedTuple):
    """A whole plan."""

    home: Home | None
    actions: tuple[Action, ...] = ()
    fence: Fence | None = None
    rally: tuple[Rally, ...] = ()


def degrees(value: float) -> float:
    """Return degrees as plans keep them, to 0.1 mm."""
    return round(float(value), DEGREE_DIGITS) + 0.0


def metres(value: float) -> float:
    """Return metres as plans keep them."""
    return round(float(value), METRE_DIGITS) + 0.0
