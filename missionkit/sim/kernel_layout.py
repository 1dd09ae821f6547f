"""Layout of the arrays that the kernels share, and the constants they read.

`state` (17,): position 0:3 (m, NED), velocity 3:6 (m/s, NED), attitude 6:10 (w, x, y, z), rates
10:13 (rad/s, FRD), rotor thrusts 13:17 (N). `memory` (SIZE,): what the autopilot and the contact
remember, at the indices below.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.geometry import GRAVITY
from missionkit.planning.rotor_power import RotorModel
from missionkit.sim.vehicle_parameters import PHYSICS_RATE
from missionkit.sim.world import World

RATE = PHYSICS_RATE  # Hz
DT = 1.0 / RATE

HOLD, OFFBOARD, TAKE_OFF, LAND = 0, 1, 2, 3
MODES = ("hold", "offboard", "take_off", "land")

FLOW_AIDED = 0.5  # its velocity is right, its position drifts

MODE = 0
ARMED = 1
ON_GROUND = 2
CRASHED = 3
ENERGY = 4  # J taken by the rotors
CLEARANCE = 5  # m, least over the last call
GNSS_OK = 6  # 1 with GNSS, FLOW_AIDED with optical flow alone, 0 with neither
ANCHORED = 7  # the hold point is set
HEIGHT = 8  # m, take-off target
LANDED_AT = 9  # s, first contact while landing, or inf
COMMANDED_AT = 10  # s, when the active setpoint arrived
DUE_AT = 11  # s, when the pending setpoint arrives, or inf
POWERED = 12  # 0 once the battery is empty
IMU_COUNT = 13
COMMANDED = 14  # 14:18 velocity (3), yaw rate
DUE = 18  # 18:22 the same, on its way
VELOCITY_ERROR = 22  # 22:25 m/s
POSITION_ERROR = 25  # 25:28 m
INTEGRAL = 28  # 28:31 m/s²
ANCHOR = 31  # 31:34 m
HEADING = 34  # rad, the yaw it holds
GUST = 35  # 35:38 m/s
FORCE_SUM = 38  # 38:41 specific force since the last inertial sample
RATE_SUM = 41  # 41:44
ACCEL_BIAS = 44  # 44:47
GYRO_BIAS = 47  # 47:50
VELOCITY_BIAS = 50  # 50:53 m/s, part of VELOCITY_ERROR, from a fault
LOOP_PERIOD = 53  # s, of a velocity loop that is too slow; 0: every step
LOOP_DUE = 54  # s, when it runs next
PUSH = 55  # 55:58 m/s², what it wanted last
DECK_HALF = 58  # m, half its side; 0: no deck
DECK_DOWN = 59  # m, NED, of its middle
DECK_SLOPE = 60  # 60:62 how much farther down for a metre to the north, and to the east
DECK_AT = 62  # 62:64 m, north and east of its middle now
DECK_VELOCITY = 64  # 64:66 m/s, north and east
DECK_TURN = 66  # rad/s, of its course
SIZE = 67

IMU_EVERY = 2  # physics steps
TRACK_WIDTH = 21
"""One row of the track: time, state 0:13, on_ground, armed, mode, crashed, charge, clearance (m),
energy (J)."""


class Body(NamedTuple):
    """Constants of the rigid body (SI)."""

    mass: float
    jx: float
    jy: float
    jz: float
    lever: float  # m, rotor from the axis, both ways
    yaw_arm: float
    lag: float
    full: float  # N, a rotor's largest thrust
    drag_linear: float
    drag_quadratic: float
    radius: float
    power: float  # W/N^1.5 of one rotor, without a model of it


class LoopGains(NamedTuple):
    """Constants of the inner autopilot (SI)."""

    velocity: float
    climb: float
    integral: float
    integral_limit: float  # m/s²
    integral_zone: float  # m/s², larger proportional parts charge nothing
    attitude: float
    rate: float
    acceleration: float
    rate_limit: float
    yaw_rate: float
    rise: float
    descent: float
    flare: float
    patience: float
    error_keep: float  # Gauss-Markov factor of one step, with GNSS
    error_kick: float  # standard deviation of its noise
    drift_kick: float  # the same without GNSS, where the error is a random walk


class Air(NamedTuple):
    """Wind and gusts: mean (NED, m/s) and the exactly discretised Gauss-Markov step."""

    north: float
    east: float
    down: float
    keep: float
    kick: float


class ImuNoise(NamedTuple):
    """Per-sample standard deviations of the inertial unit."""

    accel: float
    gyro: float
    accel_walk: float
    gyro_walk: float
    disarmed: float  # share of accel and gyro while the rotors stand still


def gauss_markov(sd: float, tau: float, dt: float) -> tuple[float, float]:
    """Return (keep, kick) of x' = keep x + kick n, exact for dx = -x/tau dt + noise.

    The process has standard deviation `sd` at any `dt`.  Source: Gelb, 1974, section 3.8.

    Args:
        sd: standard deviation.
        tau: s, correlation time.
        dt: s of a step.
    """
    keep = math.exp(-dt / tau)
    return keep, sd * math.sqrt(1.0 - keep * keep)


def constants(world: World) -> tuple[Body, RotorModel, LoopGains, Air, ImuNoise]:
    """Turn the parameters of `world` into what the kernels read."""
    quad, auto, imu = world.quadrotor, world.autopilot, world.sensors.imu
    weight = quad.mass * GRAVITY
    body = Body(
        quad.mass,
        *quad.inertia,
        lever=quad.arm / math.sqrt(2.0),
        yaw_arm=quad.yaw_arm,
        lag=quad.motor_lag,
        full=quad.thrust_to_weight * weight / 4.0,
        drag_linear=quad.drag_linear,
        drag_quadratic=quad.drag_quadratic,
        radius=quad.radius,
        power=quad.hover_power / (4.0 * (weight / 4.0) ** 1.5),
    )
    gains = LoopGains(
        auto.velocity_gain,
        auto.climb_gain,
        auto.integral_gain,
        auto.integral_limit,
        auto.integral_zone,
        auto.attitude_gain,
        auto.rate_gain,
        auto.acceleration,
        auto.rate,
        auto.yaw_rate,
        auto.climb,
        auto.descent,
        auto.flare,
        auto.patience,
        *gauss_markov(auto.velocity_sd, auto.velocity_tau, DT),
        drift_kick=auto.drift * math.sqrt(DT),
    )
    air = Air(*world.wind.mean, *gauss_markov(world.wind.gust, world.wind.gust_tau, DT))
    period = IMU_EVERY * DT
    inertial = ImuNoise(
        imu.accel_noise / math.sqrt(period),
        imu.gyro_noise / math.sqrt(period),
        imu.accel_walk * math.sqrt(period),
        imu.gyro_walk * math.sqrt(period),
        imu.disarmed,
    )
    rotor = RotorModel() if quad.rotors is None else quad.rotors.model()
    return body, rotor, gains, air, inertial
