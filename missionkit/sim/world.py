"""The world a mission is rehearsed in, as `worlds/*.yaml` describe it.

NED, m, with the origin at the take-off point; the ground is the plane down = 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from missionkit.geometry import Quat, Transform, from_matrix, multiply, vec
from missionkit.geometry import exp as rotation
from missionkit.sim.arena import (
    HIT_RADIUS,
    Arena,
    ObstacleRobots,
    PlacedObstacle,
    PlacedRobot,
    Robots,
)
from missionkit.sim.deck import Deck, DeckMarker
from missionkit.sim.fault_injection import FAULT_KINDS, Kind
from missionkit.sim.printed_marker import PrintedMarker
from missionkit.sim.vehicle_parameters import (
    BatteryModel,
    InnerAutopilotModel,
    ParameterModel,
    Quadrotor,
    Sensors,
)
from missionkit.units import Degrees, Metres, MetresPerSecond, Point, Seconds, Spot

SHEET = 0.001  # m, from one marker of a deck to the one that lies on it
WindSpeed = Annotated[MetresPerSecond, Field(ge=-100, le=100)]


class Ground(ParameterModel):
    """The plane down = 0 and what it looks like."""

    texture: Literal["grass", "soil", "gravel", "concrete", "grid", "lines"] = "grass"


class Wind(ParameterModel):
    """Mean wind (NED, where the air goes to) and first-order Gauss-Markov gusts.

    Each horizontal axis of the gust has standard deviation `gust`, the vertical one half of it.
    Source: Dryden's model to first order, MIL-F-8785C, at constant airspeed.
    """

    mean: tuple[WindSpeed, WindSpeed, WindSpeed] = (0.0, 0.0, 0.0)
    gust: MetresPerSecond = Field(default=0.0, ge=0, le=30)
    gust_tau: Seconds = Field(default=3.0, gt=0)


class Cylinder(ParameterModel):
    """An upright cylinder standing on the ground, such as a trunk."""

    use: Literal["cylinder"]
    at: Spot
    radius: Metres = Field(gt=0)
    height: Metres = Field(gt=0)


class Box(ParameterModel):
    """A box with sides along north and east, from `bottom` to `height` above the ground."""

    use: Literal["box"]
    min: Spot
    max: Spot
    height: Metres = Field(gt=0)
    bottom: Metres = Field(default=0.0, ge=0)

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not (self.min[0] < self.max[0] and self.min[1] < self.max[1]):
            raise ValueError("min must be south and west of max")
        if self.bottom >= self.height:
            raise ValueError("bottom must be below height")
        return self


class Sphere(ParameterModel):
    """A ball, such as a crown or a balloon; `at` is its centre, NED."""

    use: Literal["sphere"]
    at: Point
    radius: Metres = Field(gt=0)


Obstacle = Annotated[Cylinder | Box | Sphere, Field(discriminator="use")]


class Marker(PrintedMarker):
    """A printed fiducial, where it really hangs.

    `facing_deg` is the heading of its normal; `tilt_deg` raises the normal (90: lying face up, its
    upper edge then points away from `facing_deg`); `roll_deg` turns it clockwise for the viewer.
    """

    position: Point
    facing_deg: Degrees = 180.0
    tilt_deg: Degrees = 0.0
    roll_deg: Degrees = 0.0

    @property
    def attitude(self) -> Quat:
        """Marker axes (x right, y up, z towards the viewer) to world, (4,)."""
        return marker_attitude(self.facing_deg, self.tilt_deg, self.roll_deg)

    @property
    def pose(self) -> Transform:
        """Marker to world."""
        return Transform(self.attitude, vec(*self.position))


def _gap(obstacle: Cylinder | Box | Sphere, spot: Spot) -> float:
    """Return the distance (m) from a spot on the ground to an obstacle's surface."""
    north, east = spot
    match obstacle:
        case Cylinder(at=(n, e), radius=radius):
            return math.hypot(n - north, e - east) - radius
        case Sphere(at=(n, e, down), radius=radius):
            return math.hypot(n - north, e - east, down) - radius
        case Box(min=low, max=high, bottom=bottom):
            beside = (max(a - at, at - b, 0.0) for a, at, b in zip(low, spot, high, strict=True))
            return math.hypot(*beside, bottom)


def marker_attitude(facing_deg: float, tilt_deg: float = 0.0, roll_deg: float = 0.0) -> Quat:
    """Return marker-to-world (4,) of a marker whose normal has that heading and elevation.

    With no tilt and no roll the columns are x = (sin f, -cos f, 0), y = up, z = (cos f, sin f, 0).

    Args:
        facing_deg: heading of the normal, clockwise from north.
        tilt_deg: elevation of the normal.
        roll_deg: about the normal.
    """
    f = math.radians(facing_deg)
    upright = from_matrix(
        np.array(
            [
                [math.sin(f), 0.0, math.cos(f)],
                [-math.cos(f), 0.0, math.sin(f)],
                [0.0, -1.0, 0.0],
            ]
        )
    )
    tilt = rotation(vec(-math.radians(tilt_deg), 0.0, 0.0))
    roll = rotation(vec(0.0, 0.0, -math.radians(roll_deg)))
    return multiply(upright, multiply(tilt, roll))


