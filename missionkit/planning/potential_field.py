"""Obstacle avoidance by an artificial potential field: P1 section 4."""

from __future__ import annotations

import math
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from missionkit.geometry import Vec3
from missionkit.messages import Estimate, Guidance, Points
from missionkit.planning import firas
from missionkit.planning.avoidance_planner import AvoidancePlanner
from missionkit.planning.boundary_following import BoundaryProgress, follow, shorter_side
from missionkit.planning.firas import Distances
from missionkit.planning.obstacle_braking import (
    STILL,
    NearbyObstacles,
    Stopping,
    admissible_speed,
    backed_off,
    braked,
    free_path,
    stopping_distance,
    within_sight,
)
from missionkit.plugin import Plugin
from missionkit.units import Degrees, Metres, MetresPerSecond, MetresPerSecond2, Number, Seconds

OWN = 1.2  # m, around a work: what stands there is what it hangs on
ROOM = 0.2  # m, that a vehicle at its goal may still move towards what it works on
LEAST_GAP = 0.1  # m, kept from the object of a task, whatever the goal
FIRM = 3.0  # times the excess over the admissible speed that the last check takes off
RETREAT = 6.0  # 1/s, m/s away from what is nearer than allowed, for each metre of it
BLIND = 0.5  # m/s, enough to hold a place against the wind


class FieldMemory(NamedTuple):
    """Memory of the potential field between steps."""

    points: Points | None = None  # (N, 3), m, NED, of the last scan
    scanned_at: float = -math.inf  # s, when it was measured
    sight: float = math.inf  # m, how far it saw
    goal: tuple[float, float, float] | None = None  # m, NED
    progress: BoundaryProgress = BoundaryProgress()

    def clear(self) -> FieldMemory:
        """Return the memory when nothing is near: no escape, no waiting for progress."""
        if self.progress.since == math.inf:
            return self
        return self._replace(progress=BoundaryProgress(self.progress.best))


