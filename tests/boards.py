"""Images of a ChArUco board through a known lens."""

from __future__ import annotations

import cv2
import numpy as np

from missionkit.perception.charuco import board

BOARD = board(7, 5, 0.04, 0.03, "DICT_4X4_50")
MATRIX = np.array([[560.0, 0, 325], [0, 555, 236], [0, 0, 1]])
LENS = np.array([-0.2, 0.05, 0.001, -0.001, 0.0])
SCALE = 1600.0  # px of paper a metre, about as many as the nearest image has
MIDDLE = np.array([0.14, 0.1, 0.0])  # m, of the board

# No finer than the image, and as soft as a lens makes it: sampling sharp edges would move corners.
PAPER = cv2.GaussianBlur(BOARD.generateImage((448, 320)), (0, 0), 0.8)
SOFT = 0.6  # px

GRID = np.stack(np.meshgrid(np.arange(640.0), np.arange(480.0)), -1).reshape(-1, 1, 2)


def rays(matrix, distortion):
    """Return where each pixel looks; OpenCV's five iterations do not converge at the edges."""
    ends = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-10)
    return cv2.undistortPoints(GRID, matrix, distortion, criteria=ends).reshape(-1, 2)


RAYS = rays(MATRIX, LENS)


def rendered(turn, centre):
    """Return the image of the board, by following each pixel's ray to the paper."""
    rotation = cv2.Rodrigues(np.array(turn))[0]
    shift = np.array(centre) - rotation @ MIDDLE
    plane = np.linalg.inv(np.column_stack([rotation[:, :2], shift]))
    hit = np.column_stack([RAYS, np.ones(len(RAYS))]) @ plane.T
    at = (hit[:, :2] / hit[:, 2:] * SCALE - 0.5).astype(np.float32).reshape(480, 640, 2)
    sharp = cv2.remap(PAPER, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderValue=255)
    return cv2.GaussianBlur(sharp, (0, 0), SOFT)


def poses(count, seed=4, reach=2.0, tilt=0.5):
    """Return turns (rad) and centres (m); `reach` 1 keeps the board in the middle of the image."""
    chance = np.random.default_rng(seed)
    turns = chance.uniform(-tilt, tilt, (count, 3))
    far = np.array([0.09 * reach, 0.06 * reach])
    return list(zip(turns, chance.uniform([*-far, 0.35], [*far, 0.5], (count, 3)), strict=True))


def photographs(count, **options):
    return [rendered(*pose) for pose in poses(count, **options)]


def astray(matrix, distortion):
    """Return by how much (px) a lens misplaces what each pixel of the image looks at."""
    seen = np.column_stack([RAYS, np.ones(len(RAYS))])
    at, _ = cv2.projectPoints(
        seen, np.zeros(3), np.zeros(3), np.array(matrix), np.array(distortion)
    )
    return np.linalg.norm(at - GRID, axis=2).ravel()
