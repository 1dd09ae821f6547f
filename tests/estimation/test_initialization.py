"""Standing on the ground until attitude, biases and place are known."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from flights import FIELD, MOUNT, QUIET, TICK, Flight, attitude

from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf import initialization
from missionkit.geometry import conjugate, from_euler, log, multiply, rotate, vec

SPECIFIC = vec(0, 0, -9.80665)


def wait(flight, ticks=42, change=lambda o: o):
    navigator = build(QUIET, {"trunk": (vec(9, 1, -2), 0.7)}, MOUNT)
    memory = navigator.begin()
    for n in range(1, ticks + 1):
        memory = navigator.propagate(memory, change(flight.tick(n)))
    return navigator, memory


@pytest.mark.parametrize("angles", [(0, 0, 0), (0.1, -0.2, 2.0), (-0.3, 0.2, -3.0)])
def test_attitude_of_a_body_at_rest(angles):
    q = from_euler(*angles)
    found = initialization.attitude(
        rotate(conjugate(q), SPECIFIC), rotate(conjugate(q), FIELD), 0.0
    )
    np.testing.assert_allclose(log(multiply(conjugate(q), found)), 0, atol=1e-12)


def test_declination_turns_the_heading():
    found = initialization.attitude(SPECIFIC, FIELD, 0.1)
    np.testing.assert_allclose(found, from_euler(0, 0, 0.1), atol=1e-12)


def test_before_alignment_nothing_is_claimed():
    navigator, memory = wait(Flight(np.random.default_rng(0)), ticks=20)
    state = navigator.read(memory)
    assert not state.health.aligned
    np.testing.assert_array_equal(state.position, 0)
    np.testing.assert_array_equal(state.attitude, [1, 0, 0, 0])
    np.testing.assert_array_equal(state.targets["trunk"].position, [9, 1, -2])
    assert state.targets["trunk"].position_sd == 0.7
    assert state.targets["trunk"].seen_at is None
    assert navigator.pose_at(memory, 0.9) is None
    assert navigator.frames(memory).lookup("base", "camera", 5.0) is not None


def test_alignment_finds_biases_and_attitude_within_its_own_bounds():
    rng = np.random.default_rng(1)
    flight = Flight(rng, accel_bias=vec(0.08, -0.1, 0.12), gyro_bias=vec(0.004, -0.006, 0.002))
    navigator, memory = wait(flight)
    state = navigator.read(memory)
    assert state.health.aligned
    x, sd = memory.past.xs[-1], np.sqrt(state.covariance.diagonal())
    turn = log(multiply(conjugate(x[6:10]), attitude(42 * TICK)))
    error = np.concatenate(
        [-x[:6], turn, flight.accel_bias - x[10:13], flight.gyro_bias - x[13:16]]
    )
    assert np.all(np.abs(error) < 4 * sd)
    assert abs(error[11]) < 0.05  # the bias along gravity is found,
    assert np.all(sd[9:11] > 0.05)  # those across it are not
    assert np.all(sd[12:15] < 2e-3)


def test_tilt_and_accelerometer_bias_err_together():
    """A bias b_x that is taken for tilt pitches the attitude by b_x / g."""
    flight = Flight(np.random.default_rng(1), noise=0.0, accel_bias=vec(0.1, 0, 0))
    navigator, memory = wait(flight)
    P = navigator.read(memory).covariance
    x = memory.past.xs[-1]
    turn = log(multiply(conjugate(x[6:10]), attitude(0.0)))
    predicted = P[6:9, 9] / P[9, 9] * 0.1
    np.testing.assert_allclose(turn[:2], predicted[:2], atol=3e-4)


@pytest.mark.parametrize(
    "change",
    [
        lambda o: dataclasses.replace(o, mag=None),
        lambda o: dataclasses.replace(o, imu=tuple(s._replace(gyro=s.gyro + 0.2) for s in o.imu)),
        lambda o: dataclasses.replace(
            o, imu=tuple(s._replace(accel=s.accel * np.sin(9 * s.at)) for s in o.imu)
        ),
        lambda o: dataclasses.replace(o, imu=()),
    ],
    ids=["no field", "turning", "shaking", "no samples"],
)
def test_no_alignment_without_rest_and_field(change):
    navigator, memory = wait(Flight(np.random.default_rng(2)), 60, change)
    assert not navigator.read(memory).health.aligned


def test_without_a_fix_the_take_off_point_is_the_origin():
    navigator, memory = wait(
        Flight(np.random.default_rng(2)), 42, lambda o: dataclasses.replace(o, gnss=None)
    )
    state = navigator.read(memory)
    assert state.health.aligned
    assert not state.health.placed
    assert state.health.gnss_at is None
    assert state.health.position_sd == pytest.approx(QUIET.origin_sd, rel=0.05)
