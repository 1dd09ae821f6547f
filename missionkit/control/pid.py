"""Position error to velocity: the PID of P1 section 3.2."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from missionkit.control.velocity_limits import (
    ZERO,
    Limits,
    Triple,
    approach_speed,
    within,
)
from missionkit.units import Metres, MetresPerSecond, Number

Pair: TypeAlias = tuple[Number, Number]
"""Horizontal and vertical gain: the diagonal (h, h, v) of P1's gain matrix."""

PositivePair: TypeAlias = tuple[
    Annotated[Number, Field(gt=0)],
    Annotated[Number, Field(gt=0)],
]


class Gains(BaseModel):
    """Gains of one control mode: u = Kp e + Ki ∫(e + ė/Kp) dt + Kd ė, m to m/s.

    `integral_limit` bounds the integral term on each axis; it changes only within `zone` of the
    goal.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    kp: PositivePair = (0.9, 1.0)  # 1/s
    ki: Pair = (0.25, 0.25)  # 1/s²
    kd: Pair = (0.1, 0.1)  # 1
    integral_limit: MetresPerSecond = Field(default=0.6, ge=0)
    zone: Metres = Field(default=1.0, ge=0)


class PidMemory(NamedTuple):
    """The integral term (m/s, NED): a velocity, so that a change of gains makes no bump."""

    integral: Triple = ZERO


class Tracking(NamedTuple):
    """Input of the controller at one step."""

    error: Triple  # m, NED, desired - actual
    rate: Triple  # m/s, NED, reference velocity - actual velocity
    top: float  # m/s, length the output must not exceed
    forward: Triple = ZERO  # m/s, NED, feed-forward, part of the output
    blocked: bool = False  # something else moves the vehicle: do not integrate


def step(
    gains: Gains, limits: Limits, memory: PidMemory, track: Tracking, dt: float
) -> tuple[Triple, PidMemory]:
    """Return the velocity (m/s, NED), at most `track.top` long, and the next memory.

    The derivative uses measured velocity rather than a difference of errors, so a goal that
    jumps gives no kick. Far from the goal Kp e follows the braking curve (`approach_speed`).

    Two guards against windup. The integrand e + ė/Kp is zero on the approach the controller
    means to fly, e(t) = e(0) exp(-Kp t), so the approach charges nothing and only what keeps
    the vehicle off it does; at rest it is P1's ∫e (this is set-point weighting). And it is
    conditional: nothing is integrated while the output is saturated, except towards zero.

    Sources: P1 section 3.2; Åström and Hägglund, "Advanced PID Control", 2006, chapter 3.

    Args:
        gains: of the mode.
        limits: deceleration of the braking curve.
        memory: integral of the previous step.
        track: error (m), measured velocity (m/s), both NED, and top speed.
        dt: s since the previous step.
    """
    (ph, pv), (dh, dv) = gains.kp, gains.kd
    ex, ey, ez = track.error
    rx, ry, rz = track.rate
    fx, fy, fz = track.forward
    far, high = math.hypot(ex, ey), abs(ez)
    kh = approach_speed(far, ph, limits.braking) / far if far > 0.0 else ph
    kv = approach_speed(high, pv, limits.vertical_braking) / high if high > 0.0 else pv
    ix, iy, iz = memory.integral
    u, saturated = within(
        (
            kh * ex + ix + dh * rx + fx,
            kh * ey + iy + dh * ry + fy,
            kv * ez + iz + dv * rz + fz,
        ),
        track.top,
    )
    if track.blocked:
        return u, memory
    kh, kv = gains.ki
    near_h = kh * dt if far <= gains.zone else 0.0
    near_v = kv * dt if high <= gains.zone else 0.0
    limit = gains.integral_limit
    return u, PidMemory(
        (
            _charged(ix, near_h * (ex + rx / ph), limit, hold=saturated),
            _charged(iy, near_h * (ey + ry / ph), limit, hold=saturated),
            _charged(iz, near_v * (ez + rz / pv), limit, hold=saturated),
        )
    )


def _charged(integral: float, more: float, limit: float, *, hold: bool) -> float:
    if not hold or integral * more < 0.0:
        integral += more
    return min(limit, max(-limit, integral))
