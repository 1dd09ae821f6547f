"""Checking what a detector of another package answered, once, before anything is made of it."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Transform
from missionkit.messages import Detection, Sighting


def fault_of(answer: object, target: str, at: float) -> str:
    """Say what makes an answer unusable; "": nothing does.

    Args:
        answer: of `Detector.detect`.
        target: that it looks for.
        at: s, of the frame.
    """
    if not isinstance(answer, tuple):
        return f"{type(answer).__name__}, expected a tuple of Sightings"
    wrong = (_fault(sighting, target, at) for sighting in answer)
    return next(filter(None, wrong), "")


def _fault(sighting: object, target: str, at: float) -> str:
    if not isinstance(sighting, Sighting):
        return f"a tuple with {type(sighting).__name__}, expected a Sighting"
    if sighting.target != target:
        return f"a sighting of {sighting.target!r}, but it looks for {target!r}"
    if sighting.at != at:
        return "a sighting at another time than the frame's"
    parts = {
        "pose": _is_pose(sighting.pose),
        "position_sd": _is_deviation(sighting.position_sd),
        "angle_sd": _is_deviation(sighting.angle_sd),
        "detection": _is_detection(sighting.detection),
    }
    unsound = [name for name, sound in parts.items() if not sound]
    return f"a sighting with {unsound[0]} of a wrong type or not finite" if unsound else ""


def _is_pose(pose: object) -> bool:
    return (
        isinstance(pose, Transform)
        and _fits(pose.translation, (3,))
        and _fits(pose.rotation, (4,))
        and abs(float(pose.rotation @ pose.rotation) - 1.0) < 1e-6
    )


def _is_deviation(number: object) -> bool:
    return isinstance(number, float) and 0.0 < number < math.inf


def _is_detection(detection: object) -> bool:
    return isinstance(detection, Detection) and _fits(detection.corners, (4, 2))


def _fits(value: object, shape: tuple[int, ...]) -> bool:
    return (
        isinstance(value, np.ndarray)
        and value.shape == shape
        and value.dtype.kind == "f"
        and bool(np.isfinite(value).all())
    )
