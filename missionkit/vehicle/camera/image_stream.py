"""The images of a source one after the other, to calibrate and check a camera.

In a flight `camera_device` captures instead, in a thread of its own.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import cv2

from missionkit.errors import UsageError
from missionkit.messages import Image
from missionkit.perception.image_files import read
from missionkit.vehicle.camera.camera_device import (
    CaptureSettings,
    OpencvCapture,
    ask,
    opened,
)
from missionkit.vehicle.camera.image_source import is_device
from missionkit.vehicle.link.clocks import wall

FOREIGN_CLOCK_AGE = 5.0  # s; a stamp that is further away is on another clock


class TakenImage(NamedTuple):
    """An image of a camera."""

    image: Image
    at: float  # s, wall, when it was there
    age: float | None  # s since the driver stamped it; None: it does not


def images(source: int | str, wanted: CaptureSettings | None = None) -> Iterator[TakenImage]:
    """Yield the images of a picture, a film, a device or a stream until no more come.

    Args:
        source: number of a device, path or URL.
        wanted: settings requested from the driver.

    Raises:
        UsageError: not a single one comes.
    """
    picture = read(source) if isinstance(source, str) else None
    if picture is not None:
        yield TakenImage(picture, wall(), None)
        return
    capture = opened(source)
    try:
        if wanted is not None:
            ask(capture, wanted)
        came, image = capture.read()
        if not came:
            raise UsageError(f"{source}: no image comes from it{_hint(source)}")
        while came:
            yield _taken(capture, image, stamped=is_device(source))
            came, image = capture.read()
    finally:
        capture.release()


def _taken(capture: OpencvCapture, image: Any, *, stamped: bool) -> TakenImage:
    """Note the age of an image; the drivers of Linux stamp with the clock that `wall` reads."""
    at = wall()
    age = at - 1e-3 * capture.get(cv2.CAP_PROP_POS_MSEC) if stamped else None
    return TakenImage(
        image, at, age if age is not None and 0.0 <= age < FOREIGN_CLOCK_AGE else None
    )


def _hint(source: int | str) -> str:
    if is_device(source):
        return ": is it plugged in, and does no other program use it?"
    if isinstance(source, str) and "://" in source:
        return ": does it stream, and can this computer reach it?"
    return ": is it an image, a video or a stream?"