class PotentialField(Plugin):
    """Pushes the vehicle away from sensed obstacles and brings it past them.

    Three layers, from gentle to strict:

    1. Repulsion (`firas`): v_rep = diag(η) (1/d - 1/r)(1/d²) n, at most `top_speed`; of many
       points the mean, not P1's sum. It fades within `radius` of the goal, so that a goal near
       an obstacle can be reached (S. Ge, Y. Cui, "New potential functions for mobile robot path
       planning", 2000).
    2. Braking (`brake`): the speed along the path never exceeds what stops before an obstacle,
       nor what stops within `sight`, beyond which there may be one. It is the last word on every
       velocity, whatever a behaviour works at; then it asks for all the vehicle can do.
    3. Escape (`escape`): with an obstacle near and no progress of `step_size` in `patience`, a
       field tangential to the obstacle leads round it until the goal is nearer and in the open.

    d is measured from the vehicle's surface. Scanners look level and what they see stands
    upright, so each point counts as a column of half height `column`.

    Repulsion: influence radius r `radius`, gains η `gain_xy` and `gain_z`. Vehicle and sensor:
    `body_radius`, and `clearance` that braking leaves; `ray_deg` between neighbouring rays; scans
    count for `max_age`. Braking: `deceleration`, which begins after `reaction`. Escape: along the
    obstacle at `escape_speed`, `keep` away from it; after `longest` any free way to the goal ends
    it, since an estimate that jumped may never come nearer than where it began.

    `sight` is how far obstacles are seen; by default as far as the scanner says. A scanner that
    was received and falls silent leaves the vehicle blind: it holds.
    """

    kind: ClassVar[str] = "potential_field"

    radius: Metres = Field(default=5.0, gt=0)
    gain_xy: Number = Field(default=6.0, ge=0)  # m⁴/s
    gain_z: Number = Field(default=2.0, ge=0)  # m⁴/s
    top_speed: MetresPerSecond = Field(default=2.0, gt=0)
    attraction_gain: Number = Field(default=1.0, gt=0)  # 1/s
    body_radius: Metres = Field(default=0.35, ge=0)
    clearance: Metres = Field(default=0.4, ge=0)
    column: Metres = Field(default=1.0, ge=0)
    ray_deg: Degrees = Field(default=5.0, ge=0, le=30)
    deceleration: MetresPerSecond2 = Field(default=2.0, gt=0)
    reaction: Seconds = 0.7
    step_size: Metres = Field(default=0.3, gt=0)
    patience: Seconds = 0.3
    keep: Metres = Field(default=1.3, gt=0)
    longest: Seconds = 40.0
    escape_speed: MetresPerSecond = Field(default=3.0, gt=0)
    max_age: Seconds = 0.5
    sight: Metres | None = Field(default=None, gt=0)

    def begin(self) -> FieldMemory:
        """Return the memory at the start: nothing seen."""
        return FieldMemory()

    def step(
        self, memory: FieldMemory, seen: Estimate, goal: Vec3, wanted: Vec3
    ) -> tuple[Vec3, FieldMemory]:
        """Return what to add to the wanted velocity, and the next memory.

        Args:
            memory: what this returned a step ago.
            seen: the estimate at this tick; a scan counts for `max_age`.
            goal: (3,), m, NED.
            wanted: (3,), m/s, NED, velocity that would be flown if nothing were near.

        Returns:
            (3,), m/s, NED; zero when nothing is within the influence radius or the stopping
            distance, or when a number is not finite.
        """
        if not math.isfinite(_length(goal) + _length(wanted)):
            return np.zeros(3), memory
        memory = self._aimed(self.noted(memory, seen), goal)
        seeing = within_sight(wanted, self.fastest(memory, seen.now))
        around = self._near(memory, seen, wanted)
        if around is None:
            return seeing - wanted, memory.clear()
        distance = _length(goal - seen.position)
        fade = min(1.0, distance / self.radius)
        slowed = braked(seeing, seen.velocity, around, self.stopping)
        push = slowed + fade * self.repulsion(around) - wanted
        hindered = _length(push) > 0.3 * _length(wanted) > STILL
        progress = self._progress(memory.progress, seen, goal, around, hindered=hindered)
        if progress.side:
            push = self._past(around, seen, progress.side, wanted) - wanted
        if not math.isfinite(_length(push)):
            return np.zeros(3), memory
        return push, memory._replace(progress=progress)

    def repulsion(self, around: NearbyObstacles) -> Vec3:
        """Return v_rep (3,), m/s, NED, normalised and clamped as the class describes."""
        mean = firas.mean_repulsion(
            around.away, np.sqrt(around.squared), self.radius, self._gain, self.body_radius
        )
        size = _length(mean)
        return mean * (self.top_speed / size) if size > self.top_speed else mean

    def attraction(self, position: Vec3, goal: Vec3) -> Vec3:
        """Return v_att (3,), m/s: P1's own, for use without a position controller."""
        return firas.attraction(position, goal, self.attraction_gain)

    def potential(self, position: Vec3, goal: Vec3, points: Points) -> float:
        """Return U_total = U_att + η_xy U_rep at `position`, as P1 sums it over all points."""
        return firas.attractive_potential(
            position, goal, self.attraction_gain
        ) + self.gain_xy * firas.repulsive_potential(
            position, points, self.radius, self.body_radius
        )

    def noted(self, memory: FieldMemory, seen: Estimate) -> FieldMemory:
        """Return the memory with the scan of this tick, if there is a new one."""
        at = seen.scanned_at
        if seen.obstacles is None or at is None or at <= memory.scanned_at:
            return memory
        return memory._replace(
            points=_finite(seen.obstacles), scanned_at=at, sight=self._sight(seen.scan_range)
        )

    def blind(self, memory: FieldMemory, now: float) -> bool:
        """Say whether the scanner has fallen silent; one that never sent anything has not."""
        return now - self.max_age > memory.scanned_at > -math.inf

    def fastest(self, memory: FieldMemory, now: float) -> float:
        """Return the speed (m/s) from which the vehicle stops within what it sees."""
        return BLIND if self.blind(memory, now) else self.admissible(memory.sight)

    def admissible(self, sight: float) -> float:
        """Return the speed (m/s) from which the vehicle stops within `sight` (m)."""
        how = self.stopping
        return admissible_speed(sight - how.width, how) if math.isfinite(sight) else math.inf

    def brake(
        self, memory: FieldMemory, seen: Estimate, velocity: Vec3, guidance: Guidance | None = None
    ) -> Vec3:
        """Return `velocity` (3,), m/s, NED, so limited that the vehicle can stop in time.

        The last check on a setpoint. The obstacle that a behaviour works on, which is what stands
        within `OWN` of `guidance.work`, may be approached as far as its goal asks for, and no
        further.
        """
        velocity = within_sight(velocity, self.fastest(memory, seen.now))
        around = self._near(memory, seen, velocity)
        if around is None:
            return velocity
        if guidance is not None and guidance.work is not None:
            around = around._replace(keep=self._kept(memory, guidance.work, guidance.position))
        slowed = braked(velocity, seen.velocity, around, self.stopping, FIRM)
        return backed_off(slowed, around, self.stopping, RETREAT)

    def _kept(self, memory: FieldMemory, work: Vec3, goal: Vec3) -> Distances:
        """Return what is to be kept (N,), m, of each point near a work and its goal."""
        points, full = memory.points, self.stopping.width
        if points is None:
            return np.empty(0)
        own = np.hypot(points[:, 0] - work[0], points[:, 1] - work[1]) <= OWN
        apart = np.hypot(points[:, 0] - goal[0], points[:, 1] - goal[1])
        asked = apart[own].min() - ROOM if own.any() else full
        least = min(full, max(self.body_radius + LEAST_GAP, float(asked)))
        return np.where(own, least, full)

    def _sight(self, scan_range: float) -> float:
        return scan_range if self.sight is None else min(self.sight, scan_range)

    @cached_property
    def _gain(self) -> Vec3:
        return np.array([self.gain_xy, self.gain_xy, self.gain_z])

    @cached_property
    def stopping(self) -> Stopping:
        """How the vehicle stops, and how well its scanner sees."""
        return Stopping(
            self.body_radius + self.clearance,
            self.deceleration,
            self.reaction,
            math.radians(self.ray_deg),
        )

    def _aimed(self, memory: FieldMemory, goal: Vec3) -> FieldMemory:
        """Restart with a new goal."""
        x, y, z = goal.tolist()
        if memory.goal is None or math.dist(memory.goal, (x, y, z)) > 1.0:
            return memory._replace(goal=(x, y, z), progress=BoundaryProgress())
        return memory

    def _near(self, memory: FieldMemory, seen: Estimate, velocity: Vec3) -> NearbyObstacles | None:
        """Return the scan around the vehicle, or None if at this velocity it does not matter."""
        points = memory.points
        if points is None or not len(points) or seen.now - memory.scanned_at > self.max_age:
            return None
        away = seen.position - points
        squared = np.vecdot(away, away)
        how = self.stopping
        stop = stopping_distance(max(_length(velocity), _length(seen.velocity)), how)
        reach = max(self.radius + self.body_radius, how.width + stop)
        reach = math.hypot(reach, self.column)
        if not squared[squared.argmin()] <= reach * reach:
            return None
        z = away[:, 2]
        away[:, 2] = z - np.minimum(self.column, np.maximum(-self.column, z))
        return NearbyObstacles(away, np.vecdot(away, away))

    def _progress(
        self,
        last: BoundaryProgress,
        seen: Estimate,
        goal: Vec3,
        around: NearbyObstacles,
        *,
        hindered: bool,
    ) -> BoundaryProgress:
        to_goal = goal - seen.position
        distance = _length(to_goal)
        if last.since == math.inf:
            last = last._replace(since=seen.now)
        if last.side:
            farther = distance > last.best - self.step_size
            patient = seen.now - last.since < self.longest
            away = (farther and patient) or self._blocked(around, to_goal, distance)
            return last if away else BoundaryProgress(distance, seen.now)
        if distance < last.best - self.step_size:
            return BoundaryProgress(distance, seen.now)
        if not hindered or distance < self.step_size:
            return last._replace(since=seen.now)
        if seen.now - last.since < self.patience:
            return last
        passage = 2.0 * self.stopping.width
        return last._replace(side=shorter_side(around.away, to_goal, seen.velocity, passage))

    def _blocked(self, around: NearbyObstacles, to_goal: Vec3, distance: float) -> bool:
        how = self.stopping
        free = free_path(around, to_goal / distance, how)
        return free < min(distance, stopping_distance(self.escape_speed, how))

    def _past(self, around: NearbyObstacles, seen: Estimate, side: int, wanted: Vec3) -> Vec3:
        i = int(around.squared.argmin())
        gap = math.sqrt(around.squared[i]) - self.body_radius
        along = follow(around.away[i], gap, self.keep, self.escape_speed, side)
        along[2] = wanted[2]
        return braked(along, seen.velocity, around, self.stopping)


def _length(v: Vec3) -> float:
    return math.hypot(*v.tolist())


def _finite(points: Points) -> Points:
    if math.isfinite(points.sum()):
        return points
    return points[np.isfinite(points).all(axis=1)]


def brake_of(planner: AvoidancePlanner) -> PotentialField:
    """Return what brakes before obstacles: the planner itself, or the built-in one beside it.

    Args:
        planner: of the mission, of any package.
    """
    return planner if isinstance(planner, PotentialField) else PotentialField()
