"""From what sensors said to what is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from rehearsed import precise, short

from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.prepared_mission import begin, prepare
from missionkit.engine.sense import STALE_SCAN, sense
from missionkit.engine.tick import tick
from missionkit.estimation.navigator import NavState
from missionkit.geometry import Transform, conjugate, from_euler, rotate, to_matrix, vec
from missionkit.goal_pose import facing
from missionkit.messages import Battery, Cycle, Frame, Health, Observation, Scan, VehicleStatus
from missionkit.plugin_containment import Containment

MISSION = """\
targets:
  turned: {position: [50, 0, -3], facing_deg: 90}
  bare: {position: [0, 50, -3]}
initial: idle
states: {idle: {kind: idle}, land: {kind: land}}
"""
BATTERY = Battery(0.05, 0.8, 15.0)
HEALTH = Health(True, False, 0.0, 0.0, 0.1, 0)
STATUS = VehicleStatus(0.05, armed=False, in_air=False, ready=True, mode="hold")


def plan_of(text: str = MISSION):
    return prepare(short(text), builtin())


def sensed(*observations: Observation):
    """Return the estimate after each observation; the chart does not move."""
    plan = plan_of()
    memory, estimates = begin(plan), []
    for seen in observations:
        senses, estimate = sense(plan, memory, seen, Containment())
        memory = memory._replace(now=seen.now, senses=senses)
        estimates.append(estimate)
    return estimates


def test_the_last_battery_and_vehicle_status_are_kept_with_their_time():
    first, second = sensed(Observation(0.05, battery=BATTERY, status=STATUS), Observation(0.1))
    assert (second.battery, second.status) == (BATTERY, STATUS)
    assert (first.now, second.now) == (0.05, 0.1)


def test_events_and_timing_are_of_this_tick_only():
    first, second = sensed(
        Observation(0.05, events=("arm_refused",), cycle=Cycle(overruns=3)), Observation(0.1)
    )
    assert (first.events, second.events) == (("arm_refused",), ())
    assert (first.cycle.overruns, second.cycle.overruns) == (3, 0)


def test_home_is_where_the_vehicle_armed_first():
    armed = next(r.now for r in precise().records if r.estimate.status and r.estimate.status.armed)
    for record in precise().records:
        seen = record.estimate
        assert (seen.home is None) is (record.now < armed)
        if record.now == armed:
            home = seen.position
        if record.now >= armed:
            np.testing.assert_array_equal(seen.home, home)


def test_a_scan_counts_until_it_is_stale():
    scan = Scan(0.05, np.array([[3.0, 1.0, 0.0]]))
    later = [Observation(0.05 + age) for age in (0.45, STALE_SCAN, STALE_SCAN + 0.05)]
    estimates = sensed(Observation(0.05, scan=scan), *later)
    assert [estimate.obstacles is None for estimate in estimates] == [False, False, False, True]


def test_a_scan_that_hits_nothing_is_not_a_scan_that_is_missing():
    (estimate,) = sensed(Observation(0.05, scan=Scan(0.05, np.empty((0, 3)))))
    assert estimate.obstacles.shape == (0, 3)


def test_obstacles_are_turned_and_moved_into_the_world():
    flight = precise()
    seen = next(
        (record.estimate, observation.scan)
        for record, observation in zip(flight.records, flight.observations, strict=True)
        if observation.scan is not None and len(observation.scan.points) and record.now > 10.0
    )
    estimate, scan = seen
    expected = [rotate(estimate.attitude, point) + estimate.position for point in scan.points]
    np.testing.assert_allclose(estimate.obstacles, expected, atol=1e-9)


def test_targets_are_turned_as_surveyed_until_they_are_seen():
    (estimate,) = sensed(Observation(0.05))
    turned, bare = estimate.targets["turned"], estimate.targets["bare"]
    np.testing.assert_allclose(turned.position, (50, 0, -3))
    np.testing.assert_array_equal(turned.attitude, facing(math.radians(90.0)))
    assert bare.attitude is None
    assert (turned.seen_at, bare.seen_at) == (None, None)


def test_a_measured_attitude_replaces_the_surveyed_one():
    """The orchard's marker is turned by 3 degrees from where the survey says it faces."""
    flight = precise()
    surveyed = facing(math.pi)
    turns = []
    for record in flight.records:
        target = record.estimate.targets["trunk"]
        normals = (rotate(q, vec(0.0, 0.0, 1.0)) for q in (surveyed, target.attitude))
        a, b = normals
        turns.append(
            (target.seen_at, math.degrees(math.atan2(b[1], b[0]) - math.atan2(a[1], a[0])))
        )
    assert {turn % 360.0 for seen_at, turn in turns if seen_at is None} == {0.0}
    assert turns[-1][1] % 360.0 == pytest.approx(3.0, abs=1.0)


