"""DDP with line search, regularisation and continuation of the penalty; and P4's own form of it.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat
from missionkit.planning.ddp.backward_pass import backward_pass
from missionkit.planning.ddp.problem import Policy, Problem, Trajectory

WEIGHTS = (1.0, 10.0, 100.0, 1e3, 1e4)  # of the penalty, one after the other
HALVINGS = 12  # of the rate, in one line search
ENOUGH = 0.1  # share of the expected decrease that a step must bring
LEAST, MOST, GROWTH = 1e-6, 1e10, 10.0  # of the regularisation ρ


class Settings(NamedTuple):
    """How far the solver goes."""

    weights: tuple[float, ...] = WEIGHTS
    tolerance: float = 1e-4  # relative decrease of the cost below which it is done
    coarse: float = 1e-2  # the same for all weights but the last
    iterations: int = 100  # at most, over all weights


SETTINGS = Settings()


class Plan(NamedTuple):
    """What a solver found. All numbers are finite."""

    states: Mat  # (N + 1, n)
    controls: Mat  # (N, m)
    cost: float  # without penalties
    violation: float  # the largest of any inequality, in its own unit
    iterations: int  # backward passes
    converged: bool


class NoPlanError(ValueError):
    """Raised when there is no trajectory of finite cost; the message says why."""


class Descent(NamedTuple):
    """Where the solver stands at one weight of the penalty."""

    at: Trajectory
    value: float  # with penalties
    iterations: int = 0
    regularisation: float = 0.0
    converged: bool = False


def solve(problem: Problem, state: Mat, controls: Mat, settings: Settings = SETTINGS) -> Plan:
    """Return a local optimum from `state`, beginning with `controls`.

    Args:
        problem: dynamics, cost and penalties.
        state: (n,), x_0.
        controls: (N, m), first guess: zeros, or those of the last plan (`shifted`).
        settings: weights of the penalty, and when to stop.

    Raises:
        NoPlanError: state or controls are not finite, or the cost of the first guess is not.
    """
    at = begun(problem, state, controls)
    done, used, last = False, 0, len(settings.weights) - 1
    for turn, weight in enumerate(settings.weights):
        if 0 < turn < last and problem.violation(at) == 0.0:
            continue  # an optimum at which no penalty is at work is one for every weight
        tolerance = settings.coarse if turn < last else settings.tolerance
        found = descend(problem, at, weight, tolerance, settings.iterations - used)
        at, done, used = found.at, found.converged, used + found.iterations
    return finished(problem, at, used, converged=done)


def replan(
    problem: Problem, state: Mat, last: Plan, steps: int = 1, settings: Settings = SETTINGS
) -> Plan:
    """Return a plan that begins with what is left of the last one, and with the second weight.

    At the last weight alone it would be there sooner in most cases and take three times as many
    steps in the worst of a hundred.

    Args:
        problem: as for `solve`.
        state: (n,), x_0.
        last: the last plan.
        steps: of it that have been flown.
        settings: as for `solve`.

    Raises:
        NoPlanError: as for `solve`.
    """
    warm = settings._replace(weights=settings.weights[1:] or settings.weights)
    return solve(problem, state, shifted(last.controls, steps), warm)


def best_of_rollouts(
    problem: Problem,
    state: Mat,
    controls: Mat,
    rate: float = 0.8,
    rollouts: int = 40,
    weight: float = WEIGHTS[-1],
) -> Plan:
    """Return the cheapest of many trajectories by a fixed rate: P4, (46), as the paper does it.

    There is no line search, no continuation and no regularisation but what keeps Q_uu positive.

    Args:
        problem: as for `solve`.
        state: (n,), x_0.
        controls: (N, m), first guess.
        rate: γ.
        rollouts: N, trajectories tried.
        weight: μ, of the penalty.

    Raises:
        NoPlanError: as for `solve`.
    """
    at = best = begun(problem, state, controls)
    cheapest = problem.value(at, weight)
    regularisation = 0.0
    for _ in range(rollouts):
        policy, _, regularisation = policy_around(problem, at, weight, regularisation)
        at = problem.dynamics.roll_out(at, policy, rate)
        value = problem.value(at, weight)
        if not math.isfinite(value):
            break
        if value < cheapest:
            best, cheapest = at, value
    return finished(problem, best, rollouts, converged=True)


def shifted(controls: Mat, steps: int) -> Mat:
    """Return (N, m) controls without the first `steps`, the last one zero to fill up."""
    left = np.zeros_like(controls)
    steps = min(max(0, steps), len(controls))
    left[: len(controls) - steps] = controls[steps:]
    return left


def begun(problem: Problem, state: Mat, controls: Mat) -> Trajectory:
    """Return the first guess as a trajectory.

    Args:
        problem: dynamics, cost and penalties.
        state: (n,), x_0.
        controls: (N, m).

    Raises:
        NoPlanError: it is not finite.
    """
    if not (np.isfinite(state).all() and np.isfinite(controls).all()):
        raise NoPlanError("the state or the first guess of the controls is not finite")
    at = problem.start(np.asarray(state, dtype=float), np.asarray(controls, dtype=float))
    if not math.isfinite(problem.value(at, 1.0)):
        raise NoPlanError("the trajectory of the first guess has no finite cost")
    return at


def finished(problem: Problem, at: Trajectory, iterations: int, *, converged: bool) -> Plan:
    """Return the plan that a trajectory is.

    Args:
        problem: dynamics, cost and penalties.
        at: the trajectory.
        iterations: taken to find it.
        converged: whether the last step gained less than the tolerance.
    """
    cost, violation = problem.cost.value(at), problem.violation(at)
    return Plan(at.states, at.controls, cost, violation, iterations, converged)


def descend(
    problem: Problem, at: Trajectory, weight: float, tolerance: float, iterations: int
) -> Descent:
    """Return where Newton's steps lead at one weight of the penalty.

    Args:
        problem: dynamics, cost and penalties.
        at: where to begin.
        weight: μ, of the penalty.
        tolerance: share of the cost; a smaller expected gain has converged.
        iterations: at most.
    """
    now = Descent(at, problem.value(at, weight))
    while now.iterations < iterations and not now.converged:
        now = _stepped(problem, now, weight, tolerance)
        if now.regularisation > MOST:
            break
    return now


def policy_around(
    problem: Problem, at: Trajectory, weight: float, regularisation: float
) -> tuple[Policy, tuple[float, float], float]:
    """Return policy, expected change (linear and quadratic in the rate) and the ρ it took.

    Args:
        problem: dynamics, cost and penalties.
        at: trajectory that the policy belongs to.
        weight: μ, of the penalty.
        regularisation: ρ to begin with; it grows until Q_uu is positive definite.
    """
    f, cost = problem.dynamics.derivatives(at), problem.expand(at, weight)
    while True:
        ff, fb, expected = backward_pass(*f, *cost, regularisation)
        if expected[2] > 0.0 or regularisation > MOST:
            return Policy(ff, fb), (float(expected[0]), float(expected[1])), regularisation
        regularisation = max(LEAST, GROWTH * regularisation)


def _stepped(problem: Problem, now: Descent, weight: float, tolerance: float) -> Descent:
    """Return the descent after one backward pass and one line search."""
    policy, (slope, bend), rho = policy_around(problem, now.at, weight, now.regularisation)
    used, rate = now.iterations + 1, 1.0
    done = -(slope + bend) <= tolerance * abs(now.value) and rho <= LEAST
    for _ in range(HALVINGS):
        there = problem.dynamics.roll_out(now.at, policy, rate)
        value = problem.value(there, weight)
        if value <= now.value + ENOUGH * rate * (slope + rate * bend):
            easier = rho / GROWTH if rho > LEAST else 0.0
            return Descent(there, value, used, easier, done)
        if done:
            break
        rate *= 0.5
    return now._replace(iterations=used, regularisation=max(LEAST, GROWTH * rho), converged=done)
