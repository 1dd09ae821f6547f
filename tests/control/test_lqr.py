"""The free flyer's controller: against closed forms, the Riccati recursion and a flight."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from samples import calm
from scipy.integrate import solve_ivp

from missionkit.control import lqr_gains, quaternion_feedback
from missionkit.control.lqr import Lqr, LqrMemory, Reference
from missionkit.control.reference_motion import stepped
from missionkit.geometry import (
    IDENTITY,
    conjugate,
    exp,
    log,
    multiply,
    norm,
    normalised,
    rotate,
    vec,
)
from missionkit.messages import Guidance, Mode

DT = 0.05
HERE = np.zeros(3)


def to(place, speed=0.05, **more):
    return Guidance(np.array(place, dtype=float), speed, **more)


class Body:
    """A rigid body in free space under a wrench in body axes, by Runge and Kutta's method."""

    def __init__(self, law, position=HERE, attitude=IDENTITY, rates=HERE, disturbance=HERE):
        self.law, self.disturbance = law, np.asarray(disturbance)
        self.y = np.concatenate((position, HERE, attitude, rates)).astype(float)
        self.memory, self.wrenches, self.track, self.now = law.begin(), [], [], 0.0

    def seen(self):
        y = self.y
        return calm(
            now=self.now, position=y[0:3], velocity=y[3:6], attitude=y[6:10], rates=y[10:13]
        )

    def rate_of(self, _, y, wrench):
        inertia = np.array(self.law.inertia)
        q, w = normalised(y[6:10]), y[10:13]
        force = rotate(q, wrench.force) + self.disturbance
        spin = (wrench.torque - np.cross(w, inertia * w)) / inertia
        turning = 0.5 * multiply(y[6:10], np.array([0.0, *w]))
        return np.concatenate((y[3:6], force / self.law.mass, turning, spin))

    def later(self, wrench):
        y, h = self.y, DT
        k1 = self.rate_of(0, y, wrench)
        k2 = self.rate_of(0, y + 0.5 * h * k1, wrench)
        k3 = self.rate_of(0, y + 0.5 * h * k2, wrench)
        k4 = self.rate_of(0, y + h * k3, wrench)
        return y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)

    def fly(self, guidance, seconds):
        for _ in range(round(seconds / DT)):
            wrench, self.memory = self.law.step(self.memory, Mode.GPS, guidance, self.seen(), DT)
            self.wrenches.append(wrench)
            self.y = self.later(wrench)
            self.y[6:10] = normalised(self.y[6:10])
            self.now += DT
            self.track.append(self.y.copy())
        return self


def turned_by(q, to_q):
    return norm(log(multiply(to_q, conjugate(q))))


@pytest.mark.parametrize("period", [0.02, 0.05, 0.2])
@pytest.mark.parametrize("integral", [0.0, 0.05])
def test_gains_are_those_of_the_riccati_recursion(period, integral):
    law = Lqr(period=period, integral_weight=integral, attitude_gain=0.002, rate_gain=0.004)
    A, B = lqr_gains.plant(law.mass, period)
    n = 3 if integral else 2
    A, B, Q, R = A[:n, :n], B[:n], np.diag([1.0, 1.0, integral][:n]), law.effort_weight
    X = Q.copy()
    for _ in range(6000):
        K = np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A)
        X = Q + A.T @ X @ (A - B @ K)
    np.testing.assert_allclose(law.gains[:n], K[0], rtol=1e-6)
    assert law.gains[2] == pytest.approx(0.0) if n == 2 else law.gains[2] > 0.0


@pytest.mark.parametrize("effort", [1e-4, 0.03, 100.0])
@pytest.mark.parametrize("mass", [0.1, 1.33, 50.0])
def test_poles_lie_inside_the_unit_circle(mass, effort):
    assert Lqr(mass=mass, effort_weight=effort).spectral_radius < 1.0


