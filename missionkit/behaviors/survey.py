"""Mapping an area or a corridor by parallel lines."""

from __future__ import annotations

import abc
import math
from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.behaviors.route_flight import Heading, begun, guided
from missionkit.messages import CameraModel, Device, DeviceOrder, Estimate, Step
from missionkit.planning.camera_footprint import footprint
from missionkit.planning.route_following import OnRoute, RoutePoint, Triple, time_of
from missionkit.planning.survey_pattern import (
    Corner,
    best_heading,
    corridor_lines,
    extended,
    survey_lines,
)
from missionkit.plugin import Behavior
from missionkit.polygons import area, unfit
from missionkit.positions import GroundPosition
from missionkit.units import Degrees, Fraction, Metres, MetresPerSecond, Spot

NO_SPACING = "'spacing' is not given, and the camera does not look down at the ground"
TICK = 0.05  # s: a photo is taken at the tick that is nearest to its place
BEND = 1.0  # m, before a bend of a line, where it begins to turn
Line = tuple[Spot, ...]
_lines_over = lru_cache(maxsize=16)(survey_lines)  # asked at every tick
_heading_of = lru_cache(maxsize=16)(best_heading)
_lines_along = lru_cache(maxsize=16)(corridor_lines)


class OnSurvey(NamedTuple):
    """Memory of a survey."""

    entry: Spot  # m, where the vehicle was when it began
    yaw: float  # rad, when it began
    route: OnRoute
    photos: int = 0  # taken
    photo_at: Triple | None = None  # m, NED, where the last one was taken on this line


