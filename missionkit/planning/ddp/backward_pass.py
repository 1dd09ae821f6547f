"""The sweep from the last step to the first: policies and the quadratic model of the cost-to-go.

    Q_x  = L_x  + f_xᵀ V_x                      Q_xx = L_xx + f_xᵀ V_xx f_x + V_x · f_xx
    Q_u  = L_u  + f_uᵀ V_x                      Q_uu = L_uu + f_uᵀ V_xx f_u + V_x · f_uu
    Q_ux = L_ux + f_uᵀ V_xx f_x + V_x · f_ux
    l_ff = -(Q_uu + ρ I)⁻¹ Q_u,                 l_fb = -(Q_uu + ρ I)⁻¹ Q_ux
    V_x  = Q_x  + l_fbᵀ (Q_uu l_ff + Q_u) + Q_uxᵀ l_ff
    V_xx = Q_xx + l_fbᵀ (Q_uu l_fb + Q_ux) + Q_uxᵀ l_fb

Without regularisation ρ the last two are V_x = Q_x - Q_xu Q_uu⁻¹ Q_u and V_xx = Q_xx -
Q_xu Q_uu⁻¹ Q_ux, at t_k.

Sources: P4, (36) to (45), correction P4.2; Y. Tassa, T. Erez and E. Todorov, "Synthesis and
stabilization of complex behaviors through online trajectory optimization", 2012, for ρ.
"""

from __future__ import annotations

import numpy as np

from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled


@compiled
def backward_pass(
    A: Mat,
    B: Mat,
    second: Mat,
    lx: Mat,
    lu: Mat,
    lxx: Mat,
    lux: Mat,
    luu: Mat,
    regularisation: float,
) -> tuple[Mat, Mat, Mat]:
    """Return feedforward (N, m), feedback (N, m, n) and what the model expects (3,).

    The cost is expected to change by γ times the first plus γ² times the second of the three
    numbers at a rate γ; the third is 0 if some Q_uu + ρ I is not positive definite.

    Args:
        A: (N, n, n), ∂f/∂x.
        B: (N, n, m), ∂f/∂u.
        second: (N, n, n + m, n + m), or (0, …) for linear dynamics.
        lx: (N + 1, n).
        lu: (N, m).
        lxx: (N + 1, n, n).
        lux: (N, m, n).
        luu: (N, m, m).
        regularisation: ρ.
    """
    count, n, m = B.shape
    ff, fb = np.zeros((count, m)), np.zeros((count, m, n))
    expected = np.array([0.0, 0.0, 1.0])
    Vx, Vxx = lx[count].copy(), lxx[count].copy()
    VA, VB = np.empty((n, n)), np.empty((n, m))
    Qx, Qu = np.empty(n), np.empty(m)
    Qxx, Qux, Quu = np.empty((n, n)), np.empty((m, n)), np.empty((m, m))
    for k in range(count - 1, -1, -1):
        _times(Vxx, A[k], VA)
        _times(Vxx, B[k], VB)
        Qx[:], Qu[:] = lx[k], lu[k]
        Qxx[:], Qux[:], Quu[:] = lxx[k], lux[k], luu[k]
        _add_transposed(Qxx, A[k], VA)
        _add_transposed(Qux, B[k], VA)
        _add_transposed(Quu, B[k], VB)
        for i in range(n):
            for j in range(n):
                Qx[j] += A[k, i, j] * Vx[i]
            for j in range(m):
                Qu[j] += B[k, i, j] * Vx[i]
        if len(second) > 0:
            _add_curvature(Vx, second[k], Qxx, Qux, Quu)
        if not _gains(Quu, Qu, Qux, regularisation, ff[k], fb[k]):
            expected[2] = 0.0
            return ff, fb, expected
        _gradient_back(Qx, Qu, Qux, Quu, ff[k], fb[k], Vx, expected)
        _hessian_back(Qxx, Qux, Quu, fb[k], Vxx)
    return ff, fb, expected


@compiled
def _times(V: Mat, F: Mat, out: Mat) -> None:
    """Put V F, of V (n, n) and F (n, p), mostly zeros, in `out`."""
    out[:] = 0.0
    for i in range(F.shape[0]):
        for j in range(F.shape[1]):
            f = F[i, j]
            if f != 0.0:
                for r in range(len(V)):
                    out[r, j] += V[r, i] * f


