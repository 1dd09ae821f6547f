"""Where markers are looked for: nothing that would be believed is lost."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scenes import CAMERA, LEVEL, corners_of, marker_at, noisy, priors, render, seen_from, target

from missionkit.geometry import Transform, from_euler
from missionkit.messages import Detection, Frame
from missionkit.perception.aruco import Aruco
from missionkit.perception.camera_section import Camera
from missionkit.perception.marker_detector import MIN_PERIMETER
from missionkit.perception.marker_search import WHOLE_EVERY, MarkerSearch
from missionkit.perception.marker_selection import Candidate, area_of, plausible
from missionkit.perception.search_region import RegionFinder
from missionkit.perception.target_sighting import sight

MARKER = Aruco(target="trunk", id=23, size=0.4)
BENT = Camera(distortion=(-0.28, 0.09, 0.001, -0.001, -0.01)).model()
SIDE = MIN_PERIMETER / 4.0


def inside(region, corners) -> bool:
    low, high = corners.min(axis=0), corners.max(axis=0)
    return (low >= region[:2]).all() and (high <= region[2:]).all()


@pytest.mark.parametrize("camera", [CAMERA, BENT], ids=["straight", "bent"])
def test_every_marker_that_would_be_believed_lies_in_the_region(camera):
    rng = np.random.default_rng(7)
    finder, believed, cut, nowhere = RegionFinder(camera, SIDE), 0, 0, 0
    for _ in range(500):
        body = Transform(from_euler(*rng.normal(0.0, 0.3, 3)), rng.normal(0.0, 1.0, 3))
        marker = marker_at(
            *(rng.uniform(1.0, 25.0), rng.normal(0.0, 4.0), rng.normal(0.0, 2.0)),
            yaw=math.pi + rng.normal(0.0, 0.4),
        )
        truth = seen_from(body, marker, camera)
        place = marker.translation + rng.normal(0.0, 2.0, 3)
        belief = target(position=place, sd=rng.uniform(0.05, 1.0))
        region = finder.region([(MARKER, belief)], body)
        cut += 0 < (region.right - region.left) < camera.width
        nowhere += region.empty
        if truth.translation[2] < 1.0:
            continue
        corners = noisy(corners_of(truth, 0.4, camera), rng, 0.2)
        if (corners < 0).any() or (corners > (camera.width - 1, camera.height - 1)).any():
            continue
        found = sighted(corners, camera, body, belief)
        if found is not None and plausible(found, belief):
            believed += 1
            assert inside(region, corners)
    assert min(believed, cut, nowhere) > 30


def sighted(corners, camera, body, belief) -> Candidate | None:
    area = area_of(corners)
    if area < MARKER.min_area:
        return None
    detection = Detection(MARKER.dictionary, 23, corners, area)
    return sight(detection, MARKER, camera, at=1.0, body=body, prior=belief)


def test_without_a_belief_or_a_pose_the_whole_image_is_looked_at():
    finder = RegionFinder(CAMERA, SIDE)
    whole = (0, 0, CAMERA.width, CAMERA.height)
    assert finder.region([(MARKER, None)], LEVEL) == whole
    assert finder.region([(MARKER, target(position=(10.0, 0.0, 0.0)))], None) == whole


def test_behind_the_camera_or_too_far_away_there_is_nothing_to_look_for():
    finder = RegionFinder(CAMERA, SIDE)
    assert finder.region([(MARKER, target(position=(-10.0, 0.0, 0.0)))], LEVEL).empty
    assert finder.region([(MARKER, target(position=(60.0, 0.0, 0.0)))], LEVEL).empty
    assert not finder.region([(MARKER, target(position=(12.0, 0.0, 0.0)))], LEVEL).empty


def test_in_its_region_a_marker_is_found_to_the_same_bit():
    place = marker_at(9.0, 1.5, 0.5)
    image = render([(23, corners_of(seen_from(LEVEL, place), 0.4))], np.random.default_rng(3))
    search = MarkerSearch(CAMERA, [MARKER])
    belief = target(position=(9.2, 1.4, 0.4), sd=0.3)
    region = RegionFinder(CAMERA, SIDE).region([(MARKER, belief)], LEVEL)
    assert region.right - region.left < 0.8 * CAMERA.width
    (whole,), (part,) = (
        list(search.find(Frame(at * CAMERA.period, image), priors(belief)))
        for at in (WHOLE_EVERY, WHOLE_EVERY + 1)
    )
    assert part.detection.corners.tobytes() == whole.detection.corners.tobytes()


def test_one_frame_in_ten_is_looked_at_as_a_whole():
    image = render(
        [(23, corners_of(seen_from(LEVEL, marker_at(4.0, 0.0, 0.0)), 0.4))],
        np.random.default_rng(3),
    )
    search, elsewhere = MarkerSearch(CAMERA, [MARKER]), target(position=(-20.0, 0.0, 0.0))
    found = [
        bool(list(search.find(Frame(number * CAMERA.period, image), priors(elsewhere))))
        for number in range(2 * WHOLE_EVERY)
    ]
    assert [number for number, each in enumerate(found) if each] == [0, WHOLE_EVERY]
