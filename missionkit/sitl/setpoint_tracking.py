"""Setpoints from the wire, and the outer loop that turns them into velocities.

The simulator's inner autopilot follows a velocity with a = k (v_want - v). So

    position      v = v_ref + clamp(k_p (p_want - p))           as PX4's MPC_XY_P, MPC_Z_P
    acceleration  v = v_now + a / k
    attitude      a = g e3 - (thrust / hover) g R(q) e3          then as an acceleration
    heading       yaw rate = clamp(2 (yaw_want - yaw))

and the integral part of the inner loop is emptied while it flies an acceleration or attitude.
Sources: https://mavlink.io/en/messages/common.html (SET_POSITION_TARGET_LOCAL_NED,
SET_ATTITUDE_TARGET); https://docs.px4.io/main/en/flight_modes/offboard.html;
https://ardupilot.org/dev/docs/copter-commands-in-guided-mode.html.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import (
    GRAVITY,
    Quat,
    Vec3,
    exp,
    multiply,
    norm,
    normalised,
    rotate,
    vec,
    wrap,
    yaw_of,
)
from missionkit.messages import Setpoint
from missionkit.sim.position_control import YAW_GAIN, YAW_RATE
from missionkit.sitl.simulated_body import SimulatedBody

Axes = tuple[float | None, float | None, float | None]
NO_AXES: Axes = (None, None, None)
MOST_TILT = math.radians(35.0)


class SetpointTarget(NamedTuple):
    """Commanded position, velocity or attitude; `None` where not commanded."""

    at: float  # s, when it arrived
    position: Axes = NO_AXES  # m, NED
    velocity: Axes = NO_AXES  # m/s, NED
    acceleration: Axes = NO_AXES  # m/s², NED
    yaw: float | None = None  # rad
    yaw_rate: float | None = None  # rad/s
    attitude: Quat | None = None  # (4,), body to world
    rates: Vec3 | None = None  # (3,), rad/s, FRD
    thrust: float = 0.0  # 0 to 1; over the one that hovers, see `hover`
    speed: float | None = None  # m/s, level, not to be exceeded on the way to `position`

    @property
    def leans(self) -> bool:
        """Whether it commands an acceleration or attitude, with neither position nor velocity."""
        pushed = self.acceleration != NO_AXES and self.position == self.velocity == NO_AXES
        return self.attitude is not None or pushed

    @property
    def moves(self) -> bool:
        """Whether it commands anything but a position: a stream that must not end."""
        return self.attitude is not None or self.rates is not None or self.position == NO_AXES


class TrackingLimits(NamedTuple):
    """The autopilot's own, from its parameters."""

    gain: float  # 1/s, level
    gain_up: float  # 1/s
    speed: float  # m/s, level
    up: float  # m/s
    down: float  # m/s
    hover: float  # thrust
    velocity_gain: float = 2.2  # 1/s, of the inner loop
    climb_gain: float = 4.0


def towards(
    at: float, position: Vec3, *, yaw: float | None = None, speed: float | None = None
) -> SetpointTarget:
    """Return the target of being at `position` (3,), m, NED.

    Args:
        at: s, when it was set.
        position: (3,), m, NED.
        yaw: rad, clockwise from north; kept if absent.
        speed: m/s; that of the limits if absent.
    """
    n, e, d = map(float, position)
    return SetpointTarget(at, position=(n, e, d), yaw=yaw, speed=speed)


def follow(target: SetpointTarget, body: SimulatedBody, limits: TrackingLimits) -> Setpoint:
    """Return the velocity and yaw rate that bring the vehicle to the target.

    Args:
        target: from the wire or a mission.
        body: the true vehicle.
        limits: of speeds, accelerations and rates.
    """
    if target.attitude is not None:
        return _inclined(target, target.attitude, body, limits)
    back, ahead = vec(0.0, 0.0, 0.0), vec(0.0, 0.0, 0.0)
    for n in range(3):
        back[n], ahead[n] = _along(target, n, body, limits)
    want = _clamped(back, target.speed or limits.speed, limits) + ahead
    return Setpoint(_clamped(want, limits.speed, limits), _turn(target, body))


def _along(
    target: SetpointTarget, n: int, body: SimulatedBody, limits: TrackingLimits
) -> tuple[float, float]:
    """Return the velocities along one axis: towards the position, and fed forward (m/s)."""
    place, speed, push = target.position[n], target.velocity[n], target.acceleration[n]
    back = 0.0
    if place is not None:
        back = (limits.gain_up if n == 2 else limits.gain) * (place - float(body.position[n]))
    if speed is None and place is None and push is not None:
        speed = float(body.velocity[n])
    inner = limits.climb_gain if n == 2 else limits.velocity_gain
    return back, (speed or 0.0) + (push or 0.0) / inner


def _clamped(want: Vec3, speed: float, limits: TrackingLimits) -> Vec3:
    level = math.hypot(want[0], want[1])
    shrink = min(1.0, speed / level) if level > 0.0 else 1.0
    return vec(want[0] * shrink, want[1] * shrink, max(-limits.up, min(limits.down, want[2])))


def _turn(target: SetpointTarget, body: SimulatedBody) -> float:
    if target.yaw is not None:
        wanted = YAW_GAIN * wrap(target.yaw - yaw_of(body.attitude))
        return max(-YAW_RATE, min(YAW_RATE, wanted + (target.yaw_rate or 0.0)))
    return target.yaw_rate or 0.0


def _inclined(
    target: SetpointTarget, attitude: Quat, body: SimulatedBody, limits: TrackingLimits
) -> Setpoint:
    up = rotate(attitude, vec(0.0, 0.0, -1.0))
    push = vec(0.0, 0.0, GRAVITY) + target.thrust / limits.hover * GRAVITY * up
    level = math.hypot(push[0], push[1])
    if level > GRAVITY * math.tan(MOST_TILT):
        push[:2] *= GRAVITY * math.tan(MOST_TILT) / level
    now, climb = body.velocity, target.velocity[2]
    want = now + push / vec(limits.velocity_gain, limits.velocity_gain, limits.climb_gain)
    if climb is not None:
        want[2] = climb
    rate = target.yaw_rate or 0.0
    heading = target._replace(yaw=yaw_of(attitude), yaw_rate=rate)
    return Setpoint(want, _turn(heading, body))


def turned(target: SetpointTarget, dt: float) -> SetpointTarget:
    """Turn the attitude of a target by its rates for `dt` (s)."""
    if target.attitude is None or target.rates is None or norm(target.rates) == 0.0:
        return target
    return target._replace(attitude=normalised(multiply(target.attitude, exp(target.rates * dt))))
