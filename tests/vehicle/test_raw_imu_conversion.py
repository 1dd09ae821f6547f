import pytest

from missionkit.vehicle.telemetry import message_readings
from missionkit.vehicle.telemetry.raw_imu_conversion import RawImuConverter, pressure_altitude

RAW = {
    "time_usec": 5_000_000, "xacc": 100, "yacc": 0, "zacc": -1000,
    "xgyro": 10, "ygyro": -20, "zgyro": 0, "xmag": 300, "ymag": 0, "zmag": 400,
}  # fmt: skip


def given(*messages):
    came = []
    scaled = RawImuConverter(lambda name, fields: came.append((name, fields)))
    for name, fields in messages:
        scaled(name, fields)
    return came


def test_raw_numbers_become_the_units_of_an_inertial_sample():
    (_, _), (name, fields) = given(("RAW_IMU", RAW))
    sample, field = message_readings.imu(fields, 1.0), message_readings.magnetometer(fields, 1.0)
    assert name == "HIGHRES_IMU"
    assert sample.accel == pytest.approx([0.980665, 0.0, -9.80665])
    assert sample.gyro == pytest.approx([0.01, -0.02, 0.0])
    assert field.field == pytest.approx([0.6, 0.0, 0.8])
    assert fields["time_usec"] == RAW["time_usec"]


def test_a_pressure_is_sent_once():
    pressure = ("SCALED_PRESSURE", {"press_abs": 954.61})  # 500 m in the ICAO atmosphere
    came = [it for name, it in given(pressure, ("RAW_IMU", RAW), ("RAW_IMU", RAW)) if "xacc" in it]
    heights = [message_readings.pressure_height(it) for it in came if "pressure_alt" in it]
    assert heights == [pytest.approx(500.0, abs=0.5), None]


def test_other_messages_pass_unchanged_and_a_broken_pressure_is_survived():
    assert given(("HEARTBEAT", {"type": 2})) == [("HEARTBEAT", {"type": 2})]
    assert pressure_altitude(-1.0) == pytest.approx(44330.77)
