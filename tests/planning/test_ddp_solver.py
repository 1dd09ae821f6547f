"""Differential dynamic programming against Riccati, an exact solver and its own optimum moved."""

from __future__ import annotations

import math

import numpy as np
import pytest
from planning.ddp_oracle import ExactFlight
from scipy.linalg import solve_discrete_are

from missionkit.planning.ddp.linear_dynamics import LinearDynamics, double_integrator
from missionkit.planning.ddp.point_mass import Flight
from missionkit.planning.ddp.problem import DynamicsDerivatives, Problem, Trajectory
from missionkit.planning.ddp.quadratic_cost import QuadraticCost
from missionkit.planning.ddp.solver import (
    SETTINGS,
    NoPlanError,
    Settings,
    best_of_rollouts,
    policy_around,
    replan,
    shifted,
    solve,
)

STEPS, STILL = 40, np.zeros((40, 3))


def flights(count, seed):
    """Targets 0.5 to 8 m away in any direction, from states at up to 2 m/s."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        way, velocity = rng.normal(size=(2, 3))
        way *= rng.uniform(0.5, 8.0) / np.linalg.norm(way)
        velocity *= rng.uniform(0.0, 2.0) / np.linalg.norm(velocity)
        yield Flight(np.concatenate([way, np.zeros(3)])), np.concatenate([np.zeros(3), velocity])


class FinalQuadratic(QuadraticCost):
    """The same with a dense Hessian of the last state."""

    def __init__(self, P, state_weights, control_weights, steps):
        super().__init__(np.zeros(len(P)), state_weights, control_weights, 0 * state_weights, steps)
        self.P = P

    def value(self, at):
        last = at.states[-1]
        return super().value(at) + 0.5 * float(last @ self.P @ last)

    def expand(self, at):
        found = super().expand(at)
        found.x[-1], found.xx[-1] = self.P @ at.states[-1], self.P
        return found


@pytest.mark.parametrize("shape", [(6, 3), (4, 2), (3, 1)])
def test_without_limits_it_is_the_linear_regulator(shape):
    """With the solution of Riccati's equation as final cost the gain is the same at all steps."""
    rng = np.random.default_rng(sum(shape))
    n, m = shape
    if n == 6:
        dynamics = double_integrator(STEPS, 0.1)
    else:
        dynamics = LinearDynamics(
            np.eye(n) + 0.2 * rng.normal(size=(n, n)), rng.normal(size=(n, m)), STEPS
        )
    A, B = dynamics.A, dynamics.B
    q, r = rng.uniform(0.5, 2.0, n), rng.uniform(0.1, 1.0, m)
    P = solve_discrete_are(A, B, np.diag(q), np.diag(r))
    K = np.linalg.solve(np.diag(r) + B.T @ P @ B, B.T @ P @ A)
    problem = Problem(dynamics, FinalQuadratic(P, q, r, STEPS))
    x = rng.normal(size=n)
    plan = solve(problem, x, np.zeros((STEPS, m)))
    assert plan.converged
    assert plan.iterations == 3  # one step of Newton; two weights see that it was enough
    assert plan.cost == pytest.approx(0.5 * x @ P @ x, rel=1e-9)
    for k in range(STEPS):
        np.testing.assert_allclose(plan.controls[k], -K @ plan.states[k], rtol=0, atol=1e-9)
    at = Trajectory(plan.states, plan.controls)
    policy, _, _ = policy_around(problem, at, 1.0, 0.0)
    np.testing.assert_allclose(policy.feedback, np.tile(-K, (STEPS, 1, 1)), rtol=0, atol=1e-9)


@pytest.mark.parametrize("case", range(3))
def test_with_limits_it_costs_what_the_exact_solution_costs(case):
    flight, state = list(flights(3, seed=7))[case]
    exact, room = ExactFlight(flight, state).least()
    assert room > -1e-6
    plan = solve(flight.problem(), state, STILL)
    assert plan.converged
    assert plan.cost == pytest.approx(exact, rel=0.01)
    assert plan.violation <= 0.03


def test_a_stiff_penalty_from_a_cold_start_does_not_stall():
    """At the last weight alone Newton's steps crawl; the continuation is there sooner."""
    least, crawled, used = [], 0, 0
    for flight, state in flights(30, seed=1):
        problem = flight.problem()
        plan = solve(problem, state, STILL)
        assert plan.converged
        assert plan.violation <= 0.03
        stiff = solve(problem, state, STILL, Settings(weights=SETTINGS.weights[-1:]))
        least.append(plan.cost / stiff.cost)
        crawled, used = crawled + stiff.iterations, used + plan.iterations
    assert max(least) < 1.001
    assert used < 0.5 * crawled


def test_a_warm_start_finds_the_same_in_fewer_steps():
    cold, warm = 0, 0
    for flight, state in flights(20, seed=2):
        problem = flight.problem()
        first = solve(problem, state, STILL)
        moved = first.states[1] + 0.01
        again = replan(problem, moved, first)
        fresh = solve(problem, moved, STILL)
        assert again.cost == pytest.approx(fresh.cost, rel=2e-3)
        assert again.violation <= 0.03
        cold, warm = cold + fresh.iterations, warm + again.iterations
    assert warm < 0.8 * cold


