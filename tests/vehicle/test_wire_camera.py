"""A camera that is unplugged in flight and plugged in again: missed, reopened, believed."""

import numpy as np
from vehicle.flying import sitl
from vehicle.on_a_mission import fly_mission

from missionkit.engine.flight_end import FlightEnd
from missionkit.perception.opencv_helpers import marker_bitmap
from missionkit.vehicle.camera import camera_device
from missionkit.vehicle.camera.camera_device import CaptureSettings, Device

LOOK = """
missionkit: 1
mission: stay
camera: {use: device, source: 0, width: 320, height: 240, focal: 277, rate: 5}
dwell: 0.5
targets: {pole: {position: [4.0, 0.0, -3.0], facing_deg: 180}}
perception:
  - {use: aruco, target: pole, dictionary: DICT_6X6_250, id: 23, size: 0.6}
guards:
  sure: {use: aruco_confidence, target: pole, window: 10}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 3.0}
    transitions: [{to: up, when: done}]
  up:
    kind: custom
    behavior: hold
    transitions: [{to: seeing, when: sure}, {to: land, after: 120}]
  seeing:
    kind: custom
    behavior: hold
    transitions: [{to: blind, when: {not: sure}}, {to: land, after: 120}]
  blind:
    kind: custom
    behavior: hold
    transitions: [{to: again, when: sure}, {to: land, after: 120}]
  again:
    kind: custom
    behavior: hold
    transitions: [{to: land, after: 1}]
  land:
    kind: land
"""


def scene():
    """Return the marker as it hangs 4 m ahead."""
    image = np.full((240, 320, 3), 255, np.uint8)
    image[99:141, 139:181] = marker_bitmap("DICT_6X6_250", 23, 42)[..., None]
    return image


class Plug:
    """A capture that works while it is plugged in."""

    def __init__(self):
        self.here, self.opened, self.count = True, 0, 0
        self.scene = scene()

    def __call__(self):
        self.opened += 1
        return self

    def isOpened(self):  # noqa: N802
        return self.here

    def set(self, what, value):
        return False

    def read(self):
        self.count += 1
        image = self.scene.copy()
        image[0, 0] = self.count % 256  # no two are the same: a frozen camera is another fault
        return self.here, image

    def release(self):
        pass


def test_a_lost_camera_is_noticed_reopened_and_trusted_again(tmp_path, monkeypatch):
    monkeypatch.setattr(camera_device, "REOPEN_AFTER", 0.05)
    plug = Plug()

    def pull(mission):
        plug.here = False

    def push(mission):
        plug.here = True

    with sitl(speed=4.0) as autopilot:
        period = 0.2 / autopilot.speed
        camera = Device(plug, CaptureSettings(320, 240, 5.0), 0.0, period=period)
        strikes = {"seeing": pull, "blind": push}
        mission = fly_mission(autopilot, LOOK, tmp_path, strikes, camera=camera)
        truth = autopilot.truth
    assert mission.states == ["idle", "up", "seeing", "blind", "again", "land"]
    assert mission.events["camera_gone"] < mission.events["camera_back"]
    assert plug.opened > 1
    assert mission.flown.end is FlightEnd.LANDED
    assert np.hypot(*truth["position"][:2]) < 1.5
    assert not truth["crashed"]
