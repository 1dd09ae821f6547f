"""P = U D Uᵀ: U (n, n) upper with ones on its diagonal, D (n,) of what is on the diagonal of D.

As long as no number of D is negative P is a covariance, whatever the rounding. The kernels keep the
precision of their arrays, single or double, all of one kind.

Sources: P4, (2) to (6), correction P4.5; G. J. Bierman, "Factorization Methods for Discrete
Sequential Estimation", 1977; C. L. Thornton, "Triangular Covariance Factorizations for Kalman
Filtering", 1976; M. S. Grewal and A. P. Andrews, "Kalman Filtering", chapter 7.
"""

from __future__ import annotations

from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled


@compiled
def factorised(P: Mat) -> tuple[Mat, Vec3]:
    """Return U (n, n) and D (n,) of a covariance (n, n) that is not negative."""
    n, one = len(P), P.dtype.type(1)
    U, D = P - P, P[0] - P[0]
    for j in range(n - 1, -1, -1):
        for i in range(j, -1, -1):
            total = P[i, j]
            for k in range(j + 1, n):
                total -= U[i, k] * D[k] * U[j, k]
            if i == j:
                D[j], U[j, j] = total, one
            elif D[j] > 0:
                U[i, j] = total / D[j]
    return U, D


@compiled
def covariance(U: Mat, D: Vec3) -> Mat:
    """Return P (n, n), exactly symmetric."""
    n, P = len(D), U - U
    for i in range(n):
        for j in range(i, n):
            for k in range(j, n):
                P[i, j] += U[i, k] * D[k] * U[j, k]
            P[j, i] = P[i, j]
    return P


@compiled
def update(x: Vec3, U: Mat, D: Vec3, h: Vec3, residual: float, variance: float) -> float:
    """Take in one number z = h x + noise, in place; return the variance of its residual.

    Args:
        x: (n,) state, changed.
        U: (n, n), changed.
        D: (n,), changed.
        h: (n,), row of the Jacobian.
        residual: z - h x, a number of the same precision.
        variance: of the noise, more than 0, of the same precision.
    """
    n, b = len(D), D - D
    a = b.copy()
    for i in range(n):
        if h[i] != 0:
            for j in range(i, n):
                a[j] += U[i, j] * h[i]
    for j in range(n):
        b[j] = D[j] * a[j]
    innovation = variance
    for j in range(n):
        before = innovation
        innovation = before + a[j] * b[j]
        slope = -a[j] / before
        D[j] *= before / innovation
        for i in range(j):
            factor = U[i, j]
            U[i, j] = factor + b[i] * slope
            b[i] += b[j] * factor
    for i in range(n):
        x[i] += b[i] / innovation * residual
    return innovation


@compiled
def predict(U: Mat, D: Vec3, F: Mat, G: Mat, q: Vec3) -> None:
    """P := F P Fᵀ + G diag(q) Gᵀ on the factors, in place, by a weighted Gram-Schmidt.

    Args:
        U: (n, n), changed.
        D: (n,), changed.
        F: (n, n), transition.
        G: (n, m), how noise enters.
        q: (m,), variances of the noise.
    """
    W, N, weights = _times_upper(F, U), G.copy(), D.copy()
    for i in range(len(D) - 1, -1, -1):
        D[i] = _weighted(W[i], W[i], weights) + _weighted(N[i], N[i], q)
        for j in range(i):
            U[i, j] = U[j, i] = D.dtype.type(0)
            if D[i] > 0:
                U[j, i] = (_weighted(W[i], W[j], weights) + _weighted(N[i], N[j], q)) / D[i]
            for k in range(W.shape[1]):
                W[j, k] -= U[j, i] * W[i, k]
            for k in range(N.shape[1]):
                N[j, k] -= U[j, i] * N[i, k]


@compiled
def predict_first(U: Mat, D: Vec3, F: Mat, G: Mat, q: Vec3) -> None:
    """P := F P Fᵀ + G diag(q) Gᵀ where all but the first m states stand still, in place.

    The rows of U below the first m are orthogonal already and stay as they are, so Gram-Schmidt
    has m rows instead of n, and the rest is U_12 := F U_12.

    Args:
        U: (n, n), changed.
        D: (n,), changed.
        F: (m, m), transition of the first m.
        G: (m, k), how noise enters them.
        q: (k,), variances of the noise.
    """
    m, n = len(F), len(D)
    first, weights = U[:m, :m].copy(), D[:m].copy()
    predict(first, weights, F, G, q)
    column = D[:m].copy()
    for j in range(m, n):
        for i in range(m):
            column[i] = U[i, j]
            U[i, j] -= column[i]  # 0 of the same precision
        for i in range(m):
            for k in range(m):
                if F[i, k] != 0:
                    U[i, j] += F[i, k] * column[k]
    for i in range(m):
        D[i] = weights[i]
        for j in range(m):
            U[i, j] = first[i, j]


@compiled
def add_rank_one(U: Mat, D: Vec3, a: Vec3, weight: float) -> None:
    """P := P + weight a aᵀ on the factors of the first len(a) states, in place.

    Source: W. S. Agee and R. H. Turner, "Triangular decomposition of a positive definite matrix
    plus a symmetric dyad", 1972.

    Args:
        U: (n, n), changed.
        D: (n,), changed.
        a: (m,), m <= n, overwritten.
        weight: not negative, of the same precision.
    """
    for j in range(len(a) - 1, -1, -1):
        share, before = a[j], D[j]
        D[j] = before + weight * share * share
        if D[j] > 0:
            slope = weight * share / D[j]
            weight *= before / D[j]
            for i in range(j):
                a[i] -= share * U[i, j]
                U[i, j] += slope * a[i]


@compiled
def forget(U: Mat, D: Vec3, first: int, count: int, variance: float) -> None:
    """Make some states independent of all others, in place; what the others know stays.

    Args:
        U: (n, n), changed.
        D: (n,), changed.
        first: of the states.
        count: of the states.
        variance: theirs from now on, of the same precision.
    """
    for k in range(first + count - 1, first - 1, -1):
        column, weight = U[:k, k].copy(), D[k]
        for j in range(k + 1, len(D)):
            U[k, j] -= U[k, j]
        for i in range(k):
            U[i, k] -= U[i, k]
        D[k] = variance
        add_rank_one(U, D, column, weight)


@compiled
def _times_upper(F: Mat, U: Mat) -> Mat:
    """Return F U of F (n, n), mostly zeros, and U (n, n) upper."""
    n, W = len(U), F - F
    for i in range(n):
        for k in range(n):
            if F[i, k] != 0:
                for j in range(k, n):
                    W[i, j] += F[i, k] * U[k, j]
    return W


@compiled
def _weighted(a: Vec3, b: Vec3, weights: Vec3) -> float:
    """Return Σ aᵢ bᵢ wᵢ."""
    total = weights.dtype.type(0)
    for k in range(len(weights)):
        total += a[k] * b[k] * weights[k]
    return total
