import socket
import threading
from contextlib import contextmanager
from pathlib import Path

import cv2
import numpy as np
from rehearsed import short

from missionkit.api import vehicle_camera
from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.messages import Frame
from missionkit.sim.world import World
from missionkit.vehicle.camera import camera_device
from missionkit.vehicle.camera.camera_device import CaptureSettings, Device
from missionkit.vehicle.camera.frame_source import Rendered
from missionkit.vehicle.telemetry.reported_pose import Pose

ZERO = vec(0.0, 0.0, 0.0)


class Around:
    """A vehicle that goes north with every look at it."""

    def __init__(self, step=0.02):
        self.looks, self.step, self.events = 0, step, []

    def pose(self):
        self.looks += 1
        if self.looks == 1:
            return None
        at = self.looks * self.step
        return Pose(at, Transform(IDENTITY, vec(at, 0.0, 0.0)), ZERO, ZERO)

    def mission_time(self, wall_time):
        return wall_time

    def note(self, event):
        self.events.append(event)


def taken(camera, count, now=1e9):
    """Wait for so many frames."""
    frames, tick = [], threading.Event()
    for _ in range(2000):
        frame = camera.latest(now)
        if frame is not None:
            frames.append(frame)
        if len(frames) == count:
            return frames
        tick.wait(0.001)
    raise AssertionError(f"only {len(frames)} frames")


def test_a_drawn_frame_has_the_time_of_the_pose_it_was_drawn_from():
    camera = Rendered(lambda pose, at: Frame(0.0, None, (("d", 1, pose.body.translation),)), 20.0)
    camera.start(Around())
    try:
        frames = taken(camera, 5)
    finally:
        camera.stop()
    assert all(frame.corners[0][2][0] == frame.at for frame in frames)
    assert min(np.diff([frame.at for frame in frames])) >= 0.045


def test_a_frame_from_after_the_tick_waits_and_the_latest_wins():
    camera = Rendered(lambda _, at: Frame(at, None), 20.0)
    for at in (0.8, 1.0, 1.1, 1.3):
        camera.give(Frame(at, None))
    assert camera.latest(0.7) is None
    assert camera.latest(1.2).at == 1.1
    assert camera.latest(1.2) is None
    assert camera.latest(1.3).at == 1.3


class Film:
    """A capture of a few images of one shape; a driver that can may be asked for another."""

    def __init__(self, images, shape=(48, 64, 3), opens=True, obeys=False):
        self.left, self.shape, self.opens, self.released = images, shape, opens, False
        self.obeys, self.asked = obeys, {}

    def isOpened(self):  # noqa: N802
        return self.opens

    def set(self, what, value):
        self.asked[what] = value
        height, width, _ = self.shape
        if self.obeys and what == cv2.CAP_PROP_FRAME_WIDTH:
            self.shape = (height, int(value), 3)
        if self.obeys and what == cv2.CAP_PROP_FRAME_HEIGHT:
            self.shape = (int(value), width, 3)
        return self.obeys

    def read(self):
        if self.left == 0:
            return False, None
        self.left -= 1
        return True, np.full(self.shape, self.left % 256, np.uint8)

    def release(self):
        self.released = True


def watched(films, **options):
    reels = iter(films)
    return Device(lambda: next(reels), CaptureSettings(64, 48, 25.0), latency=0.1, **options)


@contextmanager
def running(camera):
    around = Around()
    camera.start(around)
    try:
        yield around
    finally:
        camera.stop()


def wait(holds):
    for _ in range(20_000):
        if holds():
            return
        threading.Event().wait(0.001)
    raise AssertionError("in vain")


def test_a_lost_camera_is_reopened_and_the_mission_gets_both_events(monkeypatch):
    monkeypatch.setattr(camera_device, "REOPEN_AFTER", 0.01)
    films = [Film(2), Film(0, opens=False), Film(10**9)]
    camera = watched(films)
    with running(camera) as around:
        wait(lambda: camera.opened == 3)
        assert taken(camera, 2)[1].image.shape == (48, 64, 3)
        assert around.events == ["camera_gone", "camera_back"]
        assert camera.problem == ""
    assert all(film.released for film in films)


def test_a_missing_camera_is_reported_lost_once_with_its_reason(monkeypatch):
    monkeypatch.setattr(camera_device, "REOPEN_AFTER", 0.001)
    camera = watched([Film(0, opens=False) for _ in range(4000)])
    with running(camera) as around:
        wait(lambda: camera.opened > 5)
        assert around.events == ["camera_gone"]
        assert camera.problem == "it cannot be opened"


def test_the_missions_image_size_is_requested_from_the_driver():
    film = Film(10**9, shape=(24, 32, 3), obeys=True)
    camera = watched([film])
    with running(camera):
        (frame,) = taken(camera, 1)
    assert frame.image.shape == (48, 64, 3)
    assert film.asked == {
        cv2.CAP_PROP_FRAME_WIDTH: 64,
        cv2.CAP_PROP_FRAME_HEIGHT: 48,
        cv2.CAP_PROP_FPS: 25.0,
    }


def test_images_are_stamped_with_the_middle_of_their_exposure():
    camera = watched([Film(10**9)])
    with running(camera):
        (frame,) = taken(camera, 1)
        assert 0.0 < camera_device.wall() - frame.at - 0.1 < 1.0


def test_images_of_another_size_than_calibrated_are_refused_once_with_a_sentence(monkeypatch):
    monkeypatch.setattr(camera_device, "REOPEN_AFTER", 0.001)
    camera = watched([Film(1, shape=(24, 32, 3)) for _ in range(4000)])
    with running(camera) as around:
        wait(lambda: camera.opened > 5)
        assert camera.problem == "its images are 32 x 24, not 64 x 48"
        assert camera.latest(1e9) is None
        assert around.events == ["camera_gone"]


def test_a_video_file_is_read_through_opencv(tmp_path):
    path = str(tmp_path / "film.avi")
    film = cv2.VideoWriter(path, cv2.VideoWriter_fourcc(*"MJPG"), 20.0, (64, 48))
    for grey in range(0, 200, 20):
        film.write(np.full((48, 64, 3), grey, np.uint8))
    film.release()
    camera = Device(
        lambda: camera_device.opened(path), CaptureSettings(64, 48, 20.0), 0.0, period=0.005
    )
    with running(camera):
        frames = taken(camera, 3)
    greys = [float(frame.image.mean()) for frame in frames]
    assert greys == sorted(greys)
    assert greys[0] < greys[-1]


def test_a_stream_that_never_answers_does_not_keep_the_camera_for_long(monkeypatch):
    monkeypatch.setattr(camera_device, "STREAM_TIMEOUT", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as mute:
        address = "http://{}:{}/stream".format(*mute.getsockname())
        before = camera_device.wall()
        assert not camera_device.opened(address).isOpened()
        assert camera_device.wall() - before < 10.0  # without a limit it is 30


def test_a_drawn_camera_has_drawn_once_before_the_flight(monkeypatch):
    drawn = []
    monkeypatch.setattr(vehicle_camera, "painter_of", lambda *_: lambda _, at: drawn.append(at))
    mission = short("initial: a\nstates: {a: {kind: land}}\n")
    eye = mission.camera.model_copy(update={"use": "corners"})
    mission = mission.model_copy(update={"camera": eye})
    vehicle_camera.camera_of(mission, Path(), World(world="empty"))
    assert drawn == [0.0]
