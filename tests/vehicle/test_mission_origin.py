"""A mission with an origin flies to its places on the earth, wherever the vehicle was armed."""

import numpy as np
import pytest
from vehicle.test_message_readings import FIX
from vehicle.test_observer import HOME, Listening

from missionkit.geodesy import Origin
from missionkit.geometry import vec
from missionkit.vehicle.telemetry.mission_origin import MissionOrigin, misplacement
from missionkit.vehicle.telemetry.observer import Observer

AT_HOME = Origin(47.3977418, 8.5455938, 488.0)
FIELDS = ("latitude", "longitude", "altitude")
ARMED = {"custom_mode": 6 << 16, "base_mode": 0x80, "system_status": 4, "autopilot": 12}
DISARMED = {**ARMED, "base_mode": 0}


def away(north, east, up=0.0):
    """Return home so far (m) from AT_HOME."""
    return Origin(*AT_HOME.place(vec(north, east, -up)))


def message(place, **local):
    scaled = (round(1e7 * place.latitude), round(1e7 * place.longitude), 1000 * place.altitude)
    return {**dict(zip(FIELDS, scaled, strict=True)), "x": 0, "y": 0, "z": 0, **local}


class Wanting(Listening):
    """An observer of a mission that has an origin."""

    def __init__(self, origin, **more):
        super().__init__()
        wanted = MissionOrigin(origin, **more)
        self.observer = Observer(self.cache, self.state, self.clock, wanted=wanted)


def test_north_and_east_are_measured_from_the_missions_origin_and_down_from_home():
    listening = Wanting(away(-30.0, 12.0, up=3.0))
    seen = listening.see(HOME_POSITION=HOME, GPS_RAW_INT={**FIX, "alt": 498000})
    np.testing.assert_allclose(seen.gnss.position, (30.0, -12.0, -10.0), atol=0.05)
    np.testing.assert_allclose(listening.observer.start, (-30.0, 12.0, 0.0), atol=0.05)


@pytest.mark.parametrize(
    ("wanted", "says"),
    [
        (MissionOrigin(Origin(8.5455938, 47.3977418, 488.0)), "km from the mission's origin"),
        (MissionOrigin(Origin(-47.3977418, 8.5455938, 488.0)), "km from the mission's origin"),
        (MissionOrigin(Origin(-47.3977418, -171.4544062, 488.0)), "km from the mission's origin"),
        (MissionOrigin(away(9_000.0, 5_000.0)), "km from the mission's origin"),
        (MissionOrigin(away(9_000.0, 2_000.0)), ""),
        (MissionOrigin(away(0.0, 0.0, up=9.0), amsl=True), "would be 9.0 m too low"),
        (MissionOrigin(away(0.0, 0.0, up=-9.0), amsl=True), "would be 9.0 m too high"),
        (MissionOrigin(away(0.0, 0.0, up=4.0), amsl=True), ""),
        (MissionOrigin(away(0.0, 0.0, up=90.0)), ""),
        (MissionOrigin(away(5.0, 0.0), by_fixes=False), "home is 5.0 m from"),
        (MissionOrigin(away(2.0, 0.0), by_fixes=False), ""),
        (None, ""),
    ],
)
def test_a_mission_that_is_elsewhere_is_not_flown(wanted, says):
    found = misplacement(wanted, AT_HOME)
    assert says in found
    assert bool(found) == bool(says)


def test_a_misplaced_vehicle_gets_no_position_and_says_why_once():
    listening = Wanting(Origin(8.5455938, 47.3977418, 488.0))
    seen = [listening.see(HOME_POSITION=HOME, GPS_RAW_INT=FIX) for _ in range(3)]
    assert all(one.gnss is None for one in seen)
    assert ["km from" in " ".join(one.problems) for one in seen] == [True, False, False]
    assert listening.observer.start is None


def test_a_home_that_moves_in_flight_is_reported_and_moves_nothing():
    listening = Wanting(AT_HOME)
    listening.see(HEARTBEAT=DISARMED, HOME_POSITION=message(away(40.0, 0.0)))
    listening.see(HEARTBEAT=DISARMED, HOME_POSITION=HOME, GPS_RAW_INT=FIX)
    before = listening.see(HEARTBEAT=ARMED, GPS_RAW_INT=FIX).gnss
    seen = listening.see(HOME_POSITION=message(away(25.0, 0.0)), GPS_RAW_INT=FIX)
    assert seen.events == ("home_moved",)
    assert "home has moved by 25.0 m" in seen.problems[0]
    np.testing.assert_allclose(seen.gnss.position, before.position)
    assert listening.see(HOME_POSITION=message(away(25.0, 0.0))).events == ()


def test_positions_follow_a_local_frame_that_moved():
    listening = Wanting(AT_HOME)
    before = message(away(-10.0, 0.0))
    listening.see(HEARTBEAT=DISARMED, HOME_POSITION={**HOME, "x": 10.0}, GPS_GLOBAL_ORIGIN=before)
    listening.see(HEARTBEAT=ARMED)
    np.testing.assert_allclose(listening.observer.start, (10.0, 0.0, 0.0), atol=0.05)
    seen = listening.see(GPS_GLOBAL_ORIGIN=message(away(50.0, 0.0)))
    assert seen.events == ("origin_moved",)
    assert "local frame has moved by 60.0 m" in seen.problems[0]
    np.testing.assert_allclose(listening.observer.start, (-50.0, 0.0, 0.0), atol=0.05)
    listening.see(HOME_POSITION={**HOME, "x": 10.0})  # of the old frame still
    np.testing.assert_allclose(listening.observer.start, (-50.0, 0.0, 0.0), atol=0.05)
