"""The free rigid body: 13 states, six of a wrench, Runge-Kutta.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

from missionkit.geometry import Vec3
from missionkit.jit import compiled
from missionkit.sim.free_flyer.flyer_layout import Flyer


@compiled
def derivative(x: Vec3, wrench: Vec3, body: Flyer, out: Vec3) -> None:
    """Write the time derivative (13,) of the state into `out`.

        p' = v;  m v' = R(q) F;  q' = q ⊗ (0, ω) / 2;  J ω' = N - ω × J ω

    P3 (2) with a mother-ship that does not turn, in the body's axes. P3 (1) gives the motion of the
    radio at P, ρ_ij'' = ρ'' + ω' × P + ω × (ω × P): it follows from that of the centre of mass and
    the attitude, which are simulated here.

    Args:
        x: (13,) state, see `flyer_layout`.
        wrench: (6,) force (N) and torque (N·m), body axes.
        body: constants.
        out: (13,) result.
    """
    w, i, j, k = x[6], x[7], x[8], x[9]
    p, q, r = x[10], x[11], x[12]
    fx, fy, fz = wrench[0] / body.mass, wrench[1] / body.mass, wrench[2] / body.mass
    out[0], out[1], out[2] = x[3], x[4], x[5]
    out[3] = (
        (1.0 - 2.0 * (j * j + k * k)) * fx + 2.0 * (i * j - w * k) * fy + 2.0 * (i * k + w * j) * fz
    )
    out[4] = (
        2.0 * (i * j + w * k) * fx + (1.0 - 2.0 * (i * i + k * k)) * fy + 2.0 * (j * k - w * i) * fz
    )
    out[5] = (
        2.0 * (i * k - w * j) * fx + 2.0 * (j * k + w * i) * fy + (1.0 - 2.0 * (i * i + j * j)) * fz
    )
    out[6] = 0.5 * (-i * p - j * q - k * r)
    out[7] = 0.5 * (w * p + j * r - k * q)
    out[8] = 0.5 * (w * q - i * r + k * p)
    out[9] = 0.5 * (w * r + i * q - j * p)
    out[10] = (wrench[3] - (body.jz - body.jy) * q * r) / body.jx
    out[11] = (wrench[4] - (body.jx - body.jz) * p * r) / body.jy
    out[12] = (wrench[5] - (body.jy - body.jx) * p * q) / body.jz


@compiled
def advance(x: Vec3, wrench: Vec3, body: Flyer, dt: float, work: Vec3) -> None:
    """Move the state one step of `dt` (s), in place: classical Runge-Kutta of order four.

    The wrench is constant in the body over the step.

    Args:
        x: (13,) state, changed in place.
        wrench: (6,), force (N) and torque (N·m), body.
        body: mass (kg) and inertia (kg m²).
        dt: s.
        work: (5, 13), overwritten.
    """
    derivative(x, wrench, body, work[0])
    for stage in range(1, 4):
        part = dt if stage == 3 else 0.5 * dt
        for n in range(13):
            work[4, n] = x[n] + part * work[stage - 1, n]
        derivative(work[4], wrench, body, work[stage])
    for n in range(13):
        slope = work[0, n] + 2.0 * work[1, n] + 2.0 * work[2, n] + work[3, n]
        x[n] += dt / 6.0 * slope
    size = math.sqrt(x[6] * x[6] + x[7] * x[7] + x[8] * x[8] + x[9] * x[9])
    for n in range(6, 10):
        x[n] /= size
