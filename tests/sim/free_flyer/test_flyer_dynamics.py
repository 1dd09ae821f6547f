from __future__ import annotations

import math

import numpy as np
import pytest
from docking import PERFECT, Hand, perfect
from scipy.integrate import solve_ivp

from missionkit.geometry import exp, rotate, to_matrix
from missionkit.sim.free_flyer.flyer_dynamics import advance, derivative
from missionkit.sim.free_flyer.flyer_layout import Flyer, flyer_constants
from missionkit.sim.kernel_layout import DT

SKEW = flyer_constants(perfect())._replace(jx=0.0018, jy=0.0022, jz=0.0027)
INERTIA = np.array([SKEW.jx, SKEW.jy, SKEW.jz])
COAST = np.zeros(6)


def tumbling() -> np.ndarray:
    state = np.zeros(13)
    state[:3], state[3:6] = (0.3, -0.2, 0.1), (0.01, 0.02, -0.03)
    state[6:10], state[10:13] = exp(np.array([0.4, -0.3, 1.0])), (0.5, -0.4, 0.3)
    return state


def flown(wrench: np.ndarray, steps: int, body: Flyer = SKEW, dt: float = DT) -> np.ndarray:
    state, work = tumbling(), np.empty((5, 13))
    for _ in range(steps):
        advance(state, wrench, body, dt, work)
    return state


def test_it_agrees_with_scipy_and_is_of_fourth_order():
    wrench = np.array([0.08, -0.05, 0.1, 2e-4, -1e-4, 1.5e-4])

    def slope(_: float, x: np.ndarray) -> np.ndarray:
        """Return P3 (2) as it is printed, with matrices."""
        turn = to_matrix(x[6:10])
        spin = np.array([[0, -x[12], x[11]], [x[12], 0, -x[10]], [-x[11], x[10], 0]])
        rates = np.linalg.solve(np.diag(INERTIA), wrench[3:] - spin @ np.diag(INERTIA) @ x[10:13])
        half = 0.5 * np.concatenate(([0.0], x[10:13]))
        w, v = x[6], x[7:10]
        q = np.concatenate(([-v @ half[1:]], w * half[1:] + np.cross(v, half[1:])))
        return np.concatenate((x[3:6], turn @ wrench[:3] / SKEW.mass, q, rates))

    exact = solve_ivp(slope, (0.0, 10.0), tumbling(), rtol=1e-12, atol=1e-14).y[:, -1]
    assert np.abs(flown(wrench, 2000) - exact).max() < 1e-9
    coarse, fine = (float(np.linalg.norm(flown(wrench, n, dt=10.0 / n) - exact)) for n in (50, 100))
    assert math.log2(coarse / fine) == pytest.approx(4.0, abs=0.3)


def test_coasting_keeps_momentum_and_energy():
    before, after = tumbling(), flown(COAST, 20_000)  # 100 s
    turned = [rotate(x[6:10], INERTIA * x[10:13]) for x in (before, after)]
    assert turned[1] == pytest.approx(turned[0], abs=1e-12)
    energies = [float(INERTIA @ x[10:13] ** 2) for x in (before, after)]
    assert energies[1] == pytest.approx(energies[0], rel=1e-9)
    assert after[:3] == pytest.approx(before[:3] + 100.0 * before[3:6], abs=1e-9)


def test_a_symmetric_top_precesses_at_its_rate():
    body = SKEW._replace(jx=0.002, jy=0.002, jz=0.003)
    state = flown(COAST, 1000, body)
    rate = (0.003 - 0.002) / 0.002 * 0.3  # rad/s, of the rates about the body's z
    angle, cross = rate * 5.0, complex(0.5, -0.4)
    turned = cross * complex(math.cos(angle), math.sin(angle))
    assert state[10:13] == pytest.approx([turned.real, turned.imag, 0.3], abs=1e-10)


def test_constant_force_and_torque_have_closed_forms():
    hand = Hand(perfect())
    hand.arm()
    start = hand.flyer.truth
    hand.push((0.01, 0.0, 0.0), (0.0, 0.0, 0.0), 4.0)
    now = hand.flyer.truth
    assert now.velocity == pytest.approx([0.01 / 1.33 * 4.0, 0.0, 0.0], abs=1e-12)
    assert now.position - start.position == pytest.approx([0.01 / 1.33 * 8.0, 0, 0], abs=1e-10)
    assert hand.flyer.impulse == pytest.approx(0.04)
    hand.push((0.0, 0.0, 0.0), (0.0, 1e-4, 0.0), 4.0)
    now = hand.flyer.truth
    spin = 1e-4 / 0.0022
    assert now.rates == pytest.approx([0.0, spin * 4.0, 0.0], abs=1e-12)
    assert now.attitude == pytest.approx(exp(np.array([0.0, spin * 8.0, 0.0])), abs=1e-9)
    assert hand.flyer.impulse == pytest.approx(0.04)


def test_the_derivative_is_that_of_the_motion():
    wrench, out = np.array([0.02, 0.05, -0.1, 0.001, 0.002, -0.002]), np.empty(13)
    derivative(tumbling(), wrench, SKEW, out)
    assert out[:3] == pytest.approx(tumbling()[3:6])
    assert out[3:6] == pytest.approx(to_matrix(tumbling()[6:10]) @ wrench[:3] / SKEW.mass)


def test_the_radio_moves_as_the_paper_s_first_equation_says():
    """rho_ij'' = rho'' + w' x P + w x (w x P): against differences of the simulated place."""
    radio, dt = np.array([0.05, 0.05, 0.0]), 2.0**-8
    wrench = np.array([0.08, -0.05, 0.1, 0.002, -0.001, 0.0015])
    states = [flown(wrench, n, dt=dt) for n in range(60, 63)]
    places = [x[:3] + rotate(x[6:10], radio) for x in states]
    middle, out = states[1], np.empty(13)
    derivative(middle, wrench, SKEW, out)
    turn = to_matrix(middle[6:10])
    w, w_dot, arm = turn @ middle[10:13], turn @ out[10:13], turn @ radio
    said = out[3:6] + np.cross(w_dot, arm) + np.cross(w, np.cross(w, arm))
    seen = (places[2] - 2.0 * places[1] + places[0]) / dt**2
    assert seen == pytest.approx(said, abs=2e-6)
    assert np.linalg.norm(said - out[3:6]) > 0.05  # the lever arm matters


def test_ranges_are_taken_at_the_radio():
    hand = Hand(perfect(start={"position": (0.0, 1.0, 0.0), "attitude_deg": (20.0, -30.0, 50.0)}))
    hand.wait(0.2)
    truth = hand.flyer.truth
    radio = truth.pose.apply(np.array(PERFECT.uwb.radio))
    anchors = hand.flyer.world.anchors
    ranges = [it for seen in hand.seen for it in seen.ranges]
    assert [it.anchor for it in ranges[:5]] == ["a1", "a2", "a3", "a4", "a1"]
    assert [it.at for it in ranges] == pytest.approx([0.02 * n for n in range(1, 11)])
    for it in ranges:
        gap = float(np.linalg.norm(radio - np.array(anchors[it.anchor])))
        assert it.distance == pytest.approx(gap, abs=1e-12)
    samples = [it for seen in hand.seen for it in seen.imu]
    assert [it.at for it in samples] == pytest.approx([0.01 * n for n in range(1, 21)])
