"""Meeting a ground robot: landing in front of it, and touching its top."""

from __future__ import annotations

import abc
import math
from typing import Any, ClassVar, NamedTuple

import numpy as np
from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.receding_horizon import (
    STEP,
    STEPS,
    Course,
    is_due,
    renewed,
    sampled,
    start_of,
)
from missionkit.geometry import Mat, Vec3, vec
from missionkit.ground_robot import GroundRobot
from missionkit.messages import TRACKED, Estimate, Goal, Guidance, Step, Target
from missionkit.messages.robot_modes import OBSTACLE, is_obstacle, spins
from missionkit.planning.obstacle_robots import nearest_approach, obstacle_robots
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Fraction, Metres, MetresPerSecond, MetresPerSecond2, Seconds

ROBOT = GroundRobot()
LEAD = 0.3  # s; the vehicle answers so late
OVER = 0.35  # m, level, from which it descends
STRAYS = 0.1  # m, the vehicle off its plan, kept beside all distances
TOO_LATE = 0.5  # m above the ground; lower, a spin no longer calls the descent off
NEAR = 0.08  # m above the height of contact, that a plan counts as there
GRACE = 0.3  # s that a descent stops for before it is given up
UP = 1.5  # s, from the ground out of a robot's way
NO_PLAN = "plan.none"
GIVEN_UP = "meeting.given_up"


class Meeting(NamedTuple):
    """Memory of a meeting."""

    yaw: float  # rad, where the nose points
    robot: str | None = None  # the track it began with
    course: Course = Course()
    low: bool = False  # it descends
    ground: float = 0.0  # m, down, where the robot stands
    down_since: float | None = None  # s, when it was down
    refused_since: float | None = None  # s, since when the robot must not be met


