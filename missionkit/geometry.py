"""Rotations and rigid transforms.

Quaternions are (w, x, y, z), Hamilton, and turn body vectors into world vectors. The functions
are leaves in scalar arithmetic, so kernels may compile them (`compiled(geometry.rotate)`). Numbers
are taken out of arrays first, since numpy's own are slow; numba makes arrays fastest from tuples.

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

GRAVITY = 9.80665  # m/s², standard, downwards

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
IDENTITY.flags.writeable = False


def vec(x: float, y: float, z: float) -> Vec3:
    """Return (3,) from three numbers.

    Args:
        x: north, forward or right, by the frame.
        y: east, right or down.
        z: down, down or forward.
    """
    return np.array([x, y, z], dtype=np.float64)


def norm(v: Vec3) -> float:
    """Return the Euclidean length of (3,)."""
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def wrap(angle: float) -> float:
    """Bring an angle into [-pi, pi).  Source: P1 section 3.3, `wrap_to_pi`."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def multiply(p: Quat, q: Quat) -> Quat:
    """Return the Hamilton product p ⊗ q (first q, then p)."""
    w, x, y, z = float(p[0]), float(p[1]), float(p[2]), float(p[3])
    a, b, c, d = float(q[0]), float(q[1]), float(q[2]), float(q[3])
    return np.array(
        (
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        )
    )


def conjugate(q: Quat) -> Quat:
    """Return the inverse of a unit quaternion."""
    return np.array((q[0], -q[1], -q[2], -q[3]))


def normalised(q: Quat) -> Quat:
    """Return q at unit length."""
    w, x, y, z = float(q[0]), float(q[1]), float(q[2]), float(q[3])
    n = math.sqrt(w * w + x * x + y * y + z * z)
    return np.array((w / n, x / n, y / n, z / n))


def exp(phi: Vec3) -> Quat:
    """Turn a rotation vector (3,), rad, into a quaternion; exact also near zero."""
    x, y, z = float(phi[0]), float(phi[1]), float(phi[2])
    angle = math.sqrt(x * x + y * y + z * z)
    half = 0.5 * angle
    s = 0.5 - angle * angle / 48.0 if angle < 1e-6 else math.sin(half) / angle
    return np.array((math.cos(half), s * x, s * y, s * z))


def log(q: Quat) -> Vec3:
    """Turn a unit quaternion into its rotation vector (3,), rad, the shorter way round."""
    sign = 1.0 if q[0] >= 0.0 else -1.0
    w, x, y, z = sign * float(q[0]), sign * float(q[1]), sign * float(q[2]), sign * float(q[3])
    s = math.sqrt(x * x + y * y + z * z)
    k = 2.0 if s < 1e-9 else 2.0 * math.atan2(s, w) / s
    return np.array((k * x, k * y, k * z))


def to_matrix(q: Quat) -> Mat:
    """Return the rotation matrix (3, 3) of a unit quaternion."""
    w, x, y, z = float(q[0]), float(q[1]), float(q[2]), float(q[3])
    return np.array(
        (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
            (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
            (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
        )
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
    w, x, y, z = float(q[0]), float(q[1]), float(q[2]), float(q[3])
    a, b, c = float(v[0]), float(v[1]), float(v[2])
    tx = 2.0 * (y * c - z * b)
    ty = 2.0 * (z * a - x * c)
    tz = 2.0 * (x * b - y * a)
    return np.array(
        (
            a + w * tx + y * tz - z * ty,
            b + w * ty + z * tx - x * tz,
            c + w * tz + x * ty - y * tx,
        )
    )


def yaw_of(q: Quat) -> float:
    """Return the heading (rad, clockwise from north seen from above) of a body-to-world q."""
    return math.atan2(2.0 * (q[0] * q[3] + q[1] * q[2]), 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]))


def from_euler(roll: float, pitch: float, yaw: float) -> Quat:
    """Return q of aerospace angles (rad): yaw, then pitch, then roll about the turned axes.

    Args:
        roll: about x, rad.
        pitch: about y, rad.
        yaw: about z, rad.

    Returns:
        (4,), Hamilton, w first, unit.
    """
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


def cross(a: Vec3, b: Vec3) -> Vec3:
    """Return a × b of two (3,)."""
    return np.array(
        (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    )


def across(a: Vec3) -> Vec3:
    """Return a unit vector (3,) across a (3,), not zero: the same one for the same a."""
    least = np.zeros(3)
    least[int(np.abs(a).argmin())] = 1.0
    axis = cross(a, least)
    return axis / norm(axis)


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
