"""Pictures of an arena show its robots where they were, and what became of them."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image, ImageColor

from missionkit.perception.camera_section import Camera
from missionkit.recorder.palette import FENCE_COLOUR, HOME_COLOUR
from missionkit.sim.arena import Arena
from missionkit.sim.ground_robots import HOME, LOST
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import World
from studies.arena_figure import HEAD, MARGIN, SIDE, Film, animation, film_of, frame, strip


def film(moments: int = 11) -> Film:
    """Return two robots on their way north, of which one gets home, and one that goes east."""
    times = np.arange(float(moments))
    robots = np.zeros((moments, 3, 3))
    robots[:, 0, 0], robots[:, 0, 1] = 8.0 + 0.33 * times, -5.0
    robots[:, 1, 1], robots[:, 1, 2] = 8.0 + 0.33 * times, np.pi / 2
    robots[:, 2, 0] = 3.0
    out = np.where(np.abs(robots[:, :, :2]).max(axis=2) > 10.0, (HOME, LOST, 0.0), 0.0)
    vehicle = np.column_stack((times, times, -times))
    captions = [f"state {n}" for n in range(moments)]
    return Film(Arena(), times, robots, out, 1, vehicle, captions)


def colour(image: Image.Image, north: float, east: float) -> np.ndarray:
    scale = SIDE / 20.0
    spot = round(MARGIN + scale * (east + 10.0) - 2), round(HEAD + scale * (10.0 - north) + 2)
    return np.array(image.convert("RGB").getpixel(spot))


def test_robots_are_shown_until_a_little_after_they_left():
    it = film()
    for robot, paint in ((0, HOME_COLOUR), (1, FENCE_COLOUR)):
        there = it.robots[8, robot, :2]
        assert colour(frame(it, 8), *there) == pytest.approx(ImageColor.getrgb(paint), abs=3)
    assert colour(frame(it, 10), 3.0, 0.0).max() < 200  # an obstacle robot stays
    late = it._replace(times=2.0 * it.times)
    assert colour(frame(late, 10), *it.robots[10, 0, :2]).min() > 170


def test_a_strip_and_an_animation_have_a_picture_a_moment(tmp_path):
    strip(tmp_path / "strip.png", film(), (0.0, 4.0, 8.0, 10.0))
    wide, high = frame(film(), 0).size
    with Image.open(tmp_path / "strip.png") as page:
        assert page.size == (3 * wide, 2 * high)
    animation(tmp_path / "run.gif", film())
    with Image.open(tmp_path / "run.gif") as moving:
        assert (moving.size, moving.n_frames) == ((wide, high), 6)


def test_a_flight_becomes_a_film():
    world = World.model_validate({"world": "w", "arena": {"side": 12}, "robots": {"count": 2}})
    vehicle = SimulatedVehicle(world, Camera(use="none"), 1)
    vehicle.advance(2.0)
    made = film_of(vehicle)
    assert made.arena.side == 12.0
    assert made.robots[-1, 0, 0] == pytest.approx(1.0 + 2.0 * 0.33, abs=0.02)
    assert made.vehicle is not None
    assert len(made.vehicle) == len(made.times) == len(made.robots)