def _on_deck(deck: Deck, it: DeckMarker, count: int) -> Marker:
    """Return a marker of a deck where it lies at the start, `count` sheets of paper high."""
    up, right = it.offset
    lift = SHEET * count
    facing, tilt = math.radians(deck.facing_deg), math.radians(deck.tilt_deg)
    north = -up * math.cos(tilt) + lift * math.sin(tilt)  # along the heading of the lean
    east = -right
    down = -deck.height - up * math.sin(tilt) - lift * math.cos(tilt)
    c, s = math.cos(facing), math.sin(facing)
    position = (deck.at[0] + c * north - s * east, deck.at[1] + s * north + c * east, down)
    return Marker(
        dictionary=it.dictionary,
        id=it.id,
        size=it.size,
        position=position,
        facing_deg=deck.facing_deg,
        tilt_deg=90.0 - deck.tilt_deg,
        roll_deg=it.roll_deg,
    )


class World(ParameterModel):
    """Everything the simulator needs to know beyond the mission file."""

    VEHICLE: ClassVar[str] = "a multicopter"
    FAULTS: ClassVar[Mapping[str, Kind]] = FAULT_KINDS

    world: str = Field(description="name")
    ground: Ground = Ground()
    wind: Wind = Wind()
    obstacles: tuple[Obstacle, ...] = ()
    markers: tuple[Marker, ...] = ()
    deck: Deck | None = None
    arena: Arena | None = None
    robots: Robots | None = None
    obstacle_robots: ObstacleRobots | None = None
    sensors: Sensors = Sensors()
    battery: BatteryModel = BatteryModel()
    quadrotor: Quadrotor = Quadrotor()
    autopilot: InnerAutopilotModel = InnerAutopilotModel()
    start: Spot = (0.0, 0.0)
    start_yaw_deg: Degrees = 0.0

    @model_validator(mode="after")
    def _room_to_start(self) -> Self:
        for count, obstacle in enumerate(self.obstacles, 1):
            if _gap(obstacle, self.start) <= self.quadrotor.radius:
                raise ValueError(f"obstacle {count} ({obstacle.use}) stands on the take-off point")
        return self

    @model_validator(mode="after")
    def _room_for_robots(self) -> Self:
        for name, at in self._robot_starts():
            if self.arena is not None and not self.arena.holds(at):
                raise ValueError(f"{name} starts outside the arena, at {at[0]:g}, {at[1]:g} m")
            near = HIT_RADIUS + self.quadrotor.radius
            if name.startswith("obstacle") and math.dist(at, self.start) <= near:
                raise ValueError(f"{name} starts on the take-off point: {near:g} m apart at least")
        return self

    def _robot_starts(self) -> Iterator[tuple[str, Spot]]:
        """Yield each robot's name in messages, and where it starts."""
        for count, robot in enumerate(self.target_starts, 1):
            yield f"robot {count}", robot.at
        for count, obstacle in enumerate(self.obstacle_starts, 1):
            yield f"obstacle robot {count}", obstacle.at

    def with_start(self, start: Spot) -> Self:
        """Return the same world with the vehicle standing elsewhere (m, north and east).

        Raises:
            ValidationError: something stands there.
        """
        return type(self).model_validate({**dict(self), "start": start})

    @model_validator(mode="after")
    def _starts_beside_the_deck(self) -> Self:
        deck = self.deck
        if deck is None:
            return self
        near = 0.5 * deck.size + self.quadrotor.radius
        if all(abs(a - b) <= near for a, b in zip(deck.at, self.start, strict=True)):
            raise ValueError("the deck stands on the take-off point")
        return self

    @property
    def all_markers(self) -> tuple[Marker, ...]:
        """The markers, then those of the deck where they are at the start."""
        return self.markers + self.deck_markers

    @property
    def deck_markers(self) -> tuple[Marker, ...]:
        """The markers on the deck where they are at the start."""
        deck = self.deck
        if deck is None:
            return ()
        return tuple(_on_deck(deck, it, count) for count, it in enumerate(deck.markers, 1))

    @property
    def middle(self) -> Spot:
        """Centre of the arena, or the take-off point's."""
        return (0.0, 0.0) if self.arena is None else self.arena.centre

    @property
    def target_starts(self) -> tuple[PlacedRobot, ...]:
        """Where the target robots start."""
        return () if self.robots is None else self.robots.starts(self.middle)

    @property
    def obstacle_starts(self) -> tuple[PlacedObstacle, ...]:
        """Where the obstacle robots start."""
        return () if self.obstacle_robots is None else self.obstacle_robots.starts(self.middle)

    def marker(self, id: int, dictionary: str | None = None) -> Marker | None:
        """Return the first marker with that id (and dictionary), if there is one."""
        for marker in self.all_markers:
            if marker.id == id and dictionary in {None, marker.dictionary}:
                return marker
        return None
