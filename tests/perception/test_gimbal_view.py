"""Sightings through a gimbal, against geometry; a gimbal that is not known shows nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.camera_pointing import camera_to_body
from missionkit.geometry import Transform, from_euler, vec
from missionkit.messages import GIMBAL_UNKNOWN, Frame, GimbalAngles, Observation
from missionkit.perception.aruco import Aruco
from missionkit.perception.camera_section import Camera
from missionkit.perception.marker_search import Priors
from missionkit.perception.square_pose import angle_between
from missionkit.perception.vision_pipeline import VisionPipeline
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.marker_visibility import Spotter
from missionkit.sim.world import Marker, World

SECTION = Camera(
    width=1280, height=960, focal=800, mount={"tilt_deg": 20}, gimbal={"yaw_deg": (-180, 180)}
)
CAMERA = SECTION.model()
MARKER = Marker(
    dictionary="DICT_6X6_250", id=5, size=0.8, position=(6.0, 9.0, 0.0), facing_deg=200.0
)
BODY = Transform(from_euler(0.15, -0.1, 0.4), vec(1.0, 2.0, -5.0))
TURNED = GimbalAngles(math.radians(-30.0), math.radians(32.0))
NOTHING = np.zeros((0, 8))


def state(body):
    return np.concatenate((body.translation, np.zeros(3), body.rotation, np.zeros(3)))


def looked(frame, body=BODY):
    eye = VisionPipeline(CAMERA, [Aruco(target="pad", id=5, size=0.8)])
    priors = Priors(body=lambda at: body, targets={}, goal=None)
    return eye.look(eye.begin(), Observation(2.0, frame=frame), priors)


@pytest.mark.parametrize("drawn", [True, False])
def test_a_sighting_on_the_fixed_mount_leads_to_where_the_marker_is(drawn):
    mount = camera_to_body(CAMERA, BODY.rotation, TURNED)
    if drawn:
        world = World(world="one marker", markers=[MARKER])
        picture = Renderer(world, CAMERA, np.random.default_rng(1))
        image = picture.render(BODY, np.zeros(3), np.zeros(3), 0.004, mount=mount)
        frame = Frame(2.0, image, gimbal=TURNED)
    else:
        spotter = Spotter([MARKER], CAMERA, NOTHING, np.random.default_rng(1))
        found = spotter.find(state(BODY), 0.004, frozenset(), mount=mount)
        frame = Frame(2.0, None, found, gimbal=TURNED)
    (sighting,) = looked(frame).sightings
    placed = BODY @ CAMERA.mount @ sighting.pose
    assert np.linalg.norm(placed.translation - MARKER.pose.translation) < 0.1
    assert angle_between(placed.rotation, MARKER.pose.rotation) < math.radians(5.0)
    straight = looked(frame._replace(gimbal=GimbalAngles(TURNED.pitch, TURNED.yaw + 0.2)))
    wrong = BODY @ CAMERA.mount @ straight.sightings[0].pose
    assert np.linalg.norm(wrong.translation - MARKER.pose.translation) > 1.0


def test_the_camera_stays_level_however_the_body_leans():
    mount = camera_to_body(CAMERA, BODY.rotation, GimbalAngles(0.0, math.radians(90.0)))
    axes = BODY @ mount
    ahead = axes.apply(vec(0.0, 0.0, 1.0)) - axes.translation
    heading = math.atan2(ahead[1], ahead[0])
    assert ahead[2] == pytest.approx(0.0, abs=1e-9)
    assert heading == pytest.approx(0.4 + math.pi / 2.0)
    down = axes.apply(vec(0.0, 1.0, 0.0)) - axes.translation
    assert down == pytest.approx(vec(0.0, 0.0, 1.0), abs=1e-9)


@pytest.mark.parametrize(("gimbal", "body"), [(None, BODY), (TURNED, None)])
def test_a_frame_is_not_used_while_gimbal_or_body_are_unknown(gimbal, body):
    mount = camera_to_body(CAMERA, BODY.rotation, TURNED)
    spotter = Spotter([MARKER], CAMERA, NOTHING, np.random.default_rng(1))
    found = spotter.find(state(BODY), 0.004, frozenset(), mount=mount)
    assert found
    seen = looked(Frame(2.0, None, found, gimbal=gimbal), body)
    assert seen.sightings == ()
    assert [look.silent for look in seen.looks] == [gimbal is None]
    events = [it.event for it in seen.memory.warnings]
    assert events == ([GIMBAL_UNKNOWN] if gimbal is None else [])
