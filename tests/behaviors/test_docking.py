import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from missionkit.behaviors.docking.align import Align, LookAt
from missionkit.behaviors.docking.approach import Approach
from missionkit.behaviors.docking.dock import Dock
from missionkit.behaviors.docking.docking_pose import docking_pose, looking_at, shortest
from missionkit.behaviors.docking.keep_out import way_round
from missionkit.behaviors.docking.reorient import Reorient
from missionkit.behaviors.docking.secure import Secure
from missionkit.geometry import exp, multiply, norm, rotate, vec
from missionkit.messages import Action, Estimate, Health, Target, VehicleStatus

TURNED = exp(vec(-0.5 * math.pi, 0.0, 0.0))
PORT = Target("port", vec(1.0, 2.0, 1.0), 0.0, TURNED, 0.0, None)
POSE = docking_pose(PORT, "top")
LEVEL = exp(vec(0.0, 0.0, 0.0))
SEED = 20


def seen(position, attitude=LEVEL, velocity=(0.0, 0.0, 0.0), *, armed=True, in_air=True, **more):
    return Estimate(
        now=5.0,
        position=position,
        velocity=np.array(velocity),
        attitude=attitude,
        rates=np.zeros(3),
        health=Health(True, False, None, None, 0.01, 0)._replace(**more),
        status=VehicleStatus(5.0, armed, in_air, True, "offboard"),
        targets={"port": PORT},
    )


def stepped(behavior, at):
    return behavior.step(at, behavior.begin(at))


def test_the_docked_camera_looks_into_the_face():
    looks = rotate(POSE.attitude, vec(0.0, 0.0, 1.0))
    np.testing.assert_allclose(looks, -POSE.axis, atol=1e-12)
    np.testing.assert_allclose(POSE.axis, rotate(TURNED, vec(0.0, 0.0, -1.0)), atol=1e-12)
    assert POSE.misalignment(POSE.attitude) == pytest.approx(0.0, abs=1e-9)


def test_misalignment_is_the_angle_between_the_attitudes():
    turned = multiply(POSE.attitude, exp(vec(0.3, -0.2, 0.1)))
    assert POSE.misalignment(turned) == pytest.approx(norm(vec(0.3, -0.2, 0.1)))


directions = st.tuples(*[st.floats(-1.0, 1.0) for _ in range(3)]).filter(
    lambda v: math.hypot(*v) > 0.1
)


@given(directions, directions)
def test_the_shortest_turn_leads_from_one_direction_to_the_other(a, b):
    a, b = np.array(a) / math.hypot(*a), np.array(b) / math.hypot(*b)
    turn = shortest(a, b)
    np.testing.assert_allclose(rotate(turn, a), b, atol=1e-7)
    angle = math.acos(max(-1.0, min(1.0, float(a @ b))))
    assert 2.0 * math.acos(min(1.0, abs(turn[0]))) == pytest.approx(angle, abs=1e-6)


def test_opposite_directions_are_half_a_turn_apart():
    for axis in np.eye(3):
        np.testing.assert_allclose(rotate(shortest(axis, -axis), axis), -axis, atol=1e-12)


@given(directions, st.floats(0.15, 2.0))
def test_looking_at_points_the_camera_at_the_target(direction, distance):
    unit = np.array(direction) / math.hypot(*direction)
    position = POSE.centre + distance * unit
    attitude = looking_at(POSE, position)
    np.testing.assert_allclose(rotate(attitude, vec(0.0, 0.0, 1.0)), -unit, atol=1e-7)


def test_in_front_of_the_face_looking_at_is_the_docked_attitude():
    attitude = looking_at(POSE, POSE.at(0.4))
    np.testing.assert_allclose(attitude, POSE.attitude, atol=1e-12)


@given(directions, directions, st.floats(0.21, 2.0), st.floats(0.2, 2.0))
@settings(max_examples=200)
def test_the_way_round_stays_out_of_the_sphere_and_arrives(a, b, far, end):
    centre, radius = vec(1.0, 2.0, 1.0), 0.2
    place = centre + far * np.array(a) / math.hypot(*a)
    goal = centre + end * np.array(b) / math.hypot(*b)
    for _ in range(2000):
        way = way_round(place, goal, centre, radius) - place
        length = norm(way)
        if length < 1e-9:
            break
        place = place + min(0.005, length) / length * way
        assert norm(place - centre) > 0.99 * radius
    np.testing.assert_allclose(place, goal, atol=1e-6)


def test_from_within_the_sphere_the_way_leads_straight_out():
    centre = vec(0.0, 0.0, 0.0)
    way = way_round(vec(0.05, 0.0, 0.0), vec(-1.0, 0.0, 0.0), centre, 0.2)
    np.testing.assert_allclose(way, vec(0.2, 0.0, 0.0))


@given(directions, directions, st.floats(0.185, 0.2))
def test_from_just_within_the_sphere_the_way_leads_on_and_out(a, b, near):
    a, b = np.array(a) / math.hypot(*a), np.array(b) / math.hypot(*b)
    assume(-0.999 < float(a @ b) < 0.7)  # straight opposite any way round will do
    way = way_round(near * a, 0.2 * b, vec(0.0, 0.0, 0.0), 0.2) - near * a
    along = way - float(way @ a) * a
    assert float(along @ b) > 0.0
    assert norm(along) > 0.05
    assert norm(near * a + way) >= 0.2


def test_approach_flies_at_the_target_and_keeps_its_attitude():
    at = seen(vec(0.0, 1.0, 0.0), exp(vec(0.1, 0.2, 0.3)))
    answer = stepped(Approach(target="port", stop=0.3), at)
    line = answer.guidance.position - at.position
    np.testing.assert_allclose(line / norm(line), vec(1, 1, 1) / math.sqrt(3.0), atol=1e-12)
    assert norm(answer.guidance.position - PORT.position) == pytest.approx(0.3)
    np.testing.assert_array_equal(answer.guidance.attitude, at.attitude)
    assert not answer.done


