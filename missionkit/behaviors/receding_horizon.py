"""Flying a plan that is made again and again, with no more work in a tick than one search."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from missionkit.geometry import Mat, Vec3, norm
from missionkit.messages import Estimate

if TYPE_CHECKING:
    from missionkit.planning.ddp.point_mass import Flight
    from missionkit.planning.ddp.solver import Plan

AGAIN = 0.2  # s between two plans: whole steps of the horizon
OFF = 0.4  # m off the plan, from which a new one begins where the vehicle is
EXCESS = 1.1  # times the limit; a vehicle that is faster comes to rest first
STEPS, STEP = 40, 0.1  # of the horizon; s
SOON = 10  # steps of a plan that must be clear while a better one is searched for
KEPT = 0.03  # m, by which a plan may be too near


class Course(NamedTuple):
    """The plan that is flown, and how far the search for one has come; an immutable value."""

    plan: Plan | None = None
    at: float = -math.inf  # s, when the plan begins
    tried: float = -math.inf  # s, of the last search
    attempt: int | None = None  # with which the search goes on at the next tick
    failed: bool = False  # the last search found no plan


def is_due(course: Course, now: float) -> bool:
    """Say whether it is time for a plan."""
    return course.attempt is not None or now - course.tried >= AGAIN - 1e-6


def start_of(course: Course, seen: Estimate, speed: float) -> tuple[Mat | None, int]:
    """Return the state (6,) to plan from, and how many steps of the last plan are flown.

    None if the vehicle is too fast to keep the limit from here, or its state is not finite.

    Args:
        course: with the last plan.
        seen: the estimate at this tick.
        speed: m/s, the limit.
    """
    if course.plan is not None:
        after = seen.now - course.at
        place, velocity = sampled(course.plan, after)
        if norm(place - seen.position) <= OFF:
            return np.concatenate([place, velocity]), round(after / STEP)
    fast = norm(seen.velocity)
    if not fast <= EXCESS * speed:
        return None, 0
    slower = min(1.0, speed / fast) if fast > 0.0 else 1.0
    start = np.concatenate([seen.position, slower * seen.velocity])
    return (start, 0) if np.isfinite(start).all() else (None, 0)


def renewed(course: Course, now: float, flight: Flight, start: Mat, flown: int) -> Course:
    """Return the course after one search: with its plan if it keeps all distances and limits.

    What is left of the last plan needs little work. Failing that, the search begins at rest, and
    then with swerves, one at each tick, until one is found or all failed. Meanwhile the last plan
    is flown if it keeps the distances for a second.

    Args:
        course: the last plan, and how far the search has come.
        now: s.
        flight: target, limits, obstacles.
        start: (6,), m and m/s.
        flown: steps of the last plan that have been flown.
    """
    from missionkit.planning.ddp.flight_plan import attempted, attempts, kept  # noqa: PLC0415
    from missionkit.planning.ddp.solver import replan  # noqa: PLC0415 - compiles kernels

    last, attempt = course.plan if flown else None, course.attempt
    if last is not None and attempt is None:
        plan, following = replan(flight.problem(), start, last, flown), 0
    else:
        plan, following = attempted(flight, start, attempt or 0), (attempt or 0) + 1
    if kept(plan):
        return Course(plan, now, now)
    if following >= attempts(flight):
        return Course(None, now, now, failed=True)
    if last is not None and not _clear(last, flown, flight):
        last = None
    return Course(last, course.at, now, following, failed=course.failed)


def _clear(plan: Plan, flown: int, flight: Flight) -> bool:
    """Say whether what is flown of a plan in the next second keeps all distances."""
    ahead = plan.states[flown : flown + SOON + 1, :2]
    if not len(ahead):
        return False
    times = flight.horizon.dt * np.arange(len(ahead))[:, None]
    return all(
        np.hypot(*(ahead - it.place - times * np.array(it.velocity)).T).min() >= it.radius - KEPT
        for it in flight.obstacles
    )


def sampled(plan: Plan, after: float) -> tuple[Vec3, Vec3]:
    """Return position (m) and velocity (m/s), (3,), NED, of a plan `after` (s) its beginning."""
    at = min(max(0.0, after / STEP), len(plan.states) - 1.0)
    k = min(int(at), len(plan.states) - 2)
    between = plan.states[k] + (at - k) * (plan.states[k + 1] - plan.states[k])
    return between[:3], between[3:]
