"""A real camera, a video file or a network stream, through OpenCV."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import cv2
import numpy as np
from typing_extensions import override

from missionkit.messages import Frame
from missionkit.vehicle.camera import Surroundings, ThreadedCamera
from missionkit.vehicle.timing import wall

AGAIN = 1.0  # s until a camera that went away is opened again


class Capture(Protocol):
    """What OpenCV's VideoCapture offers."""

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        """Whether it could be opened."""

    def read(self) -> tuple[bool, Any]:
        """Wait for the next image."""

    def release(self) -> None:
        """Let go of it."""


def opened(source: int | str) -> Capture:
    """Return a capture of a device number, file or URL that keeps no old images."""
    capture: Any = cv2.VideoCapture(source)
    capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
    return capture  # type: ignore[no-any-return]


class Device(ThreadedCamera):
    """Captures as fast as images come; the newest counts, and a camera that goes away is reopened.

    Args:
        open_: opens the camera.
        latency: s between the middle of the exposure and the moment the image is there.
        width: of the images the mission was calibrated for (px).
        height: of these.
        period: s between images of a source that does not wait by itself, a file; else 0.
    """

    def __init__(
        self,
        open_: Callable[[], Capture],
        latency: float,
        width: int,
        height: int,
        period: float = 0.0,
    ) -> None:
        super().__init__()
        self._open = open_
        self._latency = latency
        self._size = (height, width)
        self._period = period
        self.problem = ""  # what is wrong with it now
        self.opened = 0  # times

    @override
    def work(self, around: Surroundings) -> None:
        while not self.ended(0.0):
            capture = self._open()
            self.opened += 1
            try:
                if capture.isOpened():
                    self._watch(capture, around)
                else:
                    self.problem = "it cannot be opened"
            except cv2.error as error:
                self.problem = str(error)
            finally:
                capture.release()
            if self.ended(AGAIN):
                return

    def _watch(self, capture: Capture, around: Surroundings) -> None:
        """Take images until none comes any more."""
        while not self.ended(self._period):
            came, image = capture.read()
            at = around.mission_time(wall() - self._latency)
            if not came:
                self.problem = "it gives no more images"
                return
            if image.shape[:2] != self._size:
                seen = f"{image.shape[1]} x {image.shape[0]}"
                self.problem = f"its images are {seen}, not {self._size[1]} x {self._size[0]}"
                return
            if at is not None:
                self.problem = ""
                self.give(Frame(at, np.ascontiguousarray(image, dtype=np.uint8)))