def test_a_plan_has_the_missions_rate_camera_and_avoidance():
    plan = plan_of("settings: {rate: 50}\navoid: none\n" + MISSION)
    assert plan.period == pytest.approx(0.02)
    assert plan.law.field is None
    assert begin(plan).acting.avoidance is None
    assert plan_of().law.field is not None
    assert set(plan.facing) == {"turned"}
    np.testing.assert_allclose(to_matrix(plan.facing["turned"])[:, 2], (0, 1, 0), atol=1e-12)


class Turning:
    """A navigator that stands at the origin and turns at 30 degrees per second."""

    RATE = math.radians(30.0)

    def begin(self):
        return None

    def propagate(self, known, observation):
        return observation.now

    def pose_at(self, known, at):
        return Transform(from_euler(0.0, 0.0, self.RATE * at), vec(at, 0.0, 0.0))

    def read(self, known):
        body = self.pose_at(known, known)
        still = np.zeros(3)
        return NavState(
            body.translation, still, body.rotation, still, HEALTH, {}, np.eye(15), still, 0
        )


def test_a_scan_is_placed_from_where_it_was_measured():
    """A wall 5 m north of the start is there still when the scan comes 0.4 s late."""
    plan = plan_of()._replace(navigator=Turning())
    scan = Scan(1.0, np.array([rotate(conjugate(from_euler(0, 0, Turning.RATE)), vec(5, 0, 0))]))
    _, estimate = sense(plan, begin(plan), Observation(1.4, scan=scan), Containment())
    np.testing.assert_allclose(estimate.obstacles, [(6.0, 0.0, 0.0)], atol=1e-9)


def test_the_age_of_a_scan_counts_from_its_measurement():
    scan = Scan(0.05, np.array([[3.0, 1.0, 0.0]]), range=9.0)
    now, later = sensed(Observation(0.45, scan=scan), Observation(2.0))
    assert (now.scanned_at, now.scan_range) == (0.05, 9.0)
    assert (later.scanned_at, later.obstacles) == (0.05, None)


EQUAL_MARKERS = """\
targets: {tree: {position: [6, 0, 0]}}
perception: [{use: aruco, target: tree, id: 23, size: 0.4}]
initial: idle
states:
  idle: {kind: idle, transitions: [{to: land, event: marker_duplicated}]}
  land: {kind: land}
"""


def test_two_markers_of_one_id_are_reported_once_and_are_an_event_of_the_chart():
    plan = plan_of(EQUAL_MARKERS)
    memory, records, marker = begin(plan), [], np.array([[0, 0], [40, 0], [40, 40], [0, 40.0]])
    for tick_number in range(1, 5):
        at = 0.05 * tick_number
        shifts = (100.0, 300.0 + tick_number) if tick_number > 1 else (100.0,)
        found = tuple(("DICT_6X6_250", 23, marker + shift) for shift in shifts)
        seen = Observation(at, frame=Frame(at, None, found))
        done = tick(plan, memory, seen, Containment())
        memory = done.memory
        records.append(done.record)
    problems = [[it for it in record.problems if "with id 23" in it] for record in records]
    assert [len(it) for it in problems] == [0, 1, 0, 0]
    assert [record.estimate.events for record in records] == [(), ("marker_duplicated",), (), ()]
    assert [record.state for record in records] == ["idle", "land", "land", "land"]
