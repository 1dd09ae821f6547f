"""Searches about a place: expanding square and sectors."""

from __future__ import annotations

import abc
import math
from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.behaviors.route_flight import Heading, begun, guided
from missionkit.messages import Estimate, Step
from missionkit.messages.occupancy import Spot
from missionkit.planning import search_patterns
from missionkit.planning.route_following import OnRoute, RoutePoint, Triple
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond

TURNS = {"right": 1, "left": -1}
TURNING = 1.0  # m, before a corner


class OnSearch(NamedTuple):
    """Memory of a search."""

    datum: Triple  # m, NED
    yaw: float  # rad, when it began
    route: OnRoute


class AreaSearch(Behavior):
    """What searches about a datum have in common."""

    target: str | None = Field(default=None, description="what is searched for, if it has a name")
    centre: Literal["here", "target"] = Field(
        default="here", description="the datum: where the state was entered, or the target's place"
    )
    height: Metres | None = Field(default=None, description="above the take-off point")
    speed: MetresPerSecond = Field(default=3.0, gt=0)
    heading_deg: Degrees = Field(default=0.0, description="of the first leg")
    turn: Literal["right", "left"] = Field(default="right", description="at every corner")
    heading: Heading = Field(default="course", description="where the nose points")

    @model_validator(mode="after")
    def _flyable(self) -> Self:
        if self.centre == "target" and self.target is None:
            raise ValueError("centre: target needs a target")
        self.corners()
        return self

    @abc.abstractmethod
    def corners(self) -> list[Spot]:
        """Return the corners of the pattern about the origin (m), the first one the datum."""

    @override
    def begin(self, seen: Estimate) -> OnSearch:
        north, east, down = seen.position.tolist()
        if self.height is not None:
            down = -self.height
        found = None if self.target is None else seen.targets.get(self.target)
        if self.centre == "target" and found is not None:
            north, east, _ = found.position.tolist()
        return OnSearch((north, east, down), seen.yaw, begun(seen))

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: OnSearch = memory
        yaw = on.yaw if self.heading == "free" else None
        step, it = guided(self._route(on.datum), on.route, seen, yaw)
        what = "" if self.target is None else f" for {self.target}"
        note = f"searching{what}, leg {step.note}"
        return step._replace(note=note, memory=on._replace(route=it.on))

    @override
    def targets(self) -> tuple[str, ...]:
        return () if self.target is None else (self.target,)

    @override
    def way(self, start: Triple, targets: Mapping[str, Triple]) -> tuple[Triple, ...]:
        datum = start
        if self.centre == "target":
            datum = targets.get(self.target or "", start)
        down = start[2] if self.height is None else -self.height
        return tuple(it.position for it in self._route((datum[0], datum[1], down)))

    def _route(self, datum: Triple) -> tuple[RoutePoint, ...]:
        north, east, down = datum
        return tuple(
            RoutePoint((north + n, east + e, down), self.speed, radius=TURNING)
            for n, e in self.corners()
        )


class ExpandingSquare(AreaSearch):
    """Search in an expanding square: legs of s, s, 2s, 2s, 3s, … about the datum.

    For something that is near its last place, which is seen first. Neighbouring legs are `spacing`
    apart, at most what the camera sees across; it ends when the square reaches `outer` on all
    sides. The nose points along the legs, or stays with `heading` free.

    Source: IMO and ICAO, IAMSAR Manual, volume II, section 5.5 (pattern SS).
    """

    kind: ClassVar[str] = "expanding_square"
    spacing: Metres = Field(default=4.0, gt=0, description="between neighbouring legs")
    outer: Metres = Field(default=16.0, gt=0, description="from the datum to the last legs")

    @override
    def corners(self) -> list[Spot]:
        angle = math.radians(self.heading_deg)
        return search_patterns.expanding_square(self.spacing, self.outer, angle, TURNS[self.turn])


class Sector(AreaSearch):
    """Search in sectors: three triangles of legs as long as `radius`, which meet at the datum.

    For something whose place is known well: the datum is crossed again and again, the edge is
    seen least. Each turn is by 120 deg; `passes` repeats the pattern, turned by 30 deg each time.

    Source: IMO and ICAO, IAMSAR Manual, volume II, section 5.5 (pattern VS).
    """

    kind: ClassVar[str] = "sector"
    radius: Metres = Field(default=15.0, gt=0)
    passes: int = Field(default=1, ge=1, le=6, description="each turned by 30 deg")

    @override
    def corners(self) -> list[Spot]:
        angle = math.radians(self.heading_deg)
        return search_patterns.sector(self.radius, angle, TURNS[self.turn], self.passes)
