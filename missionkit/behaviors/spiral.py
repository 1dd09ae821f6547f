"""Search."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.control.half_space import inside
from missionkit.geometry import Vec3, norm
from missionkit.goal_pose import bound_of
from missionkit.messages import Estimate, Goal, Guidance, HalfSpace, Step, Target
from missionkit.planning.route_following import absent
from missionkit.planning.spiral_search import SpiralPath as Curve
from missionkit.plugin import Behavior
from missionkit.units import Metres, MetresPerSecond, RadiansPerSecond


class Searching(NamedTuple):
    """Memory of `spiral`."""

    centre: Vec3  # (3,), m, NED
    since: float  # s, when it began, and later by what does not count
    at: float  # s, of the last step
    returning: bool = False  # to where it was interrupted


class Spiral(Behavior):
    """Look for `target` on a widening level spiral, always facing where it was last.

    p(t) = p_center + r(t) [cos θ(t), sin θ(t), 0]  (P1, section 3.4)

    The centre lies `back` further from the target than where the search began, since a camera
    sees more from afar; with `centre` target it is the target's place, at the height of the
    vehicle, for what lies on the ground. r(t) begins with `inner` r_0. `form` is `steady` (constant
    ground speed, turns a camera `footprint` apart) or `paper` (r = r_0 + v_r t with `growth`,
    θ = ω t with `rate`). Both keep to `speed`. Round a target's place the vehicle flies over it;
    otherwise the plane `standoff` off the target's marker is never crossed. After a pause it
    continues on the curve where it was interrupted.
    """

    kind: ClassVar[str] = "spiral"
    target: str
    form: Literal["steady", "paper"] = "steady"
    speed: MetresPerSecond = Field(default=0.8, gt=0)
    footprint: Metres = Field(default=1.5, gt=0)
    inner: Metres = Field(default=0.0, ge=0, description="first radius, r_0")
    outer: Metres = Field(default=4.0, gt=0)
    centre: Literal["here", "target"] = Field(
        default="here", description="where the search began, or the target's place"
    )
    back: Metres = Field(default=1.5, ge=0)
    growth: MetresPerSecond = Field(default=0.15, gt=0)
    rate: RadiansPerSecond = Field(default=0.6, gt=0)
    standoff: Metres = Field(default=1.2, ge=0)

    @model_validator(mode="after")
    def _flyable(self) -> Self:
        _ = self._curve
        return self

    @cached_property
    def _curve(self) -> Curve:
        if self.form == "steady":
            return Curve.steady(self.speed, self.footprint, self.outer, self.inner)
        return Curve.paper(
            self.growth,
            self.rate,
            speed=self.speed,
            footprint=self.footprint,
            outer=self.outer,
            inner=self.inner,
        )

    @property
    @override
    def endless(self) -> bool:
        return True

    @override
    def begin(self, seen: Estimate) -> Searching:
        return Searching(self._middle(seen), seen.now, seen.now)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Searching = memory
        target = seen.targets.get(self.target)
        bound = None if target is None else self._bound(target, on.centre)
        due, _ = self._place(on, on.at, bound)
        off = norm(due - seen.position)
        lost, returning = absent(on.at, seen.now, off, returning=on.returning)
        on = on._replace(since=on.since + lost, at=seen.now, returning=returning)
        position, velocity = self._place(on, seen.now, bound)
        yaw = None
        if target is not None:
            offset = target.position - seen.position
            yaw = math.atan2(offset[1], offset[0])
        return Step(
            Guidance(position, 2.0 * self.speed, None if returning else velocity, yaw),
            goal=Goal(on.centre, None, on.since),
            note=f"searching for {self.target}",
            memory=on,
            bound=bound,
        )

    def _middle(self, seen: Estimate) -> Vec3:
        """Return the centre (3,), m, NED, of a search that begins here."""
        target = seen.targets.get(self.target)
        if target is None:
            return seen.position
        away = seen.position - target.position
        away[2] = 0.0
        if self.centre == "target":
            return seen.position - away
        gap = norm(away)
        return seen.position + (away * (self.back / gap) if gap > 0.1 else 0.0 * away)

    def _place(self, on: Searching, at: float, bound: HalfSpace | None) -> tuple[Vec3, Vec3]:
        """Return where to be at a time (s), and how fast that place moves: (3,), m and m/s."""
        here = self._curve.at(at - on.since)
        position = on.centre + here.position
        nearest = position if bound is None else inside(position, bound)
        return nearest, here.velocity if nearest is position else 0.0 * here.velocity

    def _bound(self, target: Target, centre: Vec3) -> HalfSpace | None:
        if self.centre == "target":
            return None
        return bound_of(target, self.standoff) or _before(target, self.standoff, centre)

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)


def _before(target: Target, out: float, centre: Vec3) -> HalfSpace | None:
    """Return the bound of a target whose marker may be turned anyhow: towards the search."""
    away = centre - target.position
    away[2] = 0.0
    gap = norm(away)
    return HalfSpace(target.position + out / gap * away, away / gap) if gap > out else None
