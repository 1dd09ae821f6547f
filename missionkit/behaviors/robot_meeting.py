"""What the ways to meet a ground robot share: the flight, the descent, when it is given up."""

from __future__ import annotations

import abc
import math
from typing import Any, NamedTuple

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
from missionkit.geometry import Mat, vec
from missionkit.ground_robot import GroundRobot
from missionkit.messages import TRACKED, Estimate, Goal, Guidance, Step, Target
from missionkit.messages.robot_modes import OBSTACLE, is_obstacle, spins
from missionkit.planning.obstacle_robots import nearest_approach, obstacle_robots
from missionkit.planning.target_robots import place_ahead, stands_for, way_out
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Fraction, Metres, MetresPerSecond, MetresPerSecond2, Seconds

ROBOT = GroundRobot()
LEAD = 0.3  # s; the vehicle answers so late
SLOPE = 0.6  # of the way down, that it may have to fly level meanwhile
STRAYS = 0.1  # m, the vehicle off its plan, kept beside all distances
TOO_LATE = 0.5  # m above the ground; lower, a spin no longer ends the meeting
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
    drove: bool = False  # the robot has been seen to drive
    low: bool = False  # it descends
    ground: float = 0.0  # m, down, where the robot stands
    down_since: float | None = None  # s, when it was down
    leaves_at: float = math.inf  # s, at the latest, once it is down
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
    def _drives_before(self) -> float:
        """For how long (s) before contact the robot must have driven again after a spin."""
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
        on = on._replace(refused_since=None, drove=on.drove or not spins(target))
        if _turns(target, on) and not _committed(seen, target, on):
            return _given_up(on, f"{target.name} has begun to turn round")
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
        committed = _committed(seen, target, on)
        if math.degrees(target.heading_sd) > self.sd_deg and not committed:
            return f"the heading of {target.name} is uncertain"
        return "" if committed else self._blocked(seen, target, on)

    def _blocked(self, seen: Estimate, target: Target, on: Meeting) -> str:
        """Say which obstacle robot comes too near to the place of contact before it is left."""
        takes = self._contact_in(seen, target, on)
        spot = place_ahead(target, self._ahead, takes)
        away, robot = _nearest(seen, target, spot, takes + self._stays + UP)
        if robot is None or away >= self.keep_out + STRAYS:
            return ""
        return f"{robot.name} with its tower comes within {away:.1f} m of the place"

    def _holding(self, seen: Estimate, on: Meeting, why: str) -> Step:
        """Return the step of a vehicle that must not go on; given up soon once it descends."""
        since = seen.now if on.refused_since is None else on.refused_since
        memory = on._replace(course=Course(), refused_since=since)
        if seen.now - since >= (GRACE if on.low else self.patience) - 1e-6:
            return _given_up(memory, why)
        return Step(note=f"holding: {why}", memory=memory, lands=on.low)

    def _turned_low(self, seen: Estimate, target: Target, on: Meeting) -> Meeting:
        """Return the memory with the decision to descend, once the rest of the way is steep."""
        takes = self._contact_in(seen, target, on)
        if on.low or stands_for(target) > takes - self._drives_before:
            return on
        spot = place_ahead(target, self._ahead, takes)
        gap = math.dist(spot, seen.position[:2])
        slope = gap / max(1e-6, height_over(seen, target) - self._lowest)
        rush = seen.velocity[:2] - velocity_out(target)[:2] * (not spins(target))
        low = slope < SLOPE and math.hypot(*rush) < self.descent
        beside = _nearest(seen, target, seen.position, UP)[0]  # a plan from there leads no nearer
        return on._replace(low=low and beside >= self.keep_out + STRAYS)

    def _flown(self, seen: Estimate, target: Target, on: Meeting) -> Step:
        goal = Goal(target.position, None, seen.now, self.target)
        events: tuple[str, ...] = ()
        if is_due(on.course, seen.now) and not _turns(target, on):
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
        return max(0.0, contact - float(seen.position[2])) / (0.85 * self.descent)

    def _down(self, seen: Estimate, on: Meeting, *, done: bool) -> Step:
        """Stay on the spot, down."""
        here = vec(seen.position[0], seen.position[1], on.ground - self._lowest)
        guidance = Guidance(here, self.descent, vec(0.0, 0.0, 0.0), yaw=on.yaw, avoid=False)
        goal = Goal(here, None, seen.now, self.target)
        note = f"down before {on.robot}"
        return Step(guidance, done=done, goal=goal, note=note, memory=on, lands=True)


def height_over(seen: Estimate, target: Target) -> float:
    """Return the height (m) above the ground that the target stands on."""
    return float(target.position[2] - seen.position[2])


def moving(target: Target, ahead: float, height: float) -> Mat:
    """Return states (N + 1, 6), m and m/s, that move with the target.

    Args:
        target: with a heading.
        ahead: m, of its centre.
        height: m, above the ground it stands on.
    """
    times, stands = STEP * np.arange(STEPS + 1), stands_for(target)
    states = np.zeros((len(times), 6))
    states[:, :2] = [place_ahead(target, ahead, it) for it in times.tolist()]
    states[:, 2] = target.position[2] - height
    states[:, 3:] = np.where((times >= stands)[:, None], velocity_out(target), 0.0)
    return states


def velocity_out(target: Target) -> Mat:
    """Return the velocity (3,), m/s, at which a target drives on."""
    return np.array((*(ROBOT.speed * way_out(target)), 0.0))


def _nearest(
    seen: Estimate, target: Target, spot: Mat, within: float
) -> tuple[float, Target | None]:
    """Return how near (m) obstacle robots come to a spot within some time (s), and which one."""
    others = (it for it in obstacle_robots(seen) if it.name != target.name)
    return nearest_approach(others, (float(spot[0]), float(spot[1])), within)


def _committed(seen: Estimate, target: Target, on: Meeting) -> bool:
    """Say whether it is too late to give the meeting up."""
    return on.low and height_over(seen, target) < TOO_LATE


def _turns(target: Target, on: Meeting) -> bool:
    """Say whether the robot has begun a spin since the meeting began."""
    return on.drove and spins(target)


def _given_up(on: Meeting, why: str) -> Step:
    return Step(done=True, note=f"given up: {why}", memory=on, events=(GIVEN_UP,))
