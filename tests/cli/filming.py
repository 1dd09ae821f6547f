"""Markers on a wall, films of them, a camera's driver, and the command that looks at them."""

from __future__ import annotations

import cv2
import numpy as np
import typer.testing

from missionkit.cli.camera_commands import camera
from missionkit.perception.opencv_helpers import marker_bitmap

MARKED = """\
missionkit: 1
mission: desk
camera: {use: device, source: %s, focal: 628, rate: 25, latency: 0.05}
targets: {desk: {position: [1, 0, 0]}}
perception:
  - {use: aruco, target: desk, id: 23, size: 0.1}
  - {use: aruco, target: desk, id: 7, size: 0.1}
initial: idle
states:
  idle: {kind: idle, behavior: take_off, transitions: [{to: land, when: done}]}
  land: {kind: land}
"""


def call(*words):
    result = typer.testing.CliRunner().invoke(camera, [str(it) for it in words])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def wall_with(number, edge=100, size=(640, 480)):
    """Return an image of a marker with an edge (px) in its middle."""
    picture = np.full((size[1], size[0]), 220, np.uint8)
    row, column = (size[1] - edge) // 2, (size[0] - edge) // 2
    picture[row : row + edge, column : column + edge] = marker_bitmap("DICT_6X6_250", number, edge)
    return cv2.cvtColor(cv2.GaussianBlur(picture, (0, 0), 0.6), cv2.COLOR_GRAY2BGR)


def film(path, pictures):
    height, width = pictures[0].shape[:2]
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 20.0, (width, height))
    for it in pictures:
        writer.write(it if it.ndim == 3 else cv2.cvtColor(it, cv2.COLOR_GRAY2BGR))
    writer.release()


class Driver:
    """A capture that gives one image every 40 ms of its own clock, stamped 30 ms before."""

    def __init__(self, picture, stamps=False):
        self.picture, self.stamps, self.asked, self.now = picture, stamps, [], 100.0

    def set(self, what, value):
        self.asked.append((what, value))
        return True

    def get(self, what):
        return 1e3 * (self.now - 0.03) if self.stamps and what == cv2.CAP_PROP_POS_MSEC else 0.0

    def read(self):
        self.now += 0.04
        return True, self.picture

    def release(self):
        pass
