"""Never faster towards an obstacle than the vehicle can stop.

Source: D. Fox, W. Burgard, S. Thrun, "The dynamic window approach to collision avoidance", 1997.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Vec3
from missionkit.messages import Points

DIRECTIONLESS_SPEED = 0.05  # m/s, below which a direction means nothing


class NearbyObstacles(NamedTuple):
    """Sensed points near the vehicle."""

    away: Points  # (N, 3), m, NED, from each point to the vehicle
    squared: npt.NDArray[np.float64]  # (N,), m², squared lengths of `away`
    keep: npt.NDArray[np.float64] | None = None  # (N,), m, to be kept; None: the width for all


class Stopping(NamedTuple):
    """How the vehicle stops, and how well it sees."""

    width: float  # m, radius of the corridor that must be free: body and clearance
    deceleration: float  # m/s²
    reaction: float  # s, before it begins to slow down
    spread: float = 0.0  # rad, between neighbouring rays: an edge may hide between two of them


def admissible_speed(free: float, how: Stopping) -> float:
    """Return the speed (m/s) that stops within `free` metres: v t + v²/(2a) = free."""
    if free <= 0.0:
        return 0.0
    lost = how.deceleration * how.reaction
    return math.sqrt(lost * lost + 2.0 * how.deceleration * free) - lost


def stopping_distance(speed: float, how: Stopping) -> float:
    """Return the metres it takes to stop from `speed` (m/s); inverse of `admissible_speed`."""
    return speed * how.reaction + speed * speed / (2.0 * how.deceleration)


def free_path(around: NearbyObstacles, heading: Vec3, how: Stopping) -> float:
    """Return how far (m) a ball of radius `width` can go along the unit vector `heading`.

    Where `around` says what is to be kept of each point, that counts instead of `width`.

    With `spread` the corridor widens ahead as the rays of the scanner do, since an edge may
    stand unseen between two of them. Infinity when nothing is in the way; zero when something
    already touches and lies ahead.

    Args:
        around: points from the vehicle (m, NED).
        heading: (3,), unit vector, NED.
        how: width and spread of the corridor.
    """
    ahead = -(around.away @ heading)
    keep = how.width if around.keep is None else around.keep
    width = keep + how.spread * ahead
    slack = width * width - around.squared + ahead * ahead
    gaps = (ahead - np.sqrt(np.maximum(slack, 0.0)))[(slack > 0.0) & (ahead > 0.0)]
    return max(0.0, float(gaps[gaps.argmin()])) if len(gaps) else math.inf


def braked(
    velocity: Vec3, actual: Vec3, around: NearbyObstacles, how: Stopping, firmness: float = 1.0
) -> Vec3:
    """Return `velocity` slowed so that neither it nor the motion under way leads to a collision.

    The command is limited first along the direction in which the vehicle moves: to the
    admissible speed, and by `firmness` times what the vehicle exceeds it less, in wind for
    instance. Then it is limited along its own direction, which it keeps.

    Args:
        velocity: (3,), m/s, NED, about to be commanded.
        actual: (3,), m/s, NED, of the vehicle.
        around: what is near.
        how: how the vehicle stops.
        firmness: 1 brakes as planned; more asks the vehicle for all it can do.
    """
    size = math.hypot(*actual.tolist())
    if size > DIRECTIONLESS_SPEED:
        heading = actual / size
        top = admissible_speed(free_path(around, heading, how), how)
        velocity = _limited(velocity, heading, min(top, top - firmness * (size - top)))
    size = math.hypot(*velocity.tolist())
    if size <= DIRECTIONLESS_SPEED:
        return velocity
    heading = velocity / size
    return _limited(velocity, heading, admissible_speed(free_path(around, heading, how), how))


def backed_off(velocity: Vec3, around: NearbyObstacles, how: Stopping, gain: float) -> Vec3:
    """Return `velocity` with what leaves the point that is nearer than allowed, if there is one.

    v n >= gain (keep - d), n level from the point to the vehicle, d its distance: what pushes the
    vehicle in, such as wind, is held in balance the further in it is.

    Args:
        velocity: (3,), m/s, NED, about to be commanded.
        around: what is near.
        how: how the vehicle stops.
        gain: 1/s.
    """
    keep = how.width if around.keep is None else around.keep
    gaps = np.sqrt(around.squared) - keep
    i = int(gaps.argmin())
    x, y = around.away[i, 0], around.away[i, 1]
    size = math.hypot(x, y)
    if gaps[i] >= 0.0 or size == 0.0:
        return velocity
    out = np.array([x / size, y / size, 0.0])
    lacking = gain * -float(gaps[i]) - float(velocity @ out)
    return velocity + lacking * out if lacking > 0.0 else velocity


def within_sight(velocity: Vec3, top: float) -> Vec3:
    """Return `velocity` (3,), m/s, NED, whose level part is at most `top` (m/s)."""
    level = math.hypot(velocity[0], velocity[1])
    if level <= top:
        return velocity
    k = top / level
    return np.array([k * velocity[0], k * velocity[1], velocity[2]])


def _limited(velocity: Vec3, heading: Vec3, top: float) -> Vec3:
    """Return `velocity` with at most `top` (m/s) along the unit vector `heading`."""
    excess = float(velocity @ heading) - top
    return velocity - excess * heading if excess > 0.0 else velocity