def test_short_periods_tend_to_the_gains_of_continuous_time():
    law = Lqr(period=1e-4, integral_weight=0.0, velocity_weight=0.0, effort_weight=0.03, mass=1.33)
    k = math.sqrt(1.0 / 0.03)  # double integrator with Q = diag(1, 0): sqrt(q/R), sqrt(2 m k)
    np.testing.assert_allclose(law.gains, [k, math.sqrt(2.0 * 1.33 * k), 0.0], rtol=1e-3)


def test_it_flies_to_the_goal_and_stays():
    body = Body(Lqr()).fly(to((0.3, -0.2, 0.1)), 40)
    np.testing.assert_allclose(body.y[0:3], [0.3, -0.2, 0.1], atol=1e-3)
    assert norm(body.y[3:6]) < 1e-3


def test_it_keeps_the_speed_and_follows_without_lag():
    body = Body(Lqr()).fly(to((1.0, 0.0, 0.0), speed=0.0139), 30)
    speeds = np.linalg.norm(np.array(body.track)[:, 3:6], axis=1)
    assert speeds.max() < 0.0139 * 1.05
    assert body.y[0] == pytest.approx(body.memory.reference.position[0], abs=1e-4)


def test_a_moving_goal_is_followed_at_its_velocity():
    body, drift = Body(Lqr()), vec(0.02, 0.0, 0.0)
    for n in range(600):
        body.fly(to((0.1 + 0.02 * DT * (n + 1), 0.0, 0.0), velocity=drift), DT)
    assert body.y[0] == pytest.approx(0.1 + 0.02 * body.now, abs=2e-3)
    np.testing.assert_allclose(body.y[3:6], drift, atol=5e-4)


@pytest.mark.parametrize("integral", [0.0, 0.05])
def test_only_the_integral_takes_a_constant_push_away(integral):
    law = Lqr(integral_weight=integral)
    push = np.array([0.02, -0.01, 0.005])
    body = Body(law, disturbance=push).fly(to(HERE), 80)
    left = np.abs(body.y[0:3])
    if integral:
        assert left.max() < 1e-5
    else:
        np.testing.assert_allclose(left, np.abs(push) / law.gains[0], rtol=1e-3)


def test_the_integral_does_not_wind_up_while_the_force_is_at_its_limit():
    """Pushed away by more than it can hold for 20 s, it comes back without swinging far past."""
    law = Lqr(integral_weight=0.05)
    body = Body(law, disturbance=(0.15, 0.0, 0.0)).fly(to(HERE), 20)
    assert body.y[0] > 3.0
    assert abs(body.memory.integral[0]) <= law.max_force / law.gains[2]
    wound = body.memory.integral[0]
    body.fly(to(HERE), 5)
    assert body.memory.integral[0] == wound
    body.disturbance = np.zeros(3)
    body.y[0:6] = [0.2, 0.0, 0.0, 0.0, 0.0, 0.0]
    body.fly(to(HERE), 60)
    assert np.array(body.track)[-1200:, 0].min() > -0.1
    assert abs(body.y[0]) < 1e-3


@pytest.mark.parametrize(("before", "after"), [(0.2, 0.2), (0.0, 0.0), (-0.2, -0.05)])
def test_at_the_limit_of_the_force_the_integral_changes_towards_zero_only(before, after):
    law, off = Lqr(), vec(3.0, 0.0, 0.0)
    reference = Reference(HERE, HERE, IDENTITY, HERE)
    memory = LqrMemory(reference, (before, 0.0, 0.0))
    _, memory = law.step(memory, Mode.GPS, to(HERE), calm(position=off, velocity=HERE), DT)
    assert memory.integral == pytest.approx((after, 0.0, 0.0))


def test_without_guidance_the_force_is_against_the_motion_however_it_is_turned():
    law, velocity = Lqr(), vec(0.005, -0.01, 0.007)
    attitude = exp(vec(0.4, 1.0, -2.0))
    seen = calm(velocity=velocity, attitude=attitude, rates=HERE)
    wrench, memory = law.step(LqrMemory(), Mode.GPS, None, seen, DT)
    np.testing.assert_allclose(rotate(attitude, wrench.force), -law.gains[1] * velocity)
    assert memory == law.begin()


