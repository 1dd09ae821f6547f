"""Looking in a frame for the features that a navigator knows."""

from __future__ import annotations

from functools import cache
from typing import Any

from typing_extensions import TypeIs

from missionkit.estimation.navigator import FeatureNavigator, Navigator
from missionkit.messages import CameraModel, Frame
from missionkit.perception.vision_recording import Vision


def with_features(
    navigator: Navigator, known: Any, frame: Frame | None, eye: Vision, camera: CameraModel
) -> Any:
    """Return a navigator's memory after what a frame shows of its features, if it has any.

    Args:
        navigator: any.
        known: its memory after the observation that brought the frame.
        frame: None if none came.
        eye: looks for them.
        camera: lens and mount.
    """
    if frame is None or not _looks_for_features(navigator):
        return known
    search = navigator.search(known, frame.at)
    if search is None:
        return known
    matches = eye.match(frame, camera, search)
    return known if matches is None else navigator.see(known, search, matches)


def _looks_for_features(navigator: Navigator) -> TypeIs[FeatureNavigator]:
    return _can_look(type(navigator))


@cache  # to ask a protocol takes 0.1 ms
def _can_look(kind: type[Navigator]) -> bool:
    return issubclass(kind, FeatureNavigator)
