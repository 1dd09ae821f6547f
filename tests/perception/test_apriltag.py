from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError
from scenes import CAMERA, LEVEL, corners_of, marker_at, priors, seen_from, with_image

from missionkit.perception import opencv_helpers
from missionkit.perception.apriltag import AprilTag
from missionkit.perception.aruco import Aruco
from missionkit.perception.vision_pipeline import VisionPipeline


def tag_image(corners, family, number):
    import cv2  # noqa: PLC0415 - as scenes.render, of another dictionary

    paper = np.full((250, 250), 200, np.uint8)
    paper[25:-25, 25:-25] = opencv_helpers.marker_bitmap(family, number, 200) // 255 * 170 + 30
    edges = np.array([[25, 25], [225, 25], [225, 225], [25, 225]], np.float32) - 0.5
    H = cv2.getPerspectiveTransform(edges, corners.astype(np.float32))
    canvas = np.full((480, 640), 120, np.uint8)
    cv2.warpPerspective(
        paper, H, (640, 480), dst=canvas, flags=cv2.INTER_AREA, borderMode=cv2.BORDER_TRANSPARENT
    )
    return cv2.GaussianBlur(canvas, (0, 0), 0.6)


@pytest.mark.parametrize("family", ["DICT_APRILTAG_36h11", "DICT_APRILTAG_16h5"])
def test_an_apriltag_marks_a_target_as_an_aruco_marker_does(family):
    spot = marker_at(3.0, 0.4, 0.2)
    image = tag_image(corners_of(seen_from(LEVEL, spot), 0.3), family, 7)
    eye = VisionPipeline(
        CAMERA,
        [
            AprilTag(target="tag", dictionary=family, id=7, size=0.3),
            AprilTag(target="other", dictionary=family, id=8, size=0.3),
            Aruco(target="trunk", id=7, size=0.3),
        ],
    )
    (sighting,) = eye.look(eye.begin(), with_image(1.0, image), priors()).sightings
    assert (sighting.target, sighting.id) == ("tag", 7)
    assert sighting.pose.translation == pytest.approx(seen_from(LEVEL, spot).translation, abs=0.05)


def test_other_dictionaries_and_ids_are_refused():
    with pytest.raises(ValidationError, match="no family of AprilTags 'DICT_6X6_250'"):
        AprilTag(target="tag", dictionary="DICT_6X6_250", id=1, size=0.3)
    with pytest.raises(ValidationError, match="has ids 0 to 34, not 35"):
        AprilTag(target="tag", dictionary="DICT_APRILTAG_25h9", id=35, size=0.3)