def test_the_fixed_rate_of_the_paper_is_no_better():
    worse = []
    for flight, state in flights(20, seed=1):
        problem = flight.problem()
        ours = solve(problem, state, STILL)
        paper = best_of_rollouts(problem, state, STILL)
        assert paper.iterations == 40
        worse.append((paper.cost + 5e3 * paper.violation**2) / ours.cost)
    assert min(worse) > 0.995
    assert max(worse) > 1.01


class Unicycle:
    """North, east, heading and speed, by turn rate and acceleration: nothing in it is linear."""

    def __init__(self, dt=0.1):
        self.dt = dt

    def step(self, x, u):
        heading, speed = x[2], x[3]
        moved = [speed * math.cos(heading), speed * math.sin(heading), u[0] * speed, u[1]]
        return x + self.dt * np.array(moved)

    def roll_out(self, around, policy, rate):
        xs, us = around.states.copy(), around.controls.copy()
        for k in range(len(us)):
            us[k] += rate * policy.feedforward[k] + policy.feedback[k] @ (xs[k] - around.states[k])
            xs[k + 1] = self.step(xs[k], us[k])
        return Trajectory(xs, us)

    def derivatives(self, at):
        count = len(at.controls)
        A, B = np.tile(np.eye(4), (count, 1, 1)), np.zeros((count, 4, 2))
        second = np.zeros((count, 4, 6, 6))
        for k, (x, u) in enumerate(zip(at.states, at.controls, strict=False)):
            c, s, v = math.cos(x[2]), math.sin(x[2]), x[3]
            A[k, 0, 2:] += self.dt * np.array([-s * v, c])
            A[k, 1, 2:] += self.dt * np.array([c * v, s])
            A[k, 2, 3] += self.dt * u[0]
            B[k, 2, 0], B[k, 3, 1] = self.dt * v, self.dt
            second[k, 0, 2:4, 2:4] = self.dt * np.array([[-c * v, -s], [-s, 0.0]])
            second[k, 1, 2:4, 2:4] = self.dt * np.array([[-s * v, c], [c, 0.0]])
            second[k, 2, 3, 4] = second[k, 2, 4, 3] = self.dt
        return DynamicsDerivatives(A, B, second)


def test_the_feedback_of_curved_dynamics_is_the_derivative_of_the_optimum():
    """∂u₀*/∂x₀ by moving the start and solving again: it takes every second derivative there is."""
    weights = np.array([1.0, 1.0, 0.2, 0.2])
    target = np.array([1.0, 0.7, 0.4, 0.5])
    cost = QuadraticCost(target, 0.1 * weights, np.array([0.05, 0.05]), 5.0 * weights, 12)
    problem, exactly = Problem(Unicycle(), cost), Settings(tolerance=1e-15, iterations=300)
    start, guess = np.array([0.0, 0.0, 0.1, 0.6]), np.zeros((12, 2))
    best = solve(problem, start, guess, exactly)
    assert best.converged
    policy, expected, rho = policy_around(problem, Trajectory(*best[:2]), 1.0, 0.0)
    assert rho == 0.0
    assert abs(expected[0]) < 1e-12
    slopes = np.zeros((2, 4))
    for i in range(4):
        aside = 1e-4 * np.eye(4)[i]
        ahead, behind = (
            solve(problem, start + sign * aside, best.controls, exactly).controls[0]
            for sign in (1.0, -1.0)
        )
        slopes[:, i] = (ahead - behind) / 2e-4
    np.testing.assert_allclose(policy.feedback[0], slopes, rtol=1e-4, atol=1e-5)


def test_regularisation_leads_out_of_where_the_cost_bends_down():
    """Beside a maximum Q_uu is negative: it is made positive, and the cost falls."""

    class Wave(QuadraticCost):
        """½ r u² + 2 cos of the last state."""

        def value(self, at):
            return super().value(at) + 2.0 * math.cos(at.states[-1, 0])

        def expand(self, at):
            found = super().expand(at)
            found.x[-1, 0] -= 2.0 * math.sin(at.states[-1, 0])
            found.xx[-1, 0, 0] -= 2.0 * math.cos(at.states[-1, 0])
            return found

    dynamics = LinearDynamics(np.eye(1), np.eye(1), 3)
    wave = Wave(np.zeros(1), np.zeros(1), np.array([0.01]), np.zeros(1), 3)
    plan = solve(Problem(dynamics, wave), np.array([0.3]), np.zeros((3, 1)))
    assert plan.converged
    assert plan.states[-1, 0] == pytest.approx(math.pi, abs=0.05)


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e200])
def test_what_is_not_finite_gives_no_plan(bad):
    flight, state = next(flights(1, seed=3))
    spoilt = state.copy()
    spoilt[1] = bad
    with pytest.raises(NoPlanError, match="finite"):
        solve(flight.problem(), spoilt, STILL)
    controls = STILL.copy()
    controls[3, 2] = bad
    with pytest.raises(NoPlanError, match="finite"):
        solve(flight.problem(), state, controls)
    with pytest.raises(NoPlanError, match="finite"):
        best_of_rollouts(flight.problem(), spoilt, STILL)


def test_shifted_controls_end_with_none():
    controls = np.arange(6.0).reshape(3, 2)
    np.testing.assert_array_equal(shifted(controls, 1), [[2, 3], [4, 5], [0, 0]])
    np.testing.assert_array_equal(shifted(controls, 0), controls)
    np.testing.assert_array_equal(shifted(controls, 9), np.zeros((3, 2)))
