"""A lens is recovered from rendered views of a board, and poor views are refused."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from missionkit.perception.calibration import View, board, calibrate, view

BOARD = board(7, 5, 0.04, 0.03, "DICT_4X4_50")
MATRIX = np.array([[560.0, 0, 325], [0, 555, 236], [0, 0, 1]])
LENS = np.array([-0.2, 0.05, 0.001, -0.001, 0.0])
PAPER = BOARD.generateImage((1120, 800))
GRID = np.stack(np.meshgrid(np.arange(640.0), np.arange(480.0)), -1).reshape(-1, 1, 2)


def rays(matrix, distortion):
    """Return where each pixel looks; OpenCV's five iterations do not converge at the edges."""
    ends = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-10)
    return cv2.undistortPoints(GRID, matrix, distortion, criteria=ends).reshape(-1, 2)


RAYS = rays(MATRIX, LENS)


def rendered(turn, centre):
    """Return the image of the board, by following each pixel's ray to the paper."""
    rotation = cv2.Rodrigues(np.array(turn))[0]
    shift = np.array(centre) - rotation @ [0.14, 0.1, 0]
    plane = np.linalg.inv(np.column_stack([rotation[:, :2], shift]))
    hit = np.column_stack([RAYS, np.ones(len(RAYS))]) @ plane.T
    at = (hit[:, :2] / hit[:, 2:] * 4000 - 0.5).astype(np.float32).reshape(480, 640, 2)
    return cv2.remap(PAPER, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderValue=255)


def views(count):
    chance = np.random.default_rng(4)
    turns = chance.uniform(-0.5, 0.5, (count, 3))
    places = chance.uniform([-0.09, -0.06, 0.35], [0.09, 0.06, 0.5], (count, 3))
    found = [view(rendered(*it), BOARD) for it in zip(turns, places, strict=True)]
    return [it for it in found if it is not None]


def test_the_lens_is_recovered():
    lens = calibrate(views(20), BOARD)
    assert lens.error < 0.3
    assert (lens.width, lens.height) == (640, 480)
    np.testing.assert_allclose(lens.matrix, MATRIX, atol=4.0)


def test_the_lens_is_recovered_exactly_from_exact_corners():
    chance = np.random.default_rng(5)
    corners = BOARD.getChessboardCorners()
    exact = []
    for _ in range(20):
        place = chance.uniform([-0.2, -0.15, 0.35], [0.0, 0.0, 0.5])
        pixels = cv2.projectPoints(corners, chance.uniform(-0.5, 0.5, 3), place, MATRIX, LENS)[0]
        exact.append(View(640, 480, np.arange(len(corners)), pixels.reshape(-1, 2)))
    lens = calibrate(exact, BOARD)
    np.testing.assert_allclose(lens.matrix, MATRIX, atol=0.05)
    np.testing.assert_allclose(lens.distortion[:4], LENS[:4], atol=0.01)


def test_an_image_without_a_board_is_no_view():
    assert view(np.full((480, 640), 200, np.uint8), BOARD) is None


def test_too_few_views_are_refused():
    with pytest.raises(ValueError, match="seen in 3 images; 8 are needed"):
        calibrate(views(20)[:3], BOARD)


def test_one_view_repeated_is_refused():
    with pytest.raises(ValueError, match="only 1 of 12 views differ"):
        calibrate(views(2)[:1] * 12, BOARD)


def test_a_board_whose_markers_overlap_is_refused():
    with pytest.raises(ValueError, match="smaller"):
        board(7, 5, 0.03, 0.04, "DICT_4X4_50")
