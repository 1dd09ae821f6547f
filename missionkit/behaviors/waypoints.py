"""Flight along a list of places."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar, NamedTuple, Self

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

from missionkit.behaviors.go_to import HOME
from missionkit.behaviors.route_flight import Heading, bearing, begun, guided, triple
from missionkit.geometry import vec
from missionkit.messages import Estimate, Goal, Guidance, Step, is_event
from missionkit.planning.route_following import OnRoute, Route, RoutePoint, Triple, absent
from missionkit.plugin import Behavior
from missionkit.positions import Place
from missionkit.units import Degrees, Metres, MetresPerSecond, Point, Seconds, Spot

MOST_PLACES = 2_000  # more of them take a large part of a tick to go through


class Waypoint(BaseModel):
    """One place of a route, how to fly there, and what to do there."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    at: Place = Field(description="with or without its own height, or a target of the mission")
    height: Metres | None = Field(default=None, description="above the take-off point")
    speed: MetresPerSecond | None = Field(default=None, gt=0, description="on the way there")
    heading_deg: Degrees | None = Field(default=None, description="where the nose points on it")
    look_at: str | None = Field(default=None, description="a target that the nose points at on it")
    stop: bool = Field(default=False, description="come to rest there")
    wait: Seconds = Field(default=0.0, description="at rest there")
    payload: str | None = Field(default=None, description="actuator that is on while it waits")
    event: str | None = Field(default=None, description="for the chart, once it is there")

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if self.heading_deg is not None and self.look_at is not None:
            raise ValueError("give either heading_deg or look_at")
        if self.payload is not None and self.wait == 0.0:
            raise ValueError("payload is on during 'wait': give it more than 0 s")
        if self.event is not None and not is_event(self.event):
            raise ValueError(f"expected the name of an event, got {self.event!r}")
        return self

    @property
    def stops(self) -> bool:
        """Whether it comes to rest here."""
        return self.stop or self.wait > 0.0


class WaypointForms:
    """Marks a waypoint that may be written as its place alone."""

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Accept both forms, return a waypoint."""

        def validate(
            data: object, whole: ValidatorFunctionWrapHandler, info: ValidationInfo
        ) -> object:
            bare = not isinstance(data, Mapping) or ("lat" in data and "at" not in data)
            if isinstance(data, Waypoint):
                return whole(data)
            written = {"at": data} if bare else data
            return Waypoint.model_validate(written, strict=True, context=info.context)

        return core_schema.with_info_wrap_validator_function(validate, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Describe both forms."""
        return {"anyOf": [handler(schema), *TypeAdapter(Place).json_schema()["anyOf"]]}


class OnWaypoints(NamedTuple):
    """Memory of `waypoints`."""

    route: OnRoute
    down: float  # m, NED, when it began
    yaw: float  # rad, when it began
    facing: float = 0.0  # rad, where the nose points while it waits
    at: int = 0  # the place that it waits at
    since: float | None = None  # s, since when it waits


