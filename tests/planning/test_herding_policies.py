"""Which ground robot is next: the policies' choices in small arenas."""

from __future__ import annotations

import math

import pytest

from missionkit.messages.herd import Arena, HerdChoice, HerdRobot, HerdView
from missionkit.planning.herding.arena_frame import from_arena, to_arena
from missionkit.planning.herding.dynamic_programme import DynamicProgramme
from missionkit.planning.herding.nearest_to_goal import NearestToGoal

EAST = Arena(north=3.0, goal=math.radians(90.0))

LEAVING = (-6.0, 8.0), math.radians(225.0)
"""2 m off the goal line and 1 m off the side on its right, driving to the latter."""


def view(*robots, arena=EAST):
    return HerdView(600.0, arena, (-6.0, 8.0, -1.5), (0.0, 0.0, 0.0), robots)


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


def test_a_robot_about_to_be_lost_is_worth_more_than_one_that_comes_home():
    going = HerdRobot("going", (3.0, 5.0), math.radians(90.0), reversal_in=19.0)  # 5 m, 16 s
    leaving = HerdRobot("leaving", *LEAVING, reversal_in=14.5)  # in 4.3 s
    choice = DynamicProgramme(length=60.0).choose(view(going, leaving))
    assert (choice.robot, choice.action) == ("leaving", "front")
    assert choice.values["going"] < 0.0
    assert choice.values["leaving"] > 0.5
    assert choice.margin > 0.5
    alone = DynamicProgramme(length=60.0).choose(view(going))
    assert (alone.robot, alone.action) == (None, "wait")
    assert "going: -" in alone.text()


def test_it_stays_with_its_robot_until_another_is_better_by_a_margin():
    twins = [
        HerdRobot(name, (-6.0, 8.0 + d), LEAVING[1], reversal_in=14.5)
        for name, d in (("a", -0.5), ("b", 0.0))
    ]
    policy = DynamicProgramme(length=60.0, stay=0.2)
    first = policy.choose(view(*twins)).robot
    (other,) = {"a", "b"} - {first}
    assert policy.choose(view(*twins)._replace(chosen=other)).robot == other
    assert (
        policy.model_copy(update={"stay": 0.0}).choose(view(*twins)._replace(chosen=other)).robot
        == first
    )


def test_what_is_out_of_view_or_not_known_counts_less():
    policy = DynamicProgramme(length=60.0)
    seen = HerdRobot("r", *LEAVING, reversal_in=14.5)
    far = seen._replace(in_view=False, position_sd=3.0)
    values = [policy.choose(view(it)).values["r"] for it in (seen, far)]
    assert values[1] < 0.5 * values[0]


def test_touches_turn_a_robot_that_a_half_turn_would_not_bring_home():
    along = HerdRobot("r", (3.0, 6.0), 0.0, reversal_in=16.5)  # 4 m off the goal line, along it
    near = view(along)._replace(position=(3.0, 6.0, -1.5), time_left=24.0)
    front = DynamicProgramme(length=60.0).choose(near)
    both = DynamicProgramme(length=60.0, turns="front_and_top").choose(near)
    assert (front.action, both.action) == ("wait", "top")
    assert both.values["r"] > 0.3 + front.values["r"]


def test_time_is_up():
    robot = HerdRobot("r", *LEAVING, reversal_in=14.5)
    policy = DynamicProgramme(length=60.0)
    assert policy.choose(view(robot)._replace(time_left=0.0)).robot is None
    assert policy.choose(view()).robot is None
