from __future__ import annotations

import numpy as np
import pytest

from missionkit.perception import image_files
from missionkit.perception.opencv_helpers import (
    decode_grey,
    dictionary,
    encode_jpeg,
    grey,
    marker_bitmap,
)


def test_a_jpeg_decodes_to_the_image_it_was():
    image = np.add.outer(np.arange(48), np.arange(64)).astype(np.uint8)
    data = encode_jpeg(image, 95)
    assert len(data) < image.size
    assert np.abs(decode_grey(data).astype(int) - image).max() <= 3


@pytest.mark.parametrize("data", [b"", b"not a picture"])
def test_a_non_image_is_reported(data):
    with pytest.raises(ValueError, match=f"{len(data)} bytes are not an image"):
        decode_grey(data)


def test_a_marker_has_a_black_border_and_its_own_bits():
    one, other = (marker_bitmap("DICT_6X6_250", i, 80) for i in (23, 62))
    assert one.shape == (80, 80)
    assert one[:10].max() == one[:, -10:].max() == 0
    assert (one != other).any()


def test_unknown_dictionary_and_id_are_refused_with_the_alternatives():
    with pytest.raises(ValueError, match="did you mean 'DICT_5X5_100'"):
        dictionary("DICT_5X5_10")
    with pytest.raises(ValueError, match="ids 0 to 249, not 250"):
        marker_bitmap("DICT_6X6_250", 250, 80)


def test_a_colour_image_becomes_grey():
    assert grey(np.full((4, 6, 3), 77, np.uint8)).tolist() == [[77] * 6] * 4


def test_an_image_that_claims_to_be_huge_is_not_decoded(tmp_path):
    claim = b"P5 20000 20000 255\n" + bytes(400)
    with pytest.raises(ValueError, match="not an image"):
        decode_grey(claim)
    (tmp_path / "huge.pgm").write_bytes(claim)
    assert image_files.read(str(tmp_path / "huge.pgm")) is None
