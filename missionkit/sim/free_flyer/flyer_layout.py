"""Layout of the arrays that the free flyer's kernels share, and the constants they read.

`state` (13,): position 0:3 (m) and velocity 3:6 (m/s) of the centre of mass in the mother-ship's
frame, attitude 6:10 (w, x, y, z, body to mother-ship), rates 10:13 (rad/s, body). `memory` (SIZE,):
what thrusters, contact and sensors remember, at the indices below. Time steps, modes and columns of
the track are those of `sim.kernel_layout`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat, Vec3, to_matrix
from missionkit.sim.free_flyer.nozzle_allocation import NOZZLES, nozzle_matrix
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from missionkit.sim.kernel_layout import DT, IMU_EVERY, RATE

MODE = 0
ARMED = 1
DOCKED = 2
CRASHED = 3
IMPULSE = 4  # N·s, integral of the force's size
GAS = 5  # N·s, integral of the nozzles' thrusts
CLEARANCE = 6  # m, least gap of the bounding spheres outside the corridor over the last call
COMMANDED_AT = 7  # s, when the active wrench arrived
DUE_AT = 8  # s, when the pending wrench arrives, or inf
IMU_COUNT = 9
COMMANDED = 10  # 10:20 N, thrust of each nozzle
DUE = COMMANDED + NOZZLES  # 20:30 the same, on its way
SAVED = DUE + NOZZLES  # 30:40 N·s, too little to open a nozzle for
FORCE_SUM = 40  # 40:43 m/s², specific force since the last inertial sample
RATE_SUM = 43  # 43:46 rad/s
ACCEL_BIAS = 46  # 46:49
GYRO_BIAS = 49  # 49:52
SIZE = 52


class Flyer(NamedTuple):
    """Constants of body, thrusters and sensors (SI)."""

    mass: float
    jx: float
    jy: float
    jz: float
    half: float  # m, half the side of the cube
    nozzles: Mat  # (6, 10) force and torque of unit thrusts
    thrust: float  # N
    bit: float  # N·s, of the shortest pulse
    patience: float
    accel: float  # per sample
    gyro: float
    gyro_walk: float
    anchors: Mat  # (A, 3)
    radio: Vec3  # (3,), m, body
    range_every: int  # physics steps
    range_sd: float
    detour: float  # m, 1 sigma


class DockGeometry(NamedTuple):
    """Constants of target, docked place and corridor, in the mother-ship's frame (SI)."""

    target: Vec3  # (3,)
    axes: Mat  # (3, 3), the target's axes as columns
    half: float  # m, half the side of the target's cube
    place: Vec3  # (3,) docked
    normal: Vec3  # (3,)
    radius: float
    slope: float
    length: float
    depth: float
    touching: float  # m, distance of centres at which the bounding spheres touch
    hard: float  # m/s, a faster touch is a crash
    solid: bool


def flyer_constants(world: FreeFlyerWorld) -> Flyer:
    """Turn the chaser's parameters into what the kernels read."""
    body, sensors = world.vehicle, world.sensors
    period = IMU_EVERY * DT
    return Flyer(
        body.mass,
        *body.inertia,
        half=0.5 * body.size,
        nozzles=nozzle_matrix(body.size, body.nozzle_arm).copy(),
        thrust=body.nozzle_thrust,
        bit=body.nozzle_thrust * body.minimum_pulse,
        patience=body.patience,
        accel=sensors.accelerometer.noise / math.sqrt(period),
        gyro=sensors.gyro.noise / math.sqrt(period),
        gyro_walk=sensors.gyro.walk * math.sqrt(period),
        anchors=np.array(list(world.anchors.values()), dtype=np.float64).reshape(-1, 3),
        radio=np.array(sensors.uwb.radio),
        range_every=max(1, round(RATE / sensors.uwb.rate)),
        range_sd=sensors.uwb.sd,
        detour=sensors.uwb.outlier_size,
    )


def dock_constants(world: FreeFlyerWorld) -> DockGeometry:
    """Turn target and corridor into what the kernels read."""
    pose, berth, cone = world.target.pose, world.berth, world.cone
    return DockGeometry(
        pose.translation,
        to_matrix(pose.rotation),
        0.5 * world.target.size,
        berth.pose.translation,
        berth.normal,
        *cone,
        touching=world.touching,
        hard=world.capture.contact_speed,
        solid=world.target.solid,
    )