class Waypoints(Behavior):
    """Fly along `places`, one after the other; done at the last one, at rest.

    A place is [north, east], [north, east, down] or a target, or a mapping with more about it:

        places: [[20, 0], {at: mast, height: 12, speed: 2, look_at: mast, wait: 5, event: seen}]

    A list that several states fly is a parameter of the mission, `params: {fence-walk: [...]}` and
    `places: $fence-walk`. `speed`, `height` and `heading` are those of places that do not say
    their own. A target is flown over at `height`; without that, at its own height; a place without
    any height at the one at which the flight along the places began. Places are flown by: the
    vehicle begins to turn up to `radius` before, no faster than it can turn; with `stop` or `wait`
    it comes to rest `within` of the place. If the state is left and entered again by its history,
    it goes on where it was. Limits: at most 2000 places; legs are
    straight, whatever is in the way but for `avoid`.
    """

    kind: ClassVar[str] = "waypoints"
    places: tuple[Annotated[Waypoint, WaypointForms()], ...] = Field(
        min_length=1, description="to fly to, in this order"
    )
    height: Metres | None = Field(default=None, description="above the take-off point")
    speed: MetresPerSecond = Field(default=5.0, gt=0)
    heading: Heading = Field(default="course", description="where the nose points")
    radius: Metres = Field(default=3.0, ge=0, description="before a place, where it may turn")
    within: Metres = Field(default=0.7, gt=0, description="that counts as being there")

    @model_validator(mode="after")
    def _few_enough(self) -> Self:
        if len(self.places) > MOST_PLACES:
            raise ValueError(f"{len(self.places)} places: at most {MOST_PLACES}")
        return self

    @override
    def begin(self, seen: Estimate) -> OnWaypoints:
        return OnWaypoints(begun(seen), float(seen.position[2]), seen.yaw)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: OnWaypoints = memory
        route = self._route(seen, on)
        if route is None:
            missing = next(it for it in self.targets() if it not in seen.targets)
            return Step(note=f"the position of {missing} is unknown", memory=on)
        if on.since is not None:
            return self._waiting(seen, on, route, on.since)
        it = self.places[on.route.leg]
        step, flown = guided(route, on.route, seen, self._yaw(seen, on, it))
        on = on._replace(route=flown.on)
        if flown.reached is None:
            return step._replace(memory=on)
        events = () if it.event is None else (it.event,)
        if it.wait == 0.0:
            return step._replace(memory=on, events=events)
        on = on._replace(facing=seen.yaw, at=flown.reached, since=seen.now)
        return self._waiting(seen, on, route, seen.now)._replace(events=events)

    @override
    def targets(self) -> tuple[str, ...]:
        named = [name for it in self.places for name in (it.at, it.look_at)]
        return tuple(dict.fromkeys(it for it in named if isinstance(it, str) and it != HOME))

    @override
    def way(self, start: Triple, targets: Mapping[str, Triple]) -> tuple[Triple, ...]:
        places = [_spot(it.at, targets, (0.0, 0.0, 0.0)) for it in self.places]
        return tuple(
            self._high(it, place, start[2])
            for it, place in zip(self.places, places, strict=True)
            if place is not None
        )

    def _route(self, seen: Estimate, on: OnWaypoints) -> Route | None:
        """Return the points, each made when it is asked for; None: a target is not known."""
        targets = seen.targets
        if any((seen.home is None) if it == HOME else (it not in targets) for it in self._named):
            return None
        return _Route(self, on.down, seen)

    @cached_property
    def _named(self) -> frozenset[str]:
        """The targets that are places of the route, home among them."""
        return frozenset(it.at for it in self.places if isinstance(it.at, str))

    def point(self, number: int, down: float, seen: Estimate) -> RoutePoint:
        """Return one point of the route.

        Args:
            number: of the place.
            down: m, NED, when it began.
            seen: where the targets and home are.
        """
        it = self.places[number]
        place: Spot | Triple
        if not isinstance(it.at, str):
            place = it.at
        elif it.at == HOME:
            place = (0.0, 0.0, 0.0) if seen.home is None else triple(seen.home)
        else:
            place = triple(seen.targets[it.at].position)
        high = self._high(it, place, down)
        return RoutePoint(high, it.speed or self.speed, it.stops, self.radius, self.within)

    def _high(self, it: Waypoint, place: Spot | Point, down: float) -> Triple:
        """Return a place with its height: its own, that of all, a target's, or as it began."""
        named = isinstance(it.at, str)
        if it.height is not None:
            down = -it.height
        elif len(place) == 3 and not named:
            down = place[2]
        elif self.height is not None:
            down = -self.height
        elif len(place) == 3 and it.at != HOME:
            down = place[2]
        return place[0], place[1], down

    def _yaw(self, seen: Estimate, on: OnWaypoints, it: Waypoint) -> float | None:
        if it.heading_deg is not None:
            return math.radians(it.heading_deg)
        if it.look_at is not None and it.look_at in seen.targets:
            towards = bearing(seen.position, seen.targets[it.look_at].position)
            return seen.yaw if towards is None else towards
        return on.yaw if self.heading == "free" else None

    def _waiting(self, seen: Estimate, on: OnWaypoints, route: Route, since: float) -> Step:
        """Stay at a place for its time, with its actuator on."""
        it, position, past = self.places[on.at], vec(*route[on.at].position), on.route
        off = math.dist(seen.position, position)
        lost, returning = absent(past.at, seen.now, off, returning=past.returning)
        past = past._replace(at=seen.now, returning=returning)
        on = on._replace(route=past, since=since + lost)
        left, towards = it.wait - (seen.now - since - lost), self._yaw(seen, on, it)
        return Step(
            Guidance(position, 1.0, yaw=on.facing if towards is None else towards),
            payload=it.payload if left > 0.0 else None,
            done=left <= 0.0 and on.at + 1 == len(route),
            goal=Goal(position, None, seen.now),
            note=f"{on.at + 1} of {len(route)}: waiting, {max(0.0, left):.0f} s left",
            memory=on if left > 0.0 else on._replace(since=None),
        )


@dataclass(frozen=True, slots=True)
class _Route:
    """The points of `waypoints`, of which a tick needs only those of the next legs."""

    behavior: Waypoints
    down: float  # m, NED, when it began
    seen: Estimate

    def __len__(self) -> int:
        return len(self.behavior.places)

    def __getitem__(self, number: int, /) -> RoutePoint:
        return self.behavior.point(number, self.down, self.seen)


def _spot(
    at: Spot | Point | str, targets: Mapping[str, Triple], home: Triple | None
) -> Spot | Point | None:
    if not isinstance(at, str):
        return at
    return home if at == HOME else targets.get(at)