class MeetRobot(Behavior):
    """What the two ways to meet a robot share; not a plug-in itself."""

    target: str = Field(default=TRACKED, description="to meet")
    height: Metres = Field(default=1.5, gt=0, description="above the ground, on the way")
    speed: MetresPerSecond = Field(default=2.13, gt=0)
    acceleration: MetresPerSecond2 = Field(default=3.05, gt=0)
    descent: MetresPerSecond = Field(default=1.0, gt=0, description="while it descends")
    keep_out: Metres = Field(default=0.6, gt=0, description="from obstacle robots' centres")
    chance: Fraction = Field(default=0.1, description="most, that it is an obstacle robot")
    sd_deg: Degrees = Field(default=20.0, gt=0, description="largest 1-sigma of its heading")
    patience: Seconds = Field(
        default=2.0, description="until a meeting that is not possible is given up"
    )

    @abc.abstractmethod
    def _reference(self, target: Target, on: Meeting, contact_in: float) -> Mat:
        """Return where to be (N + 1, 6), m and m/s, at each step of the horizon."""

    @abc.abstractmethod
    def _met(self, seen: Estimate, target: Target, on: Meeting) -> tuple[Meeting, bool]:
        """Return the memory, and whether the robot has been met."""

    @property
    @abc.abstractmethod
    def _lowest(self) -> float:
        """Height (m) above the ground at contact."""

    @property
    def _stays(self) -> float:
        """How long (s) it stays at the place of contact."""
        return 0.0

    @property
    @abc.abstractmethod
    def _ahead(self) -> float:
        """Distance (m) of the place of contact from the robot's centre, ahead of it."""

    @override
    def begin(self, seen: Estimate) -> Meeting:
        target = seen.targets.get(self.target)
        return Meeting(seen.yaw, None if target is None else target.name)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Meeting = memory or self.begin(seen)  # None: begin failed
        target = seen.targets.get(on.robot or self.target)
        if target is None:
            return self._holding(seen, on, f"{on.robot or self.target} is not tracked")
        on = on._replace(robot=on.robot or target.name, ground=float(target.position[2]))
        if why := self._refusal(seen, target, on):
            return self._holding(seen, on, why)
        on = on._replace(refused_since=None)
        on, met = self._met(seen, target, on)
        if met or on.down_since is not None:
            return self._down(seen, on, done=met)
        on = self._turned_low(seen, target, on)
        return self._flown(seen, target, on)

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)

    @override
    def warm_up(self) -> None:
        from missionkit.planning.ddp.warm_up import warm_up  # noqa: PLC0415 - compiles kernels

        warm_up()

    def _refusal(self, seen: Estimate, target: Target, on: Meeting) -> str:
        """Say why the robot must not be met, or not yet; "": nothing is in the way."""
        chance = target.classes.get(OBSTACLE, 0.0)
        if chance > self.chance:
            return f"{target.name} may be an obstacle robot ({chance:.2f})"
        if target.heading is None or target.heading_sd is None:
            return f"the heading of {target.name} is not known yet"
        committed = on.low and _height(seen, target) < TOO_LATE
        if math.degrees(target.heading_sd) > self.sd_deg and not committed:
            return f"the heading of {target.name} is uncertain"
        return "" if committed else self._blocked(seen, target, on)

    def _blocked(self, seen: Estimate, target: Target, on: Meeting) -> str:
        """Say which obstacle robot comes too near to the place of contact before it is left."""
        takes = self._contact_in(seen, target, on)
        spot = target.position[:2] + (self._ahead + ROBOT.speed * takes) * _along(target)
        others = (it for it in obstacle_robots(seen) if it.name != target.name)
        away, robot = nearest_approach(others, (spot[0], spot[1]), takes + self._stays + UP)
        if robot is None or away >= self.keep_out + STRAYS:
            return ""
        return f"{robot.name} with its tower comes within {away:.1f} m of the place"

    def _holding(self, seen: Estimate, on: Meeting, why: str) -> Step:
        """Return the step of a vehicle that must not go on; given up soon once it descends."""
        since = seen.now if on.refused_since is None else on.refused_since
        memory = on._replace(course=Course(), refused_since=since)
        if seen.now - since >= (GRACE if on.low else self.patience) - 1e-6:
            return Step(done=True, note=f"given up: {why}", memory=memory, events=(GIVEN_UP,))
        return Step(note=f"holding: {why}", memory=memory, lands=on.low)

    def _turned_low(self, seen: Estimate, target: Target, on: Meeting) -> Meeting:
        """Return the memory with the decision to descend, or to call the descent off."""
        if spins(target):
            return on._replace(low=on.low and _height(seen, target) < TOO_LATE)
        if on.low:
            return on
        place, way = target.position[:2] + self._ahead * _along(target), _velocity(target)[:2]
        gap, rush = place - seen.position[:2], seen.velocity[:2] - way
        return on._replace(low=bool(math.hypot(*gap) < OVER and math.hypot(*rush) < self.descent))

    def _flown(self, seen: Estimate, target: Target, on: Meeting) -> Step:
        goal = Goal(target.position, None, seen.now, self.target)
        events: tuple[str, ...] = ()
        if is_due(on.course, seen.now):
            course = self._planned(seen, target, on)
            events = (NO_PLAN,) if course.failed and not on.course.failed else ()
            on = on._replace(course=course)
        plan, after = on.course.plan, seen.now - on.course.at
        if plan is None:
            note = f"no plan to {target.name} keeps its distances: coming to rest"
            return Step(stop=True, goal=goal, note=note, memory=on, events=events)
        place, ahead = sampled(plan, after)[0], sampled(plan, after + LEAD)[1]
        note = f"{'descending before' if on.low else 'flying to'} {target.name}"
        guidance = Guidance(place, self.speed, ahead, yaw=on.yaw, avoid=not on.low)
        return Step(guidance, goal=goal, note=note, memory=on, events=events, lands=on.low)

    def _planned(self, seen: Estimate, target: Target, on: Meeting) -> Course:
        from missionkit.planning.ddp import keep_clear  # noqa: PLC0415 - compiles kernels
        from missionkit.planning.ddp.point_mass import Flight, Horizon, MotionLimits  # noqa: PLC0415

        speed = self.descent if on.low else self.speed
        start, flown = start_of(on.course, seen, self.speed)
        if start is None:
            return Course(None, seen.now, seen.now, failed=True)
        start[3:] *= min(1.0, speed / max(1e-9, math.hypot(*start[3:])))
        reference = self._reference(target, on, self._contact_in(seen, target, on))
        others = (it for name, it in seen.targets.items() if is_obstacle(it) and it.name == name)
        here = float(start[0]), float(start[1])
        flight = Flight(
            reference,
            MotionLimits(speed, self.acceleration),
            tuple(keep_clear.moving(others, here, self.keep_out + STRAYS)),
            horizon=Horizon(STEPS, STEP),
        )
        return renewed(on.course, seen.now, flight, start, flown)

    def _contact_in(self, seen: Estimate, target: Target, on: Meeting) -> float:
        """Return the time (s) until contact, by the plan that is flown if it leads there."""
        contact = float(target.position[2]) - self._lowest
        if on.low and on.course.plan is not None:
            there = np.flatnonzero(on.course.plan.states[:, 2] >= contact - NEAR)
            if len(there):
                return max(0.0, STEP * int(there[0]) - (seen.now - on.course.at))
        return max(0.0, contact - float(seen.position[2])) / (0.7 * self.descent)

    def _down(self, seen: Estimate, on: Meeting, *, done: bool) -> Step:
        """Stay on the spot, down."""
        here = vec(seen.position[0], seen.position[1], on.ground - self._lowest)
        guidance = Guidance(here, self.descent, vec(0.0, 0.0, 0.0), yaw=on.yaw, avoid=False)
        goal = Goal(here, None, seen.now, self.target)
        note = f"down before {on.robot}"
        return Step(guidance, done=done, goal=goal, note=note, memory=on, lands=True)