class ParallelLines(Behavior):
    """What `survey` and `corridor` have in common: lines, one after the other, and their camera."""

    height: Metres = Field(gt=0, description="above the take-off point")
    ground: Metres = Field(default=0.0, description="height of the ground above it")
    speed: MetresPerSecond = Field(default=4.0, gt=0)
    spacing: Metres | None = Field(default=None, gt=0, description="between lines, at most")
    side_overlap: Fraction = Field(
        default=0.7, lt=1, description="of pictures of neighbouring lines, without `spacing`"
    )
    turn_around: Metres = Field(
        default=4.0, ge=0, description="beyond the ends of a line, where it turns"
    )
    from_line: int = Field(default=1, ge=1, description="the first line to fly")
    heading: Heading = Field(default="course", description="where the nose points")
    payload: str | None = Field(default=None, description="actuator that is on along the lines")
    photo_every: Metres | None = Field(
        default=None, gt=0, description="along the lines, from one photo to the next"
    )
    front_overlap: Fraction | None = Field(
        default=None, lt=1, description="of photos along a line, instead of `photo_every`"
    )

    @model_validator(mode="after")
    def _above_ground(self) -> Self:
        if self.height <= self.ground:
            raise ValueError(f"height {self.height:g} m is not above ground {self.ground:g} m")
        if self.photo_every is not None and self.front_overlap is not None:
            raise ValueError("give 'photo_every' or 'front_overlap', not both")
        return self

    @abc.abstractmethod
    def lines(self, entry: Spot) -> tuple[Line, ...]:
        """Return the lines in the order flown, none if it is not known how far apart.

        Args:
            entry: m, where the vehicle comes from.
        """

    @override
    def begin(self, seen: Estimate) -> OnSurvey:
        spot = float(seen.position[0]), float(seen.position[1])
        return OnSurvey(spot, seen.yaw, begun(seen))

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: OnSurvey = memory
        lines = self.lines(on.entry)
        first = self.from_line - 1
        flown = lines[first:]
        if not flown:
            return Step(note=NO_SPACING, memory=on)
        route, ends = self._route(flown)
        step, it = guided(route, on.route, seen, on.yaw if self.heading == "free" else None)
        at = next(count for count, end in enumerate(ends) if it.on.leg <= end)
        back = ", returning to where it was interrupted" if it.on.returning else ""
        over = self._on_line(route, ends, at, it.on)
        on, orders = self._photo(on._replace(route=it.on), seen, over=over)
        taken = f", {on.photos} photos" if self.photo_every is not None else ""
        return step._replace(
            note=f"line {first + at + 1} of {len(lines)}{taken}{back}",
            payload=self.payload if over else None,
            orders=orders,
            memory=on,
        )

    def _photo(
        self, on: OnSurvey, seen: Estimate, *, over: bool
    ) -> tuple[OnSurvey, tuple[DeviceOrder, ...]]:
        """Take a photo if the last one on this line is far enough back."""
        if self.photo_every is None or not over:
            return on._replace(photo_at=None), ()
        north, east, down = seen.position.tolist()
        near = on.photo_at is not None and math.dist(on.photo_at, (north, east, down)) < (
            self.photo_every - 0.5 * TICK * self.speed
        )
        if near:
            return on, ()
        on = on._replace(photos=on.photos + 1, photo_at=(north, east, down))
        return on, (DeviceOrder(Device.CAMERA, 1, float(on.photos)),)

    def _on_line(
        self, route: tuple[RoutePoint, ...], ends: list[int], at: int, on: OnRoute
    ) -> bool:
        """Say whether the vehicle is on a line, and not where it turns."""
        starts = ends[at - 1] + 1 if at else 0
        if on.returning or on.leg <= starts:
            return False
        length = math.dist(route[on.leg - 1].position, route[on.leg].position)
        late = on.leg == ends[at] and on.along > length - self.turn_around
        return not late and (on.leg > starts + 1 or on.along >= self.turn_around)

    @override
    def with_camera(self, camera: CameraModel) -> Self:
        """Return it with the spacing that the camera asks for.

        Raises:
            ValueError: the lines cannot be flown so far apart, or are fewer than `from_line`.
        """
        ready = self
        seen = footprint(camera, self.height - self.ground)
        if self.spacing is None and seen is not None:
            ready = self.model_copy(update={"spacing": seen.across * (1.0 - self.side_overlap)})
        if self.front_overlap is not None and self.photo_every is None and seen is not None:
            every = seen.along * (1.0 - self.front_overlap)
            ready = ready.model_copy(update={"photo_every": every})
        count = len(ready.lines((0.0, 0.0)))
        if 0 < count < self.from_line:
            raise ValueError(f"'from_line' is {self.from_line}, of {count} lines")
        return ready

    @override
    def way(self, start: Triple, targets: Mapping[str, Triple]) -> tuple[Triple, ...]:
        lines = self.lines(start[:2])[self.from_line - 1 :]
        route, _ = self._route(lines)
        return tuple(it.position for it in route)

    @override
    def explained(self, camera: CameraModel) -> str:
        ready = self.with_camera(camera)
        lines = ready.lines((0.0, 0.0))
        if not lines:
            return NO_SPACING
        route, _ = ready._route(lines)  # noqa: SLF001 - of the same class
        seconds = time_of(route, route[0].position)
        length = sum(math.dist(a, b) for line in lines for a, b in pairwise(line))
        return (
            f"{ready.shape()}{len(lines)} lines {ready.spacing or 0.0:.1f} m apart or less, "
            f"{length:.0f} m in all, about {seconds:.0f} s{self._seen(camera)}"
        )

    @abc.abstractmethod
    def shape(self) -> str:
        """Return what is covered, in words that begin a sentence."""

    def _seen(self, camera: CameraModel) -> str:
        """Return what the camera makes of it."""
        seen = footprint(camera, self.height - self.ground)
        if seen is None:
            return ""
        return (
            f"; a picture covers {seen.across:.1f} m x {seen.along:.1f} m of the ground, a pixel "
            f"{100.0 * seen.pixel:.1f} cm; frames are {self.speed * camera.period:.2f} m apart"
        )

    def _route(self, lines: tuple[Line, ...]) -> tuple[tuple[RoutePoint, ...], list[int]]:
        """Return the points to fly to, and of which index the end of each line is."""
        points: list[RoutePoint] = []
        ends: list[int] = []
        for line in lines:
            first, _ = extended((line[0], line[1]), self.turn_around)
            _, last = extended((line[-2], line[-1]), self.turn_around)
            inner = [self._point(spot, BEND) for spot in line[1:-1]]
            into = max(BEND, 0.5 * self.turn_around)  # so that it is on the line where that begins
            out_of = max(BEND, self.turn_around)
            points += [self._point(first, into), *inner, self._point(last, out_of)]
            ends.append(len(points) - 1)
        return tuple(points), ends

    def _point(self, spot: Spot, radius: float) -> RoutePoint:
        return RoutePoint((*spot, -self.height), self.speed, radius=radius)


