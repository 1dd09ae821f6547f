"""Checking the boxes that a detector answered, once, before anything is made of them."""

from __future__ import annotations

import math

import numpy as np

from missionkit.messages import BoxDetection, CameraModel


def fault_of_boxes(answer: object, camera: CameraModel) -> str:
    """Say what makes an answer of `BoxDetector.boxes` unusable; "": nothing does.

    Args:
        answer: of the detector.
        camera: whose image its boxes are in.
    """
    if not isinstance(answer, tuple):
        return f"{type(answer).__name__}, expected a tuple of BoxDetections"
    wrong = (_fault(box, camera) for box in answer)
    return next(filter(None, wrong), "")


def _fault(box: object, camera: CameraModel) -> str:
    if not isinstance(box, BoxDetection):
        return f"a tuple with {type(box).__name__}, expected a BoxDetection"
    parts = {
        "detector, kind or id": _is_named(box),
        "sized": isinstance(box.sized, bool),
        "centre": _is_point(box.centre),
        "size": _is_size(box.size),
        "score": _is_number(box.score) and 0.0 <= box.score <= 1.0,
    }
    unsound = [name for name, sound in parts.items() if not sound]
    if unsound:
        return f"a box with {unsound[0]} of a wrong type, not finite or out of range"
    column, row = box.centre.tolist()
    if not (-0.5 <= column < camera.width - 0.5 and -0.5 <= row < camera.height - 0.5):
        return f"a box centred at ({column:.0f}, {row:.0f}) px, outside the image"
    return ""


def _is_named(box: BoxDetection) -> bool:
    return (
        isinstance(box.detector, str)
        and isinstance(box.kind, str)
        and (box.id is None or (isinstance(box.id, int) and not isinstance(box.id, bool)))
    )


def _is_point(centre: object) -> bool:
    return (
        isinstance(centre, np.ndarray)
        and centre.shape == (2,)
        and centre.dtype.kind == "f"
        and bool(np.isfinite(centre).all())
    )


def _is_size(size: object) -> bool:
    return (
        isinstance(size, tuple)
        and len(size) == 2
        and all(_is_number(side) and side > 0.0 for side in size)
    )


def _is_number(value: object) -> bool:
    return isinstance(value, float) and math.isfinite(value)
