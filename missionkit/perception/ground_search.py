"""Objects on the ground in a frame: boxes by all detectors, and where on the ground they stand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from missionkit.ground_robot import GroundRobot
from missionkit.messages import BoxDetection, CameraModel, Frame, GroundFrame
from missionkit.perception.box_validation import fault_of_boxes
from missionkit.perception.ground_plane import on_ground, view_of
from missionkit.perception.marker_search import Priors
from missionkit.plugin_containment import Containment, is_foreign
from missionkit.plugin_protocols import BoxDetectorProtocol, Prior

ROBOT: Final = GroundRobot()
MOST_BOXES: Final = 20
"""Boxes of one detector that count, those with the highest scores (P4 section III-A)."""


class _Answer(NamedTuple):
    """What one detector found."""

    boxes: tuple[BoxDetection, ...]
    diameter: float  # m, of what it looks for
    top: float  # m above the ground, of what its boxes are centred on


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
        on_ground(box, camera, body, priors.ground, priors.noise, it.diameter, it.top)
        for it in answers
        for box in sorted(it.boxes, key=lambda box: -box.score)[:MOST_BOXES]
    )
    return GroundFrame(
        frame.at,
        tuple(place for place in found if place is not None),
        view_of(camera, body, priors.ground),
        priors.ground,
    )


def _answers(
    detectors: Sequence[BoxDetectorProtocol],
    camera: CameraModel,
    frame: Frame,
    prior: Prior,
    contain: Containment,
) -> Iterator[_Answer]:
    """Yield sound answers. Ready boxes are centred where the object stands."""
    if frame.image is None:
        if wrong := fault_of_boxes(frame.boxes, camera):
            contain.note(f"the camera gave {wrong}")
        else:
            yield _Answer(frame.boxes or (), ROBOT.diameter, 0.0)
        return
    for it in detectors:
        boxed = contain.call(it.kind, it.boxes, frame, camera, prior, foreign=is_foreign(it))
        if boxed is None:
            continue
        if wrong := fault_of_boxes(boxed[0], camera):
            contain.note(f"{it.kind} returned {wrong}")
            continue
        diameter = getattr(it, "diameter", ROBOT.diameter)
        yield _Answer(boxed[0], diameter, getattr(it, "height", 0.0))
