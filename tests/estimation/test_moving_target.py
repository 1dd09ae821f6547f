"""A target that moves, followed through its sightings."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.estimation.error_state_ekf.moving_target import (
    FORGOTTEN,
    STRAY,
    sighted,
    target_of,
)
from missionkit.geometry import vec

GATE, ACCEL, FASTEST, PERIOD, SD = 21.1, 0.3, 2.0, 0.05, 0.02


def followed(seconds, velocity=(0.8, -0.6, 0.0), start=0.0, motion=None, seed=0, sd=SD):
    rng = np.random.default_rng(seed)
    for count in range(round(seconds / PERIOD)):
        at = start + count * PERIOD
        place = vec(5.0, 1.0, -0.5) + at * np.array(velocity) + sd * rng.standard_normal(3)
        motion = sighted(motion, at, place, sd, GATE, ACCEL, FASTEST)
    return motion


def test_place_and_velocity_are_those_of_the_truth_and_reach_ahead():
    target = target_of("deck", followed(4.0), 4.4, ACCEL)
    assert target.velocity == pytest.approx((0.8, -0.6, 0.0), abs=0.12)
    assert target.position == pytest.approx(
        vec(5.0, 1.0, -0.5) + 4.4 * vec(0.8, -0.6, 0.0), abs=0.1
    )
    assert target.seen_at == pytest.approx(3.95)


def test_what_it_says_of_its_error_fits_the_error():
    """Normalised squared errors (3 axes) over 60 runs: chi-square of 180 degrees of freedom."""
    total = 0.0
    for seed in range(60):
        target = target_of("deck", followed(3.0, seed=seed, sd=0.05), 2.95, ACCEL)
        off = target.position - (vec(5.0, 1.0, -0.5) + 2.95 * vec(0.8, -0.6, 0.0))
        total += float(off @ off) / target.position_sd**2
    assert total / 180.0 < 1.3


def test_a_decoy_is_refused_until_it_lasts():
    motion = followed(3.0)
    decoy = vec(9.0, 9.0, -0.5)
    for count in range(STRAY):
        motion = sighted(motion, 3.0 + count * PERIOD, decoy, SD, GATE, ACCEL, FASTEST)
        assert np.linalg.norm(motion.position - decoy) > 3.0
    motion = sighted(motion, 3.0 + STRAY * PERIOD, decoy, SD, GATE, ACCEL, FASTEST)
    assert motion.position == pytest.approx(decoy)


def test_after_a_long_time_out_of_sight_it_begins_again():
    there = vec(30.0, 0.0, -0.5)
    motion = sighted(followed(3.0), 3.0 + FORGOTTEN + 0.1, there, SD, GATE, ACCEL, FASTEST)
    assert motion.position == pytest.approx(there)
    assert motion.velocity == pytest.approx(np.zeros(3))


def test_it_is_never_faster_than_it_may_be():
    motion = followed(3.0, velocity=(4.0, 0.0, 0.0))
    assert np.linalg.norm(motion.velocity) <= FASTEST + 1e-9
