"""Flying in on a landing pad: level as fast as braking allows, and down as fast as that allows.

Everything is relative to the pad, which may move: its velocity is added to what is sent.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.control.landing_profile import (
    Closing,
    Descent,
    DescentState,
    closing_speed,
    closing_time,
    descent_time,
    height_before,
)
from missionkit.control.velocity_limits import stopping_speed
from missionkit.geometry import Vec3, vec
from missionkit.messages import Estimate, Target

ARRIVING = 2.0  # 1/s, speed over the level distance left, as it is flown in the end with all lags
BRAKING = 1.16  # of the acceleration: it answers late and brakes less than it is asked to
LEAD = 0.33  # s, level, it answers so late
DAMPING = 0.16  # s, of the braking wanted, taken off the speed sent
RISE = 0.75  # s, by which the speed sent is ahead while it accelerates
FOLLOW = 2.0  # 1/s, of an error of height
SINKING = 0.2  # s, its rate of descent answers so late
SLOWING = 0.25  # s, of the slowing wanted, taken off the rate sent
ARRIVED = 0.03  # m, level, it is over the pad
CLIMB = 0.5  # m/s, up to the height that it is to keep
STILL = vec(0.0, 0.0, 0.0)


class PadLimits(NamedTuple):
    """How the vehicle may move relative to the pad."""

    top_speed: float  # m/s, level
    acceleration: float  # m/s², level
    descent: float  # m/s
    vertical_acceleration: float  # m/s²
    touch_down: float  # m/s
    closing: float  # 1/s, speed over the level distance left


class PadView(NamedTuple):
    """Where the pad is from the vehicle, and how the vehicle moves relative to it."""

    offset: Vec3  # (3,), m, NED, from the vehicle to the pad
    velocity: Vec3  # (3,), m/s, NED, of the vehicle relative to the pad
    pad_velocity: Vec3  # (3,), m/s, NED

    @property
    def level(self) -> float:
        """Level distance (m)."""
        return math.hypot(float(self.offset[0]), float(self.offset[1]))

    @property
    def height(self) -> float:
        """Height above the pad (m)."""
        return float(self.offset[2])


def view_of(seen: Estimate, target: Target) -> PadView:
    """Return the pad as seen from the vehicle; one whose motion is not known stands still."""
    pad = STILL if target.velocity is None else target.velocity
    return PadView(target.position - seen.position, seen.velocity - pad, pad)


def time_to_pad(view: PadView, limits: PadLimits, within: float) -> float:
    """Return the time (s) until the vehicle is `within` (m, level) of the pad.

    Args:
        view: of the pad.
        limits: of the motion.
        within: m, more than 0.
    """
    speed = math.hypot(view.velocity[0], view.velocity[1])
    flown = Closing(ARRIVING, BRAKING * limits.acceleration, limits.top_speed)
    return closing_time(flown, view.level, speed, within)


def would_miss(view: PadView, limits: PadLimits, aside: float) -> bool:
    """Say whether a descent from now on ends before the vehicle is within `aside` of the pad.

    Args:
        view: of the pad.
        limits: of the motion.
        aside: m, level.
    """
    return time_to_pad(view, limits, aside) > descent_time(_descent(limits), view.height)


def towards(view: PadView, limits: PadLimits, floor: float) -> Vec3:
    """Return the velocity (3,), m/s, NED, to the pad, down no lower than `floor` (m) above it.

    What is sent is the speed of the profile where the vehicle will be when it answers, less a
    share of the braking v dv/dx that the profile asks for.

    Args:
        view: of the pad.
        limits: of the motion.
        floor: m above the pad; 0: down to it.
    """
    north, east, _ = (view.offset - LEAD * view.velocity).tolist()
    left = max(1e-9, math.hypot(north, east))
    vn, ve, _ = view.velocity.tolist()
    along = (vn * north + ve * east) / left
    braking = BRAKING * limits.acceleration
    speed, slope = closing_speed(Closing(limits.closing, braking, limits.top_speed), left)
    speed = min(speed, max(0.0, along) + RISE * limits.acceleration)
    damping = DAMPING * slope
    return view.pad_velocity + vec(
        speed * north / left - damping * vn,
        speed * east / left - damping * ve,
        _rate(view, limits, floor),
    )


def _descent(limits: PadLimits) -> Descent:
    rate = max(limits.descent, limits.touch_down)
    return Descent(rate, limits.vertical_acceleration, limits.touch_down)


def _rate(view: PadView, limits: PadLimits, floor: float) -> float:
    """Return the rate of descent (m/s) that ends over the pad and stops above `floor` (m)."""
    height, sinking = view.height, float(view.velocity[2])
    time = time_to_pad(view, limits, ARRIVED) - SINKING
    wanted = height_before(_descent(limits), time, sinking)
    if wanted.height <= floor:
        wanted = DescentState(floor, 0.0, 0.0)
    ahead = height - SINKING * sinking
    rate = min(wanted.rate + FOLLOW * (ahead - wanted.height), limits.descent)
    rate -= SLOWING * wanted.slowing
    if floor <= 0.0:
        return max(limits.touch_down, rate)
    if height <= floor:
        return max(rate, -CLIMB)
    late = SINKING + SLOWING
    return max(0.0, min(rate, stopping_speed(height - floor, limits.vertical_acceleration, late)))
