"""Models of how a target moves, and the Kalman filter over one of them; compiled.

    x = (north, east, ψ),   ẋ = v cos ψ,   ẏ = v sin ψ,   ψ̇ = Ω   plus white noise

with v and Ω constant: P4's straight (27) and spin (28), circling, and standing still (P4 below
(15)). A step is integrated exactly, along an arc; P4 takes F = I + Δ A. Random turns of the robot
are noise of the heading, which a step hands on to the position.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.linear_algebra import joseph, symmetrise, transpose
from missionkit.geometry import Mat, Vec3
from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled

HEADING = 2
"""Index in the state."""


class MotionModel(NamedTuple):
    """One model of motion."""

    speed: float  # m/s
    turn_rate: float  # rad/s, clockwise seen from above
    position_noise: float  # m²/s, of each axis
    heading_noise: float  # rad²/s


def straight(robot: GroundRobot) -> MotionModel:
    """Return P4 (27): a constant speed; its random turns are noise of the heading."""
    return MotionModel(robot.speed, 0.0, 1e-5, robot.turn_variance)


def spin(robot: GroundRobot) -> MotionModel:
    """Return P4 (28): it turns on the spot."""
    return MotionModel(0.0, robot.spin_rate, 1e-5, 1e-3)


def circling(robot: GroundRobot) -> MotionModel:
    """Return the motion of an obstacle robot, which takes no random turns."""
    return MotionModel(robot.speed, robot.circle_rate, 1e-5, 1e-6)


def standing(robot: GroundRobot) -> MotionModel:
    """Return P4's single model: it stands, as uncertain as its real speed makes it in 0.1 s."""
    return MotionModel(0.0, 0.0, robot.speed**2 * 0.1, 0.0)


def table(*models: MotionModel) -> Mat:
    """Return models as the rows (n, 4) that the kernels read."""
    return np.array(models)


@compiled
def moved(x: Vec3, model: Vec3, dt: float) -> Vec3:
    """Return the state (3,) after a step without noise.

    Args:
        x: (3,) m, m, rad.
        model: (4,), a row of `table`.
        dt: s.
    """
    half = 0.5 * model[1] * dt
    chord = model[0] * dt * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    along = x[HEADING] + half
    return np.array(
        (x[0] + chord * math.cos(along), x[1] + chord * math.sin(along), x[HEADING] + 2.0 * half)
    )


@compiled
def jacobian(x: Vec3, model: Vec3, dt: float) -> Mat:
    """Return the derivative F (3, 3) of `moved` by the state: of (27) and (28).

    Args:
        x: (3,) m, m, rad.
        model: (4,), a row of `table`.
        dt: s.
    """
    after = moved(x, model, dt)
    F = np.eye(3)
    F[0, HEADING] = x[1] - after[1]
    F[1, HEADING] = after[0] - x[0]
    return F


@compiled
def process_noise(x: Vec3, model: Vec3, dt: float) -> Mat:
    """Return Q (3, 3) of a step: white noise of position and heading, integrated.

    Heading noise q moves the place across the path by v: q dt, v q dt²/2 and v² q dt³/3.

    Args:
        x: (3,) m, m, rad.
        model: (4,), a row of `table`.
        dt: s.
    """
    along = x[HEADING] + 0.5 * model[1] * dt
    across = (-math.sin(along) * model[0], math.cos(along) * model[0])
    q = model[3] * dt
    Q = np.zeros((3, 3))
    for i in range(2):
        Q[i, i] = model[2] * dt
        Q[i, HEADING] = Q[HEADING, i] = 0.5 * q * dt * across[i]
        for j in range(2):
            Q[i, j] += q * dt * dt / 3.0 * across[i] * across[j]
    Q[HEADING, HEADING] = q
    return Q


@compiled
def predict(x: Vec3, P: Mat, model: Vec3, dt: float) -> None:
    """X := f(x),  P := F P Fᵀ + Q  (P4 (15)), in place.

    Args:
        x: (3,) m, m, rad.
        P: (3, 3) covariance.
        model: (4,), a row of `table`.
        dt: s.
    """
    after = moved(x, model, dt)
    north, east = x[1] - after[1], after[0] - x[0]  # what `jacobian` has beside ones
    for _ in range(2):  # F P Fᵀ = (F (F P)ᵀ)ᵀ
        for k in range(3):
            P[0, k] += north * P[HEADING, k]
            P[1, k] += east * P[HEADING, k]
        transpose(P)
    P += process_noise(x, model, dt)
    symmetrise(P)
    x[:] = after


@compiled
def update(x: Vec3, P: Mat, z: Vec3, R: Mat) -> float:
    """Correct by a place z on the ground, P4 (16) to (18), in place.

    P is taken in Joseph's form. Returns the logarithm of P4 (22), the density of z before.

    Args:
        x: (3,) m, m, rad.
        P: (3, 3) covariance.
        z: (2,), m, north and east.
        R: (2, 2) covariance of z, m².
    """
    r0, r1 = float(z[0] - x[0]), float(z[1] - x[1])
    s00, s01, s11 = float(P[0, 0] + R[0, 0]), float(P[0, 1] + R[0, 1]), float(P[1, 1] + R[1, 1])
    det = s00 * s11 - s01 * s01
    K = np.empty((3, 2))
    for i in range(3):
        K[i, 0] = (P[i, 0] * s11 - P[i, 1] * s01) / det
        K[i, 1] = (P[i, 1] * s00 - P[i, 0] * s01) / det
        x[i] += K[i, 0] * r0 + K[i, 1] * r1
    joseph(P, K, np.eye(2, 3), R)
    distance = (s11 * r0 * r0 - 2.0 * s01 * r0 * r1 + s00 * r1 * r1) / det
    return -0.5 * (distance + math.log(det)) - math.log(2.0 * math.pi)
