import threading

import numpy as np

from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.messages import Frame
from missionkit.vehicle import device
from missionkit.vehicle.camera import Rendered
from missionkit.vehicle.device import Device
from missionkit.vehicle.pose import Pose

ZERO = vec(0.0, 0.0, 0.0)


class Around:
    """A vehicle that goes north with every look at it."""

    def __init__(self, step=0.02):
        self.looks, self.step = 0, step

    def pose(self):
        self.looks += 1
        if self.looks == 1:
            return None
        at = self.looks * self.step
        return Pose(at, Transform(IDENTITY, vec(at, 0.0, 0.0)), ZERO, ZERO)

    def mission_time(self, wall_time):
        return wall_time


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
    camera = Rendered(lambda pose, at: Frame(at, None), 20.0)
    camera.give(Frame(1.0, None))
    assert camera.latest(0.9) is None
    camera.give(Frame(1.1, None))
    assert camera.latest(1.2).at == 1.1
    assert camera.latest(1.2) is None


class Film:
    """A capture of a few images of one shape."""

    def __init__(self, images, shape=(48, 64, 3), opens=True):
        self.left, self.shape, self.opens, self.released = images, shape, opens, False

    def isOpened(self):  # noqa: N802
        return self.opens

    def read(self):
        if self.left == 0:
            return False, None
        self.left -= 1
        return True, np.full(self.shape, self.left % 256, np.uint8)

    def release(self):
        self.released = True


def watched(films, **options):
    reels = iter(films)
    return Device(lambda: next(reels), latency=0.1, width=64, height=48, **options)


def test_a_camera_that_goes_away_is_opened_again(monkeypatch):
    monkeypatch.setattr(device, "AGAIN", 0.01)
    films = [Film(2), Film(0, opens=False), Film(10**9)]
    camera = watched(films)
    camera.start(Around())
    try:
        for _ in range(2000):
            if camera.opened == 3:
                break
            threading.Event().wait(0.001)
        assert taken(camera, 2)[1].image.shape == (48, 64, 3)
    finally:
        camera.stop()
    assert all(film.released for film in films)


def test_images_are_stamped_with_the_middle_of_their_exposure():
    camera = watched([Film(10**9)])
    camera.start(Around())
    try:
        (frame,) = taken(camera, 1)
        assert 0.0 < device.wall() - frame.at - 0.1 < 1.0
    finally:
        camera.stop()


def test_images_of_another_size_than_calibrated_are_refused_with_a_sentence():
    camera = watched([Film(1, shape=(24, 32, 3))])
    camera.start(Around())
    try:
        for _ in range(2000):
            if camera.problem:
                break
            threading.Event().wait(0.001)
    finally:
        camera.stop()
    assert camera.problem == "its images are 32 x 24, not 64 x 48"
    assert camera.latest(1e9) is None


def test_a_video_file_is_read_through_opencv(tmp_path):
    import cv2  # noqa: PLC0415

    path = str(tmp_path / "film.avi")
    film = cv2.VideoWriter(path, cv2.VideoWriter_fourcc(*"MJPG"), 20.0, (64, 48))
    for grey in range(0, 200, 20):
        film.write(np.full((48, 64, 3), grey, np.uint8))
    film.release()
    camera = Device(lambda: device.opened(path), 0.0, 64, 48, period=0.005)
    camera.start(Around())
    try:
        frames = taken(camera, 3)
    finally:
        camera.stop()
    greys = [float(frame.image.mean()) for frame in frames]
    assert greys == sorted(greys)
    assert greys[0] < greys[-1]