def test_force_and_torque_keep_their_limits_and_the_direction():
    law = Lqr()
    body = Body(law, position=(2.0, -1.0, 0.5), attitude=exp(vec(0.4, 1.0, -2.0)))
    body.memory = LqrMemory()
    body.fly(to(HERE), DT)
    body.y[0:3] = [5.0, 2.5, 0.0]  # carried away: far from its reference
    body.fly(to((2.0, -1.0, 0.5)), DT)
    wrench = body.wrenches[-1]
    assert np.abs(wrench.force).max() == pytest.approx(law.max_force)
    pull = rotate(body.track[-2][6:10], wrench.force)
    wanted = -np.array([3.0, 3.5, -0.5])
    assert pull @ wanted > 0.99 * norm(pull) * norm(wanted)
    assert np.abs(wrench.torque).max() <= law.max_torque


@pytest.mark.parametrize("axis", [(1, 0, 0), (0.6, 0.0, 0.8)])
def test_it_turns_by_180_degrees_from_rest_to_rest(axis):
    goal = exp(math.pi * np.array(axis, dtype=float))
    body = Body(Lqr(), attitude=IDENTITY).fly(to(HERE, attitude=goal), 60)
    assert turned_by(body.y[6:10], goal) < 1e-3
    assert norm(body.y[10:13]) < 1e-4
    rates = np.linalg.norm(np.array(body.track)[:, 10:13], axis=1)
    assert math.degrees(rates.max()) < 4.0 * 1.05
    assert max(np.abs(w.torque).max() for w in body.wrenches) <= 0.002
    assert np.abs(body.y[0:3]).max() < 1e-6


def test_it_brakes_a_fast_tumble_within_its_limits_and_turns_back():
    law = Lqr(inertia=(0.002, 0.0025, 0.003))
    body = Body(law, rates=(1.0, -0.7, 0.4)).fly(to(HERE, attitude=IDENTITY), 80)
    assert turned_by(body.y[6:10], IDENTITY) < 1e-3
    assert max(np.abs(w.torque).max() for w in body.wrenches) <= law.max_torque


def test_the_body_of_these_tests_moves_as_scipy_says():
    body = Body(Lqr(), position=(1.0, 0.0, 0.0), rates=(0.5, -0.3, 0.2))
    body.y[3:6] = [0.02, 0.0, -0.01]
    for _ in range(40):
        before = body.y.copy()
        body.fly(to(HERE, attitude=exp(vec(0.0, 1.0, 0.0))), DT)
        args = (body.wrenches[-1],)
        end = solve_ivp(body.rate_of, (0, DT), before, args=args, rtol=1e-10, atol=1e-12).y[:, -1]
        np.testing.assert_allclose(body.y, end, atol=1e-8)


def test_without_guidance_it_comes_to_rest_where_that_is():
    body = Body(Lqr(), rates=(0.3, 0.05, -0.2))
    body.y[3:6] = [0.05, -0.03, 0.0]
    body.fly(None, 40)
    assert np.abs(body.wrenches[0].torque).max() == pytest.approx(0.002)
    assert norm(body.y[3:6]) < 1e-4
    assert norm(body.y[10:13]) < 1e-4
    assert body.memory == LqrMemory()


def test_no_thrust_while_the_vehicle_flies_by_itself():
    wrench, memory = Lqr().step(LqrMemory(), Mode.NONE, to((1, 0, 0)), calm(), DT)
    assert not wrench.force.any()
    assert not wrench.torque.any()
    assert memory == LqrMemory()


