"""How far measurements lie from what the filter expects."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from flights import MOUNT, TICK, Flight
from hovering import HERE, QUIET, observed, through
from hypothesis import given
from hypothesis import strategies as st

from missionkit.estimation import mahalanobis
from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.mahalanobis import MeanDistance
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.geometry import vec

CONSISTENT = VisualInertialEkf(fix_drift_sd=0.0, mag_sd=0.05)


def distance_after(seconds, change=lambda seen: seen, since=math.inf):
    navigator = build(CONSISTENT, {}, MOUNT)
    flight, known = Flight(np.random.default_rng(3), CONSISTENT), navigator.begin()
    for n in range(1, round(seconds / TICK) + 1):
        seen = flight.tick(n)
        known = navigator.propagate(known, change(seen) if n * TICK > since else seen)
    return navigator.read(known).health.mahalanobis


def outlying(seen):
    if seen.gnss is None:
        return seen
    return dataclasses.replace(
        seen, gnss=seen.gnss._replace(position=seen.gnss.position + vec(30.0, 0.0, 0.0))
    )


def without_fixes(seen):
    return dataclasses.replace(seen, gnss=None)


def test_it_is_about_one_while_the_noise_is_right():
    assert 0.4 < distance_after(12.0) < 1.6


def test_measurements_that_are_rejected_count():
    assert distance_after(12.0, outlying, since=9.0) > 3.0


def test_it_is_not_known_before_the_first_measurement_and_long_after_the_last():
    assert distance_after(0.5) is None
    assert distance_after(14.0, without_fixes, since=9.0) is None


def test_the_flow_navigator_reports_it_too():
    navigator = build(FlowKalman(), {}, HERE)
    known, _ = through(navigator, list(observed(20.0, QUIET, 1, still=False)))
    assert 0.0 < navigator.read(known).health.mahalanobis < 1.6
    assert navigator.read(navigator.begin()).health.mahalanobis is None


@given(st.lists(st.floats(0.0, 50.0), min_size=1, max_size=20))
def test_the_mean_lies_between_the_distances_and_follows_the_newest(distances):
    known = MeanDistance()
    for n, each in enumerate(distances):
        known = mahalanobis.averaged(known, [each], 0.05 * n)
    assert min(distances) - 1e-9 <= known.mean <= max(distances) + 1e-9
    later = mahalanobis.averaged(known, [7.0], known.at + 60.0)
    assert later.mean == pytest.approx(7.0)
    assert mahalanobis.current(later, later.at + 3.1) is None


def test_what_is_not_a_number_is_far_away():
    assert mahalanobis.distance(math.inf, 3) == mahalanobis.LARGEST_COUNTED
    assert mahalanobis.distance(math.nan, 3) == mahalanobis.LARGEST_COUNTED
    assert mahalanobis.distance(12.0, 3) == pytest.approx(2.0)
