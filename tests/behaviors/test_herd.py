"""Choosing the next robot of a herd and waiting above it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import at, play

from missionkit.behaviors.herd import Herd
from missionkit.geometry import vec
from missionkit.messages import Target
from missionkit.planning.herding import robot_forecast as fc

LEAVING = math.radians(135.0)


def robot(name, north, east, heading, *, obstacle=0.0, spin=0.0):
    classes, modes = {"obstacle": obstacle}, {"spin": spin}
    return Target(
        name,
        vec(north, east, 0.0),
        0.02,
        None,
        None,
        9.9,
        None,
        heading,
        0.05,
        modes,
        classes,
        1.0,
        14.5,
    )


def stepped(behavior, *robots, place=(7.9, 8.9), ticks=1):
    targets = {it.name: it for it in robots}
    if robots:
        targets["tracked"] = robots[-1]
    seen = [at(10.0 + 0.05 * k, *place, -2.5, yaw=0.7, targets=targets) for k in range(ticks)]
    return play(behavior, seen)[-1]


def test_the_policys_choice_becomes_the_tracked_one():
    home, returns = robot("robot_1", 3.0, 5.0, 0.0), robot("robot_2", 7.0, 2.0, math.pi)
    behavior = Herd(robots=2, policy="nearest_to_goal")
    step = stepped(behavior, returns, home, place=(6.3, 1.9))
    assert step.chosen == "robot_2"
    assert step.done
    np.testing.assert_allclose(step.guidance.position, (6.2, 2.0, -2.5))  # 0.8 m ahead


def test_it_flies_there_first():
    step = stepped(Herd(robots=1), robot("robot_2", 8.0, 9.0, LEAVING), place=(7.0, 8.0))
    assert (step.chosen, step.done) == ("robot_2", False)


@pytest.mark.parametrize(
    "it",
    [
        robot("robot_2", 8.0, 9.0, LEAVING, obstacle=0.9),
        robot("robot_2", 8.0, 9.0, None),
        robot("trunk", 8.0, 9.0, LEAVING),
    ],
)
def test_what_is_no_robot_of_the_herd_is_not_chosen(it):
    step = stepped(Herd(), it)
    assert (step.chosen, step.done) == (None, False)
    assert "looking for unseen_" in step.note


def test_it_flies_to_where_a_robot_out_of_view_is_expected():
    step = stepped(Herd(), place=(-9.0, 0.0))
    assert step.chosen is None
    assert math.hypot(*step.guidance.position[:2]) < 5.0  # 10 s after the start in the middle
    assert step.guidance.position[2] == -2.5


def test_it_stays_above_a_robot_that_is_not_worth_a_landing_yet():
    step = stepped(Herd(robots=1), robot("robot_1", 8.0, 5.0, 0.0), place=(8.4, 5.0))
    assert (step.chosen, step.done) == ("robot_1", False)
    assert "wait" in step.note


def test_a_robot_that_left_the_view_is_remembered():
    behavior, memory = Herd(robots=1), None
    sighted = {"robot_1": robot("robot_1", 4.0, 5.0, 0.0)}
    memory = behavior.step(at(10.0, 4.0, 5.0, -2.5, targets=sighted), memory).memory
    step = behavior.step(at(14.0, -6.0, -6.0, -2.5), memory)
    assert "looking for unseen_1" in step.note
    np.testing.assert_allclose(step.guidance.position, (5.3, 5.0, -2.5), atol=0.6)


def test_a_robot_that_is_about_to_reverse_is_met_on_the_side_where_it_drives_then():
    behavior = Herd(robots=1, policy="nearest_to_goal")
    it = robot("robot_1", 7.0, 2.0, math.pi)
    place = (7.6, 2.0, -2.5)
    memory = behavior.step(at(10.0, *place, targets={"robot_1": it}), None).memory
    memory.known.particles[0, :, fc.REVERSAL_IN] = 1.1
    still = it._replace(seen_at=10.5)
    drives = behavior.step(at(10.5, *place, targets={"robot_1": still}), memory)
    assert drives.chosen == "robot_1"
    np.testing.assert_allclose(drives.guidance.position, (7.0 - 0.6 * 0.33 + 0.8, 2.0, -2.5))
    assert not drives.done  # a meeting would end when it begins to turn
    turning = it._replace(modes={"spin": 0.9}, spin_left=2.2, heading=math.radians(199.0))
    turning = turning._replace(seen_at=11.4)
    spins = behavior.step(at(11.4, *place, targets={"robot_1": turning}), drives.memory)
    assert spins.done
    np.testing.assert_allclose(spins.guidance.position, (7.8, 2.0, -2.5), atol=0.05)


def test_the_memory_is_a_value():
    behavior = Herd()
    first = behavior.step(at(10.0, 0.0, 0.0, -2.5), None).memory
    kept = first.known.particles.copy()
    behavior.step(at(11.0, 0.0, 0.0, -2.5), first)
    np.testing.assert_array_equal(first.known.particles, kept)


def test_from_the_ground_it_climbs_straight_up():
    behavior = Herd()
    step = behavior.step(at(10.0, 8.1, 8.6, -0.1), None)
    np.testing.assert_allclose(step.guidance.position, (8.1, 8.6, -2.5))
    assert step.note == "climbing"


def test_the_papers_policy():
    near, far = robot("robot_1", 8.0, 0.0, math.pi), robot("robot_2", 2.0, 0.0, math.pi)
    assert stepped(Herd(policy="nearest_to_goal"), far, near).chosen == "robot_1"


def test_the_arena_may_lie_anywhere():
    leaves = robot("robot_1", 2.0, 3.0, 0.0)
    turned = Herd(policy="nearest_to_goal", robots=1, goal_deg=90.0)
    assert not stepped(turned, leaves, place=(2.4, 3.0)).done  # 90 deg off is not beyond it
    opposite = Herd(policy="nearest_to_goal", robots=1, goal_deg=180.0)
    assert stepped(opposite, leaves, place=(2.4, 3.0)).chosen == "robot_1"
