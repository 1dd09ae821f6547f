"""The gimbal's behaviour: one aim, that lasts; done when there, or when patience ends."""

from __future__ import annotations

import math

import pytest
from behaviors.playing import TICK, at, marker, play

from missionkit.behaviors.gimbal import Gimbal
from missionkit.camera_pointing import angles_to
from missionkit.geometry import rotate, vec
from missionkit.messages import GimbalAim, GimbalAngles, GimbalReading, Health
from missionkit.perception.camera_section import Camera

CAMERA = Camera(use="corners", gimbal={}).model()


def turned(now, pitch_deg, yaw_deg, **changes):
    angles = GimbalAngles(math.radians(pitch_deg), math.radians(yaw_deg))
    return at(now, 0.0, 0.0, -10.0, gimbal=GimbalReading(now, angles), **changes)


def test_it_is_done_once_the_gimbal_is_there():
    gimbal = Gimbal(pitch_deg=-90, yaw_deg=20).with_camera(CAMERA)
    steps = play(gimbal, [turned(n * TICK, -9.0 * n, 2.0 * n) for n in range(12)])
    assert next(n for n, step in enumerate(steps) if step.done) == 10
    assert steps[0].gimbal.angles == (math.radians(-90.0), math.radians(20.0))
    assert steps[0].guidance.position.tolist() == [0.0, 0.0, -10.0]


def test_without_readings_it_is_done_when_its_patience_ends():
    gimbal = Gimbal(pitch_deg=-45, patience=1.0).with_camera(CAMERA)
    steps = play(gimbal, [at(n * TICK, 0.0, 0.0, -10.0) for n in range(30)])
    assert next(n for n, step in enumerate(steps) if step.done) == 20
    assert steps[0].note == "how it is turned is not known"


@pytest.mark.parametrize("yaw", [0.0, 1.0, -2.5])
def test_angles_look_at_the_place_from_where_the_gimbal_sits(yaw):
    seen = at(0.0, 1.0, 2.0, -10.0, yaw=yaw, targets={"trunk": marker(8.0, -3.0, -1.0)})
    place = seen.targets["trunk"].position
    for aim in (GimbalAim(place=place), GimbalAim(target="trunk")):
        pitch, around = angles_to(aim, CAMERA, seen)
        eye = seen.position + rotate(seen.attitude, CAMERA.mount.translation)
        far = math.dist(eye, place)
        flat = far * math.cos(pitch)
        looks_at = eye + vec(
            flat * math.cos(yaw + around), flat * math.sin(yaw + around), -far * math.sin(pitch)
        )
        assert looks_at == pytest.approx(place)


def test_a_target_that_is_not_known_or_an_estimate_that_has_diverged_leads_nowhere():
    assert angles_to(GimbalAim(target="trunk"), CAMERA, at(0.0, 0.0, 0.0, -10.0)) is None
    gone = at(0.0, 0.0, 0.0, -10.0, health=Health(True, True, 0.0, None, 0.3, 0))
    assert angles_to(GimbalAim(place=vec(5.0, 0.0, 0.0)), CAMERA, gone) is None


@pytest.mark.parametrize("aim", [{}, {"pitch_deg": 0, "target": "trunk"}])
def test_it_takes_one_aim(aim):
    with pytest.raises(ValueError, match="give one aim"):
        Gimbal(**aim)
