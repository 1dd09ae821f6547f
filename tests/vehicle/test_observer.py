"""Messages in, observations out: nothing that a mission relies on is dropped without a word."""

import math

import numpy as np
import pytest
from vehicle.test_batteries import ALL, PAYLOAD, said
from vehicle.test_ground_sensors import DOWN, FLOW, RAD, RATE
from vehicle.test_message_readings import FIX, HIGHRES
from vehicle.test_obstacle_ring import ring
from vehicle.test_time import Wall

from missionkit.geometry import from_euler
from missionkit.vehicle.autopilot_dialect import PX4
from missionkit.vehicle.link.clocks import MissionClock
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_rates import QUEUED
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from missionkit.vehicle.telemetry.observer import Observer

HOME = {"latitude": 473977418, "longitude": 85455938, "altitude": 488000, "x": 0, "y": 0, "z": 0}
BEAT = {"custom_mode": 6 << 16, "base_mode": 0x80, "system_status": 4, "autopilot": 12}
IN_AIR, ON_GROUND = {"landed_state": 2}, {"landed_state": 1}


def turned(yaw=0.0, boot=0):
    q = from_euler(0.0, 0.0, yaw)
    names = dict(zip(("q1", "q2", "q3", "q4"), map(float, q), strict=True))
    return {**names, "rollspeed": 0.0, "pitchspeed": 0.0, "yawspeed": 0.0, "time_boot_ms": boot}


class Listening:
    """An observer, its cache and a wall clock that only these tests turn."""

    def __init__(self):
        self.wall, self.clock = Wall(), MissionClock()
        self.cache = Cache(self.wall, QUEUED)
        self.state = AutopilotState(self.cache, PX4)
        self.observer = Observer(self.cache, self.state, self.clock)
        self.now = 0.0
        self.see()

    def see(self, **messages):
        """Put messages, let a tick pass, and return what it sees."""
        for name, fields in messages.items():
            for each in fields if isinstance(fields, list) else [fields]:
                self.cache.put(name, each)
        self.now += 0.05
        self.wall.now += 0.05
        self.clock.tick(self.now, self.wall.now)
        return self.observer.observe(self.now, None, ())


@pytest.fixture
def listening():
    return Listening()


def test_a_fix_without_course_is_a_fix(listening):
    seen = listening.see(HOME_POSITION=HOME, GPS_RAW_INT={**FIX, "cog": 65535})
    np.testing.assert_allclose(seen.gnss.position[:2], 0.0, atol=0.05)
    assert seen.gnss.velocity is None


def test_the_climb_rate_is_the_autopilots_while_it_reports_one(listening):
    local = {"x": 0.0, "y": 0.0, "z": -10.0, "vx": 0.0, "vy": 0.0, "vz": -1.5}
    seen = listening.see(HOME_POSITION=HOME, LOCAL_POSITION_NED=local, GPS_RAW_INT=FIX)
    assert seen.gnss.velocity[2] == -1.5
    listening.wall.now += 2.0
    listening.now += 2.0
    assert listening.see(GPS_RAW_INT=FIX).gnss.velocity_sd[2] == math.inf


def test_a_second_receiver_is_used_while_the_first_has_no_fix(listening):
    lost = {**FIX, "fix_type": 1, "vel": 65535, "cog": 65535}
    other = {**FIX, "alt": 508000}
    first = listening.see(HOME_POSITION=HOME, GPS_RAW_INT=FIX, GPS2_RAW=other)
    assert first.gnss.position[2] == pytest.approx(-10.0)
    assert listening.see(GPS_RAW_INT=lost, GPS2_RAW=other).gnss is None
    heights = [listening.see(GPS_RAW_INT=lost, GPS2_RAW=other).gnss for _ in range(40)]
    assert heights[-1].position[2] == pytest.approx(-20.0)
    assert listening.see(GPS_RAW_INT=FIX, GPS2_RAW=other).gnss.position[2] == pytest.approx(-10.0)


def test_a_home_of_zeros_does_not_count(listening):
    nowhere = {**HOME, "latitude": 0, "longitude": 0, "altitude": 0}
    assert listening.see(HOME_POSITION=nowhere, GPS_RAW_INT=FIX).gnss is None
    assert listening.observer.origin is None
    assert listening.see(HOME_POSITION=HOME, GPS_RAW_INT=FIX).gnss is not None


