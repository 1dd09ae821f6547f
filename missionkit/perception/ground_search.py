"""Objects on the ground in a frame: boxes by all detectors, and where on the ground they stand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from missionkit.messages import BoxDetection, CameraModel, Frame, GroundFrame
from missionkit.perception.box_validation import fault_of_boxes
from missionkit.perception.ground_plane import ROBOT_DIAMETER, on_ground, view_of
from missionkit.perception.marker_search import Priors
from missionkit.plugin_containment import Containment, is_foreign
from missionkit.plugin_protocols import BoxDetectorProtocol, Prior

MOST_BOXES: Final = 20
"""Boxes of one detector that count, those with the highest scores (P4 section III-A)."""


def ground_frame(
    detectors: Sequence[BoxDetectorProtocol],
    camera: CameraModel,
    frame: Frame,
    priors: Priors,
    contain: Containment,
) -> GroundFrame | None:
    """Return what a frame shows on the ground; None: nothing can be said about it.

    That is so without detectors, without an image or ready boxes, and where the vehicle's own pose
    is unknown. A detector that fails or answers nonsense counts as one that saw nothing; if all do,
    the frame says nothing.

    Args:
        detectors: of the mission.
        camera: lens and mount.
        frame: an image, or ready boxes.
        priors: where the vehicle and the ground are thought to be.
        contain: keeps what went wrong in a detector.
    """
    body = priors.body(frame.at) if detectors else None
    if body is None or (frame.image is None and frame.boxes is None):
        return None
    prior = Prior(body, None, priors.ground)
    answers = list(_answers(detectors, camera, frame, prior, contain))
    if not answers:
        return None
    found = (
        on_ground(box, camera, body, priors.ground, priors.noise, diameter)
        for boxes, diameter in answers
        for box in sorted(boxes, key=lambda box: -box.score)[:MOST_BOXES]
    )
    return GroundFrame(
        frame.at,
        tuple(it for it in found if it is not None),
        view_of(camera, body, priors.ground),
    )


def _answers(
    detectors: Sequence[BoxDetectorProtocol],
    camera: CameraModel,
    frame: Frame,
    prior: Prior,
    contain: Containment,
) -> Iterator[tuple[tuple[BoxDetection, ...], float]]:
    """Yield sound answers, each with the diameter (m) of what was looked for."""
    if frame.image is None:
        if wrong := fault_of_boxes(frame.boxes, camera):
            contain.note(f"the camera gave {wrong}")
        else:
            yield frame.boxes or (), ROBOT_DIAMETER
        return
    for it in detectors:
        boxed = contain.call(it.kind, it.boxes, frame, camera, prior, foreign=is_foreign(it))
        if boxed is None:
            continue
        if wrong := fault_of_boxes(boxed[0], camera):
            contain.note(f"{it.kind} returned {wrong}")
            continue
        yield boxed[0], getattr(it, "diameter", ROBOT_DIAMETER)
