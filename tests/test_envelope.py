"""The worst flights of docs/studies/envelope.md, each of which once hit something."""

from __future__ import annotations

import numpy as np
from rehearsed import flown, precise_stage

from missionkit.sim.world import Wind

STRONG = Wind(mean=(7.0, 0.0, 0.0), gust=2.0)


def clearance(flight) -> float:
    """Return the least distance (m) of the vehicle's surface from an obstacle, by the truth."""
    return flight.result.grade.clearance


def test_a_speed_that_cannot_be_stopped_from_is_not_flown():
    flight = flown(precise_stage(cruise=8.0, seed=100))
    speeds = np.hypot(*flight.ready.vehicle.track.rows[:, 4:6].T)
    assert flight.result.succeeded
    assert clearance(flight) > 0.2
    assert speeds.max() < 6.0


def test_wind_does_not_carry_it_into_what_it_waits_before():
    """It waits for a marker that it cannot hold in view."""
    flight = flown(precise_stage(cruise=5.0, seed=102, wind=STRONG, limit=100.0))
    assert "waiting for trunk" in {record.step_note for record in flight.records}
    assert flight.result.grade.landed
    assert clearance(flight) > 0.1


def test_a_gust_at_work_does_not_push_it_in():
    flight = flown(precise_stage("wind_gust=8@task:1+3", seed=2))
    assert flight.result.succeeded
    assert clearance(flight) > 0.15
