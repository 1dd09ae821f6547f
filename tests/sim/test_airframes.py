from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from missionkit.errors import UsageError
from missionkit.sim.airframes import flown_with
from missionkit.sim.world import World

Make = Callable[..., Any]


def test_without_a_name_the_world_keeps_its_own() -> None:
    world = World(world="test")
    assert flown_with(world, "") is world


def test_an_unknown_name_is_reported_with_the_nearest() -> None:
    with pytest.raises(UsageError, match="did you mean 'sih'"):
        flown_with(World(world="test"), "sim")


def test_sih_leans_and_lags_as_px4s_own_simulation(perfect: World, pilot: Make) -> None:
    """Seen on the real one: it leans by 26 degrees at 4.7 m/s, and drifts on while it unlearns."""
    flight = pilot(flown_with(perfect, "sih"))
    flight.rise()
    flight.fly((5.0, 0.0, 0.0), 2.0)
    early = flight.vehicle.truth.velocity[0]
    flight.fly((5.0, 0.0, 0.0), 18.0)
    row = flight.vehicle.truth
    lean = np.degrees(2.0 * np.arcsin(np.hypot(row.attitude[1], row.attitude[2])))
    assert early < 4.0
    assert row.velocity[0] == pytest.approx(4.9, abs=0.3)
    assert lean == pytest.approx(27.0, abs=2.0)
    flight.fly((0.0, 0.0, 0.0), 1.0)
    assert flight.vehicle.truth.velocity[0] > 1.5


def test_sih_shakes_its_inertial_unit_only_while_rotors_turn(pilot: Make) -> None:
    flight = pilot(flown_with(World(world="test"), "sih"))
    flight.wait(1.0)
    still = np.array([sample.gyro for seen in flight.seen for sample in seen.imu]).std(axis=0)
    flight.rise()
    turning = np.array([sample.gyro for seen in flight.seen[-40:] for sample in seen.imu])
    assert still.max() < 0.012
    assert turning.std(axis=0).min() > 0.07
