"""Visual servoing."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import at, marker, play
from samples import calm

from missionkit.behaviors.servo import Servo
from missionkit.geometry import vec
from missionkit.messages import Target

TRUNK = marker(20.0, 5.0, -3.0, faces_deg=180.0)  # to be faced by looking north
SERVO = Servo(target="trunk", standoff=(1.5, 0.0, 0.0), speed=0.8, align=0.6, patience=0.7)


def test_the_goal_stands_off_the_marker_and_faces_it():
    (step,) = play(SERVO, [at(10.0, 15.0, 5.0, -3.0, targets={"trunk": TRUNK})])
    np.testing.assert_allclose(step.guidance.position, (18.5, 5.0, -3.0), atol=1e-12)
    assert (step.guidance.speed, step.guidance.avoid) == (0.8, False)
    assert step.goal.yaw == pytest.approx(0.0)
    assert step.goal.target == "trunk"
    assert SERVO.targets() == ("trunk",)


@pytest.mark.parametrize(
    ("place", "yaw"),
    [
        ((15.0, 0.0, -3.0), math.atan2(5.0, 5.0)),
        ((18.5, 5.7, -3.0), math.atan2(-0.7, 1.5)),
        ((18.5, 5.5, -3.0), 0.0),
    ],
    ids=["far: at the marker", "just outside", "near: the goal's own"],
)
def test_it_looks_at_the_marker_until_it_is_near_the_goal(place, yaw):
    (step,) = play(SERVO, [at(10.0, *place, targets={"trunk": TRUNK})])
    assert step.guidance.yaw == pytest.approx(yaw)


@pytest.mark.parametrize(("age", "flies"), [(0.0, True), (0.7, True), (0.75, False), (5.0, False)])
def test_it_stops_and_waits_when_the_marker_is_out_of_sight(age, flies):
    seen = calm(now=16.0, targets={"trunk": TRUNK._replace(seen_at=16.0 - age)})
    (step,) = play(SERVO, [seen])
    assert (step.guidance is not None) is flies
    assert step.goal is not None
    assert step.note == ("" if flies else "waiting for trunk")


@pytest.mark.parametrize(
    ("north", "note"),
    [(18.0, "waiting for trunk"), (18.7, "backing off: trunk is out of sight")],
    ids=["before the goal", "beyond it"],
)
def test_out_of_sight_it_backs_off_from_the_marker_to_its_goal(north, note):
    lost = {"trunk": TRUNK._replace(seen_at=9.0)}
    (step,) = play(SERVO, [at(10.0, north, 5.3, -3.0, targets=lost)])
    assert step.note == note
    if step.guidance is not None:
        np.testing.assert_allclose(step.guidance.position, (18.5, 5.0, -3.0), atol=1e-12)


@pytest.mark.parametrize(
    "targets",
    [{}, {"trunk": Target("trunk", vec(20, 5, -3), 1.0, None, None, None)}],
    ids=["unknown", "how it is turned is unknown"],
)
def test_without_a_pose_there_is_no_goal(targets):
    (step,) = play(SERVO, [calm(targets=targets)])
    assert (step.guidance, step.goal, step.note) == (None, None, "trunk was never seen")


def test_a_surveyed_target_is_not_servoed_on_before_it_was_seen():
    (step,) = play(SERVO, [calm(targets={"trunk": TRUNK._replace(seen_at=None)})])
    assert (step.guidance, step.note) == (None, "waiting for trunk")


def test_the_plane_before_the_goal_is_never_to_be_crossed_also_while_it_waits():
    for now in (10.0, 12.0):
        (step,) = play(SERVO, [at(now, 15.0, 5.0, -3.0, targets={"trunk": TRUNK})])
        np.testing.assert_allclose(step.bound.normal, (-1.0, 0.0, 0.0), atol=1e-12)
        assert step.bound.point[0] == pytest.approx(18.5 + 0.15)
    assert step.guidance is None


@pytest.mark.parametrize("turn", [0.0, 30.0, -90.0, 170.0])
def test_the_nose_may_be_turned_from_facing_the_marker(turn):
    servo = Servo(target="trunk", standoff=(2.0, 0.0, 0.0), turn_deg=turn)
    target = marker(10.0, 0.0, -3.0, faces_deg=180.0)
    (step,) = play(servo, [at(10.0, 8.0, 0.0, -3.0, targets={"trunk": target})])
    np.testing.assert_allclose(step.goal.position, (8.0, 0.0, -3.0), atol=1e-9)
    assert step.guidance.yaw == pytest.approx(math.radians(turn))  # north, and turned from that
    assert step.goal.yaw == step.guidance.yaw
