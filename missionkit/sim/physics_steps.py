"""One call flies many physics steps: wind, autopilot, body, contact, obstacles, inertial unit.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import GRAVITY, Mat, Vec3
from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled
from missionkit.planning.rotor_power import RotorModel
from missionkit.sim import kernel_layout as at
from missionkit.sim.inner_autopilot import blur, command
from missionkit.sim.kernel_layout import (
    Air,
    Body,
    ImuNoise,
    LoopGains,
)
from missionkit.sim.obstacle_distance import nearest_gap
from missionkit.sim.rigid_body import advance, drive_deck, electrical_power, touch
from missionkit.sim.robot_contact import Floor, live


@compiled
def blow(memory: Vec3, noise: Vec3, air: Air, extra: Vec3, wind: Vec3) -> None:
    """Advance the gust by one step and write the wind (3,), m/s, NED, into `wind`.

    Args:
        memory: by `kernel_layout`; the gust in it is changed.
        noise: (3,), standard normal.
        air: mean wind (m/s, NED), and how the gust decays and is driven.
        extra: (3,), m/s, NED, of a fault.
        wind: (3,), overwritten.
    """
    for n in range(3):
        kick = air.kick * (0.5 if n == 2 else 1.0)
        memory[at.GUST + n] = air.keep * memory[at.GUST + n] + kick * noise[n]
    wind[0] = air.north + extra[0] + memory[at.GUST]
    wind[1] = air.east + extra[1] + memory[at.GUST + 1]
    wind[2] = air.down + extra[2] + memory[at.GUST + 2]


@compiled
def feel(x: Vec3, before: Vec3, memory: Vec3) -> None:
    """Add this step's mean specific force R^T (Δv/dt - g) and rates to the inertial sums.

    Rates are those of the turn made, Log(q_before* ⊗ q) / dt, whatever caused it: contact as well.

    Args:
        x: (17,) true state after the step.
        before: (17,) true state before it.
        memory: sums since the last sample, changed in place.
    """
    w, i, j, k = x[6] + before[6], x[7] + before[7], x[8] + before[8], x[9] + before[9]
    size = math.sqrt(w * w + i * i + j * j + k * k)
    w, i, j, k = w / size, i / size, j / size, k / size
    fn = (x[3] - before[3]) / at.DT
    fe = (x[4] - before[4]) / at.DT
    fd = (x[5] - before[5]) / at.DT - GRAVITY
    memory[at.FORCE_SUM] += (
        (1 - 2 * (j * j + k * k)) * fn + 2 * (i * j + w * k) * fe + 2 * (i * k - w * j) * fd
    )
    memory[at.FORCE_SUM + 1] += (
        2 * (i * j - w * k) * fn + (1 - 2 * (i * i + k * k)) * fe + 2 * (j * k + w * i) * fd
    )
    memory[at.FORCE_SUM + 2] += (
        2 * (i * k + w * j) * fn + 2 * (j * k - w * i) * fe + (1 - 2 * (i * i + j * j)) * fd
    )
    turn(x, before, memory)


@compiled
def turn(x: Vec3, before: Vec3, memory: Vec3) -> None:
    """Add the mean rates of this step to the inertial sums.

    Args:
        x: (17,) true state after the step.
        before: (17,) true state before it.
        memory: sums since the last sample, changed in place.
    """
    w, i, j, k = before[6], before[7], before[8], before[9]
    roll = w * x[7] - i * x[6] - j * x[9] + k * x[8]
    pitch = w * x[8] + i * x[9] - j * x[6] - k * x[7]
    yaw = w * x[9] - i * x[8] + j * x[7] - k * x[6]
    half = math.sqrt(roll * roll + pitch * pitch + yaw * yaw)
    rate = 2.0 / at.DT
    if half > 1e-9:
        rate *= math.atan2(half, w * x[6] + i * x[7] + j * x[8] + k * x[9]) / half
    memory[at.RATE_SUM] += rate * roll
    memory[at.RATE_SUM + 1] += rate * pitch
    memory[at.RATE_SUM + 2] += rate * yaw


@compiled
def sample(memory: Vec3, noise: Vec3, inertial: ImuNoise, out: Vec3) -> None:
    """Write one inertial sample (6,), accel and gyro, into `out`; `noise` is (12,).

    Args:
        memory: sums since the last sample, and biases; changed in place.
        noise: (12,) standard normal.
        inertial: deviations and bias drift.
        out: (6,), m/s² and rad/s, FRD, written.
    """
    share = 1.0 if memory[at.ARMED] > 0.0 else inertial.disarmed
    for n in range(3):
        memory[at.ACCEL_BIAS + n] += inertial.accel_walk * noise[6 + n]
        memory[at.GYRO_BIAS + n] += inertial.gyro_walk * noise[9 + n]
        accel = memory[at.FORCE_SUM + n] / at.IMU_EVERY + memory[at.ACCEL_BIAS + n]
        gyro = memory[at.RATE_SUM + n] / at.IMU_EVERY + memory[at.GYRO_BIAS + n]
        out[n] = max(-160.0, min(160.0, accel + share * inertial.accel * noise[n]))
        out[3 + n] = gyro + share * inertial.gyro * noise[3 + n]
        memory[at.FORCE_SUM + n] = 0.0
        memory[at.RATE_SUM + n] = 0.0


@compiled
def watch(x: Vec3, memory: Vec3, things: Mat, body: Body) -> None:
    """Take the clearance; a vehicle that touches an obstacle has crashed and stops there.

    Args:
        x: (17,) true state, changed on a crash.
        memory: of the simulator, changed in place.
        things: (n, ·) obstacles, a row each.
        body: its radius.
    """
    clear = nearest_gap(things, x[0], x[1], -x[2]) - body.radius
    memory[at.CLEARANCE] = min(memory[at.CLEARANCE], clear)
    if clear <= 0.0 and memory[at.CRASHED] == 0.0:
        memory[at.CRASHED] = 1.0
        x[3], x[4] = 0.0, 0.0


@compiled
def fly(
    x: Vec3,
    memory: Vec3,
    step: int,
    extra: Vec3,
    things: Mat,
    robots: Mat,
    offsets: Mat,
    robot: GroundRobot,
    floor: Floor,
    body: Body,
    rotor: RotorModel,
    gains: LoopGains,
    air: Air,
    inertial: ImuNoise,
    wind_noise: Mat,
    own_noise: Mat,
    imu_noise: Mat,
) -> Mat:
    """Fly as many physics steps as there are rows of noise; return the inertial samples.

    Args:
        x: (17,) state, changed in place.
        memory: (SIZE,) changed in place.
        step: number of the first step; its end is at (step + 1) at.DT.
        extra: (3,) m/s, NED, wind on top of mean and gusts.
        things: (N, 8) obstacles, those of obstacle robots at the end; they are moved.
        robots: (R, ·) states of ground robots, changed in place.
        offsets: (R, k) m/s, of their random turns.
        robot: how they drive.
        floor: where they are in play.
        body: constants.
        rotor: constants of one rotor.
        gains: constants.
        air: constants.
        inertial: constants.
        wind_noise: (n, 3) standard normal.
        own_noise: (n, 3) standard normal, of the autopilot's own velocity.
        imu_noise: (m, 12) standard normal, one row for each inertial sample that falls due.

    Returns:
        (m, 6) accel (m/s², FRD) and gyro (rad/s, FRD), means over the sampling interval.
    """
    samples = np.empty((imu_noise.shape[0], 6))
    work, orders = np.empty((5, 17)), np.empty((2, 4))
    u, wind, before = np.zeros(4), np.empty(3), np.empty(17)
    done = 0
    memory[at.CLEARANCE] = math.inf
    for n in range(wind_noise.shape[0]):
        blow(memory, wind_noise[n], air, extra, wind)
        blur(memory, own_noise[n], gains)
        command(x, memory, (step + n) * at.DT, body, gains, orders, u)
        for part in range(17):  # a slice would take numba two seconds longer to compile
            before[part] = x[part]
        advance(x, u, wind, body, at.DT, work)
        if memory[at.DECK_HALF] > 0.0:
            drive_deck(memory)
        touch(x, memory)
        if robots.shape[0] > 0:
            end = (step + n + 1) * at.DT
            live(x, -before[2], end, memory, body.radius, robots, offsets, robot, floor, things)
        watch(x, memory, things, body)
        feel(x, before, memory)
        if rotor.area > 0.0:
            memory[at.ENERGY] += electrical_power(x, wind, rotor) * at.DT
        else:
            for thrust in range(13, 17):
                memory[at.ENERGY] += body.power * max(0.0, x[thrust]) ** 1.5 * at.DT
        memory[at.IMU_COUNT] += 1.0
        if memory[at.IMU_COUNT] >= at.IMU_EVERY:
            sample(memory, imu_noise[done], inertial, samples[done])
            memory[at.IMU_COUNT] = 0.0
            done += 1
    return samples
