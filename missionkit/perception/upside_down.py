"""Markers that hang upside down in the image, although the mission says that they are upright."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Final

from missionkit.geometry import Quat, multiply, to_matrix
from missionkit.messages import MARKER_UPSIDE_DOWN, Sighting
from missionkit.perception.vision_warning import VisionWarning

_COSINE: Final = -0.5  # upper edge more than 120 deg from the vertical

MarkerName = tuple[str, int, str]  # dictionary, id, target


def is_upside_down(marker: Quat) -> bool:
    """Say whether a marker (its axes to world, NED) has its upper edge below."""
    return -float(to_matrix(marker)[2, 1]) < _COSINE


def right_way_up(
    sightings: Iterable[Sighting], upright: Collection[MarkerName], camera: Quat | None
) -> tuple[list[Sighting], list[VisionWarning]]:
    """Return the sightings without markers that are upside down, and a warning of each of those.

    Args:
        sightings: of one frame.
        upright: markers that the mission says are upright.
        camera: camera to world; None: unknown, nothing is upside down.
    """
    kept, warnings = [], []
    for it in sightings:
        name, number = it.detection.dictionary, it.detection.id
        expected = camera is not None and (name, number, it.target) in upright
        if camera is None or not expected or not is_upside_down(multiply(camera, it.pose.rotation)):
            kept.append(it)
            continue
        message = (
            f"marker {number} ({name}) of {it.target} is upside down in the image and not used: "
            "is the camera mounted upside down? If the marker hangs so, set 'upright: false'"
        )
        about = (it.target, name, str(number))
        warnings.append(VisionWarning(MARKER_UPSIDE_DOWN, about, message, it.at, it.at))
    return kept, warnings
