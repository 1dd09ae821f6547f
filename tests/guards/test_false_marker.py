"""The false marker in a cluttered photograph does not get past the guards; the true ones do."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
from photographs import DICTIONARY, IDS, LENS, SMALL, drawn
from photographs import FALSE as FALSE_ID
from samples import calm

from missionkit.geometry import Transform, from_euler
from missionkit.guards.detection_confidence import ArucoConfidence
from missionkit.guards.gps_to_visual import GpsToVisual
from missionkit.messages import Frame, Goal, Observation, Sighting, Target, Verdict
from missionkit.perception.aruco import Aruco
from missionkit.perception.marker_detector import MarkerDetector
from missionkit.perception.marker_search import Priors
from missionkit.perception.vision_pipeline import VisionPipeline

CAMERA = LENS.model()
FALSE = Aruco(target="trunk", dictionary=SMALL, id=FALSE_ID, size=0.40)
TRUE = Aruco(target="trunk", dictionary=DICTIONARY, id=IDS[0], size=0.40)
BODY = Transform(from_euler(0, 0, 0), np.zeros(3))  # at the origin, looking north
PERIOD = 0.05


@cache
def video(frames: int) -> list[np.ndarray]:
    """Hold the photograph in a hand: it moves, and the sensor adds noise."""
    photo, rng = drawn(), np.random.default_rng(3)
    shots = []
    for _ in range(frames):
        shift = np.array([[1, 0, rng.normal(0, 3)], [0, 1, rng.normal(0, 3)]])
        moved = cv2.warpAffine(photo, shift, photo.shape[::-1], borderMode=cv2.BORDER_REPLICATE)
        noisy = moved + rng.normal(0, 4, moved.shape)
        shots.append(np.clip(noisy, 0, 255).astype(np.uint8))
    return shots


def watched(marker: Aruco, trunk: Target | None) -> tuple[Verdict, Verdict, list[Sighting]]:
    """Watch for three seconds; return C_aruco and G_gps->visual at the end, and the sightings.

    Without a `trunk` the target is believed to be wherever the marker puts it: the worst case.
    """
    eye = VisionPipeline(CAMERA, (marker,))
    priors = Priors(lambda _: BODY, {} if trunk is None else {"trunk": trunk}, None)
    sure, whole = ArucoConfidence(target="trunk"), GpsToVisual(target="trunk")
    memory, known, window = eye.begin(), sure.begin(), whole.begin()
    found: list[Sighting] = []
    seen = calm()
    for k, image in enumerate(video(60)):
        now = (k + 1) * PERIOD
        memory, looks, sightings, _ = eye.look(
            memory, Observation(now, frame=Frame(now, image)), priors
        )
        found += sightings
        place = trunk
        if place is None and found:
            position = (BODY @ CAMERA.mount @ found[-1].pose).translation
            place = Target("trunk", position, 0.1, None, None, now)
        seen = calm(
            now=now,
            position=np.zeros(3),
            looks=looks,
            targets={} if place is None else {"trunk": place},
            goal=Goal(np.zeros(3), None, now),
        )
        known, window = sure.advance(known, seen), whole.advance(window, seen)
    return sure.check(known, seen), whole.check(window, seen), found


def surveyed(north: float) -> Target:
    return Target("trunk", np.array([north, 0.0, 0.0]), 1.0, None, None, None)


def test_the_detector_does_find_the_false_marker_and_steadily():
    raw = MarkerDetector(SMALL)
    found = [bool(raw.detect(image, {FALSE_ID})) for image in video(60)]
    assert np.mean(found) > 0.7


def test_it_is_rejected_where_the_target_cannot_be():
    """Its 20 px would be a 0.4 m marker 12 m away: not the trunk 6 m ahead."""
    sure, hand_over, found = watched(FALSE, surveyed(6.0))
    assert not found
    assert (sure.value, sure.holds, hand_over.holds) == (0.0, False, False)


def test_a_false_marker_that_passed_would_be_out_of_range():
    sure, hand_over, found = watched(FALSE, None)
    assert found
    assert sure.holds
    assert not hand_over.holds
    assert hand_over.threshold == GpsToVisual(target="trunk").range


def test_the_true_marker_hands_over():
    _, _, found = watched(TRUE, None)
    north = float((BODY @ CAMERA.mount @ found[-1].pose).translation[0])
    sure, hand_over, _ = watched(TRUE, surveyed(north + 0.5))
    assert (sure.value, sure.holds, hand_over.holds) == (1.0, True, True)
