"""Climbing from near the ground, and the guard that says when to."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import at, play

from missionkit.behaviors.climb_clear import ClimbClear
from missionkit.geometry import vec
from missionkit.guards.obstacle_robots import ObstacleRobotNear
from missionkit.messages import Target
from missionkit.planning.obstacle_robots import ROBOT, nearest_approach


def obstacle(north, east, heading=None, chance=0.9, name="robot_9"):
    classes = {"target": 1.0 - chance, "obstacle": chance}
    found = Target(name, vec(north, east, 0.0), 0.02, None, None, 9.9, classes=classes)
    return found._replace(heading=heading)


def seen(height, *robots, place=(1.0, 2.0)):
    return at(10.0, *place, -height, yaw=0.4, targets={it.name: it for it in robots})


def test_it_climbs_straight_up_from_the_ground():
    steps = play(ClimbClear(height=3.0), [seen(0.05), seen(1.0, place=(1.1, 2.0)), seen(2.75)])
    assert [it.done for it in steps] == [False, False, True]
    for it in steps:
        np.testing.assert_allclose(it.guidance.position, (1.0, 2.0, -3.0))
        assert it.lands
        assert not it.guidance.avoid


@pytest.mark.parametrize(
    ("gap", "chance", "moves"), [(0.7, 0.9, True), (0.7, 0.1, False), (3.0, 0.9, False)]
)
def test_from_an_obstacle_robot_it_moves_away_as_it_climbs(gap, chance, moves):
    near = obstacle(1.0, 2.0 + gap, chance=chance)
    (step,) = play(ClimbClear(keep_out=1.5), [seen(0.2, near)])
    away = 1.5 - gap if moves else 0.0
    np.testing.assert_allclose(step.guidance.position, (1.0, 2.0 - away, -3.0))


def test_what_the_range_sensor_sees_counts_where_the_camera_has_not_looked():
    tower = {"obstacles": np.array([[1.0, 3.0, -0.2], [8.0, 2.0, -0.2]])}
    low = at(10.0, 1.0, 2.0, -0.2, yaw=0.4, **tower)
    assert ObstacleRobotNear().check(low).holds
    assert ObstacleRobotNear(scanned=0.9).check(low).holds is None
    assert ObstacleRobotNear().check(at(10.0, 1.0, 2.0, -2.4, **tower)).holds is None
    (step,) = play(ClimbClear(keep_out=1.5), [low])
    np.testing.assert_allclose(step.guidance.position, (1.0, 1.5, -3.0))


def test_right_above_a_robot_it_climbs_at_finite_speed():
    (step,) = play(ClimbClear(), [seen(0.2, obstacle(1.0, 2.0))])
    assert np.isfinite(step.guidance.position).all()


def test_the_nearest_approach_is_that_of_its_circle():
    robot = obstacle(0.0, 0.0, heading=0.0)
    turn, radius = ROBOT.circle_rate * 6.0, ROBOT.speed / ROBOT.circle_rate
    ends = (radius * math.sin(turn), radius * (1.0 - math.cos(turn)))
    assert nearest_approach([robot], ends, 6.0)[0] == pytest.approx(0.0, abs=0.01)
    assert nearest_approach([robot], (-1.0, 0.0), 6.0)[0] == pytest.approx(1.0)
    anyhow = obstacle(0.0, 0.0)
    assert nearest_approach([anyhow], (-1.0, 0.0), 2.0)[0] == pytest.approx(1.0 - 2 * ROBOT.speed)
    assert nearest_approach([], (0.0, 0.0), 2.0) == (math.inf, None)


@pytest.mark.parametrize(
    ("height", "robots", "holds"),
    [
        (1.0, [obstacle(1.0, 3.2, heading=-math.pi / 2)], True),  # comes straight to it
        (1.0, [obstacle(1.0, 3.2, heading=math.pi / 2)], False),
        (2.5, [obstacle(1.0, 2.5)], None),
        (1.0, [obstacle(1.0, 2.5, chance=0.1)], None),
        (1.0, [], None),
    ],
)
def test_the_guard_warns_below_the_towers(height, robots, holds):
    assert ObstacleRobotNear().check(seen(height, *robots)).holds is holds