def test_approach_never_leads_into_the_keep_out_sphere():
    answer = stepped(Approach(target="port", stop=0.01, keep_out=0.2), seen(vec(0.0, 1.0, 0.0)))
    assert norm(answer.guidance.position - PORT.position) == pytest.approx(0.2)


def test_reorient_is_done_once_turned_as_docked():
    behavior = Reorient(target="port", within_deg=5.0)
    place = vec(0.6, 1.6, 0.6)
    assert not stepped(behavior, seen(place)).done
    near = multiply(POSE.attitude, exp(vec(math.radians(4.0), 0.0, 0.0)))
    assert stepped(behavior, seen(place, near)).done


def test_align_leads_to_the_axis_at_the_distance_of_its_entry():
    at = seen(PORT.position + vec(0.4, 0.0, 0.0))
    answer = stepped(Align(target="port", keep_out=0.2), at)
    np.testing.assert_allclose(answer.goal.position, POSE.at(0.4), atol=1e-12)
    near = seen(PORT.position + vec(0.1, 0.0, 0.0))
    answer = stepped(Align(target="port", keep_out=0.2), near)
    np.testing.assert_allclose(answer.goal.position, POSE.at(0.2), atol=1e-12)


def test_look_at_keeps_the_target_in_view_all_the_way():
    at = seen(vec(0.0, 1.0, 0.0))
    answer = stepped(LookAt(target="port", distance=0.25), at)
    looks = rotate(answer.guidance.attitude, vec(0.0, 0.0, 1.0))
    np.testing.assert_allclose(looks, vec(1, 1, 1) / math.sqrt(3.0), atol=1e-12)
    np.testing.assert_allclose(answer.goal.position, POSE.at(0.25), atol=1e-12)


def test_look_at_may_cut_the_corner_towards_the_vehicle():
    at = seen(PORT.position + 0.8 * POSE.axis + vec(1.0, 0.0, 0.0))
    corner = stepped(LookAt(target="port", distance=0.2, beside=0.02), at).goal.position
    assert norm(corner - PORT.position) == pytest.approx(0.2)
    off = corner - PORT.position - float((corner - PORT.position) @ POSE.axis) * POSE.axis
    np.testing.assert_allclose(off, vec(0.02, 0.0, 0.0), atol=1e-12)
    ahead = seen(POSE.at(0.8))
    straight = stepped(LookAt(target="port", distance=0.2, beside=0.02), ahead)
    np.testing.assert_allclose(straight.goal.position, POSE.at(0.2), atol=1e-12)


def test_the_corridor_may_widen_outwards():
    behavior = Dock(target="port", corridor=0.03, corridor_deg=15.0)
    beside = seen(POSE.at(0.25) + vec(0.05, 0.0, 0.0), POSE.attitude)
    np.testing.assert_allclose(stepped(behavior, beside).guidance.position, POSE.at(0.10))
    near = seen(POSE.at(0.12) + vec(0.05, 0.0, 0.0), POSE.attitude)
    np.testing.assert_allclose(stepped(behavior, near).guidance.position, POSE.at(0.12))


def test_dock_waits_beside_the_axis_and_moves_in_on_it():
    behavior = Dock(target="port", corridor=0.03)
    beside = seen(POSE.at(0.25) + vec(0.05, 0.0, 0.0), POSE.attitude)
    np.testing.assert_allclose(stepped(behavior, beside).guidance.position, POSE.at(0.25))
    inside = seen(POSE.at(0.25) + vec(0.02, 0.0, 0.0), POSE.attitude)
    np.testing.assert_allclose(stepped(behavior, inside).guidance.position, POSE.at(0.10))


@pytest.mark.parametrize(
    ("off", "turned", "done"), [(0.005, 0.04, True), (0.007, 0.04, False), (0.005, 0.06, False)]
)
def test_docked_means_near_in_place_and_attitude(off, turned, done):
    at = seen(POSE.at(0.10 + off), multiply(POSE.attitude, exp(vec(turned, 0.0, 0.0))))
    assert stepped(Dock(target="port"), at).done is done


def test_secure_switches_off_where_it_is_docked():
    assert stepped(Secure(target="port"), seen(POSE.at(0.105))).action is Action.DISARM


def test_secure_backs_off_along_the_axis_from_the_corridor():
    answer = stepped(Secure(target="port", clear=0.5), seen(POSE.at(0.15)))
    assert answer.action is None
    np.testing.assert_allclose(answer.guidance.position, POSE.at(0.5), atol=1e-12)


def test_secure_comes_to_rest_before_it_switches_off_clear_of_the_target():
    behavior, place = Secure(target="port", clear=0.5), PORT.position + vec(0.0, 0.0, 0.6)
    assert stepped(behavior, seen(place, velocity=(0.01, 0.0, 0.0))).action is None
    assert stepped(behavior, seen(place)).action is Action.DISARM


def test_secure_is_done_when_the_vehicle_says_so():
    assert stepped(Secure(target="port"), seen(POSE.at(0.1), armed=False, in_air=False)).done


@pytest.mark.parametrize(
    "behavior", [kind(target="port") for kind in (Align, Approach, Dock, LookAt, Reorient)]
)
def test_a_target_of_unknown_attitude_is_waited_for(behavior):
    blind = seen(vec(0.0, 0.0, 0.0))._replace(targets={"port": PORT._replace(attitude=None)})
    answer = stepped(behavior, blind)
    assert answer.guidance is None
    assert "not known" in answer.note
