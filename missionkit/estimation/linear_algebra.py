"""Rotations and small dense matrices, compiled; in place where nothing is returned."""

from __future__ import annotations

import numpy as np

from missionkit import geometry
from missionkit.geometry import Mat
from missionkit.jit import compiled

conjugate = compiled(geometry.conjugate)
exp = compiled(geometry.exp)
log = compiled(geometry.log)
multiply = compiled(geometry.multiply)
normalised = compiled(geometry.normalised)
rotate = compiled(geometry.rotate)
to_matrix = compiled(geometry.to_matrix)
wrap = compiled(geometry.wrap)


@compiled
def transpose(P: Mat) -> None:
    """Transpose a square matrix."""
    for i in range(len(P)):
        for j in range(i):
            P[i, j], P[j, i] = P[j, i], P[i, j]


@compiled
def symmetrise(P: Mat) -> None:
    """P := ½ (P + Pᵀ)."""
    for i in range(len(P)):
        for j in range(i):
            P[i, j] = P[j, i] = 0.5 * (P[i, j] + P[j, i])


@compiled
def inverted(S: Mat) -> tuple[Mat, bool]:
    """Return the inverse of a symmetric (m, m) by elimination, and whether it is positive."""
    m, A = len(S), S.copy()
    for k in range(m):
        pivot = A[k, k]
        if not pivot > 0.0:
            return A, False
        A[k, k] = 1.0
        for j in range(m):
            A[k, j] /= pivot
        for i in range(m):
            if i != k:
                g = A[i, k]
                A[i, k] = 0.0
                for j in range(m):
                    A[i, j] -= g * A[k, j]
    return A, True


@compiled
def times_transposed(A: Mat, B: Mat) -> Mat:
    """Return A Bᵀ (n, m) of A (n, k) and B (m, k), which is mostly zeros."""
    n, m = len(A), len(B)
    C = np.zeros((n, m))
    for i in range(m):
        for k in range(A.shape[1]):
            g = B[i, k]
            if g != 0.0:
                for c in range(n):
                    C[c, i] += g * A[c, k]
    return C


@compiled
def add_product(P: Mat, A: Mat, B: Mat, sign: float) -> None:
    """P := P + sign A B, of A (n, m) and B (m, n).

    Args:
        P: (n, n), changed in place.
        A: (n, m).
        B: (m, n).
        sign: 1 or -1.
    """
    for c in range(len(P)):
        for k in range(len(P)):
            total = 0.0
            for i in range(len(B)):
                total += A[c, i] * B[i, k]
            P[c, k] += sign * total


@compiled
def joseph(P: Mat, K: Mat, H: Mat, R: Mat) -> None:
    """P := (I - K H) P (I - K H)ᵀ + K R Kᵀ, which stays positive whatever K is.

    P is (n, n), K (n, m), H (m, n) and R (m, m).

    Args:
        P: (n, n) covariance, changed in place.
        K: (n, m) gain.
        H: (m, n) Jacobian.
        R: (m, m) covariance of the measurement.
    """
    G = K.T.copy()
    for _ in range(2):
        add_product(P, times_transposed(P, H), G, -1.0)
        transpose(P)
    add_product(P, times_transposed(K, R), G, 1.0)
    symmetrise(P)
