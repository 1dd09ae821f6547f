"""The simulated gimbal: its rate, its limits, and that the picture does not blur by the body."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.geometry import from_euler, rotate
from missionkit.messages import GimbalAngles
from missionkit.perception.camera_section import Camera, Gimbal, Mount
from missionkit.sim.gimbal import SimulatedGimbal


def made():
    section = Gimbal(pitch_deg=(-90, 30), yaw_deg=(-90, 90), rate_deg=60, angle_sd_deg=0.0)
    return SimulatedGimbal(section, Mount(tilt_deg=10), np.random.default_rng(0))


def degrees(gimbal, now):
    return [math.degrees(it) for it in gimbal.measured(now)]


def test_it_turns_at_its_rate_up_to_its_limits():
    gimbal = made()
    assert degrees(gimbal, 0.0) == pytest.approx([-10.0, 0.0])
    gimbal.order(GimbalAngles(math.radians(-200.0), math.radians(150.0)), 1.0)
    assert degrees(gimbal, 1.5) == pytest.approx([-40.0, 30.0])
    gimbal.order(GimbalAngles(math.radians(-90.0), 0.0), 1.5)
    assert degrees(gimbal, 1.75) == pytest.approx([-55.0, 15.0])
    gimbal.order(GimbalAngles(math.radians(-200.0), math.radians(150.0)), 2.0)
    assert degrees(gimbal, 9.0) == pytest.approx([-90.0, 90.0])


def test_the_camera_turns_with_the_heading_and_its_motors_only():
    gimbal, x = made(), np.zeros(13)
    x[6:10] = from_euler(0.2, -0.1, 0.5)
    x[10:13] = (3.0, 0.0, 0.0)  # rolling
    heading_rate = rotate(x[6:10], x[10:13])[2]
    turning = rotate(x[6:10], gimbal.turned_state(x, 1.0)[10:13])
    assert turning == pytest.approx([0.0, 0.0, heading_rate], abs=1e-9)
    gimbal.order(GimbalAngles(math.radians(30.0), 0.0), 1.0)
    moved = rotate(x[6:10], gimbal.turned_state(x, 1.1)[10:13])
    assert np.linalg.norm(moved[:2]) == pytest.approx(math.radians(60.0))


@pytest.mark.parametrize(
    ("camera", "why"),
    [
        ({"mount": {"roll_deg": 10}}, "keeps it level"),
        ({"mount": {"pan_deg": 100}}, "rests at yaw_deg 100"),
        ({"gimbal": {"pitch_deg": (10, -10)}}, "least, most"),
        ({"gimbal": {"pitch_deg": (-120, 0)}}, "within -90"),
    ],
)
def test_a_gimbal_that_cannot_be_is_refused(camera, why):
    with pytest.raises(ValueError, match=why):
        Camera(**{"gimbal": {}, **camera})
