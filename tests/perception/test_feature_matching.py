"""Features found again in images that are shifted, turned and scaled, and corners found at all."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from missionkit.messages import FeatureSearch
from missionkit.messages.image_features import PATCH
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.feature_matching import matched
from missionkit.sim.textures import ground_patches

LENS = Camera(width=320, height=240, focal=200, mount=Mount(tilt_deg=90)).model()
BENT = Camera(width=320, height=240, focal=200, distortion=(-0.2, 0.05, 0.0, 0.0, 0.0)).model()
MIDDLE = np.array([159.5, 119.5])


def picture(angle: float = 0.0, scale: float = 1.0, shift: tuple[float, float] = (0.0, 0.0)):
    """Ground turned by an angle (rad), enlarged, then shifted (px), about the image's middle."""
    c, s = scale * math.cos(angle), scale * math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    affine = np.column_stack((turn, MIDDLE + shift - turn @ (600.0, 600.0)))
    return cv2.warpAffine(ground_patches("gravel"), affine, (320, 240)), turn


def looking_for(patches, points, warp=None, vacant=0, reach=8.0):
    count = len(points)
    warps = np.tile(np.eye(2) if warp is None else warp, (count, 1, 1))
    return FeatureSearch(
        np.arange(count), points, np.full(count, reach), warps, patches, vacant, 0, 25.0
    )


NOTHING = looking_for(np.empty((0, PATCH, PATCH), np.uint8), np.empty((0, 2)), vacant=8)


@pytest.mark.parametrize("camera", [LENS, BENT])
def test_corners_keep_their_distance_and_are_found_again_where_they_are(camera):
    image, _ = picture()
    first = matched(image, 1.0, camera, NOTHING)
    assert len(first.corners) == 8
    apart = np.linalg.norm(first.corners[:, None] - first.corners, axis=2) * 200
    assert (apart + 1e3 * np.eye(8)).min() > 20.0
    again = matched(image, 2.0, camera, looking_for(first.corner_patches, first.corners + 0.01))
    assert again.found.all()
    assert again.at == 2.0
    np.testing.assert_allclose(again.points, first.corners, atol=0.1 / 200)
    np.testing.assert_array_equal(again.patches, first.corner_patches)


@pytest.mark.parametrize(("angle", "scale"), [(0.0, 1.0), (0.5, 1.0), (3.0, 1.2), (0.0, 0.75)])
def test_a_patch_is_found_to_a_fraction_of_a_pixel_however_it_is_turned(angle, scale):
    before, _ = picture()
    first = matched(before, 1.0, LENS, NOTHING)
    near = np.linalg.norm(first.corners, axis=1) * 200 < 80
    after, turn = picture(angle, scale, (3.3, -2.6))
    true = first.corners[near] @ turn.T + np.array([3.3, -2.6]) / 200
    search = looking_for(first.corner_patches[near], true + 0.015, np.linalg.inv(turn))
    again = matched(after, 2.0, LENS, search)
    assert again.found.mean() > 0.7
    error = np.linalg.norm(again.points - true, axis=1)[again.found] * 200
    assert np.median(error) < 0.2


def test_what_is_not_there_is_not_found():
    image, _ = picture()
    first = matched(image, 1.0, LENS, NOTHING)
    search = looking_for(first.corner_patches, first.corners)
    for other in (np.full_like(image, 90), picture(0.0, 1.0, (150.0, 80.0))[0]):
        again = matched(other, 2.0, LENS, search)
        assert again.found.sum() <= 1
        np.testing.assert_array_equal(again.points[~again.found], first.corners[~again.found])
    assert len(matched(np.full_like(image, 90), 2.0, LENS, NOTHING).corners) == 0


def test_what_lies_at_the_border_or_beyond_is_out_of_view():
    image, _ = picture()
    patches = matched(image, 1.0, LENS, NOTHING).corner_patches[:3]
    places = np.array([[0.0, 0.0], [0.75, 0.0], [40.0, -3.0]])
    seen = matched(image, 2.0, LENS, looking_for(patches, places))
    assert seen.in_view.tolist() == [True, False, False]
    assert not seen.found[1:].any()


def test_with_too_few_in_view_new_corners_are_found_though_no_room_is_left():
    image, _ = picture()
    search = NOTHING._replace(vacant=0, enough=5)
    assert len(matched(image, 1.0, LENS, search).corners) == 5
    colour = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    np.testing.assert_array_equal(
        matched(colour, 1.0, LENS, search).corners, matched(image, 1.0, LENS, search).corners
    )
