"""Conflicts of many flights, each with its interval."""

from __future__ import annotations

import pytest

from missionkit.campaigns.fleet_statistics import fleet_statistics, poisson_rate
from missionkit.recorder.fleet_summary import EncounterSummary, FleetSummary, MemberSummary


def test_the_rate_has_the_exact_poisson_interval():
    # Garwood's table for 10 events: 4.795 to 18.390
    found = poisson_rate(10, 1.0)
    assert (found.value, found.low, found.high) == pytest.approx((10.0, 4.795, 18.390), abs=1e-3)
    none = poisson_rate(0, 2.0)
    assert (none.value, none.low) == (0.0, 0.0)
    assert none.high == pytest.approx(3.689 / 2.0, abs=1e-3)


def test_runs_conflicts_collisions_and_successes_are_counted():
    def run(conflicts, outcome="success", collisions=()):
        met = EncounterSummary(
            first="a", second="b", least=5.0 - conflicts, at=1.0, conflicts=conflicts, duration=0.0
        )
        members = tuple(
            MemberSummary(vehicle=name, mission="m", outcome=how, reason="")
            for name, how in (("a", "success"), ("b", outcome))
        )
        return FleetSummary(
            seed=0,
            vehicles=members,
            separation=2.0,
            measured_by="ground truth",
            encounters=(met,),
            collisions=collisions,
        )

    runs = [run(0), run(3), run(1, "crash", ((1.0, "a", "b"),)), run(0)]
    found = fleet_statistics(runs, 0.5)
    assert (found.runs, found.conflicts, found.least) == (4, 4, 2.0)
    assert found.in_conflict.value == 0.5
    assert found.rate.value == 8.0
    assert found.collided.value == 0.25
    assert {name: rate.value for name, rate in found.success.items()} == {"a": 1.0, "b": 0.75}
