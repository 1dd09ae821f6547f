import math

import numpy as np
import pytest

from missionkit.geodesy import Origin
from missionkit.geometry import vec
from missionkit.vehicle.autopilot_dialect import (
    ARDUPILOT,
    PX4,
    dialect_of,
    word,
)
from missionkit.vehicle.telemetry import message_readings
from missionkit.vehicle.telemetry.status_text import event_of

HOME = Origin(47.3977418, 8.5455938, 488.0)
HIGHRES = {
    "xacc": 0.1, "yacc": -0.2, "zacc": -9.8, "xgyro": 0.01, "ygyro": 0.02, "zgyro": 0.03,
    "xmag": 0.2, "ymag": 0.0, "zmag": 0.4, "pressure_alt": 490.0, "fields_updated": 0x1FFF,
}  # fmt: skip
FIX = {
    "fix_type": 3, "lat": 473977418, "lon": 85455938, "alt": 498000, "vel": 500, "cog": 9000,
    "h_acc": 1500, "v_acc": 2500, "vel_acc": 80, "satellites_visible": 12,
}  # fmt: skip


def test_inertial_sample_field_and_height_are_read():
    sample = message_readings.imu(HIGHRES, 3.0)
    assert sample.at == 3.0
    np.testing.assert_allclose(sample.accel, (0.1, -0.2, -9.8))
    np.testing.assert_allclose(sample.gyro, (0.01, 0.02, 0.03))
    assert np.linalg.norm(message_readings.magnetometer(HIGHRES, 3.0).field) == pytest.approx(1.0)
    assert message_readings.baro(HIGHRES, 3.0, 488.0).height == pytest.approx(2.0)


@pytest.mark.parametrize("name", ["xacc", "zgyro"])
def test_a_sample_with_an_unknown_part_is_dropped(name):
    assert message_readings.imu({**HIGHRES, name: None}, 3.0) is None


def test_what_the_sensor_has_not_updated_is_not_read_again():
    old = {**HIGHRES, "fields_updated": 0x3F}
    assert message_readings.magnetometer(old, 3.0) is None
    assert message_readings.baro(old, 3.0, 488.0) is None


def test_a_fix_is_read_in_metres_from_home():
    fix = message_readings.gnss(FIX, 3.0, HOME, climb=1.5)
    np.testing.assert_allclose(fix.position, (0.0, 0.0, -10.0), atol=0.02)
    np.testing.assert_allclose(fix.velocity, (0.0, 5.0, -1.5), atol=1e-9)
    np.testing.assert_allclose(fix.position_sd, (1.5, 1.5, 2.5))
    np.testing.assert_allclose(fix.velocity_sd, 0.08)


def test_no_fix_gives_no_reading_and_unknown_accuracy_is_coarse():
    assert message_readings.gnss({**FIX, "fix_type": 2}, 3.0, HOME, 0.0) is None
    assert message_readings.gnss({**FIX, "h_acc": 0}, 3.0, HOME, 0.0).position_sd[0] == 2.5


@pytest.mark.parametrize("unknown", [{"cog": 65535}, {"vel": 65535}, {"vel": 65535, "cog": 65535}])
def test_a_part_that_the_receiver_does_not_know_leaves_the_rest(unknown):
    fix = message_readings.gnss({**FIX, **unknown}, 3.0, HOME, climb=1.5)
    np.testing.assert_allclose(fix.position, (0.0, 0.0, -10.0), atol=0.02)
    assert fix.velocity is None


def test_standing_still_needs_no_course():
    fix = message_readings.gnss({**FIX, "vel": 0, "cog": 65535}, 3.0, HOME, climb=0.0)
    np.testing.assert_array_equal(fix.velocity, 0.0)


def test_an_unknown_climb_rate_is_not_sent_as_zero():
    fix = message_readings.gnss(FIX, 3.0, HOME, climb=None)
    np.testing.assert_allclose(fix.velocity[:2], (0.0, 5.0), atol=1e-9)
    np.testing.assert_array_equal(fix.velocity_sd, (0.08, 0.08, math.inf))


@pytest.mark.parametrize("latitude", [-60.0, 0.0, 47.0, 80.0])
def test_places_and_metres_agree_in_both_directions(latitude):
    home = Origin(latitude, 179.9999, 100.0)
    point = vec(350.0, -720.0, -30.0)
    np.testing.assert_allclose(home.local(*home.place(point)), point, atol=1e-6)


@pytest.mark.parametrize(("longitude", "east"), [(179.9999, 40.0), (-179.9999, -40.0)])
def test_a_place_beyond_the_antimeridian_has_a_longitude_that_exists(longitude, east):
    home = Origin(0.0, longitude, 0.0)
    found = home.place(vec(0.0, east, 0.0))[1]
    assert abs(found) <= 180.0
    assert found * longitude < 0.0


def test_metres_agree_with_the_length_of_a_degree():
    """Lengths of one degree at 45 degrees north on WGS 84: 111,131.8 m and 78,846.8 m."""
    north = Origin(45.0, 10.0, 0.0).local(45.001, 10.001, 0.0)
    np.testing.assert_allclose(north[:2], (111.1318, 78.8468), rtol=2e-5)


def test_modes_have_the_missions_names():
    assert word(PX4, 6 << 16) == "offboard"
    assert word(PX4, 4 << 16 | 3 << 24) == "hold"
    assert word(ARDUPILOT, 9) == "land"
    assert word(ARDUPILOT, 99) == "mode_63"


def test_the_heartbeat_identifies_the_dialect():
    assert dialect_of(12) is PX4
    assert dialect_of(3) is ARDUPILOT
    assert dialect_of(8) is None


def test_status_texts_become_events():
    assert event_of(2, "PreArm: GPS 1: Bad fix") == "status.critical.PreArm_GPS_1_Bad_fix"
    assert event_of(6, "---") == "status.info.nothing"