BAD = (math.nan, math.inf, -math.inf)


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("part", ["position", "velocity", "attitude", "rates"])
def test_an_estimate_that_is_not_finite_gives_no_thrust(part, bad):
    value = np.array([1.0, 0.0, 0.0, 0.0][: 4 if part == "attitude" else 3])
    value[1] = bad
    wrench, _ = Lqr().step(LqrMemory(), Mode.GPS, to((1, 0, 0)), calm(**{part: value}), DT)
    assert not wrench.force.any()
    assert not wrench.torque.any()


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("part", ["position", "velocity", "attitude", "speed"])
def test_guidance_that_is_not_finite_counts_as_missing(part, bad):
    value = np.full(4 if part == "attitude" else 3, bad)
    guidance = to((1, 0, 0))._replace(**{part: bad if part == "speed" else value})
    seen = calm(velocity=vec(0.01, 0.0, 0.0), rates=vec(0.0, 0.01, 0.0))
    wrench, memory = Lqr().step(LqrMemory(), Mode.GPS, guidance, seen, DT)
    still, _ = Lqr().step(LqrMemory(), Mode.GPS, None, seen, DT)
    np.testing.assert_array_equal(wrench, still)
    assert memory == LqrMemory()


@pytest.mark.parametrize("dt", [0.0, -1.0, math.nan, 1e-9, 1e9])
def test_a_strange_step_of_time_gives_a_wrench_within_limits(dt):
    law, memory = Lqr(), LqrMemory()
    for _ in range(3):
        wrench, memory = law.step(memory, Mode.GPS, to((1, 2, 3)), calm(), dt)
        assert np.abs(wrench.force).max() <= law.max_force
        assert np.abs(wrench.torque).max() <= law.max_torque


@pytest.mark.parametrize(
    ("gains", "says"),
    [
        ({"rate_gain": 0.2}, "unstable with an inertia"),
        ({"attitude_gain": 30.0}, "unstable with an inertia"),
        ({"rate_gain": 0.0}, "above 0"),
        ({"attitude_gain": -0.02}, "above 0"),
    ],
)
def test_attitude_gains_that_do_not_come_to_rest_are_refused(gains, says):
    with pytest.raises(ValidationError, match=says):
        Lqr(**gains)


def test_the_stability_condition_is_that_of_a_simulated_axis():
    """Angle and rate of an axis over 4000 periods fall exactly where the condition says so."""
    rng = np.random.default_rng(1)
    decided = 0
    for _ in range(100):
        k, d = 10.0 ** rng.uniform(-3, 1), 10.0 ** rng.uniform(-3, 0)
        M = quaternion_feedback.sampled(0.0022, k, d, DT)
        radius = np.abs(np.linalg.eigvals(M)).max()
        if abs(radius - 1.0) < 0.01:
            continue
        angle, rate = 0.01, 0.0
        for _ in range(4000):
            accel = (-0.5 * k * angle - d * rate) / 0.0022
            angle, rate = angle + DT * rate + 0.5 * DT * DT * accel, rate + DT * accel
            if abs(angle) > 1e6:
                break
        fell = abs(angle) < 0.01
        assert fell == (not quaternion_feedback.instability(0.0022, k, d, DT))
        decided += 1
    assert decided > 70


@pytest.mark.parametrize("dt", [0.02, 0.05])
@pytest.mark.parametrize("away", [1e-6, 0.003, 0.5, 2.0])
def test_a_reference_arrives_without_overshoot(away, dt):
    place, velocity, goal = HERE, HERE, np.array([away, 0.0, 0.0])
    for _ in range(round((away / 0.05 + 20) / dt)):
        new = stepped(goal - place, velocity, 0.05, 0.01, dt)
        assert norm(new - velocity) <= 0.01 * dt * (1 + 1e-9)
        velocity, place = new, place + dt * new
        assert norm(velocity) <= 0.05 * (1 + 1e-9)
        assert place[0] <= away * (1.0 + 1e-6) + 1e-6
    np.testing.assert_allclose(place, goal, atol=1e-6)


@pytest.mark.parametrize("away", [1e-6, 1e-5])
def test_a_reference_one_step_from_its_goal_arrives_and_goes_no_further(away):
    offset = np.array([0.6, 0.0, -0.8]) * away
    np.testing.assert_allclose(DT * stepped(offset, HERE, 0.05, 0.01, DT), offset)
