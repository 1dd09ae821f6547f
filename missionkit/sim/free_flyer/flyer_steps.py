"""One call flies many physics steps: thrusters, body, contact, inertial unit, radio.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat, Vec3, rotate
from missionkit.jit import compiled
from missionkit.sim.free_flyer import flyer_layout as at
from missionkit.sim.free_flyer.cube_contact import touch
from missionkit.sim.free_flyer.flyer_dynamics import advance
from missionkit.sim.free_flyer.flyer_layout import DockGeometry, Flyer
from missionkit.sim.free_flyer.nozzle_allocation import NOZZLES
from missionkit.sim.kernel_layout import DT, HOLD, IMU_EVERY, OFFBOARD

turn = compiled(rotate)


@compiled
def listen(memory: Vec3, now: float, body: Flyer) -> None:
    """Take the wrench that is due; after too long a silence stop thrusting.

    Args:
        memory: by `flyer_layout`, changed in place.
        now: s.
        body: its `patience` (s) with silence.
    """
    if memory[at.DUE_AT] <= now + 1e-9:
        for n in range(NOZZLES):
            memory[at.COMMANDED + n] = memory[at.DUE + n]
        memory[at.COMMANDED_AT], memory[at.DUE_AT] = now, math.inf
        memory[at.MODE] = OFFBOARD
    if memory[at.MODE] == OFFBOARD and now - memory[at.COMMANDED_AT] > body.patience:
        memory[at.MODE] = HOLD


@compiled
def thrust(memory: Vec3, health: Vec3, body: Flyer, wrench: Vec3) -> None:
    """Write the wrench (6,) of this step, and count its impulse.

    A nozzle that is to give less than its shortest pulse in this step saves it up until that
    suffices, so that the impulse is kept on average.

    Args:
        memory: (SIZE,) changed in place.
        health: (10,) share of its thrust that each nozzle gives, 0 if it stays shut.
        body: constants.
        wrench: (6,) result.
    """
    on = memory[at.ARMED] > 0.0 and memory[at.MODE] == OFFBOARD and memory[at.CRASHED] == 0.0
    for row in range(6):
        wrench[row] = 0.0
    for n in range(NOZZLES):
        memory[at.SAVED + n] = memory[at.SAVED + n] + memory[at.COMMANDED + n] * DT if on else 0.0
        push = min(memory[at.SAVED + n] / DT, body.thrust)
        if push <= 0.0 or push * DT < body.bit:
            continue
        memory[at.SAVED + n] = max(0.0, memory[at.SAVED + n] - push * DT)
        memory[at.GAS] += push * health[n] * DT
        for row in range(6):
            wrench[row] += body.nozzles[row, n] * push * health[n]
    size = math.sqrt(wrench[0] ** 2 + wrench[1] ** 2 + wrench[2] ** 2)
    memory[at.IMPULSE] += size * DT


@compiled
def stand(x: Vec3, memory: Vec3) -> None:
    """Keep a chaser that is docked, or that has crashed, where it is."""
    if memory[at.DOCKED] > 0.0 or memory[at.CRASHED] > 0.0:
        for n in range(3):
            x[3 + n] = x[10 + n] = 0.0


@compiled
def sample(memory: Vec3, noise: Vec3, body: Flyer, out: Vec3) -> None:
    """Write one inertial sample (6,), specific force and rates, into `out`.

    Args:
        memory: by `flyer_layout`; its sums begin again.
        noise: (9,), standard normal: accelerometer, gyroscope, walk of the gyroscope's bias.
        body: its standard deviations.
        out: (6,), m/s² and rad/s, body, overwritten.
    """
    for n in range(3):
        memory[at.GYRO_BIAS + n] += body.gyro_walk * noise[6 + n]
        accel = memory[at.FORCE_SUM + n] / IMU_EVERY + memory[at.ACCEL_BIAS + n]
        gyro = memory[at.RATE_SUM + n] / IMU_EVERY + memory[at.GYRO_BIAS + n]
        out[n] = accel + body.accel * noise[n]
        out[3 + n] = gyro + body.gyro * noise[3 + n]
        memory[at.FORCE_SUM + n] = memory[at.RATE_SUM + n] = 0.0


@compiled
def distance(x: Vec3, anchor: Vec3, body: Flyer) -> float:
    """Return the true distance (m) from the radio, p + R(q) P, to an anchor.

    Args:
        x: (13,) state.
        anchor: (3,), m, world.
        body: the place of its radio P (m, body).
    """
    arm = turn(x[6:10], body.radio)
    a = x[0] + arm[0] - anchor[0]
    b = x[1] + arm[1] - anchor[1]
    c = x[2] + arm[2] - anchor[2]
    return math.sqrt(a * a + b * b + c * c)


@compiled
def measure_range(x: Vec3, anchor: Vec3, noise: Vec3, rare: float, body: Flyer) -> float:
    """Return a measured range (m): white noise, and a detour if `noise[1]` is below `rare`.

    Args:
        x: (13,) state.
        anchor: (3,), m, world.
        noise: (3,): normal, uniform in 0 to 1, normal.
        rare: probability of a detour.
        body: the standard deviation and the length of a detour (m).
    """
    detour = body.detour * abs(noise[2]) if noise[1] < rare else 0.0
    measured: float = distance(x, anchor, body) + body.range_sd * noise[0] + detour
    return max(0.0, measured)


@compiled
def fly(
    x: Vec3,
    memory: Vec3,
    step: int,
    stop: int,
    health: Vec3,
    rare: float,
    body: Flyer,
    dock: DockGeometry,
    imu_noise: Mat,
    range_noise: Mat,
) -> tuple[Mat, Mat]:
    """Fly to physics step `stop`; return the inertial samples and ranges on the way.

    Args:
        x: (13,) state, changed in place.
        memory: (SIZE,) changed in place.
        step: number of steps before.
        stop: number of steps after.
        health: (10,) share of its thrust that each nozzle gives.
        rare: normal number below which a range is an outlier.
        body: constants.
        dock: constants.
        imu_noise: (m, 9) standard normal, a row for each inertial sample that falls due.
        range_noise: (k, 3) standard normal, a row for each range that falls due.

    Returns:
        (m, 6) specific force (m/s²) and rates (rad/s), body axes, means over the sampling interval;
        contact is not felt. (k, 2) number of the anchor and range (m).
    """
    samples, ranges = np.empty((imu_noise.shape[0], 6)), np.empty((range_noise.shape[0], 2))
    work, wrench = np.empty((5, 13)), np.empty(6)
    felt = heard = 0
    memory[at.CLEARANCE] = math.inf
    for n in range(step, stop):
        listen(memory, n * DT, body)
        thrust(memory, health, body, wrench)
        for c in range(3):
            memory[at.FORCE_SUM + c] += wrench[c] / body.mass
            memory[at.RATE_SUM + c] += 0.5 * x[10 + c]
        advance(x, wrench, body, DT, work)
        touch(x, memory, body, dock)
        stand(x, memory)
        for c in range(3):
            memory[at.RATE_SUM + c] += 0.5 * x[10 + c]
        memory[at.IMU_COUNT] += 1.0
        if memory[at.IMU_COUNT] >= IMU_EVERY:
            sample(memory, imu_noise[felt], body, samples[felt])
            memory[at.IMU_COUNT] = 0.0
            felt += 1
        if (n + 1) % body.range_every == 0 and heard < ranges.shape[0]:
            turns = (n + 1) // body.range_every - 1
            which = turns % body.anchors.shape[0]
            ranges[heard, 0] = which
            ranges[heard, 1] = measure_range(x, body.anchors[which], range_noise[heard], rare, body)
            heard += 1
    return samples, ranges
