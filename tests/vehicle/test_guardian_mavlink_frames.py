"""MAVLink frames by hand, against pymavlink."""

import numpy as np
import pytest

from missionkit.sitl.pymavlink_dialect import mavlink
from missionkit.vehicle.autopilot_dialect import PX4
from missionkit.vehicle.guardian import mavlink_frames
from missionkit.vehicle.guardian.mavlink_frames import FrameRoute, MavlinkFrame

HEARTBEAT = mavlink.MAVLink_heartbeat_message(2, 12, 0x81, 6 << 16, 4, 3)
POSITION = mavlink.MAVLink_local_position_ned_message(9, 1.0, 2.0, 3.0, 3.0, 4.0, 0.0)
LAND = mavlink.MAVLink_command_long_message(1, 1, 21, 0, 0, 0, 0, 0, 0, 0, 0)
MODE = mavlink.MAVLink_command_int_message(1, 1, 0, 176, 0, 0, 1.0, 6.0, 0, 0, 0, 0, 0)
VELOCITY = mavlink.MAVLink_set_position_target_local_ned_message(
    9, 7, 1, 1, 0x5C7, 0, 0, 0, 2.0, 0, 0, 0, 0, 0, 0, 0.1
)
ATTITUDE = mavlink.MAVLink_set_attitude_target_message(9, 7, 1, 7, [1.0, 0, 0, 0], 0, 0, 0, 0.5)
GLOBAL = mavlink.MAVLink_set_position_target_global_int_message(
    9, 7, 1, 6, 0x9F8, 1, 2, 3.0, 0, 0, 0, 0, 0, 0, 0, 0
)
IMU = mavlink.MAVLink_highres_imu_message(1, *(1.0,) * 13, 0x1FF)
ALL = (HEARTBEAT, POSITION, LAND, MODE, VELOCITY, ATTITUDE, GLOBAL, IMU)


def packed(message, version=2, system=1, component=1):
    mav = mavlink.MAVLink(None, system, component)
    return message.pack(mav, force_mavlink1=version == 1)


def said(message, version=2):
    return mavlink_frames.read(packed(message, version))


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("message", ALL, ids=lambda it: it.get_type())
def test_frames_are_found_and_read_as_pymavlink_writes_them(message, version):
    data = packed(message, version, 3, 4)
    assert mavlink_frames.split(data) == ([data], b"")
    assert mavlink_frames.ident_of(data) == message.get_msgId()
    read = mavlink_frames.read(data)
    if message is IMU:
        assert read is None
    else:
        assert (read.ident, read.system, read.component) == (message.get_msgId(), 3, 4)


def test_frames_are_found_in_pieces_and_between_noise():
    whole = [packed(message, 1 + number % 2) for number, message in enumerate(ALL)]
    stream = b"\x00\x17noise" + b"\x01\x02".join(whole)
    rng = np.random.default_rng(5)
    found, rest, at = [], b"", 0
    while at < len(stream):
        size = int(rng.integers(1, 30))
        more, rest = mavlink_frames.split(rest + stream[at : at + size])
        found += more
        at += size
    assert found == whole
    assert rest == b""


def test_a_damaged_frame_is_rejected():
    data = bytearray(packed(HEARTBEAT))
    data[12] ^= 1
    assert mavlink_frames.read(bytes(data)) is None


def test_what_matters_is_read():
    assert mavlink_frames.beat(said(HEARTBEAT)) == (6 << 16, 12, True)
    assert mavlink_frames.speed(said(POSITION)) == 5.0
    assert mavlink_frames.order(said(LAND)) == (21, 0.0, 0.0)
    assert mavlink_frames.order(said(MODE)) == (176, 1.0, 6.0)
    for message in (VELOCITY, ATTITUDE, GLOBAL):
        assert mavlink_frames.target(said(message)) == (7, 1)
    assert isinstance(said(HEARTBEAT, 1), MavlinkFrame)


def test_pymavlink_reads_the_frames_written():
    to = FrameRoute(245, 191, 7, 1)
    mav = mavlink.MAVLink(None)
    still, mode = mav.parse_buffer(
        mavlink_frames.still(to, 3, 77) + mavlink_frames.mode(to, 4, PX4.hold, 2)
    )
    assert (still.get_srcSystem(), still.get_srcComponent(), still.get_seq()) == (245, 191, 3)
    assert (still.target_system, still.type_mask, still.coordinate_frame) == (7, 0x5C7, 1)
    assert (still.vx, still.vy, still.vz, still.yaw_rate) == (0.0, 0.0, 0.0, 0.0)
    assert (mode.command, mode.param1, mode.param2, mode.param3) == (176, *PX4.hold)
    assert (mode.target_system, mode.target_component, mode.confirmation) == (7, 1, 2)
