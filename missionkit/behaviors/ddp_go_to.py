"""Flight to a point by a plan that is made again and again."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.go_to import GoTo
from missionkit.behaviors.receding_horizon import (
    STEP,
    STEPS,
    Course,
    is_due,
    renewed,
    sampled,
    start_of,
)
from missionkit.geometry import Mat, Vec3, norm
from missionkit.messages import Estimate, Goal, Guidance, Points, Step
from missionkit.units import Metres, MetresPerSecond, MetresPerSecond2

if TYPE_CHECKING:
    from missionkit.planning.ddp.point_mass import Flight, Obstacle

LEAD = 0.3  # s; the vehicle answers so late
TURNS = 1.0  # m to the goal, nearer the nose stays
STRAYS = 0.1  # m, the vehicle off its plan, kept beside all distances
NO_PLAN = "plan.none"


class OnPlan(NamedTuple):
    """Memory of `ddp_go_to`."""

    down: float  # m, height when it began
    yaw: float  # rad, where the nose points
    course: Course = Course()
    points: Points | None = None  # of the last scan


class DdpGoTo(GoTo):
    """Fly to `target` by a receding-horizon plan round obstacles; done `within` of it, at rest.

    Every 0.2 s it plans the next 4 s by differential dynamic programming: little time, little
    acceleration, at most `speed` and `acceleration` in any direction, no nearer with the vehicle's
    surface (`body`) than `clearance` to what the scan sees and to walls of the mission's map, and
    no nearer with its centre than `keep_out` to the targets in `obstacles`, which may move. An
    obstacle counts as a column of any height. A tick does one search: a first plan among several
    obstacles may take a few ticks.

    A plan looks 4 s ahead and no farther: round a wall that is wider than that it does not find
    the way, which `follow_path` does over a map. Without a plan that keeps its distances it comes
    to rest, raises `plan.none` and tries again. `standoff` and `height` are those of `go_to`.

    Source: P4, section IV.
    """

    kind: ClassVar[str] = "ddp_go_to"
    speed: MetresPerSecond = Field(default=2.13, gt=0)
    acceleration: MetresPerSecond2 = Field(default=3.05, gt=0)
    body: Metres = Field(default=0.35, ge=0)
    clearance: Metres = Field(default=0.4, ge=0)
    obstacles: tuple[str, ...] = Field(default=(), description="targets to stay clear of")
    keep_out: Metres = Field(default=0.6, gt=0, description="from their centres")
    within: Metres = Field(default=0.5, gt=0)

    @override
    def begin(self, seen: Estimate) -> OnPlan:
        return OnPlan(float(seen.position[2]), seen.yaw)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: OnPlan = memory or self.begin(seen)  # None: begin failed
        goal = self._goal(seen, on.down)
        if goal is None:
            return Step(note=f"the position of {self.target} is unknown", memory=on)
        if seen.obstacles is not None:
            on = on._replace(points=seen.obstacles)
        events: tuple[str, ...] = ()
        if is_due(on.course, seen.now):
            course = self._planned(seen, goal, on)
            events = (NO_PLAN,) if course.failed and not on.course.failed else ()
            on = on._replace(course=course)
        gap = norm(goal.position - seen.position)
        plan, after = on.course.plan, seen.now - on.course.at
        if plan is None:
            note = f"no plan keeps its distances, {gap:.1f} m to go: coming to rest"
            return Step(stop=True, goal=goal, note=note, memory=on, events=events)
        on = on._replace(yaw=self._heading(seen, goal, on.yaw))
        place, ahead = sampled(plan, after)[0], sampled(plan, after + LEAD)[1]
        guidance = Guidance(place, self.speed, ahead, yaw=on.yaw)
        done = gap <= self.within and norm(seen.velocity) < 0.5
        return Step(guidance, done=done, goal=goal, note=f"{gap:.1f} m to go", memory=on)

    @override
    def targets(self) -> tuple[str, ...]:
        return (*super().targets(), *self.obstacles)

    @override
    def warm_up(self) -> None:
        from missionkit.planning.ddp.warm_up import warm_up  # noqa: PLC0415 - compiles kernels

        warm_up()

    def _planned(self, seen: Estimate, goal: Goal, on: OnPlan) -> Course:
        """Return the course after a search from where the last plan leads, or from where it is."""
        from missionkit.planning.ddp.point_mass import Flight, Horizon, MotionLimits  # noqa: PLC0415

        start, flown = start_of(on.course, seen, self.speed)
        if start is None or not np.isfinite(goal.position).all():
            return Course(None, seen.now, seen.now, failed=True)
        limits = MotionLimits(self.speed, self.acceleration)
        flight = Flight(self._ahead(goal.position, start), limits, horizon=Horizon(STEPS, STEP))
        flight = flight._replace(obstacles=self._around(seen, on.points, start, flight))
        return renewed(on.course, seen.now, flight, start, flown)

    def _ahead(self, goal: Vec3, start: Mat) -> Mat:
        """Return the goal as a state (6,), or one on the way to it as far as a plan reaches."""
        way = goal - start[:3]
        gap, reach = norm(way), self.speed * STEP * STEPS
        if gap <= reach:
            return np.concatenate([goal, np.zeros(3)])
        way /= gap
        return np.concatenate([start[:3] + reach * way, self.speed * way])

    def _around(
        self, seen: Estimate, points: Points | None, start: Mat, flight: Flight
    ) -> tuple[Obstacle, ...]:
        from missionkit.planning.ddp import keep_clear  # noqa: PLC0415

        here = float(start[0]), float(start[1])
        keep = self.body + self.clearance + STRAYS
        reach = self.speed * flight.horizon.duration
        found: list[Obstacle] = []
        if points is not None:
            found += keep_clear.standing(points[:, :2], here, reach + keep, keep)
        if seen.map is not None:
            wide = keep + keep_clear.half_diagonal(seen.map)
            found += keep_clear.standing(keep_clear.walls(seen.map), here, reach + wide, wide)
        named = (seen.targets[name] for name in self.obstacles if name in seen.targets)
        return (*found, *keep_clear.moving(named, here, self.keep_out + STRAYS))

    def _heading(self, seen: Estimate, goal: Goal, yaw: float) -> float:
        """Return where the nose points: to the goal, and near it as the goal says, or as before."""
        north, east, _ = (goal.position - seen.position).tolist()
        if math.hypot(north, east) > TURNS:
            return math.atan2(east, north)
        return yaw if goal.yaw is None else goal.yaw
