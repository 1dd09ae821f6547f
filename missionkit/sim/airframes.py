"""Vehicles that others simulate, as parts of a world: `missionkit sitl --airframe NAME`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from missionkit.errors import UsageError, nearest
from missionkit.sim.vehicle_parameters import ImuModel, InnerAutopilotModel, Quadrotor
from missionkit.sim.world import World


class SimulatedAirframe(NamedTuple):
    """Body, inner autopilot and inertial unit that belong together."""

    quadrotor: Quadrotor
    autopilot: InnerAutopilotModel
    imu: ImuModel


SIH = SimulatedAirframe(
    Quadrotor(
        mass=1.0,
        inertia=(0.025, 0.025, 0.030),
        arm=0.283,
        yaw_arm=0.02,
        motor_lag=0.05,
        thrust_to_weight=2.04,
        drag_linear=1.0,
        drag_quadratic=0.0,
    ),
    InnerAutopilotModel(
        velocity_gain=1.8,
        integral_gain=0.4,
        integral_limit=5.0,
        integral_zone=20.0,
        attitude_gain=6.5,
    ),
    ImuModel(accel_noise=0.107, gyro_noise=0.0089, disarmed=0.1),
)
"""PX4's own simulation with PX4's default gains: SIH_MASS, SIH_KDV, SIH_T_MAX, SIH_T_TAU,
MPC_XY_VEL_P_ACC, MPC_XY_VEL_I_ACC, MC_ROLL_P. Its drag is a second velocity loop: the integral has
to learn five times as much as with ours, at half the rate, so speed follows a setpoint by two
thirds within a second and the rest takes seven more. Its inertial noise, 1.7 m/s² and 0.14 rad/s at
250 Hz along the worst axis, is five times what the filter expects by default; a tenth of that
while nothing turns.

Source: PX4-Autopilot, `simulator_sih/sih_params.c` and `sih.cpp`, version 1.16.
"""

AIRFRAMES: Mapping[str, SimulatedAirframe] = {"sih": SIH}


def flown_with(world: World, name: str) -> World:
    """Return the world with the vehicle of that name; "" keeps its own.

    Raises:
        UsageError: there is none of that name.
    """
    if not name:
        return world
    if name not in AIRFRAMES:
        raise UsageError(f"unknown airframe {name!r}: {nearest(name, AIRFRAMES)}")
    body = AIRFRAMES[name]
    sensors = world.sensors.model_copy(update={"imu": body.imu})
    parts = {"quadrotor": body.quadrotor, "autopilot": body.autopilot, "sensors": sensors}
    return world.model_copy(update=parts)
