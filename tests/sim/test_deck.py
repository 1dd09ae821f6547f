"""A landing deck: where it is, what stands on it, what is seen of it; against closed forms."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from pydantic import ValidationError
from scipy.integrate import quad

from missionkit.geometry import IDENTITY, from_euler, norm, rotate, to_matrix, vec
from missionkit.perception.camera_section import Camera
from missionkit.sim import kernel_layout as at
from missionkit.sim.deck import Deck, DeckMarker
from missionkit.sim.marker_visibility import Spotter
from missionkit.sim.plant import Plant
from missionkit.sim.random_blocks import streams
from missionkit.sim.solid_shapes import deck_solids, moved
from missionkit.sim.world import World, marker_attitude

PAPER = DeckMarker(dictionary="DICT_6X6_250", id=19, size=0.6)
SMALL = DeckMarker(dictionary="DICT_6X6_250", id=227, size=0.08, offset=(0.3, 0.2))


def deck(**changes):
    values = {"at": (10.0, 0.0), "height": 0.5, "size": 2.0, "markers": (PAPER, SMALL)}
    return Deck(**(values | changes))


def world(**changes):
    return World(world="deck", deck=deck(**changes))


def standing(of: World, north: float, east: float, height: float, seconds: float):
    """The plant after a vehicle was let fall, rotors off, over the deck."""
    plant = Plant(of, streams(0))
    plant.state[:3] = north, east, -of.deck.height - height
    plant.memory[at.ON_GROUND] = 0.0
    plant.advance(round(seconds * at.RATE))
    return plant


@pytest.mark.parametrize(("velocity", "rate"), [((0.6, -0.8), 0.0), ((0.6, -0.8), 12.0)])
def test_it_drives_as_its_velocity_says(velocity, rate):
    it = deck(velocity=velocity, turn_rate_deg=rate)
    for axis in (0, 1):
        way, _ = quad(lambda t, n=axis: it.velocity_at(t)[n], 0.0, 7.0)
        assert it.shift(7.0)[axis] == pytest.approx(way, abs=1e-9)
    assert math.hypot(*it.velocity_at(7.0)) == pytest.approx(1.0)


def test_the_kernel_drives_it_to_the_same_place():
    of = world(velocity=(0.6, -0.8), turn_rate_deg=12.0)
    plant = Plant(of, streams(0))
    plant.advance(7 * at.RATE)
    moved_by = plant.memory[at.DECK_AT : at.DECK_AT + 2] - of.deck.at
    assert moved_by == pytest.approx(of.deck.shift(7.0), abs=1e-4)


def test_who_stands_on_it_leans_and_drives_with_it():
    of = world(tilt_deg=8.0, facing_deg=40.0, velocity=(0.5, 0.3))
    plant = standing(of, 10.2, 0.1, 0.05, 4.0)
    assert plant.on_ground
    assert plant.memory[at.CRASHED] == 0.0
    assert plant.state[3:5] == pytest.approx((0.5, 0.3), abs=0.06)
    up = -to_matrix(plant.state[6:10])[:, 2]
    normal = rotate(marker_attitude(40.0, 82.0), vec(0.0, 0.0, 1.0))
    assert math.degrees(math.acos(min(1.0, float(up @ normal)))) < 0.5
    north, east = plant.state[:2] - plant.memory[at.DECK_AT : at.DECK_AT + 2]
    lean = math.tan(math.radians(8.0))
    c, s = math.cos(math.radians(40.0)), math.sin(math.radians(40.0))
    assert plant.state[2] == pytest.approx(-0.5 + lean * (c * north + s * east), abs=1e-6)


def test_beside_it_is_the_ground_and_its_side_is_a_crash():
    beside = standing(world(), 12.0, 0.0, 0.0, 1.0)
    assert beside.state[2] == 0.0
    plant = Plant(world(), streams(0))
    plant.state[:3] = 10.0, 0.0, -0.1
    plant.advance(2)
    assert plant.memory[at.CRASHED] == 1.0


def test_the_height_above_it_is_what_the_range_finder_sees():
    plant = Plant(world(), streams(0))
    plant.state[:3] = 10.3, -0.2, -3.0
    assert plant.above_surface()[:3] == pytest.approx((0.3, -0.2, -2.5))
    plant.state[0] = 5.0
    assert plant.above_surface()[2] == -3.0


def test_its_markers_lie_on_it():
    of = world(tilt_deg=10.0, facing_deg=250.0)
    large, small = of.deck_markers
    normal = rotate(large.attitude, vec(0.0, 0.0, 1.0))
    assert normal @ vec(0.0, 0.0, -1.0) == pytest.approx(math.cos(math.radians(10.0)))
    middle = vec(10.0, 0.0, -0.5)
    assert (large.pose.translation - middle) @ normal == pytest.approx(0.001)
    assert (small.pose.translation - middle) @ normal == pytest.approx(0.002)
    local = to_matrix(large.attitude).T @ (small.pose.translation - large.pose.translation)
    assert local[:2] == pytest.approx((0.2, 0.3))  # right, up


def test_the_camera_sees_its_markers_where_they_have_driven():
    of = world(velocity=(1.0, 0.0))
    camera = Camera(use="corners", mount={"position": [0, 0, 0], "tilt_deg": 90})
    spotter = Spotter(of.all_markers, camera.model(), np.zeros((0, 8)), np.random.default_rng(0), 2)
    x = np.zeros(13)
    x[:3], x[6:10] = (13.0, 0.0, -2.5), IDENTITY
    nothing = frozenset[int]()
    assert not any(number == 19 for _, number, _ in spotter.find(x, 0.0, nothing))
    seen = spotter.find(x, 0.0, nothing, (3.0, 0.0))
    found = {number: corners for _, number, corners in seen}
    middle = found[19].mean(axis=0)
    K = camera.model().matrix
    assert middle == pytest.approx((K[0, 2], K[1, 2]), abs=1.0)


@pytest.mark.parametrize("height", [2.5, 0.4])
def test_nested_markers_are_drawn_and_read(height):
    """The small one lies in the white middle of the large one; each is read at its distance."""
    from missionkit.sim.camera_renderer import Renderer  # noqa: PLC0415

    inner = DeckMarker(dictionary="DICT_6X6_250", id=227, size=0.08)
    of = world(markers=(PAPER, inner), tilt_deg=5.0)
    camera = Camera(use="rendered", mount={"tilt_deg": 90}, focal=300)
    renderer = Renderer(of, camera.model(), np.random.default_rng(1))
    body = moved_body(vec(12.0, 1.0, -0.5 - height))
    image = renderer.render(body, np.zeros(3), np.zeros(3), 0.0, shift=(2.0, 1.0))
    reader = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_6X6_250))
    _, ids, _ = reader.detectMarkers(image)
    assert (19 if height > 1.0 else 227) in ids.ravel()


def moved_body(place):
    from missionkit.geometry import Transform  # noqa: PLC0415

    return Transform(from_euler(0.0, 0.0, 0.0), place)


def test_a_moved_solid_shows_the_faces_of_where_it_was():
    solid = deck_solids(world())[0]
    away = vec(3.0, -2.0, 0.0)
    there = moved(solid, away)
    eye = vec(12.0, 0.5, -3.0)
    before, after = solid.faces(eye), there.faces(eye + away)
    assert len(before) == len(after) > 0
    assert all(norm(b.origin + away - a.origin) < 1e-12 for b, a in zip(before, after, strict=True))


def test_a_deck_that_cannot_be_is_refused():
    with pytest.raises(ValidationError, match="corner of the deck is below the ground"):
        deck(height=0.1, tilt_deg=10.0)
    with pytest.raises(ValidationError, match="stands on the take-off point"):
        world(at=(0.5, 0.5))
