"""Keeping to one side of a plane: arriving with what can be braked, and never crossing it."""

from __future__ import annotations

import math

from missionkit.control.velocity_limits import Limits, Triple, stopping_speed
from missionkit.geometry import Vec3
from missionkit.messages import Estimate, HalfSpace

RETURN_GAIN = 2.0  # 1/s, m/s back out for each metre on the wrong side
EXCESS_GAIN = 3.0
"""Times what the vehicle is too fast that the command falls below the admissible speed."""
OUTWARD = 2.0  # m/s, largest velocity commanded away from the plane


def admissible_speed(gap: float, limits: Limits) -> float:
    """Return the speed (m/s) at which the plane may be closed from `gap` (m) before it.

    That which stops before it; beyond the plane it is negative: back out.
    """
    if gap <= 0.0:
        return max(-OUTWARD, RETURN_GAIN * gap)
    return stopping_speed(gap, limits.braking, limits.lag)


def kept(velocity: Triple, seen: Estimate, bound: HalfSpace, limits: Limits) -> Triple:
    """Return `velocity` (m/s, NED) with its part towards the plane limited; the rest stays.

    A vehicle that closes too fast is commanded back by `EXCESS_GAIN` times the excess, since
    one whose velocity loop lags, or has learnt to fly fast, does not follow its command at once.

    Args:
        velocity: (3,), m/s, NED, as commanded so far.
        seen: position and velocity of the vehicle.
        bound: the plane, and the side to stay on.
        limits: deceleration and lag with which the vehicle stops.
    """
    n = bound.normal
    gap = float((seen.position - bound.point) @ n)
    closing = -float(seen.velocity @ n)
    if not math.isfinite(gap + closing):
        return velocity
    top = admissible_speed(gap, limits)
    top = max(-OUTWARD, min(top, top - EXCESS_GAIN * (closing - top)))
    wanted = -(velocity[0] * n[0] + velocity[1] * n[1] + velocity[2] * n[2])
    excess = max(0.0, float(wanted) - top)
    x, y, z = (excess * n).tolist()
    return velocity[0] + x, velocity[1] + y, velocity[2] + z


def inside(position: Vec3, bound: HalfSpace) -> Vec3:
    """Return the place (3,), m, NED, nearest to `position` on the right side of the plane."""
    gap = float((position - bound.point) @ bound.normal)
    return position if gap >= 0.0 else position - gap * bound.normal
