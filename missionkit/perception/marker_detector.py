"""Markers in an image: found fast, and on a second look if need be."""

from __future__ import annotations

from collections.abc import Set
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.messages import Detection, Image
from missionkit.perception.marker_selection import area_of
from missionkit.perception.opencv_helpers import dictionary, grey
from missionkit.perception.search_region import Region

Corners = npt.NDArray[np.float64]  # (4, 2), px

MIN_PERIMETER: Final = 38.0  # px; the bits of a smaller marker cannot be read
_REFINE_WITHIN: Final = 0.5  # of a module on each side of the corner, so that no other edge is seen
_REFINE_UNTIL: Final = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 30, 0.02)


class MarkerDetector:
    """Finds the markers of one dictionary, corners to a fraction of a pixel.

    Two passes. The first thresholds the sharp image in a small window: fast, and the only one
    that reads markers below 25 px. The second, in case none of the wanted ids was found, smooths
    away noise and thresholds in a larger window, which also reads blurred markers.
    """

    def __init__(self, name: str, longest_side: int = 640) -> None:
        markers = dictionary(name)
        self.name = name
        self._modules = markers.markerSize + 2  # with the black border
        self._longest = longest_side
        self._sharp, self._smooth = _parameters(5, 10.0), _parameters(13, 7.0)
        self._detector = cv2.aruco.ArucoDetector(markers)

    def detect(
        self, image: Image, wanted: Set[int] | None = None, region: Region | None = None
    ) -> tuple[Detection, ...]:
        """Return the markers in an image.

        Args:
            image: grey or BGR.
            wanted: ids; None: all.
            region: where to look; None: everywhere.
        """
        flat = grey(image)
        left, top, right, bottom = region or (0, 0, flat.shape[1], flat.shape[0])
        part = np.ascontiguousarray(flat[top:bottom, left:right])
        at = np.array([left, top], np.float32)
        found = self._pass(self._sharp, part, at, flat, wanted)
        if found:
            return found
        smooth = np.asarray(cv2.blur(part, (3, 3)), np.uint8)
        return self._pass(self._smooth, smooth, at, flat, wanted)

    def _pass(
        self,
        parameters: cv2.aruco.DetectorParameters,
        part: Image,
        at: npt.NDArray[np.float32],
        original: Image,
        wanted: Set[int] | None,
    ) -> tuple[Detection, ...]:
        whole = part.shape == original.shape
        longest = self._longest if whole else max(part.shape)
        parameters.minMarkerPerimeterRate = MIN_PERIMETER / longest
        self._detector.setDetectorParameters(parameters)
        quads, ids, _ = self._detector.detectMarkers(part)
        numbers = [] if ids is None else [int(i) for i in ids.ravel()]
        return tuple(
            self._detection(number, np.asarray(quad, np.float32).reshape(4, 2) + at, original)
            for number, quad in zip(numbers, quads, strict=True)
            if wanted is None or number in wanted
        )

    def _detection(self, number: int, quad: npt.NDArray[np.float32], image: Image) -> Detection:
        """Refine on the original image: smoothing would round the corners."""
        module = area_of(quad.astype(np.float64)) ** 0.5 / self._modules
        reach = min(max(round(_REFINE_WITHIN * module), 2), 7)
        exact = cv2.cornerSubPix(image, quad.copy(), (reach, reach), (-1, -1), _REFINE_UNTIL)
        corners = exact.reshape(4, 2).astype(np.float64)
        return Detection(self.name, number, corners, area_of(corners))


def _parameters(window: int, contrast: float) -> cv2.aruco.DetectorParameters:
    """Threshold once, in a `window` (px), at `contrast` grey levels below the local mean."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeMin = window
    parameters.adaptiveThreshWinSizeMax = window
    parameters.adaptiveThreshConstant = contrast
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_NONE
    return parameters
