"""A ChArUco board: what cannot be one, and how it is printed."""

from __future__ import annotations

import struct

import cv2
import numpy as np
import pytest
from boards import BOARD

from missionkit.perception.charuco import DOTS, board, printed, view


@pytest.mark.parametrize(
    ("plan", "reason"),
    [
        ((7, 5, 0.03, 0.04, "DICT_4X4_50"), "smaller"),
        ((2, 5, 0.04, 0.03, "DICT_4X4_50"), "at least 3x3 squares"),
        ((12, 9, 0.04, 0.03, "DICT_4X4_50"), "12x9 squares need 54 markers; DICT_4X4_50 has 50"),
        ((7, 5, 0.04, 0.03, "DICT_4X4_5"), "did you mean 'DICT_4X4_50'"),
    ],
)
def test_what_cannot_be_a_board_is_refused(plan, reason):
    with pytest.raises(ValueError, match=reason):
        board(*plan)


def test_the_printed_board_has_its_true_size():
    data = printed(BOARD)
    at = data.index(b"pHYs")
    assert struct.unpack(">IIB", data[at + 4 : at + 13]) == (DOTS, DOTS, 1)  # dots a metre
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert image.shape == (round(0.21 * DOTS), round(0.29 * DOTS))  # with 5 mm of white
    small = cv2.resize(image, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    found = view(small, BOARD)
    assert len(found.ids) == 24
    metres = (found.pixels + 0.5) * 4 / DOTS
    corners = BOARD.getChessboardCorners()[found.ids, :2]
    np.testing.assert_allclose(metres - corners, 0.005, atol=0.0002)


def test_a_board_in_millimetres_is_not_drawn():
    with pytest.raises(ValueError, match="squares are given in metres"):
        printed(board(7, 5, 40.0, 30.0, "DICT_4X4_50"))
