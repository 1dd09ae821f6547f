"""A drawn photograph: six markers on a wall full of clutter, through a lens, soft and noisy.

`PHOTO` is a real one of the same kind, which lies beside some checkouts.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import cv2
import numpy as np

from missionkit.geometry import Mat, Transform, from_euler, vec
from missionkit.perception.camera_section import Camera
from missionkit.perception.opencv_helpers import marker_bitmap
from missionkit.perception.square_pose import project, square

PHOTO = Path(__file__).parents[2] / "shared/data/aruco/single_markers.jpg"
LENS = Camera(
    matrix=((628.158, 0, 324.099), (0, 628.156, 260.908), (0, 0, 1)),
    distortion=(0.0995485, -0.206384, 0.00754589, 0.00336531, 0),
)
DICTIONARY, IDS = "DICT_6X6_250", (23, 40, 62, 98, 124, 203)
SMALL = "DICT_4X4_50"  # so small that clutter looks like one of its markers
SEED = 54  # one whose clutter holds a false marker, `FALSE` of `SMALL`
FALSE = 17
SIDE = 0.1  # m, of a marker
SHARP = 4  # fine pixels in a pixel while it is drawn
SOFT = 0.7  # px, blur of the lens
NOISE = 3.0  # grey levels
PATCHES = 110  # dark labels, switches and panes, each with bright spots in it


def pose_of(number: int) -> Transform:
    """Return marker to camera of one of the six."""
    k = IDS.index(number)
    turn = from_euler(np.pi - 0.15, 0.25 - 0.1 * k, 0.1 * (k - 2))
    return Transform(turn, vec(-0.55 + 0.5 * (k % 3), -0.28 + 0.55 * (k // 3), 1.7 + 0.03 * k))


@cache
def drawn(seed: int = SEED) -> Mat:
    """Return the picture, (480, 640), grey."""
    chance = np.random.default_rng(seed)
    fine = _wall(chance)
    for _ in range(PATCHES):
        _patch(fine, chance)
    for number in IDS:
        _sheet(fine, number)
    seen = cv2.GaussianBlur(_through_the_lens(fine), (0, 0), SOFT)
    return np.clip(seen + chance.normal(0.0, NOISE, seen.shape), 0, 255).astype(np.uint8)


def _wall(chance: np.random.Generator) -> Mat:
    """Return uneven light on plaster, with dark edges of furniture across it."""
    size = (640 * SHARP, 480 * SHARP)
    wall = np.full(size[::-1], 135.0, np.float32)
    for cells, strength in ((4, 25.0), (40, 9.0), (160, 6.0)):
        rough = chance.normal(0.0, strength, (cells * 3 // 4, cells)).astype(np.float32)
        wall += cv2.resize(rough, size, interpolation=cv2.INTER_CUBIC)
    for _ in range(14):
        ends = chance.uniform((0, 0), size, (2, 2)).astype(int)
        cv2.line(wall, ends[0].tolist(), ends[1].tolist(), chance.uniform(20, 230), 3 * SHARP)
    return wall


def _patch(image: Mat, chance: np.random.Generator) -> None:
    """Draw a dark plate, a little askew, with bright spots: a label, a switch, a window."""
    plate = np.full((64, 64), 30.0, np.float32)
    plate[:8], plate[-8:], plate[:, :8], plate[:, -8:] = (chance.uniform(150, 220),) * 4
    for at in np.argwhere(chance.random((4, 4)) < 0.45):
        middle, size = 16 + 8 * at + chance.uniform(3, 5, 2), chance.uniform(3.5, 6.0, 2)
        bright, turn = chance.uniform(140, 220), chance.uniform(0, 180)
        cv2.ellipse(plate, (tuple(middle), tuple(2 * size), turn), bright, -1)
    half = 0.5 * SHARP * chance.uniform(20, 34) * 8 / 6
    corners = chance.uniform((20, 20), (620, 460)) * SHARP + half * _turned(chance)
    _stick(image, plate, corners)


def _turned(chance: np.random.Generator) -> Mat:
    angle = chance.uniform(-0.3, 0.3)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    upright = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return upright * (1.0, chance.uniform(0.85, 1.0)) @ turn.T


def _sheet(image: Mat, number: int) -> None:
    """Stick up a sheet with a marker; its white rim is a cell wide."""
    bits = np.pad(marker_bitmap(DICTIONARY, number, 8), 1, constant_values=255)
    pinhole = Camera(matrix=LENS.matrix).model()
    corners = project(square(SIDE * 10 / 8), pose_of(number), pinhole)
    _stick(image, 30.0 + 0.7 * bits, SHARP * (corners + 0.5) - 0.5)


def _stick(image: Mat, face: Mat, corners: Mat) -> None:
    """Draw a face (n, n) between these corners (4, 2), fine px, clockwise from its upper left."""
    low = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 1, image.shape[::-1])
    part = image[low[1] : high[1], low[0] : high[0]]
    n = len(face)
    edges = np.array([[0, 0], [n, 0], [n, n], [0, n]], np.float32) - 0.5
    H = cv2.getPerspectiveTransform(edges, (corners - low).astype(np.float32))
    to, how, edge = part.shape[::-1], cv2.INTER_NEAREST, cv2.BORDER_TRANSPARENT
    cv2.warpPerspective(face.astype(np.float32), H, to, part, how, edge)


def _through_the_lens(fine: Mat) -> Mat:
    """Return what the pixels see, by following each one's ray to the pinhole's picture."""
    matrix, lens = np.array(LENS.matrix), np.array(LENS.distortion)
    grid = np.stack(np.meshgrid(np.arange(640.0), np.arange(480.0)), -1).reshape(-1, 1, 2)
    ends = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 50, 1e-8)
    rays = cv2.undistortPoints(grid, matrix, lens, P=matrix, criteria=ends).reshape(480, 640, 2)
    at = (SHARP * (cv2.resize(rays, fine.shape[::-1]) + 0.5) - 0.5).astype(np.float32)
    edge = cv2.BORDER_REPLICATE
    seen = cv2.remap(fine, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=edge)
    return cv2.resize(seen, (640, 480), interpolation=cv2.INTER_AREA)
