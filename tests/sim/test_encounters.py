"""Encounters of two tracks by ground truth."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.sim.kernel_layout import TRACK_WIDTH
from missionkit.sim.separation import encounters, time_in_air


def track(position, until=20.0, landed=np.inf):
    """Rows of a vehicle whose position at t is given, on the ground from `landed` on."""
    times = np.arange(0.0, until + 0.01, 0.05)
    rows = np.zeros((len(times), TRACK_WIDTH))
    rows[:, 0] = times
    rows[:, 1:4] = [position(t) for t in times]
    rows[:, 14] = times >= landed
    return rows


def test_least_distance_its_time_and_the_conflicts():
    still = track(lambda _: (0.0, 0.0, -10.0))
    passing = track(lambda t: (2.0, 3.0 * (t - 8.0), -10.0))
    (met,) = encounters({"still": still, "passing": passing}, 5.0)
    assert (met.first, met.second) == ("still", "passing")
    assert met.least == pytest.approx(2.0)
    assert met.at == pytest.approx(8.0)
    assert met.conflicts == 1
    assert met.duration == pytest.approx(2 * np.sqrt(25 - 4) / 3, abs=0.1)


def test_each_approach_counts_and_time_on_the_ground_does_not():
    still = track(lambda _: (0.0, 0.0, -10.0))
    swinging = track(lambda t: (6.0 + 5.0 * np.cos(np.pi * t / 5.0), 0.0, -10.0))
    assert encounters({"a": still, "b": swinging}, 2.0)[0].conflicts == 2  # at 5 s and 15 s
    landed = track(lambda t: (6.0 + 5.0 * np.cos(np.pi * t / 5.0), 0.0, -10.0), landed=10.0)
    assert encounters({"a": still, "b": landed}, 2.0)[0].conflicts == 1
    assert time_in_air(landed) == pytest.approx(10.0, abs=0.06)


def test_the_shorter_track_bounds_the_comparison_and_apart_in_time_is_no_encounter():
    early = track(lambda _: (0.0, 0.0, -10.0), until=5.0)
    late = track(lambda t: (20.0 - t, 0.0, -10.0))
    assert encounters({"a": early, "b": late}, 2.0)[0].least == pytest.approx(15.0)
    down = track(lambda _: (0.0, 0.0, 0.0), landed=0.0)
    assert encounters({"a": early, "b": down}, 2.0) == ()
