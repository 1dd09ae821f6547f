from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from missionkit.geometry import from_euler, rotate, vec
from missionkit.messages import Action
from missionkit.sim.flight_grading import grade, true_goal
from missionkit.sim.kernel_layout import TRACK_WIDTH
from missionkit.sim.world import Marker, World

MARKER = Marker(dictionary="DICT_4X4_50", id=3, size=0.4, position=(10.0, 2.0, -2.5))
Make = Callable[..., Any]


class Wanted(NamedTuple):
    standoff: tuple[float, float, float] = (1.2, 0.0, 0.0)
    position: float = 0.1
    yaw_deg: float = 5.0
    turn_deg: float = 0.0


def track(*positions: tuple[float, float, float], yaw: float = 0.0) -> np.ndarray:
    """One second apart, flying, then landed in place."""
    rows = np.zeros((len(positions) + 1, TRACK_WIDTH))
    rows[:, 0] = np.arange(len(rows))
    rows[:-1, 1:4], rows[-1, 1:4] = positions, positions[-1]
    rows[:, 7:11] = from_euler(0.0, 0.0, yaw)
    rows[-1, 14], rows[:-1, 15] = 1.0, 1.0
    rows[:, 19], rows[:, 20] = 3.0, np.arange(len(rows)) * 50.0
    return rows


@pytest.mark.parametrize(
    ("facing", "standoff", "position", "yaw_deg"),
    [
        (180.0, (1.2, 0.0, 0.0), (8.8, 2.0, -2.5), 0.0),
        (180.0, (1.0, 0.5, 0.3), (9.0, 2.5, -2.8), 0.0),
        (270.0, (2.0, 0.0, 0.0), (10.0, 0.0, -2.5), 90.0),
        (0.0, (1.0, 0.5, 0.0), (11.0, 1.5, -2.5), 180.0),
    ],
)
def test_goal_stands_off_and_faces_the_marker(
    facing: float,
    standoff: tuple[float, float, float],
    position: tuple[float, float, float],
    yaw_deg: float,
) -> None:
    marker = MARKER.model_copy(update={"facing_deg": facing})
    goal = true_goal(marker, standoff)
    ahead = rotate(goal.rotation, vec(1.0, 0.0, 0.0))
    yaw = math.radians(yaw_deg)
    assert goal.translation == pytest.approx(position)
    assert ahead == pytest.approx([math.cos(yaw), math.sin(yaw), 0.0])


def test_a_heading_may_be_wanted_that_is_turned_from_the_marker() -> None:
    rows = track((0, 0, -2.5), (8.83, 2.04, -2.5), (0, 0, -2.5), yaw=0.5)
    turned = grade(rows, Wanted(turn_deg=math.degrees(0.5)), MARKER, (1.0, 2.0))
    assert turned.visit is not None
    assert turned.visit.yaw_error == pytest.approx(0.0, abs=1e-9)


def test_visit_is_measured_on_entry_and_until_the_state_is_left() -> None:
    rows = track((0, 0, -2.5), (8.83, 2.04, -2.5), (9.2, 2.06, -2.5), (0, 0, -2.5), yaw=0.05)
    result = grade(rows, Wanted(), MARKER, (1.0, 2.0))
    assert result.visit is not None
    assert result.visit.position_error == pytest.approx(0.05)
    assert result.visit.yaw_error == pytest.approx(0.05)
    assert result.visit.worst_error == pytest.approx(math.hypot(0.4, 0.06))
    assert result.visit.worst_sideways == pytest.approx(0.06)
    assert result.succeeded


@pytest.mark.parametrize(
    ("place", "yaw", "good"),
    [
        ((8.75, 2.0, -2.5), 0.0, True),
        ((8.65, 2.0, -2.5), 0.0, False),
        ((8.8, 2.0, -2.5), 0.08, True),
        ((8.8, 2.0, -2.5), -0.1, False),
    ],
)
def test_success_needs_place_and_heading(
    place: tuple[float, float, float], yaw: float, *, good: bool
) -> None:
    assert grade(track(place, yaw=yaw), Wanted(), MARKER, (0.0, 0.0)).succeeded is good


def test_success_needs_the_visit_and_a_landing() -> None:
    rows = track((8.8, 2.0, -2.5))
    assert not grade(rows, Wanted(), MARKER, None).succeeded
    in_air = grade(rows[:-1], Wanted(), MARKER, (0.0, 0.0))
    assert in_air.in_air
    assert not in_air.succeeded
    rows[-1, 17] = 1.0
    crashed = grade(rows, Wanted(), MARKER, (0.0, 0.0))
    assert crashed.crashed
    assert not crashed.succeeded


def test_totals() -> None:
    rows = track((0, 0, -3), (3, 4, -3), (3, 4, -3))
    rows[1, 19] = 0.7
    result = grade(rows)
    assert result.succeeded
    assert result.clearance == 0.7
    assert (result.distance, result.duration, result.energy) == (5.0, 2.0, 150.0)


def test_marker_on_the_ground_has_no_heading_to_face() -> None:
    flat = Marker(dictionary="DICT_4X4_50", id=1, size=1.0, position=(0, 0, 0), tilt_deg=90.0)
    result = grade(track((0, 0, -2.0), yaw=2.0), Wanted((2.0, 0.0, 0.0)), flat, (0.0, 0.0))
    assert result.visit is not None
    assert result.visit.yaw_error is None
    assert result.succeeded


def test_a_real_flight_is_graded(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.wait(0.5)
    assert not grade(flight.vehicle.track.rows).landed
    flight.rise()
    flight.fly((1.0, 0.0, 0.0), 3.0)
    assert grade(flight.vehicle.track.rows).in_air
    flight.act(Action.LAND)
    flight.wait(12.0)
    result = grade(flight.vehicle.track.rows)
    assert result.succeeded
    assert result.distance == pytest.approx(9.5, abs=1.5)
