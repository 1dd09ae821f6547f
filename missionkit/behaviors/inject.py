"""The precision task: move in, work, move back."""

from __future__ import annotations

from enum import StrEnum
from typing import Any, ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import Vec3, norm, rotate, vec
from missionkit.goal_pose import bound_of, goal_of
from missionkit.messages import Estimate, Guidance, Step, Target
from missionkit.planning.route_following import unflown
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond, Point, Seconds

WAITING_ERROR_SHARE = 0.6  # share of `within`: with a larger error the goal waits for the vehicle
LONGEST_SLIDE = 0.2  # s; after a longer gap the goal must not leap


class Phase(StrEnum):
    """Where the injection stands."""

    IN = "moving in"
    WORK = "injecting"
    OUT = "moving back"


class Progress(NamedTuple):
    """The phase, how far along the approach (m), and when work began (s)."""

    phase: Phase
    depth: float
    last: float
    since: float | None = None


class Inject(Behavior):
    """Move `depth` towards the marker from `standoff`, run the actuator for `hold`, move back.

    The goal slides along the marker's normal at `speed`, so that the error against it stays as
    small as when hovering (P1, section 7.3 keeps the tolerance during the task). It stands still
    while the vehicle is behind, and without a sighting for `patience`. The plane through the goal,
    parallel to the marker, is never crossed.
    """

    kind: ClassVar[str] = "inject"
    target: str
    standoff: Point = (1.2, 0.0, 0.0)
    turn_deg: Degrees = Field(
        default=0.0, description="of the nose from facing the marker, clockwise"
    )
    depth: Metres = Field(default=0.4, ge=0)
    hold: Seconds = 3.0
    speed: MetresPerSecond = Field(default=0.1, gt=0)
    within: Metres = Field(default=0.10, gt=0)
    patience: Seconds = 0.7
    payload: str = "injector"

    @override
    def begin(self, seen: Estimate) -> Progress:
        return Progress(Phase.IN, 0.0, seen.now)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        before: Progress = memory
        target = seen.targets.get(self.target)
        if target is None or target.seen_at is None:
            return Step(note=f"{self.target} was never seen", memory=before)
        if before.since is not None:
            before = before._replace(since=before.since + unflown(before.last, seen.now))
        waiting = seen.now - target.seen_at > self.patience or self._behind(seen)
        at_rest = before._replace(last=seen.now)
        here = at_rest if waiting else self._slide(before, seen.now)
        out, right, up = self.standoff
        goal = goal_of(target, (out - here.depth, right, up), seen.now, self.turn_deg)
        if goal is None:
            return Step(note=f"the orientation of {self.target} is unknown", memory=at_rest)
        progress = self._advance(here, norm(seen.position - goal.position), seen.now)
        velocity = None if waiting else self._velocity(target, here)
        return Step(
            Guidance(goal.position, 0.5, velocity, goal.yaw, avoid=False, work=target.position),
            payload=self.payload if progress.phase is Phase.WORK else None,
            done=progress.phase is Phase.OUT and progress.depth <= 0.0,
            goal=goal._replace(target=self.target),
            note=progress.phase,
            memory=progress,
            bound=bound_of(target, out - here.depth),
        )

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)

    def _behind(self, seen: Estimate) -> bool:
        goal = seen.goal
        return (
            goal is not None
            and norm(seen.position - goal.position) > WAITING_ERROR_SHARE * self.within
        )

    def _velocity(self, target: Target, progress: Progress) -> Vec3 | None:
        """Return the velocity of the goal (3,), m/s, NED, None while it stands still."""
        inwards = progress.phase is Phase.IN and progress.depth < self.depth
        if target.attitude is None or not (inwards or progress.phase is Phase.OUT):
            return None
        return rotate(target.attitude, vec(0.0, 0.0, -self.speed if inwards else self.speed))

    def _slide(self, progress: Progress, now: float) -> Progress:
        travelled = self.speed * min(LONGEST_SLIDE, now - progress.last)
        depth = progress.depth
        if progress.phase is Phase.IN:
            depth = min(self.depth, depth + travelled)
        elif progress.phase is Phase.OUT:
            depth = max(0.0, depth - travelled)
        return progress._replace(depth=depth, last=now)

    def _advance(self, progress: Progress, error: float, now: float) -> Progress:
        if progress.phase is Phase.IN and progress.depth >= self.depth and error <= self.within:
            return progress._replace(phase=Phase.WORK, since=now)
        if progress.phase is Phase.WORK and now - (progress.since or now) >= self.hold:
            return progress._replace(phase=Phase.OUT)
        return progress
