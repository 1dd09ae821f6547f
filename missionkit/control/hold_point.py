"""Standing still in the air: holding a place, since a velocity of zero drifts with the wind."""

from __future__ import annotations

from typing import NamedTuple

from missionkit.control.velocity_limits import Limits
from missionkit.geometry import Quat, Vec3, norm
from missionkit.messages import Estimate, Guidance

LAG = 0.3  # s, the vehicle answers so late
RETURN_SPEED_LIMIT = 1.5  # m/s, on the way back


class HoldPoint(NamedTuple):
    """A place to hold."""

    position: Vec3  # (3,), m, NED
    yaw: float  # rad
    attitude: Quat | None = None  # (4,), body to world, of a vehicle that turns about any axis


def place(seen: Estimate, limits: Limits) -> HoldPoint:
    """Return where the vehicle comes to rest if it brakes now.

    Braking takes v (t + v/(2a)) with the vehicle's lag t and the limits' acceleration a.
    """
    speed = norm(seen.velocity)
    ahead = seen.velocity * (LAG + 0.5 * speed / limits.acceleration)
    return HoldPoint(seen.position + ahead, seen.yaw)


def known(seen: Estimate) -> bool:
    """Say whether a place can be held by this estimate."""
    return seen.health.aligned and not seen.health.diverged


def guidance_to(held: HoldPoint) -> Guidance:
    """Return what leads back to the place and keeps the heading."""
    return Guidance(held.position, RETURN_SPEED_LIMIT, yaw=held.yaw, attitude=held.attitude)
