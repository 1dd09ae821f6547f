"""Which ground robot is next: the policies' choices in small arenas."""

from __future__ import annotations

import math

import pytest

from missionkit.messages.herd import Arena, HerdChoice, HerdRobot, HerdView
from missionkit.planning.herding.arena_frame import from_arena, to_arena
from missionkit.planning.herding.nearest_to_goal import NearestToGoal

EAST = Arena(north=3.0, goal=math.radians(90.0))


def view(*robots, arena=EAST):
    return HerdView(600.0, arena, (3.0, 0.0, -1.5), (0.0, 0.0, 0.0), robots)


def test_axes_of_an_arena():
    assert to_arena(EAST, (3.0, 10.0)) == pytest.approx((10.0, 0.0))
    assert to_arena(EAST, (2.0, 0.0)) == pytest.approx((0.0, 1.0))  # right of east is south
    assert from_arena(EAST, to_arena(EAST, (-4.0, 7.0))) == pytest.approx((-4.0, 7.0))


def test_the_papers_policy_takes_the_nearest_that_does_not_drive_to_the_goal():
    near = HerdRobot("near", (3.0, 8.0), math.radians(60.0))  # 30 deg off
    next_ = HerdRobot("next", (3.0, 5.0), math.radians(-45.0))  # 135 deg off
    far = HerdRobot("far", (3.0, -5.0), math.radians(-90.0))
    choice = NearestToGoal().choose(view(near, far, next_))
    assert (choice.robot, choice.action) == ("next", "front")
    assert choice.values == pytest.approx({"next": -5.0, "far": -15.0})
    assert choice.margin == pytest.approx(10.0)
    assert NearestToGoal(off_deg=140.0).choose(view(near, far, next_)).robot == "far"
    assert NearestToGoal().choose(view(near)).robot is None


def test_a_choice_in_words():
    choice = HerdChoice("robot_4", "front", values={"robot_7": 0.22, "robot_4": 0.31, "r": -0.4})
    assert choice.text() == "robot_4: +0.31, robot_7: +0.22"
