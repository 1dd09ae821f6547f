"""A lens is recovered from views of a board, and what they do not determine is said."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from boards import BOARD, LENS, MATRIX, MIDDLE, astray, photographs, poses

from missionkit.perception.charuco import View, view
from missionkit.perception.lens_calibration import LEAST_VIEWS, calibrate, doubts

CORNERS = BOARD.getChessboardCorners()


def seen(images):
    found = [view(image, BOARD) for image in images]
    return [it for it in found if it is not None]


def projected(count, lens=LENS, noise=0.0, dice=7, **options):
    """Return views with exact corners, but for the noise (px), inside the image."""
    chance, found = np.random.default_rng(dice), []
    for turn, centre in poses(count, **options):
        shift = centre - cv2.Rodrigues(turn)[0] @ MIDDLE
        pixels = cv2.projectPoints(CORNERS, turn, shift, MATRIX, lens)[0].reshape(-1, 2)
        pixels += chance.normal(0.0, noise, pixels.shape)
        inside = np.all((pixels > 0) & (pixels < (639, 479)), axis=1)
        found.append(View(640, 480, np.flatnonzero(inside), pixels[inside]))
    return found


def test_the_lens_is_recovered_all_over_the_image():
    lens = calibrate(seen(photographs(24)), BOARD)
    assert lens.error < 0.1
    assert (lens.width, lens.height) == (640, 480)
    np.testing.assert_allclose(lens.matrix, MATRIX, atol=1.0)
    off = astray(lens.matrix, lens.distortion)
    assert np.quantile(off, 0.95) < 0.7
    assert off.max() < 1.2
    assert list(doubts(lens)) == []


def test_the_lens_is_recovered_exactly_from_exact_corners():
    lens = calibrate(projected(20), BOARD)
    np.testing.assert_allclose(lens.matrix, MATRIX, atol=0.01)
    np.testing.assert_allclose(lens.distortion, LENS, atol=0.001)


def test_the_deviations_bound_the_error_of_the_lens():
    lens = calibrate(projected(24, noise=0.2), BOARD)
    found = (*lens.matrix[[0, 1], [0, 1]], *lens.matrix[:2, 2], *lens.distortion[:4])
    truth = (*MATRIX[[0, 1], [0, 1]], *MATRIX[:2, 2], *LENS[:4])
    spreads = list(lens.deviations.values())[:8]
    assert np.all(np.abs(np.subtract(found, truth)) < 4.0 * np.array(spreads))
    assert np.abs(np.subtract(found, truth)).max() > 0.1 * max(spreads)


def test_a_k3_that_only_follows_the_noise_is_left_out():
    worst = []
    for dice in range(6):
        lens = calibrate(projected(20, noise=0.2, dice=dice, reach=1.0), BOARD)
        assert lens.distortion[4] == 0.0
        assert math.isnan(lens.deviations["k3"])
        worst.append(astray(lens.matrix, lens.distortion).max())
    assert max(worst) < 6.0  # with k3 fitted: 10


def test_a_k3_that_the_views_show_is_kept():
    strong = np.array([-0.3, 0.15, 0.0, 0.0, -0.08])
    lens = calibrate(projected(30, strong, noise=0.05, reach=2.5), BOARD)
    assert lens.distortion[4] == pytest.approx(-0.08, abs=3.0 * lens.deviations["k3"])
    assert lens.deviations["k3"] < 0.02


def test_views_of_the_middle_are_reported_to_miss_the_edges():
    lens = calibrate(projected(20, noise=0.2, reach=0.7), BOARD)
    text = "\n".join(doubts(lens))
    assert lens.covered < 0.6
    assert f"the board covers {lens.covered:.0%} of the image" in text
    assert "k2 = " in text
    assert "is not determined, worth ± " in text


def test_a_barely_tilted_board_is_reported():
    lens = calibrate(projected(20, noise=0.1, tilt=0.1), BOARD)
    text = "\n".join(doubts(lens))
    assert "the board is tilted by " in text
    assert "the focal length is known to " in text
    assert lens.tilts[0] < lens.tilts[1] < math.radians(9.0)


def test_an_image_without_a_board_is_not_a_view():
    assert view(np.full((480, 640), 200, np.uint8), BOARD) is None


def test_too_few_views_are_refused():
    with pytest.raises(ValueError, match=f"seen in 3 images; {LEAST_VIEWS} are needed"):
        calibrate(projected(3), BOARD)


def test_one_view_repeated_is_refused():
    with pytest.raises(ValueError, match="only 1 of 12 views differ"):
        calibrate(projected(1) * 12, BOARD)


@pytest.mark.parametrize(
    "pixels",
    [
        CORNERS[:, :2] * 1000.0,  # never tilted
        np.column_stack([np.arange(24) * 5.0, np.full(24, 50.0)]),  # all on one line
    ],
)
def test_views_that_no_lens_explains_are_refused(pixels):
    views = [
        View(640, 480, np.arange(24), pixels + np.array([20.0 * n, 10.0 * n])) for n in range(12)
    ]
    with pytest.raises(ValueError, match="no lens explains these views: tilt the board"):
        calibrate(views, BOARD)


def test_a_board_that_was_never_tilted_is_refused():
    with pytest.raises(ValueError, match="no lens explains these views: tilt the board"):
        calibrate(projected(20, noise=0.1, tilt=0.02), BOARD)


def test_badly_fitting_corners_are_reported():
    lens = calibrate(projected(24, noise=2.0), BOARD)
    assert "a reprojection error of 2.5 px is too much" in next(doubts(lens))


def test_images_of_several_sizes_are_refused():
    views = projected(12)
    odd = View(320, 240, views[0].ids, views[0].pixels)
    with pytest.raises(ValueError, match="of several sizes"):
        calibrate([*views, odd], BOARD)
