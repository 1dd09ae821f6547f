"""Ground robots are drawn where they stand, as large as they are, in the right order."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.geometry import Transform, from_euler, vec
from missionkit.perception.camera_section import Camera, Mount
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.robot_look import RobotLook
from missionkit.sim.world import World

STILL = np.zeros(3)
FOCAL = 277.0


def drawn(robots=(), *, north=0.0, height=2.0, tilt=90.0, **world):
    """Return a frame of a camera over the origin that has north above, as signed numbers."""
    eye = Camera(
        width=320, height=240, focal=FOCAL, mount=Mount(position=(0, 0, 0), tilt_deg=tilt)
    ).model()
    scene = World.model_validate({"world": "w", "ground": {"texture": "concrete"}, **world})
    body = Transform(from_euler(0.0, 0.0, 0.0), vec(north, 0.0, -height))
    frame = Renderer(scene, eye, np.random.default_rng(1)).render(
        body, STILL, STILL, 0.0, robots=robots
    )
    return frame.astype(int)


def changed(robots, **view):
    return np.abs(drawn(robots, **view) - drawn((), **view)) > 40


def plate(image, robot, height=2.0):
    """Return the mean grey of the plate beside its pad."""
    scale = FOCAL / (height - 0.1)
    row, column = 119.5 - scale * robot.north, 159.5 + scale * robot.east
    left = round(column - 0.09 * scale)
    return image[round(row) - 3 : round(row) + 3, left - 2 : left + 3].mean()


def test_a_robot_below_is_a_disc_of_its_size():
    robot = RobotLook(0.3, -0.4, 0.7, 20)
    rows, columns = np.nonzero(changed([robot], height=2.1))
    scale = FOCAL / 2.0  # its top is 2 m below
    assert 119.5 - rows.mean() == pytest.approx(scale * robot.north, abs=6)  # its shadow pulls
    assert columns.mean() - 159.5 == pytest.approx(scale * robot.east, abs=6)
    side = 0.5 * (np.ptp(np.percentile(rows, [1, 99])) + np.ptp(np.percentile(columns, [1, 99])))
    assert side == pytest.approx(scale * 0.34, rel=0.15)


def test_the_plate_has_its_grey_level_and_the_bumper_is_in_front():
    light, dark = RobotLook(0.5, 0.0, 0.0, 200), RobotLook(-0.5, 0.0, 0.0, 60)
    image = drawn([light, dark])
    assert plate(image, light) > 150
    assert plate(image, dark) < 110
    scale = FOCAL / 1.9
    for heading in (0.0, 2.0):
        image = drawn([RobotLook(0.0, 0.0, heading, 128)])
        rim = [
            image[
                round(119.5 - scale * 0.155 * math.cos(heading + turn)),
                round(159.5 + scale * 0.155 * math.sin(heading + turn)),
            ]
            for turn in (0.0, math.pi)
        ]
        assert rim[0] < rim[1] - 50


def test_a_tower_reaches_outwards_and_hides_what_is_behind_it():
    tall = RobotLook(0.5, 0.0, 0.0, 200, 1.5)
    rows, _ = np.nonzero(changed([tall]))
    top = FOCAL * 0.5 / (2.0 - 1.5)
    assert 119.5 - rows.min() == pytest.approx(min(119.5, top), abs=4)
    near, far = RobotLook(2.0, 0.0, 0.0, 20, 1.9), RobotLook(3.0, 0.0, 0.0, 20)
    ahead = {"north": 0.0, "height": 1.0, "tilt": 10.0}
    both, alone = drawn([far, near], **ahead), drawn([near], **ahead)
    pole = (slice(60, 150), slice(157, 163))
    assert np.abs(both - alone)[pole].mean() < 8
    assert np.abs(drawn([near, far], **ahead) - both).mean() < 4  # in whatever order


def test_a_robot_behind_a_wall_is_hidden_by_it_and_one_before_it_is_not():
    wall = {"use": "box", "min": [3.0, -2.0], "max": [3.1, 2.0], "height": 1.0}
    view = {"height": 0.5, "tilt": 5.0, "obstacles": [wall]}
    assert not changed([RobotLook(4.0, 0.0, 0.0, 20)], **view).any()
    assert changed([RobotLook(2.0, 0.0, 0.0, 20)], **view).any()


@pytest.mark.parametrize(("texture", "crossings"), [("grid", 4), ("lines", 0)])
def test_lines_are_painted_on_whole_metres(texture, crossings):
    """Where lines along north and east meet, a metre apart, all of it is white; also far away."""
    for place in (0.0, 37.0, 79.0, -123.0):
        image = drawn(north=place, ground={"texture": texture})
        scale = FOCAL / 2.0
        spots = [(round(119.5 - scale * n), 160) for n in (-0.5, 0.5)]
        between = [
            image[row - 2 : row + 3, column - 1 : column + 2].mean() for row, column in spots
        ]
        here = image[117:123, 158:162].mean()
        assert here > 165  # a line runs along north through the origin in both
        assert min(between) > 165
        off = [image[119:121, round(159.5 + scale * e)].mean() for e in (-0.5, 0.5)]
        assert (min(off) > 165) == (crossings > 0)


def test_the_arena_has_its_lines_the_goals_brightest():
    view = {"arena": {"side": 4.0, "goal": "north"}, "ground": {"texture": "grass"}}
    goal = drawn(north=1.95, **view)[116:124, 60:260].mean()
    other = drawn(north=-1.95, **view)[116:124, 60:260].mean()
    assert goal > 225 > other > 180
