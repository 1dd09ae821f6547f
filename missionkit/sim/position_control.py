"""Position setpoints of the simulated vehicle, flown by an outer loop around its velocity loop.

    v = clamp(POSITION_GAIN (p_want - p)), yaw rate = clamp(YAW_GAIN (yaw_want - yaw))

from the true state at the time of the command, so it must be commanded at every tick, as real
autopilots want it. Attitudes are not flown here: the simulated autopilot of `missionkit sitl` does.
"""

from __future__ import annotations

import math

from missionkit.errors import VehicleError
from missionkit.geometry import Vec3, vec, wrap, yaw_of
from missionkit.messages import AnySetpoint, AttitudeSetpoint, PositionSetpoint, Setpoint, Wrench

POSITION_GAIN = 0.95  # 1/s, PX4's MPC_XY_P
CRUISE_SPEED = 5.0  # m/s, level, PX4's MPC_XY_CRUISE
CLIMB_SPEED = 1.5  # m/s, PX4's MPC_Z_V_AUTO_DN
YAW_GAIN, YAW_RATE = 2.0, 1.5  # 1/s, rad/s


def velocity_for(wanted: AnySetpoint, state: Vec3) -> Setpoint:
    """Return the velocity setpoint that does what is wanted.

    Args:
        wanted: velocity or position.
        state: (17,), as in `kernel_layout`.

    Raises:
        VehicleError: an attitude, a wrench, or a position that is none.
    """
    if isinstance(wanted, Setpoint):
        return wanted
    if isinstance(wanted, AttitudeSetpoint):
        raise VehicleError(
            "the built-in simulator does not fly attitude setpoints: use missionkit sitl"
        )
    if isinstance(wanted, Wrench):
        raise VehicleError("a multicopter flies no wrench: that is for vehicles with thrusters")
    if not all(map(math.isfinite, (*wanted.position.tolist(), wanted.yaw))):
        raise VehicleError("a position setpoint with a number that is not finite")
    return _towards(wanted, state)


def _towards(wanted: PositionSetpoint, state: Vec3) -> Setpoint:
    north, east, down = (POSITION_GAIN * (wanted.position - state[:3])).tolist()
    level = math.hypot(north, east)
    shrink = min(1.0, CRUISE_SPEED / level) if level > 0.0 else 1.0
    turn = YAW_GAIN * wrap(wanted.yaw - yaw_of(state[6:10]))
    velocity = vec(north * shrink, east * shrink, max(-CLIMB_SPEED, min(CLIMB_SPEED, down)))
    return Setpoint(velocity, max(-YAW_RATE, min(YAW_RATE, turn)))
