from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from missionkit.geometry import IDENTITY, Transform, from_euler, vec
from missionkit.messages import Frame
from missionkit.perception.apparent_size import size_gate
from missionkit.perception.blob import Blob
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.square_pose import project
from missionkit.plugin_protocols import Prior

CAMERA = Camera(
    width=320, height=240, focal=277.0, mount=Mount(position=(0, 0, 0), tilt_deg=90.0)
).model()
GROUND = 0.3
DIAMETER, TOP = 0.34, 0.1
PLACES = ((0.4, -0.5), (-0.3, 0.6), (0.0, 0.0))  # north and east of the vehicle, m


def above(height=2.0, roll=0.0, pitch=0.0) -> Transform:
    return Transform(from_euler(roll, pitch, 0.0), vec(0.0, 0.0, GROUND - height))


def scene(body, places=PLACES, *, paint=(200, 200, 200), floor=(110, 110, 110), diameter=DIAMETER):
    """Return a BGR image of discs on the ground, and their centres (n, 2), px."""
    image = np.full((240, 320, 3), floor, np.uint8)
    eye, angles, centres = (body @ CAMERA.mount).inverse(), np.linspace(0, 2 * math.pi, 60), []
    for north, east in places:
        ring = 0.5 * diameter * np.column_stack((np.cos(angles), np.sin(angles)))
        points = np.column_stack((np.add(ring, (north, east)), np.full(60, GROUND - TOP)))
        outline = project(points, eye, CAMERA)
        cv2.fillConvexPoly(image, np.rint(16 * outline).astype(np.int32), paint, cv2.LINE_AA, 4)
        centres.append(outline.mean(axis=0))
    noise = np.random.default_rng(0).normal(0.0, 4.0, image.shape)
    return np.clip(image + noise, 0, 255).astype(np.uint8), np.array(centres)


def grey(image):
    return cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)


def found(detector, image, body):
    boxes = detector.boxes(Frame(0.0, image), CAMERA, Prior(body, None, GROUND))
    return sorted(boxes, key=lambda it: it.centre[0])


@pytest.mark.parametrize("as_grey", [True, False])
@pytest.mark.parametrize("body", [above(), above(2.6, 0.15, -0.1)], ids=["level", "tilted"])
def test_discs_as_large_as_a_robot_are_found_where_they_are(as_grey, body):
    image, centres = scene(body)
    boxes = found(Blob(), grey(image) if as_grey else image, body)
    assert len(boxes) == 3
    for box, centre in zip(boxes, sorted(centres.tolist()), strict=True):
        assert box.centre == pytest.approx(centre, abs=1.0)
        assert (box.detector, box.kind, box.id) == ("blob", "robot", None)
        assert 0.6 < box.score <= 1.0


def test_a_colour_is_found_among_others_as_bright():
    body = above()
    red, at = scene(body, PLACES[:1], paint=(40, 40, 220))
    green, _ = scene(body, PLACES[1:2], paint=(40, 200, 40))
    image = np.where(np.ptp(red, axis=2, keepdims=True) > 60, red, green)
    (box,) = found(Blob(hue_deg=0), image, body)
    assert box.centre == pytest.approx(at[0], abs=1.0)
    (box,) = found(Blob(hue_deg=350), image, body)  # hues go round
    assert box.centre == pytest.approx(at[0], abs=1.0)
    assert found(Blob(hue_deg=240), image, body) == []


def test_in_a_grey_frame_a_hue_says_nothing_and_brightness_counts():
    body = above()
    image, _ = scene(body, paint=(40, 40, 220), floor=(20, 20, 20))
    assert len(found(Blob(hue_deg=240), grey(image), body)) == 3
    dark, _ = scene(body, paint=(30, 30, 30))
    assert found(Blob(), grey(dark), body) == []
    assert len(found(Blob(brightness="dark"), grey(dark), body)) == 3


@pytest.mark.parametrize("diameter", [0.2, 0.5])
def test_blobs_of_another_size_do_not_count(diameter):
    body = above()
    image, _ = scene(body, diameter=diameter)
    assert found(Blob(), image, body) == []
    assert len(found(Blob(diameter=diameter), image, body)) == 3


def test_a_disc_cut_by_the_edge_and_a_bar_do_not_count():
    body = above()
    image, _ = scene(body, ((0.675, 0.0),))  # by 4 px
    assert found(Blob(), image, body) == []
    bar = np.full((240, 320), 110, np.uint8)
    bar[100:148, 20:300] = 200
    assert found(Blob(), bar, body) == []


def test_nothing_is_found_from_nowhere_or_without_an_image():
    image, _ = scene(above())
    assert Blob().boxes(Frame(0.0, image), CAMERA, Prior(None, None)) == ()
    assert Blob().boxes(Frame(0.0, None, (), ()), CAMERA, Prior(above(), None)) == ()
    below = Transform(IDENTITY, vec(0.0, 0.0, 1.0))
    assert Blob().boxes(Frame(0.0, image), CAMERA, Prior(below, None)) == ()


@pytest.mark.parametrize("body", [above(), above(2.6, 0.2, -0.15)], ids=["level", "tilted"])
def test_the_expected_width_is_that_of_a_small_bar_across_the_line_of_sight(body):
    """P4 (7) at any pixel: f_x A / depth."""
    gate = size_gate(CAMERA, body, GROUND, diameter=DIAMETER, top=TOP, margin=4.0)
    eye = body @ CAMERA.mount
    for north, east in PLACES:
        place = np.array([north, east, GROUND - TOP])
        pixel = project(place[None], eye.inverse(), CAMERA)[0]
        depth = eye.inverse().apply(place)[2]
        assert gate.width(*pixel) == pytest.approx(277.0 * DIAMETER / depth)
    least, largest = gate.spans(CAMERA)
    assert least < gate.width(160, 120) - 3.9
    assert largest > gate.width(160, 120) + 3.9


def test_too_small_an_object_is_not_looked_for():
    gate = size_gate(CAMERA, above(30.0), GROUND, diameter=DIAMETER, top=TOP, margin=2.0)
    assert gate.spans(CAMERA) is None