class Survey(ParallelLines):
    """Photograph the area inside `polygon` by parallel lines; done at the end of the last one.

    Neighbouring lines are at most `spacing` apart; without it, as far as the camera that looks down
    sees across less `side_overlap`. The lines lie along `angle_deg`, or along the direction that
    needs the fewest turns. They begin at the corner of the area that `entry` names, or the nearest
    one. The vehicle turns `turn_around` beyond the ends of a line, level and at speed when it is
    back over the area. A state that is left and entered again by its history goes on a little
    before where it was interrupted; `from_line` begins with a later line, for the next battery.
    `explain` tells the number of lines, their length, and the ground sample distance.

    An area that bends is cut into parts; on the way from one part to the next the vehicle may leave
    the area. Limits: at most 2000 lines; the ground is level, `ground` above the take-off point.

    Sources: H. Choset, 2000 (boustrophedon decomposition); G. Toussaint, 1983 (rotating calipers).
    """

    kind: ClassVar[str] = "survey"
    polygon: Annotated[tuple[GroundPosition, ...], Field(min_length=3, description="corners")]
    angle_deg: Degrees | None = Field(
        default=None, description="heading of the lines; absent: the one with the fewest turns"
    )
    entry: Corner | Literal["nearest"] = Field(
        default="nearest", description="corner of the area at which it begins"
    )

    @model_validator(mode="after")
    def _an_area(self) -> Self:
        if wrong := unfit(self.polygon):
            raise ValueError(f"polygon: {wrong}")
        self.lines((0.0, 0.0))
        return self

    @override
    def lines(self, entry: Spot) -> tuple[Line, ...]:
        if self.spacing is None:
            return ()
        begin = entry if self.entry == "nearest" else self.entry
        return tuple(_lines_over(self.polygon, self.spacing, self._angle(self.spacing), begin))

    @override
    def shape(self) -> str:
        angle = math.degrees(self._angle(self.spacing or 1.0))
        return f"{abs(area(self.polygon)):.0f} m² along {angle:.0f} deg: "

    def _angle(self, spacing: float) -> float:
        if self.angle_deg is not None:
            return math.radians(self.angle_deg)
        return _heading_of(self.polygon, spacing)


class Corridor(ParallelLines):
    """Photograph along `line`, such as a road or a power line; done at the end of the last pass.

    The corridor is `breadth` wide, half to each side. It is flown in as many parallel passes as
    `spacing`, or the camera and `side_overlap`, ask for, each the other way than the one before,
    the corners mitred. Everything else is as for `survey`. A corridor that turns back by more than
    150 deg, or is too wide for a bend, is refused.
    """

    kind: ClassVar[str] = "corridor"
    line: Annotated[tuple[GroundPosition, ...], Field(min_length=2, description="the middle")]
    breadth: Metres = Field(gt=0, description="of the corridor")

    @model_validator(mode="after")
    def _flyable(self) -> Self:
        _lines_along(self.line, self.breadth, self.spacing or self.breadth)
        return self

    @override
    def lines(self, entry: Spot) -> tuple[Line, ...]:
        if self.spacing is None:
            return ()
        rows = _lines_along(self.line, self.breadth, self.spacing)
        return tuple(tuple(row) for row in rows)

    @override
    def shape(self) -> str:
        length = sum(math.dist(a, b) for a, b in pairwise(self.line))
        return f"{length:.0f} m of corridor, {self.breadth:g} m wide: "
