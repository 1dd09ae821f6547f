"""The study of the precision landing, a few of its flights end to end."""

from __future__ import annotations

import re

import pytest

from studies import precision_landing
from studies.precision_landing_flight import CASES, Order, flown, fly_all


@pytest.fixture(scope="module")
def runs():
    return list(fly_all(precision_landing.orders([3], "corners"), workers=1))


def test_the_page_says_what_the_flights_gave(runs, tmp_path):
    poor = list(fly_all(precision_landing.poor_orders([5], "corners")[:2], workers=1))
    precision_landing.write(runs, poor, tmp_path, "a command")
    page = (tmp_path / "precision_landing.md").read_text()
    assert precision_landing.verdict(runs) in page
    assert f"{len(runs)} flights: every rule" in page
    assert not re.search(r"\$[a-z]", page)
    guarded, unguarded = poor
    assert "deviate" in guarded.states
    assert "deviate" not in unguarded.states
    assert guarded.succeeded
    assert guarded.duration < 0.5 * unguarded.duration  # the other waits where the pad is not
    assert (tmp_path / "precision_landing.png").read_bytes().startswith(b"\x89PNG")


def test_every_rule_comes_down_and_only_the_blind_one_misses(runs):
    for run in runs:
        assert run.states[-1] == "land"
        assert run.touched < 1.0
        assert run.seen is (run.order.rule != "blind")
        assert run.order.rule == "blind" or run.missed < 0.2


def test_less_energy_than_a_fixed_switch(runs):
    ours = precision_landing.chosen(runs, "ours")
    assert precision_landing.gain(precision_landing.chosen(runs, "conservative"), ours).value < -40
    assert precision_landing.gain(precision_landing.chosen(runs, "brisk"), ours).value < -20


def test_without_a_camera_it_does_not_drift_away_near_the_ground():
    """Optical flow is blind below 0.3 m: who hovers there flies off without noticing."""
    run = flown(Order("blind", CASES[0], 0.0, 1001, "corners"))
    assert run.missed < 1.5
    assert run.duration < 8.0
