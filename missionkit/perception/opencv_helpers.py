"""Small helpers around OpenCV that other parts need."""

from __future__ import annotations

import cv2
import numpy as np

from missionkit.messages import Image
from missionkit.perception.marker_dictionaries import SIZES, known

# One thread: neither results nor timings depend on the cores of the machine.
cv2.setNumThreads(1)


def dictionary(name: str) -> cv2.aruco.Dictionary:
    """Return OpenCV's dictionary of that name.

    Raises:
        ValueError: there is none; the message names the nearest.
    """
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, known(name)))


def marker_bitmap(name: str, id: int, pixels: int) -> Image:
    """Return marker `id` of dictionary `name` as grey (pixels, pixels), without a white margin.

    Args:
        name: of the dictionary.
        id: within the dictionary.
        pixels: edge of the image.

    Raises:
        ValueError: there is no such dictionary or id.
    """
    if not 0 <= id < SIZES[known(name)]:
        raise ValueError(f"{name} has ids 0 to {SIZES[name] - 1}, not {id}")
    return np.asarray(cv2.aruco.generateImageMarker(dictionary(name), id, pixels), np.uint8)


def grey(image: Image) -> Image:
    """Return (height, width) of a grey or BGR image."""
    if image.ndim == 2:
        return image
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)


def encode_jpeg(image: Image, quality: int = 80) -> bytes:
    """Return `image` as a JPEG file of `quality` 0 to 100."""
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return bytes(data)


def decode_grey(data: bytes) -> Image:
    """Return the grey image (height, width) in a JPEG, PNG or PGM file.

    Raises:
        ValueError: the data are not an image.
    """
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_GRAYSCALE) if data else None
    except cv2.error:  # it claims to be too large
        image = None
    if image is None:
        raise ValueError(f"these {len(data)} bytes are not an image")
    return np.asarray(image, np.uint8)
