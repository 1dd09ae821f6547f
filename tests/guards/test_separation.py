"""Separation from other vehicles: value, threshold, margin, and when nothing is known."""

from __future__ import annotations

import numpy as np
import pytest
from samples import calm

from missionkit.guards.separation import SeparationBelow
from missionkit.messages import OtherVehicle, TrafficReport


def other(position, velocity=(0.0, 0.0, 0.0), *, at=10.0, in_air=True, name="east", ended=False):
    report = TrafficReport(at, np.array(position), np.array(velocity), in_air)
    return OtherVehicle(name, report, ended)


def verdict(guard, *others, **changes):
    return guard.check(calm(traffic=others, **changes))


def test_it_measures_the_distance_in_three_dimensions():
    found = verdict(SeparationBelow(distance=6), other((3.0, 0.0, -9.0)))
    assert found.holds
    assert (found.value, found.threshold, found.margin) == pytest.approx((5.0, 6.0, 1.0))
    assert found.why == "east"
    assert verdict(SeparationBelow(distance=5), other((3.0, 0.0, -9.0))).holds is False


def test_the_nearest_vehicle_counts_or_the_one_that_is_named():
    near, far = other((4.0, 0.0, -5.0), name="near"), other((20.0, 0.0, -5.0), name="far")
    assert verdict(SeparationBelow(distance=5), far, near).why == "near"
    assert verdict(SeparationBelow(distance=5, vehicle="far"), far, near).value == 20.0


def test_a_report_is_moved_on_at_its_velocity_for_as_long_as_it_is_old():
    found = verdict(SeparationBelow(distance=6), other((12.0, 0.0, -5.0), (-4.0, 0, 0), at=9.5))
    assert found.value == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("velocity", "ahead", "least"),
    [
        ((-5.0, 0.0, 0.0), 10.0, 0.0),  # head on: they meet after 4 s
        ((-5.0, 0.0, 0.0), 2.0, 10.0),  # not within 2 s
        ((5.0, 0.0, 0.0), 10.0, 20.0),  # it flies away: now is nearest
        ((0.0, 0.0, 0.0), 10.0, 20.0),
        ((-3.0, 4.0, 0.0), 60.0, 16.0),  # passes by: 20 m · 4/5
    ],
)
def test_it_looks_ahead_to_the_closest_approach(velocity, ahead, least):
    guard = SeparationBelow(distance=6, ahead=ahead)
    assert verdict(guard, other((20.0, 0.0, -5.0), velocity)).value == pytest.approx(least)


def test_its_own_velocity_counts_as_much_as_the_others():
    guard = SeparationBelow(distance=6, ahead=10)
    found = verdict(guard, other((20.0, 0.0, -5.0)), velocity=np.array([3.0, 4.0, 0.0]))
    assert found.value == pytest.approx(16.0)


@pytest.mark.parametrize(
    ("others", "why"),
    [
        ((), "no other vehicle is known: fly it in a fleet"),
        ((OtherVehicle("east"),), "east has not been heard yet"),
        ((other((20.0, 0.0, -5.0), at=8.5),), "east has been silent for 1.5 s"),
        ((other((2.0, 0.0, 0.0), at=8.5, in_air=False),), "east has been silent for 1.5 s"),
    ],
)
def test_silence_is_unknown(others, why):
    found = verdict(SeparationBelow(distance=6), *others)
    assert found.holds is None
    assert found.why == why


def test_a_silent_vehicle_hides_no_other_that_is_too_near():
    near, silent = other((4.0, 0.0, -5.0), name="near"), OtherVehicle("silent")
    assert verdict(SeparationBelow(distance=5), near, silent).holds
    assert verdict(SeparationBelow(distance=5), silent, near).holds
    assert verdict(SeparationBelow(distance=3), near, silent).holds is None


def test_vehicles_on_the_ground_or_at_the_end_of_their_flight_do_not_count():
    standing = other((2.0, 0.0, 0.0), in_air=False)
    landed = other((2.0, 0.0, 0.0), at=1.0, in_air=False, ended=True)
    for one in (standing, landed):
        found = verdict(SeparationBelow(distance=6), one)
        assert found.holds is False
        assert found.value is None
