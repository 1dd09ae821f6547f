"""The camera's lens and sensor: distortion, blur, exposure and noise.

Pixel centres lie at integer coordinates, as everywhere in OpenCV.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat
from missionkit.messages import CameraModel, Image

DEFOCUS = 0.6  # px, sd of the point spread
READ_NOISE = 2.4  # grey levels, sd
SHOT_NOISE = 0.018  # sd as a share of the brightness
LONGEST_STREAK = 20.0  # px
LARGEST_CANVAS = 2.0  # times the image's width and height


class Lens(NamedTuple):
    """An undistorted canvas and, for each image pixel, where on the canvas it looks."""

    size: tuple[int, int]  # width, height of the canvas, px
    matrix: Mat  # (3, 3), pinhole matrix of the canvas, px
    maps: tuple[npt.NDArray[np.int16], npt.NDArray[np.uint16]] | None  # None: no distortion


def lens(camera: CameraModel) -> Lens:
    """Return the canvas that covers the whole image of `camera`.

    The maps invert OpenCV's five-coefficient model, so that the image agrees with
    `cv2.projectPoints`. A canvas is at most `LARGEST_CANVAS` times the image in size: what a
    wilder lens sees outside it is drawn with the canvas's edge.
    """
    if not np.any(camera.distortion):
        return Lens((camera.width, camera.height), camera.matrix, None)
    columns, rows = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    pixels = np.stack([columns, rows], axis=-1).reshape(-1, 1, 2).astype(np.float64)
    converged = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 60, 1e-9)
    straight = cv2.undistortPoints(
        pixels, camera.matrix, camera.distortion, None, None, camera.matrix, converged
    ).reshape(camera.height, camera.width, 2)
    limit = np.array([camera.width, camera.height], dtype=np.float64)
    margin = 0.5 * (LARGEST_CANVAS - 1.0) * limit
    low = np.floor(np.maximum(straight.min(axis=(0, 1)), -margin)) - 2.0
    high = np.ceil(np.minimum(straight.max(axis=(0, 1)), limit + margin)) + 2.0
    local = np.clip(straight - low, 0.0, high - low).astype(np.float32)
    shift = np.array([[1.0, 0.0, -low[0]], [0.0, 1.0, -low[1]], [0.0, 0.0, 1.0]])
    width, height = (int(side) + 1 for side in high - low)
    fixed, fraction = cv2.convertMaps(local[..., 0], local[..., 1], cv2.CV_16SC2)
    return Lens((width, height), shift @ camera.matrix, (fixed, fraction))


def streak(dx: float, dy: float) -> list[npt.NDArray[np.float32]]:
    """Return kernels that one after the other smear an image along (dx, dy), px.

    Each kernel's centroid is its anchor, so that the smear shifts nothing. Below half a pixel
    there are none; beyond `LONGEST_STREAK` the smear is cut.
    """
    length = math.hypot(dx, dy)
    if length < 0.5:
        return []
    cut = min(1.0, LONGEST_STREAK / length)
    dx, dy = dx * cut, dy * cut
    if length <= 10.0:
        return [_line(dx, dy, max(3, math.ceil(2 * length)))]
    return [_line(dx / 2, dy / 2, math.ceil(length)), _line(dx / 2, dy / 2, 2)]


def _line(dx: float, dy: float, taps: int) -> npt.NDArray[np.float32]:
    """Spread `taps` equal weights along a segment centred on the anchor, bilinearly."""
    reach = math.ceil(max(abs(dx), abs(dy)) / 2)
    kernel = np.zeros((2 * reach + 3, 2 * reach + 3), np.float32)
    spread = (np.arange(taps) + 0.5) / taps - 0.5 if taps > 2 else np.array([-0.5, 0.5])
    for s in spread:
        x, y = reach + 1 + s * dx, reach + 1 + s * dy
        i, j = math.floor(y), math.floor(x)
        v, u = y - i, x - j
        kernel[i : i + 2, j : j + 2] += np.outer([1 - v, v], [1 - u, u]) / taps
    return kernel


def blur(image: Image, dx: float, dy: float) -> Image:
    """Return the image out of focus by `DEFOCUS` and smeared along (dx, dy), px.

    Args:
        image: (h, w), grey.
        dx: px along a row.
        dy: px along a column.
    """
    for kernel in streak(dx, dy):
        image = np.asarray(
            cv2.filter2D(image, -1, kernel, borderType=cv2.BORDER_REPLICATE), np.uint8
        )
    soft = cv2.GaussianBlur(image, (5, 5), DEFOCUS, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(soft, np.uint8)


class Sensor:
    """Exposure, vignetting and noise of one camera.

    grey = v g i (1 + SHOT_NOISE n₁) + READ_NOISE n₂ with n ~ N(0, 1), v the vignette and
    g the automatic exposure's gain, which follows g' = 1 + 0.98 (g - 1) + 0.004 n₃.
    The noise is read from two large banks at a random place, which is cheap and never the same.
    """

    def __init__(self, width: int, height: int, rng: np.random.Generator) -> None:
        self._rng = rng
        self._gain = 1.0
        bank = (height + 256, width + 256)
        read = rng.standard_normal(bank, dtype=np.float32) * READ_NOISE
        shot = 1.0 + SHOT_NOISE * rng.standard_normal(bank, dtype=np.float32)
        self._read = np.clip(np.rint(read), -127, 127).astype(np.int8)
        self._shot = np.clip(np.rint(shot * 230.0), 0, 255).astype(np.uint8)
        x = (np.arange(width) - 0.5 * (width - 1)) / width
        y = (np.arange(height) - 0.5 * (height - 1)) / width
        fall = 1.0 - 0.22 * (x[None, :] ** 2 + y[:, None] ** 2)
        self._vignette = np.rint(255.0 * fall).astype(np.uint8)

    def expose(self, image: Image) -> Image:
        """Return what the sensor reads of an optical image (height, width)."""
        self._gain = 1.0 + 0.98 * (self._gain - 1.0) + 0.004 * float(self._rng.standard_normal())
        rows, columns = image.shape
        i, j, k, m = (int(offset) for offset in self._rng.integers(0, 256, 4))
        out = cv2.multiply(image, self._vignette, scale=self._gain / 255.0)
        cv2.multiply(out, self._shot[i : i + rows, j : j + columns], dst=out, scale=1.0 / 230.0)
        read = self._read[k : k + rows, m : m + columns]
        return np.asarray(cv2.add(out, read, dst=out, dtype=cv2.CV_8U), np.uint8)
