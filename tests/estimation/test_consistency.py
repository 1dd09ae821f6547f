"""Is the filter as good as it says? NEES over seeds, with noise that matches the model."""

from __future__ import annotations

import numpy as np
import pytest
from flights import MOUNT, QUIET, TICK, TRUNK, Flight, attitude, position, velocity
from scipy.stats import chi2

from missionkit.estimation.builder import build
from missionkit.geometry import conjugate, log, multiply

SEEDS = 25


def error_at_the_end(seed, *, vision):
    """Fly 15 s from a start at rest; return the error state (18,) and its covariance."""
    rng = np.random.default_rng(seed)
    flight = Flight(rng, accel_bias=QUIET.accel_bias_sd * rng.standard_normal(3))
    survey = TRUNK.translation + rng.standard_normal(3)
    navigator = build(QUIET, {"trunk": (survey, 1.0)}, MOUNT)
    memory = navigator.begin()
    for n in range(1, 300):
        memory = navigator.propagate(memory, flight.tick(n))
        if vision and n > 80:
            memory = navigator.fuse(memory, (flight.sighting(n * TICK - 0.08),))
    x, P, t = memory.past.xs[-1], memory.past.Ps[-1], 299 * TICK
    turn = log(multiply(conjugate(x[6:10]), attitude(t)))
    truth = [flight.accel_bias, flight.gyro_bias, TRUNK.translation]
    error = np.concatenate(
        [position(t) - x[:3], velocity(t) - x[3:6], turn, np.concatenate(truth) - x[10:19]]
    )
    return error, P


@pytest.mark.parametrize("vision", [False, True])
def test_nees_lies_in_the_95_percent_band(vision):
    """Σ eᵀ P⁻¹ e over the runs is χ² distributed with 15 degrees of freedom a run."""
    total = 0.0
    for seed in range(SEEDS):
        e, P = error_at_the_end(seed, vision=vision)
        total += float(e[:15] @ np.linalg.solve(P[:15, :15], e[:15]))
    low, high = chi2.ppf([0.025, 0.975], 15 * SEEDS)
    assert low < total < high


def test_the_target_is_known_to_centimetres_relative_to_the_vehicle():
    errors = []
    for seed in range(5):
        e, P = error_at_the_end(seed, vision=True)
        relative = e[15:18] - e[0:3]
        covariance = P[15:18, 15:18] + P[:3, :3] - P[:3, 15:18] - P[15:18, :3]
        errors.append(np.linalg.norm(relative))
        assert float(relative @ np.linalg.solve(covariance, relative)) < chi2.ppf(0.9999, 3)
    assert np.mean(errors) < 0.15