class LandInFront(MeetRobot):
    """Land in front of a tracked robot so that its bumper hits the vehicle and it turns by 180 deg.

    A plan by differential dynamic programming leads the robot by its speed times the time until
    touch-down, and by `block`, the distance of the centres then: the robot has 0.17 m to its
    bumper, so that under 0.37 m it would be a touch on top of a vehicle of 0.2 m. First it flies
    ahead of the robot at `height`, then down to `lowest`, where it waits; done once the robot
    spins, or after `wait`, for from down there the camera may lose it.

    It never lands before a robot that may be an obstacle robot, nor while the heading is not known,
    nor where an obstacle robot would come within `keep_out` before it is up again; then it holds
    and says so. After `patience`, and at once when it has begun to descend, it gives up: it is
    done, with the event `meeting.given_up`, wherever it is then. A spin that begins above 0.5 m
    calls the descent off. The way keeps clear of obstacle robots, which carry towers up to 2 m, as
    if they had any height.

    Source: P4, sections IV and V; the goal is (35) with all six components.
    """

    kind: ClassVar[str] = "land_in_front"
    block: Metres = Field(default=0.45, gt=0, description="distance of centres at touch-down")
    lowest: Metres = Field(default=0.05, ge=0, description="above the ground, down")
    wait: Seconds = Field(default=1.5, description="down, for the bump")

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Meeting = memory or self.begin(seen)  # None: begin failed
        if on.down_since is None:
            return super().step(seen, on)
        target = seen.targets.get(on.robot or "")
        turned = target is not None and spins(target)
        here = float(seen.position[0]), float(seen.position[1])
        away = nearest_approach(obstacle_robots(seen), here, 2.0 * UP)[0]
        over = seen.now - on.down_since >= self.wait or away < self.keep_out
        return self._down(seen, on, done=turned or over)

    @property
    @override
    def _lowest(self) -> float:
        return self.lowest

    @property
    @override
    def _stays(self) -> float:
        return self.wait

    @property
    @override
    def _ahead(self) -> float:
        return self.block

    @override
    def _reference(self, target: Target, on: Meeting, contact_in: float) -> Mat:
        if not on.low:
            return _moving(target, self.block, self.height)
        spot = np.zeros(6)
        lead = self.block * _along(target) + contact_in * _velocity(target)[:2]
        spot[:2] = target.position[:2] + lead
        spot[2] = target.position[2] - self.lowest
        return spot

    @override
    def _met(self, seen: Estimate, target: Target, on: Meeting) -> tuple[Meeting, bool]:
        if on.low and _height(seen, target) <= self.lowest + NEAR:
            on = on._replace(down_since=seen.now)
        return on, False


class TouchTop(MeetRobot):
    """Touch the plate on top of a tracked robot, so that it turns by 45 deg clockwise.

    A plan by differential dynamic programming follows the robot, first at `height` and then down
    onto its plate, `plate` above the ground; done when the vehicle is there. It refuses as
    `land_in_front` does, and waits while the robot spins, for it would not notice.

    Source: P4, section IV; the organisers' firmware.
    """

    kind: ClassVar[str] = "touch_top"
    plate: Metres = Field(default=ROBOT.height, gt=0, description="above the ground")

    @property
    @override
    def _lowest(self) -> float:
        return self.plate - 0.02

    @property
    @override
    def _ahead(self) -> float:
        return 0.0

    @override
    def _reference(self, target: Target, on: Meeting, contact_in: float) -> Mat:
        return _moving(target, 0.0, self._lowest if on.low else self.height)

    @override
    def _met(self, seen: Estimate, target: Target, on: Meeting) -> tuple[Meeting, bool]:
        return on, on.low and _height(seen, target) <= self.plate + 0.01


def _height(seen: Estimate, target: Target) -> float:
    """Return the height (m) above the ground that the target stands on."""
    return float(target.position[2] - seen.position[2])


def _along(target: Target) -> Mat:
    """Return the direction (2,) in which the target heads."""
    heading = target.heading or 0.0
    return np.array((math.cos(heading), math.sin(heading)))


def _velocity(target: Target) -> Vec3:
    return np.array((*(ROBOT.speed * _along(target)), 0.0))


def _moving(target: Target, ahead: float, height: float) -> Mat:
    """Return states (N + 1, 6) that move with the target, `ahead` of it (m) at a `height` (m)."""
    times = STEP * np.arange(STEPS + 1)[:, None]
    velocity = _velocity(target) * (not spins(target))
    place = np.array((*(target.position[:2] + ahead * _along(target)), target.position[2] - height))
    return np.hstack((place + times * velocity, np.tile(velocity, (len(times), 1))))
