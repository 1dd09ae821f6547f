"""Obstacle robots by plate and tower, in pictures of the simulator."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.geometry import Transform, from_euler, vec
from missionkit.messages import Frame
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.ground_plane import ViewNoise, on_ground
from missionkit.perception.tower import Tower
from missionkit.plugin_protocols import Prior
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.robot_look import RobotLook
from missionkit.sim.world import Arena, Ground, World

CAMERA = Camera(
    width=320, height=240, focal=160.0, mount=Mount(position=(0, 0, 0), tilt_deg=90.0)
).model()
LEVEL = Transform(from_euler(0.0, 0.0, 0.0), vec(0.0, 0.0, 0.0))
TARGETS = (RobotLook(0.3, -0.9, 1.0, 150), RobotLook(-0.8, 0.2, -2.0, 95))


@pytest.fixture(scope="module")
def renderer():
    world = World(world="grid", ground=Ground(texture="grid"), arena=Arena())
    return Renderer(world, CAMERA, np.random.default_rng(1))


def found(renderer, robots, height, *, at=(0.0, 0.0), roll=0.0, pitch=0.0):
    body = Transform(from_euler(roll, pitch, 0.4), vec(*at, -height))
    image = renderer.render(body, np.zeros(3), np.zeros(3), 0.004, robots=robots)
    boxes = Tower().boxes(Frame(0.0, image), CAMERA, Prior(body, None, 0.0))
    assert {it.kind for it in boxes} <= {"obstacle"}
    assert not any(it.sized for it in boxes)
    placed = [on_ground(it, CAMERA, body, 0.0, ViewNoise(), 0.34, 0.1) for it in boxes]
    return [it.position for it in placed if it is not None]


@pytest.mark.parametrize("height", [1.5, 2.0, 2.5])
@pytest.mark.parametrize("tower", [1.0, 2.0])
@pytest.mark.parametrize("bearing", [0.3, 2.4, -1.8])
def test_an_obstacle_robot_is_found_where_its_plate_is(renderer, height, tower, bearing):
    away = 0.3 * height + 0.1
    north, east = away * math.cos(bearing), away * math.sin(bearing)
    robots = (*TARGETS, RobotLook(north, east, 0.7, 205, tower))
    (place,) = found(renderer, robots, height, roll=0.05, pitch=-0.04)
    assert math.dist(place, (north, east)) < 0.06


def test_straight_below_the_top_hides_the_plate(renderer):
    (place,) = found(renderer, (RobotLook(0.02, 0.0, 0.0, 205, 1.0),), 3.0)
    assert math.dist(place, (0.0, 0.0)) < 0.1


@pytest.mark.parametrize("height", [1.0, 2.0, 3.0])
def test_lines_targets_and_the_arenas_side_are_none(renderer, height):
    assert not found(renderer, TARGETS, height)
    assert not found(renderer, (), height, at=(9.6, 3.0), roll=0.1)


def test_without_pose_or_picture_it_finds_nothing():
    frame = Frame(0.0, np.zeros((240, 320), np.uint8))
    assert Tower().boxes(frame, CAMERA, Prior(None, None)) == ()
    assert Tower().boxes(frame._replace(image=None), CAMERA, Prior(LEVEL, None, 2.0)) == ()
