"""Features as states: expected, taken in, and begun; compiled, arrays are changed in place.

A feature l is seen at f (X/Z, Y/Z) of c = R_cb (b - t), b = R(q)ᵀ (l - p), so with M the derivative
by b, ∂z = M (R(q)ᵀ (δl - δp) + [b]× δθ). Layout as in `vehicle_steps`.

Source: P4 section II-B and (11), whose first column lacks the square of the depth.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from missionkit.estimation.error_state_ekf.state_layout import D_ANGLE, D_LANDMARKS, LANDMARKS
from missionkit.estimation.linear_algebra import rotate, to_matrix
from missionkit.estimation.ud_filter import factors
from missionkit.estimation.ud_vision.vehicle_steps import correct, distance, innovation
from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled

LEAST_DEPTH = 0.05
"""m, nearer to the camera's plane nothing is expected."""
LEAST_SINK = 0.2
"""A line of sight that sinks less than this share of its length meets the ground too far away."""


@compiled
def expect(x: Vec3, slot: int, eye: Mat, focal: Vec3, H: Mat, z: Vec3) -> bool:
    """Write where a feature is seen (2,), px from the middle, and the Jacobian (2, n).

    Says whether it lies before the camera.

    Args:
        x: (16 + 3 N,) state.
        slot: which feature.
        eye: (4, 3), camera to body: its axes as columns of the first three rows, then t (m).
        focal: (2,), px.
        H: (2, n), zero on entry, written.
        z: (2,), written.
    """
    R, first = to_matrix(x[6:10]), LANDMARKS + 3 * slot
    b = _rotated_back(R, x[first : first + 3] - x[:3])
    c = _rotated_back(eye, b - eye[3])
    if not c[2] > LEAST_DEPTH:
        return False
    for a in range(2):
        z[a] = focal[a] * c[a] / c[2]
        M = (focal[a] * eye[:3, a] - z[a] * eye[:3, 2]) / c[2]
        for j in range(3):
            slope = M[0] * R[j, 0] + M[1] * R[j, 1] + M[2] * R[j, 2]
            H[a, j], H[a, first - 1 + j] = -slope, slope
            k, m = (j + 1) % 3, (j + 2) % 3
            H[a, D_ANGLE + j] = M[k] * b[m] - M[m] * b[k]
    return True


@compiled
def _rotated_back(R: Mat, v: Vec3) -> Vec3:
    """Return Rᵀ v (3,) of the first three rows of R."""
    out = np.empty(3)
    for i in range(3):
        out[i] = R[0, i] * v[0] + R[1, i] * v[1] + R[2, i] * v[2]
    return out


@compiled
def aim(x: Vec3, U: Mat, D: Vec3, slots: npt.NDArray[np.int64], eye: Mat, focal: Vec3) -> Mat:
    """Return (k, 3) where features are expected, px from the middle, and how surely, px (1 sigma).

    One that is not before the camera has an infinite deviation.

    Args:
        x: (16 + 3 N,) state.
        U: (n, n).
        D: (n,).
        slots: (k,) which features.
        eye: (4, 3) as in `expect`.
        focal: (2,), px.
    """
    out = np.empty((len(slots), 3))
    for s in range(len(slots)):
        H, z = np.zeros((2, len(D))), np.zeros(2)
        out[s, 2] = math.inf
        if expect(x, slots[s], eye, focal, H, z):
            S = innovation(U, D, H)
            out[s, 2] = math.sqrt(S[0, 0] + S[1, 1])
        out[s, 0], out[s, 1] = z[0], z[1]
    return out


@compiled
def see(
    x: Vec3,
    U: Mat,
    D: Vec3,
    slots: npt.NDArray[np.int64],
    seen: Mat,
    eye: Mat,
    focal: Vec3,
    variance: float,
    gate: float,
) -> Vec3:
    """Take in where features were seen, unless too far from expected; return the ε (k,) of each.

    Args:
        x: (16 + 3 N,) state, changed.
        U: (n, n), changed.
        D: (n,), changed.
        slots: (k,) which features.
        seen: (k, 2), px from the middle.
        eye: (4, 3) as in `expect`.
        focal: (2,), px.
        variance: px², of each number.
        gate: ε from which a feature is refused.
    """
    k, used = len(slots), 0
    H, r = np.zeros((2 * k, len(D))), np.zeros(2 * k)
    nis, variances, z = np.empty(k), np.full(2 * k, variance), np.empty(2)
    for s in range(k):
        rows = H[2 * used : 2 * used + 2]
        nis[s] = math.inf
        if expect(x, slots[s], eye, focal, rows, z):
            for a in range(2):
                r[2 * used + a] = seen[s, a] - z[a]
            nis[s] = distance(U, D, rows, r[2 * used : 2 * used + 2], variances[:2])
        if nis[s] < gate:
            used += 1
        else:
            rows[:] = 0.0
    correct(x, U, D, H[: 2 * used], r[: 2 * used], variances[: 2 * used])
    return nis


@compiled
def begin(
    x: Vec3,
    U: Mat,
    D: Vec3,
    slot: int,
    seen: Vec3,
    eye: Mat,
    focal: Vec3,
    variances: Vec3,
) -> bool:
    """Put a feature where its line of sight meets level ground; say whether it does.

    Nothing is known of it at first but `variances[0]`; then the image and the level ground are
    measurements like all others, and tie it to the vehicle.

    Args:
        x: (16 + 3 N,) state, changed.
        U: (n, n), changed.
        D: (n,), changed.
        slot: which feature.
        seen: (2,), px from the middle.
        eye: (4, 3) as in `expect`.
        focal: (2,), px.
        variances: (3,): of its place before (m²), of the image (px²), of the ground (m²).
    """
    b, q, first = np.empty(3), x[6:10], LANDMARKS + 3 * slot
    for i in range(3):
        b[i] = eye[i, 0] * seen[0] / focal[0] + eye[i, 1] * seen[1] / focal[1] + eye[i, 2]
    ray, arm = rotate(q, b), rotate(q, eye[3].copy())
    length = math.sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2])
    height = -x[2] - arm[2]
    if not (ray[2] > LEAST_SINK * length and height > 0.0):
        return False
    for i in range(3):
        x[first + i] = x[i] + arm[i] + height / ray[2] * ray[i]
    factors.forget(U, D, D_LANDMARKS + 3 * slot, 3, D.dtype.type(variances[0]))
    H, z, noise = np.zeros((3, len(D))), np.empty(2), np.empty(3)
    expect(x, slot, eye, focal, H[:2], z)
    H[2, first + 1] = 1.0
    noise[0], noise[1], noise[2] = variances[1], variances[1], variances[2]
    correct(x, U, D, H, np.zeros(3), noise)
    return True
