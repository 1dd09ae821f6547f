"""Encodes setpoints as SET_POSITION_TARGET_LOCAL_NED or SET_ATTITUDE_TARGET.

    velocity    mask 0x5c7, velocity and yaw rate
    position    mask 0x9f8, position and yaw, moved from the mission's origin to the autopilot's
    attitude    mask 0x07, attitude and thrust

ArduPilot takes the thrust for a climb rate unless GUID_OPTIONS has bit 3, and flies to a position
even if no more setpoints come. So it gets a point on the way, at most a leash ahead: when
missionkit falls silent it stops there. PX4's failsafe counts for all three kinds.
"""

from __future__ import annotations

import math
from typing import Any

from missionkit.geometry import Vec3, norm
from missionkit.messages import AttitudeSetpoint, AutopilotSetpoint, PositionSetpoint, Setpoint
from missionkit.vehicle.autopilot_dialect import (
    ATTITUDE_MASK,
    LOCAL_NED,
    POSITION_MASK,
    VELOCITY_MASK,
)

UNIT = 1e-3  # how far the length of a quaternion may be from one
_NO_FIELDS = dict.fromkeys(
    ("x", "y", "z", "vx", "vy", "vz", "afx", "afy", "afz", "yaw", "yaw_rate"), 0.0
)


def sound(setpoint: AutopilotSetpoint) -> bool:
    """Return whether a setpoint can be flown: finite, a true attitude, a thrust of 0 to 1."""
    match setpoint:
        case PositionSetpoint(position, yaw):
            return _finite(*position.tolist(), yaw)
        case AttitudeSetpoint(attitude, thrust):
            turned = abs(math.hypot(*attitude.tolist()) - 1.0) < UNIT
            return turned and 0.0 <= thrust <= 1.0  # neither holds for NaN
        case Setpoint(velocity, yaw_rate):
            return _finite(*velocity.tolist(), yaw_rate)


def leashed(setpoint: PositionSetpoint, here: Vec3, leash: float | None) -> PositionSetpoint:
    """Return the setpoint, or the point on the way to it that is `leash` (m) from `here` (3,).

    Args:
        setpoint: m, NED.
        here: (3,), m, NED.
        leash: m, or `None` for none.
    """
    way = setpoint.position - here
    away = norm(way)
    if leash is None or away <= leash:
        return setpoint
    return setpoint._replace(position=here + leash / away * way)


def message(setpoint: AutopilotSetpoint, at: float, start: Vec3) -> tuple[str, dict[str, Any]]:
    """Return the name and the fields of the message for a setpoint that is sound.

    Args:
        setpoint: what to fly.
        at: s, stamp of the message.
        start: (3,), m, the mission's origin in the autopilot's local frame.
    """
    stamp = {"time_boot_ms": int(1e3 * at) & 0xFFFFFFFF}
    match setpoint:
        case PositionSetpoint(position, yaw):
            axes = dict(zip(("x", "y", "z"), (position + start).tolist(), strict=True))
            return _target(stamp, POSITION_MASK, {**axes, "yaw": float(yaw)})
        case AttitudeSetpoint(attitude, thrust):
            return "SET_ATTITUDE_TARGET", {
                **stamp,
                "type_mask": ATTITUDE_MASK,
                "q": attitude.tolist(),
                **dict.fromkeys(("body_roll_rate", "body_pitch_rate", "body_yaw_rate"), 0.0),
                "thrust": float(thrust),
            }
        case Setpoint(velocity, yaw_rate):
            axes = dict(zip(("vx", "vy", "vz"), velocity.tolist(), strict=True))
            return _target(stamp, VELOCITY_MASK, {**axes, "yaw_rate": float(yaw_rate)})


def _target(
    stamp: dict[str, int], mask: int, fields: dict[str, float]
) -> tuple[str, dict[str, Any]]:
    shape = {"coordinate_frame": LOCAL_NED, "type_mask": mask}
    return "SET_POSITION_TARGET_LOCAL_NED", {**stamp, **shape, **_NO_FIELDS, **fields}


def _finite(*numbers: float) -> bool:
    return all(map(math.isfinite, numbers))
