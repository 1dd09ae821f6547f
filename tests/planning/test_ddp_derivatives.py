"""Gradients and Hessians of costs and penalties against central differences."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.planning.ddp.linear_dynamics import double_integrator
from missionkit.planning.ddp.penalties import KeepOut, NormLimit
from missionkit.planning.ddp.problem import CostExpansion, Policy, Trajectory
from missionkit.planning.ddp.quadratic_cost import QuadraticCost

N, EPS, WEIGHT = 5, 1e-5, 7.0
RNG = np.random.default_rng(0)
AT = Trajectory(RNG.normal(size=(N + 1, 6)), RNG.normal(size=(N, 3)))
SPEED = NormLimit("states", 3, 5, 0.4)
ACCELERATION = NormLimit("controls", 0, 2, 0.4)
NEAR = KeepOut(AT.states[None, :, :2] + 0.3 * RNG.normal(size=(3, N + 1, 2)), np.full(3, 0.9))
COST = QuadraticCost(
    RNG.normal(size=6), RNG.uniform(size=6), RNG.uniform(1, 2, 3), RNG.uniform(size=6), N
)


def nothing():
    return CostExpansion(
        np.zeros((N + 1, 6)),
        np.zeros((N, 3)),
        np.zeros((N + 1, 6, 6)),
        np.zeros((N, 3, 6)),
        np.zeros((N, 3, 3)),
    )


def penalised(penalty, at):
    expansion = nothing()
    penalty.add_to(expansion, at, WEIGHT)
    return expansion


def moved(at, part, place, by):
    arrays = [at.states.copy(), at.controls.copy()]
    arrays[part][place] += by
    return Trajectory(*arrays)


def differences(of, part, first):
    """Central differences of `of(trajectory)` by each number of one part, from row `first` on."""
    out = []
    for place in np.ndindex(AT[part].shape):
        if place[0] >= first:
            ahead, behind = (of(moved(AT, part, place, sign * EPS)) for sign in (1.0, -1.0))
            out.append((ahead - behind) / (2.0 * EPS))
    return np.array(out)


def diagonal_blocks(H, first):
    """(count n, count n) of (N, n, n) blocks, which are independent between steps."""
    blocks = H[first:]
    n = H.shape[1]
    out = np.zeros((len(blocks), n, len(blocks), n))
    for k, block in enumerate(blocks):
        out[k, :, k] = block
    return out.reshape(len(blocks) * n, -1)


@pytest.mark.parametrize("penalty", [SPEED, ACCELERATION, NEAR], ids=["speed", "push", "near"])
def test_gradients_of_penalties(penalty):
    found = penalised(penalty, AT)
    assert penalty.value(AT) > 0.0
    for part, gradient in enumerate((found.x, found.u)):
        first = 1 - part  # the first state is given
        by = differences(lambda at: WEIGHT * penalty.value(at), part, first)
        np.testing.assert_allclose(gradient[first:].ravel(), by, atol=1e-6)
    assert not found.x[0].any()


@pytest.mark.parametrize("penalty", [SPEED, ACCELERATION], ids=["speed", "push"])
def test_hessians_of_limits(penalty):
    found = penalised(penalty, AT)
    by_state = differences(lambda at: penalised(penalty, at).x[1:].ravel(), 0, 1)
    np.testing.assert_allclose(diagonal_blocks(found.xx, 1), by_state, atol=1e-6)
    by_control = differences(lambda at: penalised(penalty, at).u.ravel(), 1, 0)
    np.testing.assert_allclose(diagonal_blocks(found.uu, 0), by_control, atol=1e-6)


def test_the_hessian_of_a_keep_out_is_the_part_that_is_never_negative():
    found = penalised(NEAR, AT)
    for k in range(1, N + 1):
        exact = differences(lambda at, k=k: penalised(NEAR, at).x[k, :2], 0, k)[:2]
        both = np.linalg.eigvalsh(found.xx[k, :2, :2])
        assert both.min() >= -1e-9
        assert np.linalg.eigvalsh(found.xx[k, :2, :2] - exact).min() >= -1e-5


def test_gradients_and_hessians_of_the_cost():
    found = COST.expand(AT)
    np.testing.assert_allclose(found.x.ravel(), differences(COST.value, 0, 0), atol=1e-8)
    np.testing.assert_allclose(found.u.ravel(), differences(COST.value, 1, 0), atol=1e-8)
    by_state = differences(lambda at: COST.expand(at).x.ravel(), 0, 0)
    np.testing.assert_allclose(diagonal_blocks(found.xx, 0), by_state, atol=1e-8)


def test_derivatives_of_the_double_integrator():
    dynamics = double_integrator(1, 0.1)
    by_state, by_control, second = dynamics.derivatives(AT)
    still = Policy(np.zeros((1, 3)), np.zeros((1, 3, 6)))

    def next_state(state, control):
        at = Trajectory(np.vstack([state, state]), control[None])
        return dynamics.roll_out(at, still, 0.0).states[1]

    for i, unit in enumerate(np.eye(6)):
        np.testing.assert_allclose(next_state(unit, np.zeros(3)), by_state[0][:, i])
    for i, unit in enumerate(np.eye(3)):
        np.testing.assert_allclose(next_state(np.zeros(6), unit), by_control[0][:, i])
    assert not len(second)