def test_home_follows_from_the_local_origin_when_it_is_not_sent(listening):
    """Home 10 m above the origin and 0.0001 deg north of it, x, y and z left zero."""
    origin = {"latitude": HOME["latitude"] - 1000, "longitude": HOME["longitude"]}
    listening.see(HOME_POSITION=HOME, GPS_GLOBAL_ORIGIN={**origin, "altitude": 478000})
    np.testing.assert_allclose(listening.observer.start, (11.12, 0.0, -10.0), atol=0.02)
    local = {"x": 0.0, "y": 0.0, "z": -40.0, "vx": 0.0, "vy": 0.0, "vz": 0.0}
    listening.see(LOCAL_POSITION_NED=local)
    assert listening.state.height == pytest.approx(30.0)
    listening.see(HOME_POSITION={**HOME, "x": 3.0, "z": -1.0})
    np.testing.assert_allclose(listening.observer.start, (3.0, 0.0, -1.0), atol=0.02)


def test_a_landed_state_that_has_stopped_says_nothing_of_a_vehicle_whose_heart_beats(listening):
    listening.see(HEARTBEAT=BEAT, EXTENDED_SYS_STATE=ON_GROUND)
    assert listening.state.in_air is False
    for _ in range(50):
        seen = listening.see(HEARTBEAT=BEAT)
    assert listening.state.in_air is True
    assert seen.status.in_air
    listening.see(EXTENDED_SYS_STATE=ON_GROUND)
    assert listening.state.in_air is False


def test_a_silent_link_does_not_turn_standing_into_flying(listening):
    listening.see(HEARTBEAT=BEAT, EXTENDED_SYS_STATE=ON_GROUND)
    for _ in range(100):
        listening.see()
    assert listening.state.in_air is False


def test_packs_that_report_in_one_tick_all_count(listening):
    for _ in range(3):
        seen = listening.see(BATTERY_STATUS=[said(0, 8, ALL), said(1, 95, PAYLOAD)])
    assert seen.battery.charge == 0.08
    assert listening.see().battery is None


def test_a_ring_of_the_world_is_turned_by_the_attitude_of_its_time(listening):
    """The vehicle turns right at 1 rad/s; the ring was measured 0.1 s before the last attitude."""
    turns = [turned(0.9 + 0.02 * n, boot=4900 + 20 * n) for n in range(6)]
    listening.see(ATTITUDE_QUATERNION=turns)
    fields = ring({0: 300}, frame=0, time_usec=4_900_000)
    (point,) = listening.see(OBSTACLE_DISTANCE=fields).scan.points
    np.testing.assert_allclose(point, (3.0 * math.cos(0.9), -3.0 * math.sin(0.9), 0.0), atol=1e-6)


def test_a_ring_that_is_not_understood_is_a_problem_once(listening):
    seen = [listening.see(OBSTACLE_DISTANCE=ring({}, frame=21)) for _ in range(3)]
    assert [one.scan for one in seen] == [None] * 3
    problems = [one.problems for one in seen]
    assert "MAV_FRAME 21" in problems[0][0]
    assert problems[1:] == [(), ()]


def test_rings_of_two_sensors_are_seen_together(listening):
    front, rear = ring({0: 300}, sensor_type=0), ring({36: 400}, sensor_type=1)
    seen = listening.see(ATTITUDE_QUATERNION=turned(), OBSTACLE_DISTANCE=[front, rear])
    assert len(seen.scan.points) == 2


@pytest.mark.parametrize("flow", [{"OPTICAL_FLOW_RAD": RAD}, {"OPTICAL_FLOW": RATE}])
def test_flow_and_range_are_seen(listening, flow):
    for _ in range(2):
        seen = listening.see(DISTANCE_SENSOR=DOWN, HIGHRES_IMU=HIGHRES, **flow)
    np.testing.assert_allclose(seen.flow.flow, FLOW)
    assert seen.range.distance == pytest.approx(1.53)


def test_the_date_is_known_once_the_vehicle_has_it_and_runs_on(listening):
    moved = {"x": 0.0, "y": 0.0, "z": 0.0, "vx": 0.0, "vy": 0.0, "vz": 0.0}
    local = {"LOCAL_POSITION_NED": {**moved, "time_boot_ms": 5000}}
    unset = {"time_unix_usec": 0, "time_boot_ms": 5000}
    assert listening.see(**local, SYSTEM_TIME=unset).utc is None
    dated = listening.see(SYSTEM_TIME={**unset, "time_unix_usec": 1_780_000_000_000_000})
    assert dated.utc == pytest.approx(1_780_000_000.0 + 0.05, abs=0.06)
    assert listening.see().utc == pytest.approx(dated.utc + 0.05)
    listening.observer.forget()
    assert listening.see(SYSTEM_TIME=unset).utc is None
