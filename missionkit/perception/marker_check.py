"""Checks which markers of a mission a camera sees, and how far away they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from missionkit.camera_pointing import looking
from missionkit.geometry import multiply, norm
from missionkit.messages import CameraModel, Detection, Image
from missionkit.perception.aruco import Aruco
from missionkit.perception.image_files import outlined, with_axes
from missionkit.perception.marker_detector import MarkerDetector
from missionkit.perception.square_pose import Solution, solve
from missionkit.perception.upside_down import is_upside_down

_LEVEL = looking(0.0)  # camera to world of a level camera


class Found(NamedTuple):
    """A marker of the mission in an image."""

    marker: Aruco
    detection: Detection
    solution: Solution | None  # its pose to the camera; None: there is none that fits

    @property
    def distance(self) -> float | None:
        """From the camera (m)."""
        return None if self.solution is None else norm(self.solution.pose.translation)

    @property
    def upside_down(self) -> bool:
        """Whether its upper edge is below in the image, although the mission says upright."""
        if self.solution is None or not self.marker.upright:
            return False
        return is_upside_down(multiply(_LEVEL, self.solution.pose.rotation))

    @property
    def counts(self) -> bool:
        """Whether it is as large in the image as the mission demands."""
        return self.marker.min_area <= self.detection.area <= self.marker.max_area


class Checkup:
    """Looks at images as a flight would.

    Args:
        names: dictionaries of markers.
        markers: of the mission; without any, all of the dictionaries are reported.
        camera: its lens; only needed for the markers of a mission.
        longest_side: of the images (px).
    """

    def __init__(
        self,
        names: Sequence[str],
        markers: Sequence[Aruco] = (),
        camera: CameraModel | None = None,
        longest_side: int = 640,
    ) -> None:
        self._detectors = [MarkerDetector(name, longest_side) for name in names]
        self._markers = tuple(markers)
        self._camera = camera

    def look(self, image: Image) -> tuple[Found, ...]:
        """Return the markers of the mission in an image."""
        return tuple(
            Found(marker, it, self._solved(it, marker))
            for detector in self._detectors
            for it in detector.detect(image, self._ids(detector.name))
            for marker in self._markers
            if (marker.dictionary, marker.id) == (it.dictionary, it.id)
        )

    def all(self, image: Image) -> tuple[Detection, ...]:
        """Return every marker of the dictionaries in an image."""
        return tuple(it for detector in self._detectors for it in detector.detect(image))

    def drawn(self, image: Image) -> Image:
        """Return the image with all markers outlined, and axes on those of the mission."""
        picture = outlined(image, self.all(image))
        for found in self.look(image):
            if found.solution is not None and self._camera is not None:
                pose, size = found.solution.pose, found.marker.size
                picture = with_axes(picture, pose, size, self._camera)
        return picture

    def _ids(self, name: str) -> set[int]:
        return {marker.id for marker in self._markers if marker.dictionary == name}

    def _solved(self, detection: Detection, marker: Aruco) -> Solution | None:
        if self._camera is None:
            return None
        solutions = solve(detection.corners, marker.size, self._camera)
        return solutions[0] if solutions else None
