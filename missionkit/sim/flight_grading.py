"""Grading a simulated flight by what really happened, never by what was estimated."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Protocol

import numpy as np

from missionkit.geometry import Mat, Transform, Vec3, from_euler, rotate, vec, wrap, yaw_of
from missionkit.sim.free_flyer.docking_grading import DockingGrade
from missionkit.sim.ground_truth import TrueState
from missionkit.sim.kernel_layout import TAKE_OFF
from missionkit.sim.world import Marker

NO_HEADING_BELOW = 0.17  # a normal with a smaller horizontal part has no heading


class SuccessTolerances(Protocol):
    """The `success` section of a mission, as far as grading needs it."""

    @property
    def standoff(self) -> tuple[float, float, float]:
        """Out of the marker, to its right, up along it (m)."""

    @property
    def turn_deg(self) -> float:
        """Of the nose from facing the marker, clockwise (deg)."""

    @property
    def position(self) -> float:
        """Allowed distance from the goal (m)."""

    @property
    def yaw_deg(self) -> float:
        """Allowed error of the heading (deg)."""


class GradedVisit(NamedTuple):
    """How well the vehicle stood while the mission was in the state that counts."""

    position_error: float  # m, on entry
    yaw_error: float | None  # rad, on entry; None when the marker lies flat
    worst_error: float  # m, until the state was left, an injection's stroke included
    worst_sideways: float  # m, the same across the marker's normal


class HerdGrade(NamedTuple):
    """What became of the target robots of an arena."""

    home: int  # left over the goal's side
    lost: int  # left over another
    remaining: int
    home_at: tuple[float, ...]  # s, of each, in order
    lost_at: tuple[float, ...]  # s
    bumps: int  # that robots reacted to
    touches: int  # on top, the same


class Grade(NamedTuple):
    """Grade of a flight by ground truth."""

    succeeded: bool
    visit: GradedVisit | None  # None: the state that counts was never entered
    landed: bool  # on the ground, disarmed, unhurt, after having flown
    crashed: bool
    in_air: bool  # at the end of the record
    clearance: float  # m, least distance of its surface from an obstacle, infinite without any
    distance: float  # m, flown
    duration: float  # s, armed
    energy: float  # J
    touched_at: float | None = None  # s, the ground outside landing and take-off
    estimate_error: float | None = None  # m, largest distance of the estimate in flight
    outside_fence: float | None = None  # m, farthest; None: no failsafe keeps a fence
    landing_error: float | None = None  # m, level, from where it meant to land
    docking: DockingGrade | None = None  # of a free flyer
    herd: HerdGrade | None = None  # of the robots in the world

    def as_dict(self) -> dict[str, Any]:
        """Return plain values for a report; what is not finite or not known is None."""
        visit = None if self.visit is None else self.visit._asdict()
        clearance = self.clearance if math.isfinite(self.clearance) else None
        found = {**self._asdict(), "visit": visit, "clearance": clearance}
        docking, herd = found.pop("docking"), found.pop("herd")
        if docking is not None:
            found["docking"] = docking.as_dict()
        if herd is not None:
            found["herd"] = herd._asdict()
        return found


def true_goal(marker: Marker, standoff: tuple[float, float, float]) -> Transform:
    """Return body-to-world of a level vehicle that stands off and faces the marker.

    p = p_m + out z_m + right x_m + up y_m, forward = -z_m.  Source: P1 section 2.3.
    """
    out, right, up = standoff
    position = marker.pose.apply(vec(right, up, out))
    normal = rotate(marker.attitude, vec(0.0, 0.0, 1.0))
    return Transform(from_euler(0.0, 0.0, math.atan2(-normal[1], -normal[0])), position)


def judge_visit(
    rows: Mat,
    marker: Marker,
    standoff: tuple[float, float, float],
    span: tuple[float, float],
    turn_deg: float = 0.0,
) -> GradedVisit:
    """Measure the visit that lasted over `span` (s).

    Args:
        rows: (N, TRACK_WIDTH) track.
        marker: the target's marker where it really hangs.
        standoff: out, right, up (m).
        span: when the state was entered and left, or the end of the flight.
        turn_deg: of the nose from facing the marker, clockwise.
    """
    goal = true_goal(marker, standoff)
    times = rows[:, 0]
    first = min(int(np.searchsorted(times, span[0] - 1e-6)), len(rows) - 1)
    last = max(first + 1, int(np.searchsorted(times, span[1] + 1e-6)))
    gaps = rows[first:last, 1:4] - goal.translation
    normal = rotate(marker.attitude, vec(0.0, 0.0, 1.0))
    sideways = gaps - np.outer(gaps @ normal, normal)
    yaw_error = abs(
        wrap(yaw_of(rows[first, 7:11]) - yaw_of(goal.rotation) - math.radians(turn_deg))
    )
    return GradedVisit(
        _length(gaps[0]),
        yaw_error if math.hypot(normal[0], normal[1]) > NO_HEADING_BELOW else None,
        max(map(_length, gaps)),
        max(map(_length, sideways)),
    )


def _length(gap: Vec3) -> float:
    return float(np.linalg.norm(gap))


def grade(
    rows: Mat,
    success: SuccessTolerances | None = None,
    marker: Marker | None = None,
    span: tuple[float, float] | None = None,
) -> Grade:
    """Grade a whole flight.

    It succeeded when it landed unhurt and, if the mission says what success is, entered the state
    that counts within the allowed errors.

    Args:
        rows: (N, TRACK_WIDTH) track of the flight, N >= 1.
        success: the mission's section, if it has one.
        marker: the true marker of its target, such as `World.marker(id)`.
        span: when its state was first entered and left (s), `None` if never.
    """
    visit = None
    if success is not None and marker is not None and span is not None:
        visit = judge_visit(rows, marker, success.standoff, span, success.turn_deg)
    last = TrueState.of(rows[-1])
    flying = rows[:, 14] == 0.0
    landed = last.on_ground and not last.armed and not last.crashed and bool(flying.any())
    return Grade(
        succeeded=landed and (success is None or _good(visit, success)),
        visit=visit,
        landed=landed,
        crashed=last.crashed,
        in_air=not last.on_ground,
        clearance=float(rows[:, 19].min()),
        distance=_flown(rows[:, 1:4], flying),
        duration=float(np.diff(rows[:, 0])[rows[1:, 15] > 0.0].sum()),
        energy=last.energy,
        touched_at=touched_at(rows),
    )


def touched_at(rows: Mat, below: float = -math.inf) -> float | None:
    """Return when (s) the ground was first touched outside landing and take-off.

    Args:
        rows: (N, TRACK_WIDTH) track.
        below: m, NED; what is touched higher up does not count.
    """
    flown = np.logical_or.accumulate(rows[:, 14] == 0.0)
    wrong = (
        flown
        & (rows[:, 3] >= below)
        & (rows[:, 14] > 0.0)
        & (rows[:, 15] > 0.0)
        & (rows[:, 16] < TAKE_OFF)
    )
    return float(rows[int(wrong.argmax()), 0]) if wrong.any() else None


def landed_at(rows: Mat) -> tuple[float, float]:
    """Return north and east (m) of the last place."""
    return float(rows[-1, 1]), float(rows[-1, 2])


def in_flight(rows: Mat) -> list[tuple[float, float, float]]:
    """Return where the vehicle was in the air, ten times a second at least (m, NED)."""
    places = rows[rows[:, 14] == 0.0, 1:4][::2]
    return [(north, east, down) for north, east, down in places.tolist()]


def _good(visit: GradedVisit | None, success: SuccessTolerances) -> bool:
    if visit is None or visit.position_error > success.position:
        return False
    return visit.yaw_error is None or math.degrees(visit.yaw_error) <= success.yaw_deg


def _flown(positions: Mat, flying: Mat) -> float:
    legs = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    return float(legs[flying[1:]].sum())
