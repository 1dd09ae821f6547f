"""Maps from images and polygons: which cell is where, and what a metre in it costs."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from pydantic import ValidationError

from missionkit.messages import Occupancy
from missionkit.perception.map_image import decode_shades
from missionkit.planning.map_section import KnownMap
from missionkit.planning.map_server import DEAREST, MapFile
from missionkit.planning.polygon_cells import drawn

INF = math.inf
FILE = MapFile(image="map.pgm", resolution=0.5, origin=(10.0, 20.0, 0.0))


def test_the_last_row_of_an_image_is_the_south_of_the_map():
    image = np.full((3, 4), 254, np.uint8)
    image[0, 0] = 0  # upper left: north-west
    known = FILE.read(image / 255.0)
    assert known.blocked((21.25, 10.25))
    assert np.isinf(known.costs).sum() == 1
    assert known.costs[2, 0] == INF
    assert known.covers((20.0, 10.0))
    assert known.covers((21.49, 11.99))
    assert not known.covers((21.5, 10.0))
    assert not known.covers((20.0, 9.99))


def test_grey_is_free_blocked_or_not_known():
    greys = np.array([[254, 206, 205, 128, 90, 89, 0]], np.uint8)
    p = (255.0 - greys) / 255.0
    read_costs = FILE.read(greys / 255.0).costs
    np.testing.assert_array_equal(read_costs == 1.0, p < 0.196)
    assert np.isinf(read_costs[p >= 0.196]).all()
    inverted = FILE.model_copy(update={"negate": 1}).read((255 - greys) / 255.0).costs
    np.testing.assert_array_equal(inverted, read_costs)


def test_mode_scale_makes_grey_dearer():
    scale = FILE.model_copy(update={"mode": "scale", "free_thresh": 0.2, "occupied_thresh": 0.6})
    (costs,) = scale.read(np.array([[255, 204, 153, 102, 100]]) / 255.0).costs
    assert costs[:4] == pytest.approx([1.0, 1.0, (1.0 + DEAREST) / 2.0, DEAREST])
    assert costs[4] == INF


@pytest.mark.parametrize("ending", ["png", "pgm"])
def test_png_and_pgm_are_read_alike(tmp_path, ending):
    image = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20
    path = tmp_path / f"map.{ending}"
    cv2.imwrite(str(path), image)
    np.testing.assert_allclose(decode_shades(path.read_bytes(), 12), image / 255.0)


def test_a_text_pgm_is_read_too():
    data = b"P2\n# written by hand\n3 1\n255\n0 128 255\n"
    np.testing.assert_allclose(decode_shades(data, 3), [[0.0, 128 / 255, 1.0]])


@pytest.mark.parametrize(
    "data",
    [
        b"P5 3 1 100\n" + bytes([0, 50, 100]),
        b"P2 3 1 100 0 50 100 ",
        b"P5\n# of a scanner\n3 1\n# 16 bits\n1000\n" + np.array([0, 500, 1000], ">u2").tobytes(),
        b"P5 3 1 2\n" + bytes([0, 1, 2]),
    ],
)
def test_white_is_the_largest_value_of_a_pgm_whatever_it_is(data):
    np.testing.assert_allclose(decode_shades(data, 3), [[0.0, 0.5, 1.0]])


PNG_HEADER = b"\x89PNG\r\n\x1a\n" + b"\0\0\0\rIHDR" + b"\0\0\0\x05" * 2


def png(image):
    return cv2.imencode(".png", image)[1].tobytes()


def test_a_png_of_16_bits_is_read_in_full():
    np.testing.assert_allclose(
        decode_shades(png(np.array([[0, 32768, 65535]], np.uint16)), 3),
        [[0.0, 0.5, 1.0]],
        atol=1e-5,
    )


@pytest.mark.parametrize("mode", ["trinary", "scale"])
@pytest.mark.parametrize("shade", [0, 200, 255])
@pytest.mark.parametrize("alpha", [0, 254, 255])
def test_transparent_cells_are_unknown_and_blocked(mode, shade, alpha):
    image = np.full((2, 2, 4), 255, np.uint8)
    image[0, 0] = (shade, shade, shade, alpha)
    meta = FILE.model_copy(update={"mode": mode})
    known = meta.read(decode_shades(png(image), 4))
    opaque = meta.read(decode_shades(png(image[..., :3]), 4))
    assert np.isinf(known.costs[1, 0]) == (alpha < 255 or np.isinf(opaque.costs[1, 0]))
    assert np.isinf(known.costs).sum() <= 1


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"", "these 0 bytes are not a PNG or PGM image"),
        (b"P5 30000 30000 255\n\x00", "30000 x 30000 pixels, and 100 are the most"),
        (b"P5 999999999 999999999 255\n", "and 100 are the most"),
        (b"P5 5 5 255\n\x00\x01", "5 x 5 pixels by its header, but 2 in the file"),
        (b"P5 2 1 100\n\x00\x65", "a pixel of 101, and 100 is the largest by its header"),
        (b"P5 0 5 255\n", "it has 0 x 5 pixels"),
        (b"P5 2 1 0\n\x00\x00", "its largest value is 0"),
        (b"P5 2 1 70000\n\x00\x00", "its largest value is 70000"),
        (b"P2 2 1 255\n1 x", "a pixel is not a number"),
        (b"P5 -2 1 255\n1 x", "not a PNG or PGM"),
        (png(np.zeros((11, 10), np.uint8)), "10 x 11 pixels, and 100 are the most"),
        (png(np.zeros((5, 5), np.uint8))[:45], "a PNG that cannot be decoded: it is cut short"),
        (png(np.eye(9, dtype=np.uint8))[:-13], "it is cut short"),
        (png(np.eye(9, dtype=np.uint8)).replace(b"IDAT", b"IDAU"), "cut short or damaged"),
        (PNG_HEADER + b"\xff" * 40, "it is cut short or damaged"),
        (b"\x89PNG\r\n\x1a\n" + bytes(40), "it has 0 x 0 pixels"),
        (cv2.imencode(".jpg", np.zeros((5, 5), np.uint8))[1].tobytes(), "not a PNG or PGM"),
    ],
)
def test_an_invalid_image_is_refused_in_a_sentence(data, why):
    with pytest.raises(ValueError, match=why):
        decode_shades(data, 100)


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        ({"resolution": 0.0}, "greater than 0"),
        ({"free_thresh": 0.7}, "free_thresh must be below occupied_thresh"),
        ({"origin": (0.0, 0.0)}, "origin"),
        ({"negate": 2}, "negate"),
        ({"mode": "raw"}, "mode"),
        ({"colour": 1}, "colour"),
    ],
)
def test_a_map_file_that_cannot_be_is_refused(wrong, why):
    good = {"image": "map.pgm", "resolution": 0.5, "origin": (0.0, 0.0, 0.0)}
    MapFile(**good)
    with pytest.raises(ValidationError, match=why):
        MapFile(**(good | wrong))


def test_a_turned_map_turns_counter_clockwise():
    known = Occupancy(np.ones((4, 4)), 1.0, (0.0, 0.0), math.radians(90.0))
    assert known.spot(0.0, 1.0) == pytest.approx((1.0, 0.0))  # its x leads north
    assert known.spot(1.0, 0.0) == pytest.approx((0.0, -1.0))  # its y leads west
    rng = np.random.default_rng(0)
    askew = Occupancy(np.ones((4, 4)), 0.3, (2.0, -1.0), 0.7)
    for row, column in rng.uniform(-5.0, 5.0, (20, 2)):
        assert askew.cell(askew.spot(row, column)) == pytest.approx((row, column))


def test_a_polygon_blocks_every_cell_it_touches_and_no_other():
    triangle = [(1.2, 1.2), (6.8, 2.4), (2.0, 7.7)]
    known = drawn(((0.0, 0.0), (8.0, 8.0)), 1.0, [triangle])
    fine = drawn(((0.0, 0.0), (8.0, 8.0)), 0.02, [triangle])
    inner = np.isinf(fine.costs).reshape(8, 50, 8, 50).sum(axis=(1, 3))
    blocked = np.isinf(known.costs)
    assert blocked[inner > 100].all()
    assert (inner[blocked] > 0).all()
    assert not blocked[inner == 0].any()


def test_a_thin_wall_has_no_holes_and_a_small_one_is_not_lost():
    known = drawn(((0.0, 0.0), (10.0, 10.0)), 0.5, [[(0.1, 0.1), (9.9, 7.3), (9.9, 7.31)]])
    assert np.isinf(known.costs).any(axis=1).all()
    speck = [(3.1, 3.1), (3.11, 3.1), (3.1, 3.11)]
    assert np.isinf(drawn(((0.0, 0.0), (10.0, 10.0)), 0.5, [speck]).costs).sum() == 1


def test_weights_cost_and_walls_close():
    square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
    inner = [(1.2, 1.2), (1.8, 1.2), (1.8, 1.8), (1.2, 1.8)]
    known = drawn(((0.0, 0.0), (4.0, 4.0)), 1.0, [inner], [(square, 3.0), (inner, 2.0)])
    np.testing.assert_array_equal(known.costs[:2, :2], [[3.0, 3.0], [3.0, INF]])
    assert (known.costs[2:] == 1.0).all()


def test_the_gap_to_the_nearest_wall():
    known = drawn(((0.0, 0.0), (10.0, 10.0)), 0.5, [])
    assert known.gap((5.0, 5.0)) == INF
    walled = known.with_walls([(7.2, 5.1), (70.0, 0.0)])
    assert walled.gap((5.0, 5.1)) == pytest.approx(2.0)
    assert walled.gap((6.0, 4.0)) == pytest.approx(math.hypot(1.0, 1.0))
    assert walled.gap((7.3, 5.2)) == 0.0
    assert known.gap((7.0, 5.0)) == INF


@pytest.mark.parametrize(
    ("keys", "why"),
    [
        ({}, "needs 'file', or 'north' and 'east'"),
        ({"file": "a.yaml", "north": (0, 1)}, "'file' defines the whole map; leave out north"),
        ({"north": (0, 1)}, "needs 'file', or 'north' and 'east'"),
        ({"north": (1, 0), "east": (0, 1)}, "north: the second number must be larger"),
        ({"north": (0, 1), "east": (0, 1), "resolution": 1e-5}, "more than 4000000 cells"),
        ({"north": (0, 1), "east": (0, 1), "polygons": [[(0, 0), (1, 1)]]}, "polygons"),
    ],
)
def test_a_section_that_cannot_be_is_refused(keys, why):
    with pytest.raises(ValidationError, match=why):
        KnownMap(**keys)
