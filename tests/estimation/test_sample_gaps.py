"""Gaps in the inertial samples: short ones are integrated across, after long ones it aligns again.

What the vehicle does during and after the gap is that of a hovering autopilot, or a moving one.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from flights import MOUNT, TICK, Flight, attitude, position, velocity
from hovering import HERE, QUIET, observed

from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf import initialization, realignment
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.state_layout import D_LANDMARKS, LANDMARKS
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.geometry import GRAVITY, conjugate, log, multiply, norm

SETTINGS = VisualInertialEkf(fix_drift_sd=0.0, mag_sd=0.05)
KILLED = 8.0  # s, in the middle of a turn


def frozen(observation, now, moment):
    """Return an old observation, as if it were measured now."""
    shift = now - moment
    imu = tuple(s._replace(at=s.at + shift) for s in observation.imu)
    parts = {n: getattr(observation, n) for n in ("gnss", "baro", "mag")}
    moved = {n: None if p is None else p._replace(at=p.at + shift) for n, p in parts.items()}
    return dataclasses.replace(observation, now=now, imu=imu, **moved)


def across(gap, seed, *, fixes=True, length=8.0):
    """Fly to `KILLED`, then hear nothing for `gap` (s), then stand at rest at the start again."""
    nav = build(SETTINGS, {}, MOUNT)
    flight = Flight(np.random.default_rng(seed), SETTINGS)
    memory = nav.begin()
    for n in range(1, round(KILLED / TICK) + 1):
        memory = nav.propagate(memory, flight.tick(n))
    states, at = [], round((KILLED + gap) / TICK)
    for k in range(round(length / TICK)):
        rest = 1 + k % 50
        seen = frozen(flight.tick(rest), (at + k) * TICK, rest * TICK)
        memory = nav.propagate(memory, seen if fixes else dataclasses.replace(seen, gnss=None))
        states.append(nav.read(memory))
    return states


@pytest.mark.parametrize("gap", [1.0, 5.0, 20.0, 39.0, 120.0])
@pytest.mark.parametrize("seed", [0, 1])
def test_after_a_long_gap_it_has_diverged_until_it_is_aligned_again_and_then_is_right(gap, seed):
    states = across(gap, seed)
    assert states[0].health.diverged
    assert states[0].health.cause == f"no inertial samples for {gap:.1f} s: aligning again"
    sound = [s for s in states if not s.health.diverged]
    assert len(sound) > len(states) / 2
    for state in sound:
        sds = np.sqrt(np.diag(state.covariance))
        off = np.concatenate(
            [
                state.position - position(0.0),
                state.velocity,
                log(multiply(conjugate(attitude(0.0)), state.attitude)),
            ]
        )
        assert (np.abs(off) < 4.5 * sds[:9] + 0.01).all()
    assert norm(states[-1].velocity) < 0.2


def test_without_fixes_it_stays_lost():
    assert all(state.health.diverged for state in across(39.0, 0, fixes=False))


def test_without_fixes_the_place_is_as_uncertain_as_the_speed_before_the_gap_makes_it():
    missing, speed = 4.0, np.array([3.0, -2.0, 0.5])
    times = np.arange(101.0)[:, None] / 100.0
    imu = np.hstack((times, np.tile([0.0, 0.0, -GRAVITY, 0.0, 0.0, 0.0], (101, 1))))
    rest = initialization.begin()._replace(imu=imu, fields=np.array([[1.0, 1.0, 0.0, 0.0]]))
    x, P = np.zeros(LANDMARKS), np.diag(np.full(D_LANDMARKS, 0.04))
    x[3:6], x[6] = speed, 1.0
    start = realignment.begun(rest, x, P, missing, SETTINGS)
    expected = 0.04 + (SETTINGS.reset_velocity_sd * missing) ** 2 + (missing * speed) ** 2
    np.testing.assert_allclose(start.P.diagonal()[:3], expected)
    np.testing.assert_array_equal(start.x[:6], 0.0)


@pytest.mark.parametrize("gap", [0.2, 0.4])
def test_a_short_gap_is_integrated_across(gap):
    nav = build(SETTINGS, {}, MOUNT)
    flight = Flight(np.random.default_rng(0), SETTINGS)
    memory = nav.begin()
    for n in range(1, round(12.0 / TICK) + 1):
        if KILLED < n * TICK <= KILLED + gap:
            continue
        memory = nav.propagate(memory, flight.tick(n))
        assert not nav.read(memory).health.diverged
    state = nav.read(memory)
    assert state.health.resets == 0
    assert norm(state.velocity - velocity(12.0)) < 0.4


@pytest.mark.parametrize(("gap", "diverged"), [(1.0, False), (39.0, True)])
def test_dead_reckoning_by_flow_reports_its_uncertainty_after_a_gap(gap, diverged):
    navigator = build(FlowKalman(), {}, HERE)
    known = navigator.begin()
    for seen, _ in observed(20.0, QUIET, 1):
        known = navigator.propagate(known, seen)
    moment = seen.now + TICK
    before = navigator.read(known)
    samples = tuple(s._replace(at=s.at + TICK + gap) for s in seen.imu)
    known = navigator.propagate(known, dataclasses.replace(seen, now=moment + gap, imu=samples))
    after = navigator.read(known)
    assert after.health.position_sd > 4.0 * gap
    assert after.health.diverged is diverged
    assert norm(after.position - before.position) < 1.0
