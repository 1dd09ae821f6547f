"""Rotations and rigid transforms.

Quaternions are (w, x, y, z), Hamilton, and turn body vectors into world vectors. The functions
are leaves in scalar arithmetic, so kernels may compile them (`compiled(geometry.rotate)`).

Source: J. Solà, "Quaternion kinematics for the error-state Kalman filter", 2017.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Vec3 = npt.NDArray[np.float64]  # (3,)
Quat = npt.NDArray[np.float64]  # (4,) w, x, y, z
Mat = npt.NDArray[np.float64]

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
IDENTITY.flags.writeable = False


def vec(x: float, y: float, z: float) -> Vec3:
    """Return (3,) from three numbers."""
    return np.array([x, y, z], dtype=np.float64)


def norm(v: Vec3) -> float:
    """Return the Euclidean length of (3,)."""
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def wrap(angle: float) -> float:
    """Bring an angle into [-pi, pi).  Source: P1 section 3.3, `wrap_to_pi`."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def multiply(p: Quat, q: Quat) -> Quat:
    """Return the Hamilton product p ⊗ q (first q, then p)."""
    return np.array(
        [
            p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
            p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
            p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
            p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
        ]
    )


def conjugate(q: Quat) -> Quat:
    """Return the inverse of a unit quaternion."""
    return np.array([q[0], -q[1], -q[2], -q[3]])


def normalised(q: Quat) -> Quat:
    """Return q at unit length."""
    n = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return np.array([q[0] / n, q[1] / n, q[2] / n, q[3] / n])


def exp(phi: Vec3) -> Quat:
    """Turn a rotation vector (3,), rad, into a quaternion; exact also near zero."""
    angle = math.sqrt(phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2])
    half = 0.5 * angle
    s = 0.5 - angle * angle / 48.0 if angle < 1e-6 else math.sin(half) / angle
    return np.array([math.cos(half), s * phi[0], s * phi[1], s * phi[2]])


def log(q: Quat) -> Vec3:
    """Turn a unit quaternion into its rotation vector (3,), rad, the shorter way round."""
    sign = 1.0 if q[0] >= 0.0 else -1.0
    w, x, y, z = sign * q[0], sign * q[1], sign * q[2], sign * q[3]
    s = math.sqrt(x * x + y * y + z * z)
    k = 2.0 if s < 1e-9 else 2.0 * math.atan2(s, w) / s
    return np.array([k * x, k * y, k * z])


def to_matrix(q: Quat) -> Mat:
    """Return the rotation matrix (3, 3) of a unit quaternion."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def from_matrix(R: Mat) -> Quat:
    """Return the unit quaternion of a rotation matrix (3, 3).  Source: Shepperd, 1978."""
    k = np.array(
        [
            R[0, 0] + R[1, 1] + R[2, 2],
            R[0, 0] - R[1, 1] - R[2, 2],
            R[1, 1] - R[0, 0] - R[2, 2],
            R[2, 2] - R[0, 0] - R[1, 1],
        ]
    )
    i = int(np.argmax(k))
    s = 2.0 * math.sqrt(1.0 + k[i])
    if i == 0:
        q = (0.25 * s, (R[2, 1] - R[1, 2]) / s, (R[0, 2] - R[2, 0]) / s, (R[1, 0] - R[0, 1]) / s)
    elif i == 1:
        q = ((R[2, 1] - R[1, 2]) / s, 0.25 * s, (R[0, 1] + R[1, 0]) / s, (R[0, 2] + R[2, 0]) / s)
    elif i == 2:
        q = ((R[0, 2] - R[2, 0]) / s, (R[0, 1] + R[1, 0]) / s, 0.25 * s, (R[1, 2] + R[2, 1]) / s)
    else:
        q = ((R[1, 0] - R[0, 1]) / s, (R[0, 2] + R[2, 0]) / s, (R[1, 2] + R[2, 1]) / s, 0.25 * s)
    sign = 1.0 if q[0] >= 0 else -1.0
    return np.array([sign * c for c in q])


def rotate(q: Quat, v: Vec3) -> Vec3:
    """Return R(q) v for (3,) v."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    tx = 2.0 * (y * v[2] - z * v[1])
    ty = 2.0 * (z * v[0] - x * v[2])
    tz = 2.0 * (x * v[1] - y * v[0])
    return np.array(
        [
            v[0] + w * tx + y * tz - z * ty,
            v[1] + w * ty + z * tx - x * tz,
            v[2] + w * tz + x * ty - y * tx,
        ]
    )


def yaw_of(q: Quat) -> float:
    """Return the heading (rad, clockwise from north seen from above) of a body-to-world q."""
    return math.atan2(2.0 * (q[0] * q[3] + q[1] * q[2]), 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]))


def from_euler(roll: float, pitch: float, yaw: float) -> Quat:
    """Return q of aerospace angles (rad): yaw, then pitch, then roll about the turned axes."""
    cr, sr = math.cos(0.5 * roll), math.sin(0.5 * roll)
    cp, sp = math.cos(0.5 * pitch), math.sin(0.5 * pitch)
    cy, sy = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def to_euler(q: Quat) -> tuple[float, float, float]:
    """Return aerospace roll, pitch, yaw (rad) of q; pitch is clamped at the poles."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
    return roll, pitch, yaw_of(q)


def skew(v: Vec3) -> Mat:
    """Return [v]× (3, 3), so that [v]× u = v × u."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


@dataclass(frozen=True, slots=True)
class Transform:
    """A rigid transform T_a_b: maps coordinates in frame b to coordinates in frame a."""

    rotation: Quat  # (4,) b to a
    translation: Vec3  # (3,), m, origin of b in a

    def __matmul__(self, other: Transform) -> Transform:
        """Chain: T_a_b @ T_b_c = T_a_c."""
        return Transform(
            normalised(multiply(self.rotation, other.rotation)), self.apply(other.translation)
        )

    def apply(self, point: Vec3) -> Vec3:
        """Return (3,) in a of a point (3,) in b."""
        return rotate(self.rotation, point) + self.translation

    def inverse(self) -> Transform:
        """Return T_b_a."""
        back = conjugate(self.rotation)
        return Transform(back, -rotate(back, self.translation))
