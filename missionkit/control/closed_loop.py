"""The closed loop of one axis near its goal: position, velocity, integral and lag, sampled.

The vehicle answers the velocity u that it is sent, held over one period, like

    p' = v,   v' = (w - v)/τ,   w' = (u - w)/T,

with the lag T of attitude and rotors and τ = 1/k of the autopilot's velocity loop. Both are those
of the mission's `observer`; without one they share the vehicle's declared lag (`limits: {lag}`) as
the measured autopilots do (`disturbance_observer`: 0.18 s of 0.63 s). The controller of `pid.step`,
linear near the goal (at 0), with the smoothing of the command c:

    u = K (-Kp p + s - Kd v),   s⁺ = s - Ki h (p + v/Kp),   c⁺ = α u + (1 - α) c

K is 1; the gain margin is how much larger it may be. The loop x⁺ = A x comes to rest if and only if
the discrete Lyapunov equation Aᵀ P A - P = -Q has a positive definite P for Q = I: then V = xᵀ P x
falls at every step. P1 section 8.2 prints V and its derivative with different signs of Q, so that
this is the textbook's equation.

Source: Ogata, "Discrete-Time Control Systems", 2nd ed., sections 4-2 and 5-6.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.control.controller import Control
from missionkit.control.pid import Gains
from missionkit.control.velocity_smoothing import alpha_at
from missionkit.geometry import Mat
from missionkit.messages import Mode

LARGEST_MARGIN = 1000.0
STEP = 1.1  # between two gains that are tried on the way to the margin
INNER_SHARE = 0.3  # of the declared lag that attitude and rotors have
AXES = ("level", "vertical")


class Response(NamedTuple):
    """How a vehicle answers a velocity."""

    lag: float  # s, τ, of the velocity loop; 0: it flies what it is sent at once
    inner: float  # s, T, of attitude and rotors


class ClosedLoop(NamedTuple):
    """One axis of one control mode, sampled."""

    kp: float  # 1/s
    ki: float  # 1/s²; 0: without the integral
    kd: float
    alpha: float  # of the smoothing, at this period
    period: float  # s
    response: Response

    def matrix(self, gain: float = 1.0) -> Mat:
        """Return A of x = (p, v, w, c, s); without s where there is no integral.

        Args:
            gain: K, 1 as flown.
        """
        plant = sampled(self.response, self.period)
        n = len(plant) - 1
        size = n + 1 + (self.ki > 0.0)
        A = np.zeros((size, size))
        command = np.zeros(size)  # c⁺ by x
        command[0], command[1], command[n] = -gain * self.kp, -gain * self.kd, 0.0
        if self.ki > 0.0:
            command[n + 1] = gain
        command *= self.alpha
        command[n] = 1.0 - self.alpha
        A[:n, :n] = plant[:n, :n]
        A[:n] += plant[:n, n:] * command
        A[n] = command
        if self.ki > 0.0:
            A[n + 1, n + 1] = 1.0
            A[n + 1, 0] = -self.ki * self.period
            A[n + 1, 1] = -self.ki * self.period / self.kp
        return A


def sampled(response: Response, period: float) -> Mat:
    """Return the vehicle over one period (s): (p, v, w, u), u held."""
    if response.lag <= 0.0 or response.inner <= 0.0:
        M = np.zeros((4, 4))
        M[0, 0] = 1.0
        M[:, 3] = period, 1.0, 1.0, 1.0
        return M
    F = np.zeros((4, 4))
    F[0, 1] = 1.0
    F[1, 1], F[1, 2] = -1.0 / response.lag, 1.0 / response.lag
    F[2, 2], F[2, 3] = -1.0 / response.inner, 1.0 / response.inner
    return _exponential(F * period)


def _exponential(M: Mat) -> Mat:
    """Return e^M by Taylor's series of M/2^k, squared k times; M is small and dense."""
    halvings = max(0, math.ceil(math.log2(max(float(np.abs(M).sum(axis=1).max()), 1e-9))) + 4)
    X, term = np.eye(len(M)), np.eye(len(M))
    small = M / 2.0**halvings
    for order in range(1, 13):
        term = term @ small / order
        X = X + term
    for _ in range(halvings):
        X = X @ X
    return X


def loops(control: Control, mode: Mode, rate: float) -> dict[str, ClosedLoop]:
    """Return the loops of a control mode by the name of their axis.

    Args:
        control: of the mission.
        mode: whose gains are meant.
        rate: ticks per second.
    """
    gains, period, observer = control.gains_of(mode), 1.0 / rate, control.observer
    lag = control.limits.lag
    found = {}
    for n, axis in enumerate(AXES):
        response = (
            Response((1.0 - INNER_SHARE) * lag, INNER_SHARE * lag)
            if observer is None
            else Response(1.0 / observer.gain[n], observer.lag)
        )
        ki = gains.ki[n] if _integrates(gains) else 0.0
        alpha = alpha_at(control.alpha, period)
        found[axis] = ClosedLoop(gains.kp[n], ki, gains.kd[n], alpha, period, response)
    return found


def _integrates(gains: Gains) -> bool:
    return gains.integral_limit > 0.0 and gains.zone > 0.0


def slowest_pole(A: Mat) -> complex:
    """Return the eigenvalue of the largest modulus: below 1, the loop comes to rest."""
    poles = np.linalg.eigvals(A)
    return complex(poles[np.argmax(np.abs(poles))])


def settling_time(pole: complex, period: float) -> float:
    """Return the time (s) in which what a pole belongs to falls to 1/e; infinity if it does not."""
    size = abs(pole)
    if size >= 1.0:
        return math.inf
    return period if size <= math.exp(-1.0) else -period / math.log(size)


def gain_margin(loop: ClosedLoop) -> float:
    """Return by what factor the loop's gain may grow before it no longer comes to rest.

    0 if it does not as it is; at most `LARGEST_MARGIN`.
    """
    stable, gain = 0.0, 1.0
    while abs(slowest_pole(loop.matrix(gain))) < 1.0:
        if gain >= LARGEST_MARGIN:
            return LARGEST_MARGIN
        stable, gain = gain, gain * STEP
    if not stable:
        return 0.0
    for _ in range(20):
        middle = 0.5 * (stable + gain)
        if abs(slowest_pole(loop.matrix(middle))) < 1.0:
            stable = middle
        else:
            gain = middle
    return stable


def lyapunov(A: Mat) -> Mat | None:
    """Return P of V = xᵀ P x, which falls by xᵀ x at every step; None if there is none."""
    from scipy.linalg import solve_discrete_lyapunov  # noqa: PLC0415 - slow to import

    if np.isclose(np.abs(np.linalg.eigvals(A)), 1.0, rtol=0.0, atol=1e-12).any():
        return None
    P = np.asarray(solve_discrete_lyapunov(A.T, np.eye(len(A))), dtype=np.float64)
    return P if float(np.linalg.eigvalsh(0.5 * (P + P.T)).min()) > 0.0 else None
