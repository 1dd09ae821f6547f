"""The gimbal of the simulated autopilot."""

from __future__ import annotations

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.geometry import to_euler

QUIET = True
ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
STATUS = mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS


def status(station):
    """Pitch and yaw (deg) as it reports them."""
    assert station.command(mavlink.MAV_CMD_REQUEST_MESSAGE, STATUS) == ACCEPTED
    q = station.last("GIMBAL_DEVICE_ATTITUDE_STATUS").q
    return [math.degrees(it) for it in to_euler(q)[1:]]


def test_it_turns_for_who_has_control(either):
    order = (mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, -60, 30, math.nan, math.nan, 44)
    assert either.command(*order) == (DENIED if either.px4 else ACCEPTED)
    assert either.command(mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE, -2, -2, -1, -1) == ACCEPTED
    assert either.command(*order) == ACCEPTED
    either.run(0.5)
    assert status(either) == pytest.approx([-30.0, 30.0], abs=0.7)
    either.run(1.0)
    assert status(either) == pytest.approx([-60.0, 30.0], abs=1e-3)


def test_it_knows_the_old_command(either):
    mount = mavlink.MAV_CMD_DO_MOUNT_CONTROL
    assert either.command(mount, -45, 0, -20, 0, 0, 0, 2) == ACCEPTED
    either.run(2.0)
    assert status(either) == pytest.approx([-45.0, -20.0], abs=1e-3)
    assert either.command(mount, 0, 0, 0, 0, 0, 0, 4) == DENIED