@compiled
def _add_transposed(Q: Mat, F: Mat, G: Mat) -> None:
    """Q := Q + Fᵀ G, of F, mostly zeros, and G with n rows."""
    for i in range(F.shape[0]):
        for j in range(F.shape[1]):
            f = F[i, j]
            if f != 0.0:
                for c in range(G.shape[1]):
                    Q[j, c] += f * G[i, c]


@compiled
def _add_curvature(Vx: Vec3, second: Mat, Qxx: Mat, Qux: Mat, Quu: Mat) -> None:
    """Add V_x · f_xx, V_x · f_ux and V_x · f_uu, the terms beside those of Gauss and Newton."""
    n, m = len(Vx), len(Quu)
    for c in range(n):
        for i in range(n):
            for j in range(n):
                Qxx[i, j] += Vx[c] * second[c, i, j]
        for i in range(m):
            for j in range(n):
                Qux[i, j] += Vx[c] * second[c, n + i, j]
            for j in range(m):
                Quu[i, j] += Vx[c] * second[c, n + i, n + j]


@compiled
def _gains(Quu: Mat, Qu: Mat, Qux: Mat, regularisation: float, ff: Vec3, fb: Mat) -> bool:
    """Put the gains in `ff` and `fb`; say whether Q_uu + ρ I is positive definite."""
    m, n = Qux.shape
    L = Quu.copy()
    for i in range(m):
        L[i, i] += regularisation
    if not _factored(L):
        return False
    for i in range(m):
        ff[i] = -Qu[i]
        for c in range(n):
            fb[i, c] = -Qux[i, c]
    _solve(L, ff.reshape(m, 1))
    _solve(L, fb)
    return True


@compiled
def _factored(L: Mat) -> bool:
    """Put the Cholesky factor of L (m, m) in its lower half; say whether there is one."""
    for j in range(len(L)):
        for c in range(j):
            L[j, j] -= L[j, c] * L[j, c]
        if not L[j, j] > 0.0:
            return False
        L[j, j] = np.sqrt(L[j, j])
        for i in range(j + 1, len(L)):
            for c in range(j):
                L[i, j] -= L[i, c] * L[j, c]
            L[i, j] /= L[j, j]
    return True


@compiled
def _solve(L: Mat, X: Mat) -> None:
    """X := (L Lᵀ)⁻¹ X, of L (m, m) lower and X (m, p)."""
    m = len(L)
    for column in range(X.shape[1]):
        for i in range(m):
            for c in range(i):
                X[i, column] -= L[i, c] * X[c, column]
            X[i, column] /= L[i, i]
        for i in range(m - 1, -1, -1):
            for c in range(i + 1, m):
                X[i, column] -= L[c, i] * X[c, column]
            X[i, column] /= L[i, i]


@compiled
def _gradient_back(
    Qx: Vec3, Qu: Vec3, Qux: Mat, Quu: Mat, ff: Vec3, fb: Mat, Vx: Vec3, expected: Vec3
) -> None:
    """Put the gradient of the cost-to-go in V_x, and add what the feedforward should bring."""
    m, n = Qux.shape
    Vx[:] = Qx
    for i in range(m):
        pull = 0.0
        for j in range(m):
            pull += Quu[i, j] * ff[j]
        expected[0] += ff[i] * Qu[i]
        expected[1] += 0.5 * ff[i] * pull
        for r in range(n):
            Vx[r] += fb[i, r] * (pull + Qu[i]) + Qux[i, r] * ff[i]


@compiled
def _hessian_back(Qxx: Mat, Qux: Mat, Quu: Mat, fb: Mat, Vxx: Mat) -> None:
    """Put the Hessian of the cost-to-go, exactly symmetric, in V_xx."""
    m, n = Qux.shape
    Vxx[:] = Qxx
    for i in range(m):
        for c in range(n):
            slope = Qux[i, c]
            for j in range(m):
                slope += Quu[i, j] * fb[j, c]
            for r in range(c + 1):
                Vxx[r, c] += fb[i, r] * slope + Qux[i, r] * fb[i, c]
    for c in range(n):
        for r in range(c):
            Vxx[c, r] = Vxx[r, c]
