"""Events of a real camera reach the mission, over the wire."""

import asyncio

import numpy as np
from vehicle.flying import flying, sitl

from missionkit.vehicle.camera import camera_device
from missionkit.vehicle.camera.camera_device import CaptureSettings, Device


class Reel:
    """A capture of so many images."""

    def __init__(self, images):
        self.left = images

    def isOpened(self):  # noqa: N802
        return self.left > 0

    def set(self, what, value):
        return False

    def read(self):
        self.left -= 1
        return self.left >= 0, np.full((48, 64, 3), self.left % 256, np.uint8)

    def release(self):
        pass


def test_a_mission_gets_events_when_its_camera_is_lost_and_found(tmp_path, monkeypatch):
    monkeypatch.setattr(camera_device, "REOPEN_AFTER", 0.05)
    reels = iter([Reel(5), Reel(0), Reel(10**9)])
    camera = Device(lambda: next(reels), CaptureSettings(64, 48, 100.0), 0.0, period=0.01)

    async def fly():
        with sitl() as autopilot:
            async with flying(autopilot, tmp_path, camera=camera) as flight:
                await flight.until(lambda: "camera_back" in flight.events)
                assert flight.vehicle.camera_problem == ""
                await flight.until(lambda: flight.seen[-1].frame is not None)
                return flight

    flight = asyncio.run(asyncio.wait_for(fly(), 60.0))
    assert [it for it in flight.events if it.startswith("camera")] == ["camera_gone", "camera_back"]
