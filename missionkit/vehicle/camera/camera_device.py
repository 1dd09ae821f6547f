"""A real camera, a video file or a network stream, through OpenCV."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import cv2
import numpy as np
from typing_extensions import override

from missionkit.messages import Frame
from missionkit.vehicle.camera.frame_source import CameraCarrier, ThreadedCamera
from missionkit.vehicle.link.clocks import wall

REOPEN_AFTER = 1.0  # s until a camera that went away is opened again
STREAM_TIMEOUT = 5.0  # s to wait for a stream, at its opening and for an image
CAMERA_GONE, CAMERA_BACK = "camera_gone", "camera_back"  # events

# We report a failure to open once; OpenCV would print it at every attempt.
os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_ERROR)


class OpencvCapture(Protocol):
    """Interface of OpenCV's VideoCapture."""

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        """Whether it could be opened."""

    def set(self, what: int, value: float) -> bool:
        """Ask the driver for a property."""

    def get(self, what: int) -> float:
        """Return a property."""

    def read(self) -> tuple[bool, Any]:
        """Wait for the next image."""

    def release(self) -> None:
        """Let go of it."""


class CaptureSettings(NamedTuple):
    """The images that a mission was calibrated for."""

    width: int  # px
    height: int  # px
    rate: float  # images a second


def opened(source: int | str) -> OpencvCapture:
    """Return a capture of a device number, file or URL that keeps no old images."""
    if isinstance(source, str) and "://" in source:
        patience = int(1e3 * STREAM_TIMEOUT)
        limits = [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, patience]
        limits += [cv2.CAP_PROP_READ_TIMEOUT_MSEC, patience]
        stream: OpencvCapture = cv2.VideoCapture(source, cv2.CAP_ANY, limits)
        return stream
    capture: OpencvCapture = cv2.VideoCapture(source)
    capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
    return capture


def ask(capture: OpencvCapture, wanted: CaptureSettings) -> None:
    """Ask the driver for the images a mission wants; what it gives is seen in the first of them."""
    capture.set(cv2.CAP_PROP_FRAME_WIDTH, wanted.width)
    capture.set(cv2.CAP_PROP_FRAME_HEIGHT, wanted.height)
    capture.set(cv2.CAP_PROP_FPS, wanted.rate)


def unfit(image: Any, wanted: CaptureSettings) -> str:
    """Return what is wrong with the size of an image, "" if nothing is."""
    height, width = image.shape[:2]
    if (width, height) == (wanted.width, wanted.height):
        return ""
    return f"its images are {width} x {height}, not {wanted.width} x {wanted.height}"


class Device(ThreadedCamera):
    """Captures as fast as images come; the newest counts, and a camera that goes away is reopened.

    The mission gets the events `camera_gone` and `camera_back`; `problem` says what is wrong.

    Args:
        open_: opens the camera.
        wanted: settings requested from the driver; images of another size are refused.
        latency: s between the middle of the exposure and the moment the image is there.
        period: s between images of a source that does not wait by itself, a file; else 0.
    """

    def __init__(
        self,
        open_: Callable[[], OpencvCapture],
        wanted: CaptureSettings,
        latency: float,
        period: float = 0.0,
    ) -> None:
        super().__init__()
        self._open = open_
        self._wanted = wanted
        self._latency = latency
        self._period = period
        self.opened = 0  # times

    @override
    def work(self, around: CameraCarrier) -> None:
        while not self.ended(0.0):
            capture = self._open()
            self.opened += 1
            try:
                if capture.isOpened():
                    ask(capture, self._wanted)
                    wrong = self._watch(capture, around)
                else:
                    wrong = "it cannot be opened"
            except cv2.error as error:
                wrong = " ".join(str(error).split())
            finally:
                capture.release()
            self._now(wrong, around)
            if self.ended(REOPEN_AFTER):
                return

    def _watch(self, capture: OpencvCapture, around: CameraCarrier) -> str:
        """Take images until none comes any more; return why."""
        while not self.ended(self._period):
            came, image = capture.read()
            at = around.mission_time(wall() - self._latency)
            if not came:
                return "it gives no more images"
            if wrong := unfit(image, self._wanted):
                return wrong
            if at is not None:
                self._now("", around)
                self.give(Frame(at, np.ascontiguousarray(image, dtype=np.uint8)))
        return self.problem

    def _now(self, problem: str, around: CameraCarrier) -> None:
        """Keep the current problem; the mission gets an event when it begins and ends."""
        before, self.problem = self.problem, problem
        if bool(problem) != bool(before):
            around.note(CAMERA_GONE if problem else CAMERA_BACK)
