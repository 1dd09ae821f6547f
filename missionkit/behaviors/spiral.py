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
from missionkit.planning.spiral_search import SpiralPath as Curve
from missionkit.plugin import Behavior
from missionkit.units import Metres, MetresPerSecond, RadiansPerSecond


class Centre(NamedTuple):
    """Where and when the search began."""

    position: Vec3  # (3,), m, NED
    at: float  # s


class Spiral(Behavior):
    """Look for `target` on a widening level spiral, always facing where it was last.

    p(t) = p_center + r(t) [cos θ(t), sin θ(t), 0]  (P1, section 3.4)

    The centre lies `back` further from the target than where the search began, since a camera
    sees more from afar; with `centre` target it is the target's place, at the height of the
    vehicle, for what lies on the ground. r(t) begins with `inner` r_0. `form` is `steady` (constant
    ground speed, turns a camera `footprint` apart) or `paper` (r = r_0 + v_r t with `growth`,
    θ = ω t with `rate`). Both keep to `speed`. Round a target's place the vehicle flies over it;
    otherwise the plane `standoff` off the target's marker is never crossed.
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
    def begin(self, seen: Estimate) -> Centre:
        target = seen.targets.get(self.target)
        if target is None:
            return Centre(seen.position, seen.now)
        away = seen.position - target.position
        away[2] = 0.0
        if self.centre == "target":
            return Centre(seen.position - away, seen.now)
        gap = norm(away)
        step = away * (self.back / gap) if gap > 0.1 else 0.0 * away
        return Centre(seen.position + step, seen.now)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        centre: Centre = memory
        here = self._curve.at(seen.now - centre.at)
        position, velocity = centre.position + here.position, here.velocity
        target = seen.targets.get(self.target)
        yaw, bound = None, None
        if target is not None:
            offset = target.position - seen.position
            yaw = math.atan2(offset[1], offset[0])
            bound = self._bound(target, centre)
            nearest = position if bound is None else inside(position, bound)
            velocity = velocity if nearest is position else 0.0 * velocity
            position = nearest
        return Step(
            Guidance(position, 2.0 * self.speed, velocity, yaw),
            goal=Goal(centre.position, None, centre.at),
            note=f"searching for {self.target}",
            memory=centre,
            bound=bound,
        )

    def _bound(self, target: Target, centre: Centre) -> HalfSpace | None:
        if self.centre == "target":
            return None
        return bound_of(target, self.standoff) or _before(target, self.standoff, centre)

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)


def _before(target: Target, out: float, centre: Centre) -> HalfSpace | None:
    """Return the bound of a target whose marker may be turned anyhow: towards the search."""
    away = centre.position - target.position
    away[2] = 0.0
    gap = norm(away)
    return HalfSpace(target.position + out / gap * away, away / gap) if gap > out else None
