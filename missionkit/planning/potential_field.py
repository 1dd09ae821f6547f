"""Obstacle avoidance by an artificial potential field: P1 section 4."""

from __future__ import annotations

import math
from functools import cached_property
from typing import ClassVar

import numpy as np
from pydantic import Field

from missionkit.geometry import Vec3
from missionkit.messages import Estimate, Guidance, Points
from missionkit.planning import firas
from missionkit.planning.approach_distance import kept_distances
from missionkit.planning.avoidance_planner import AvoidancePlanner
from missionkit.planning.boundary_escape import EscapeLimits, past, progressed
from missionkit.planning.obstacle_braking import (
    DIRECTIONLESS_SPEED,
    NearbyObstacles,
    Stopping,
    admissible_speed,
    backed_off,
    braked,
    stopping_distance,
    within_sight,
)
from missionkit.planning.obstacle_weights import ObstacleWeight, factors_at
from missionkit.planning.scan_memory import FieldMemory, finite, nearby
from missionkit.plugin import Plugin
from missionkit.units import Degrees, Metres, MetresPerSecond, MetresPerSecond2, Number, Seconds

LAST_CHECK_GAIN = 3.0  # times the excess over the admissible speed that the last check takes off
RETREAT_GAIN = 6.0  # 1/s, m/s away from what is nearer than allowed, for each metre of it
BLIND_SPEED = 0.5  # m/s, enough to hold a place against the wind


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

    `weights`, `[{polygon: [[n, e], ...], factor: 3}]`, multiply the gains for what stands inside
    a polygon (P1's η_i), such as people or a mast with guys: they repel harder, though at most with
    `top_speed` and within `radius`. Braking is that of any obstacle.

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
    weights: tuple[ObstacleWeight, ...] = Field(
        default=(), description="obstacles that repel more than others, by where they stand"
    )

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
        memory = self.noted(memory, seen).aimed(goal)
        seeing = within_sight(wanted, self.fastest(memory, seen.now))
        around = self._near(memory, seen, wanted)
        if around is None:
            return seeing - wanted, memory.clear()
        distance = _length(goal - seen.position)
        fade = min(1.0, distance / self.radius)
        slowed = braked(seeing, seen.velocity, around, self.stopping)
        push = slowed + fade * self.repulsion(around, memory.points) - wanted
        hindered = _length(push) > 0.3 * _length(wanted) > DIRECTIONLESS_SPEED
        how = self._escape
        progress = progressed(memory.progress, seen, goal, around, how, hindered=hindered)
        if progress.side:
            climb = float(wanted[2])
            push = past(around, seen, progress.side, climb, self.body_radius, how) - wanted
        if not math.isfinite(_length(push)):
            return np.zeros(3), memory
        return push, memory._replace(progress=progress)

    def repulsion(self, around: NearbyObstacles, points: Points | None = None) -> Vec3:
        """Return v_rep (3,), m/s, NED, normalised and clamped as the class describes.

        Args:
            around: from each obstacle point to the vehicle.
            points: (N, 3), m, NED, the same points, which `weights` apply to.
        """
        weights = 1.0 if points is None else self._factors(points)
        distance = np.sqrt(around.squared)
        mean = firas.mean_repulsion(
            around.away, distance, self.radius, self._gain, self.body_radius, weights
        )
        size = _length(mean)
        return mean * (self.top_speed / size) if size > self.top_speed else mean

    def attraction(self, position: Vec3, goal: Vec3) -> Vec3:
        """Return v_att (3,), m/s: P1's own, for use without a position controller."""
        return firas.attraction(position, goal, self.attraction_gain)

    def potential(self, position: Vec3, goal: Vec3, points: Points) -> float:
        """Return U_total = U_att + η_xy U_rep at `position`, as P1 sums it over all points.

        Args:
            position: (3,), m, NED.
            goal: (3,), m, NED.
            points: (n, 3), m, NED, of obstacles.
        """
        return firas.attractive_potential(
            position, goal, self.attraction_gain
        ) + self.gain_xy * firas.repulsive_potential(
            position, points, self.radius, self.body_radius, self._factors(points)
        )

    def _factors(self, points: Points) -> firas.Weights:
        return factors_at(points, self.weights) if self.weights else 1.0

    def noted(self, memory: FieldMemory, seen: Estimate) -> FieldMemory:
        """Return the memory with the scan of this tick, if there is a new one."""
        at = seen.scanned_at
        if seen.obstacles is None or at is None or at <= memory.scanned_at:
            return memory
        return memory._replace(
            points=finite(seen.obstacles), scanned_at=at, sight=self._sight(seen.scan_range)
        )

    def blind(self, memory: FieldMemory, now: float) -> bool:
        """Say whether the scanner has fallen silent; one that never sent anything has not."""
        return now - self.max_age > memory.scanned_at > -math.inf

    def fastest(self, memory: FieldMemory, now: float) -> float:
        """Return the speed (m/s) from which the vehicle stops within what it sees."""
        return BLIND_SPEED if self.blind(memory, now) else self.admissible(memory.sight)

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

        Args:
            memory: with the points of the scans so far.
            seen: the estimate at this tick.
            velocity: (3,), m/s, NED, that is wanted.
            guidance: of the behaviour; nothing may be approached closely without it.
        """
        velocity = within_sight(velocity, self.fastest(memory, seen.now))
        around = self._near(memory, seen, velocity)
        if around is None:
            return velocity
        if guidance is not None and guidance.work is not None and memory.points is not None:
            full, body, goal = self.stopping.width, self.body_radius, guidance.position
            keep = kept_distances(memory.points, guidance.work, goal, body, full)
            around = around._replace(keep=keep)
        slowed = braked(velocity, seen.velocity, around, self.stopping, LAST_CHECK_GAIN)
        return backed_off(slowed, around, self.stopping, RETREAT_GAIN)

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

    @cached_property
    def _escape(self) -> EscapeLimits:
        return EscapeLimits(
            self.step_size,
            self.patience,
            self.longest,
            self.keep,
            self.escape_speed,
            self.stopping,
        )

    def _near(self, memory: FieldMemory, seen: Estimate, velocity: Vec3) -> NearbyObstacles | None:
        """Return the scan around the vehicle, or None if at this velocity it does not matter."""
        points = memory.points
        if points is None or not len(points) or seen.now - memory.scanned_at > self.max_age:
            return None
        how = self.stopping
        stop = stopping_distance(max(_length(velocity), _length(seen.velocity)), how)
        reach = max(self.radius + self.body_radius, how.width + stop)
        return nearby(points, seen.position, math.hypot(reach, self.column), self.column)


def _length(v: Vec3) -> float:
    return math.hypot(*v.tolist())


def brake_of(planner: AvoidancePlanner) -> PotentialField:
    """Return what brakes before obstacles: the planner itself, or the built-in one beside it.

    Args:
        planner: of the mission, of any package.
    """
    return planner if isinstance(planner, PotentialField) else PotentialField()
