"""Ground robots over the wire: a camera that is drawn elsewhere sees them where they really are."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.api.vehicle_camera import painter_of
from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.perception.camera_section import Camera, Mount
from missionkit.sim import ground_robots
from missionkit.sim.world import World
from missionkit.sitl import robot_messages
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.telemetry.reported_pose import Pose, reported_robots

WORLD = World.model_validate({"world": "w", "start": [-9, 0], "robots": {}, "obstacle_robots": {}})


def test_an_autopilot_says_where_robots_are_and_which_are_out_of_play(station):
    made = station("px4", world=WORLD)
    made.run(1.2)
    robots = made.state.body.robots
    robots[3, ground_robots.OUT] = ground_robots.HOME
    fields = robot_messages.debug_float_array(made.state).to_dict()
    cache = Cache(lambda: 0.0, frozenset())
    assert reported_robots(cache) == ()
    cache.put("DEBUG_FLOAT_ARRAY", fields)
    told = reported_robots(cache)
    assert told[3] is None
    assert told[0] == pytest.approx(robots[0, :3], abs=1e-6)
    assert told[13] == pytest.approx(robots[13, :3], abs=1e-5)
    cache.put("DEBUG_FLOAT_ARRAY", {**fields, "name": "other"})
    assert reported_robots(cache) == ()


def test_an_autopilot_without_robots_says_nothing_of_them(station):
    made = station("px4")
    assert robot_messages.debug_float_array(made.state) is None


@pytest.mark.parametrize("use", ["rendered", "corners"])
def test_a_painter_shows_the_reported_robots(use):
    look = Mount(position=(0.0, 0.0, 0.0), tilt_deg=90.0)
    section = Camera(use=use, width=320, height=240, focal=277.0, mount=look)
    paint = painter_of(section, WORLD)
    still = vec(0.0, 0.0, 0.0)
    pose = Pose(1.0, Transform(IDENTITY, vec(3.0, 0.0, -2.0)), still, still)
    empty, full = paint(pose, 1.0), paint(pose._replace(robots=((3.2, 0.3, 0.0),)), 1.0)
    if use == "corners":
        assert empty.boxes == ()
        assert full.boxes[0].centre == pytest.approx([201.0, 91.8], abs=8.0)
    else:
        rows, columns = np.nonzero(np.abs(full.image.astype(int) - empty.image) > 40)
        assert (columns.mean(), rows.mean()) == pytest.approx((201.0, 91.8), abs=8.0)
