"""Flight to a point."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import at, marker, play, status
from samples import calm

from missionkit.behaviors.go_to import GoTo
from missionkit.geometry import vec
from missionkit.messages import Target

UNTURNED = Target("trunk", vec(50.0, 10.0, -2.0), 1.0, None, None, None)
TURNED = marker(50.0, 10.0, -2.0, faces_deg=180.0, seen_at=None)


def goes(behavior: GoTo, **changes) -> list[float]:
    (step,) = play(behavior, [calm(**changes)])
    np.testing.assert_array_equal(step.guidance.position, step.goal.position)
    return [float(n) for n in step.goal.position]


@pytest.mark.parametrize(
    ("parameters", "target", "expected"),
    [
        ({}, UNTURNED, (50.0, 10.0, -2.0)),
        ({"height": 8.0}, UNTURNED, (50.0, 10.0, -8.0)),
        ({"standoff": (6.0, 0.0, 0.0)}, TURNED, (44.0, 10.0, -2.0)),
        ({"standoff": (6.0, 1.0, 2.0)}, TURNED, (44.0, 11.0, -4.0)),
        ({"standoff": (6.0, 0.0, 0.0), "height": 7.0}, TURNED, (44.0, 10.0, -7.0)),
        ({"standoff": (6.0, 0.0, 0.0)}, UNTURNED, (50.0, 10.0, -2.0)),
    ],
)
def test_where_a_target_leads(parameters, target, expected):
    behavior = GoTo(target="trunk", **parameters)
    assert goes(behavior, targets={"trunk": target}) == pytest.approx(expected)
    assert behavior.targets() == ("trunk",)


def test_home_is_where_the_vehicle_armed():
    home = vec(3.0, 4.0, -0.2)
    assert goes(GoTo(target="home", height=6.0), home=home) == [3.0, 4.0, -6.0]
    assert GoTo(target="home").targets() == ()


def test_the_way_home_keeps_the_height_it_began_with():
    behavior, start = GoTo(target="home"), calm(position=vec(9.0, 9.0, -7.0))
    later = calm(position=vec(5.0, 5.0, -6.0), home=vec(3.0, 4.0, -0.2))
    step = behavior.step(later, behavior.begin(start))
    assert step.goal.position.tolist() == [3.0, 4.0, -7.0]


@pytest.mark.parametrize(("north", "stops"), [(4.0, True), (0.6, False), (-4.0, False)])
def test_it_comes_to_rest_before_it_turns_round_and_does_so_once(north, stops):
    away = at(10.0, 60.0, 0.0, -5.0, velocity=vec(north, 0, 0), home=vec(0, 0, 0), status=status())
    rest = at(11.0, 62.0, 0.0, -5.0, velocity=vec(0.5, 0, 0), home=vec(0, 0, 0), status=status())
    steps = play(GoTo(target="home"), [away, rest, away])
    assert [step.stop for step in steps] == [stops, False, False]
    assert steps[1].guidance is not None


@pytest.mark.parametrize(("target", "known"), [("home", {"home": None}), ("trunk", {})])
def test_an_unknown_place_is_not_a_goal(target, known):
    (step,) = play(GoTo(target=target), [calm(**known)])
    assert (step.guidance, step.goal, step.done) == (None, None, False)
    assert step.note == f"the position of {target} is unknown"


@pytest.mark.parametrize(
    ("gap", "speed", "done"),
    [(0.9, 0.4, True), (1.1, 0.4, False), (0.9, 0.6, False), (1.0, 0.0, True)],
)
def test_it_is_done_near_the_goal_and_nearly_at_rest(gap, speed, done):
    seen = at(10.0, 50.0 - gap, 10.0, -2.0, velocity=vec(speed, 0, 0), targets={"trunk": UNTURNED})
    (step,) = play(GoTo(target="trunk", within=1.0), [seen])
    assert step.done is done


def test_it_turns_to_the_goals_heading_only_when_near():
    behavior = GoTo(target="trunk", standoff=(6.0, 0.0, 0.0), speed=3.0)
    targets = {"trunk": marker(50.0, 10.0, -2.0, faces_deg=-90.0)}
    far, near = (at(10.0, 50.0, y, -2.0, targets=targets) for y in (-20.0, 3.5))
    steps = play(behavior, [far, near])
    assert [step.guidance.yaw for step in steps[:2]] == [None, None]  # the yaw law chooses
    assert steps[1].guidance.final_yaw == pytest.approx(math.pi / 2)
    assert [step.guidance.speed for step in steps] == [3.0, 3.0]
    assert all(step.guidance.avoid for step in steps)
