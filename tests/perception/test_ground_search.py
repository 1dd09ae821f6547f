"""From boxes by any detector, or by the simulator, to what a frame shows on the ground."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scenes import priors

from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.ground_robot import GroundRobot
from missionkit.messages import BoxDetection, Frame, Observation
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.ground_plane import ViewNoise
from missionkit.perception.vision_pipeline import VisionPipeline
from missionkit.plugin import BoxDetector
from missionkit.plugin_containment import Containment

CAMERA = Camera(
    width=320, height=240, focal=277.0, mount=Mount(position=(0, 0, 0), tilt_deg=90.0)
).model()
ABOVE = Transform(IDENTITY, vec(3.0, 1.0, -2.0))


def box(column=159.5, row=119.5, side=47.0, score=0.9, **more) -> BoxDetection:
    return BoxDetection("sure", np.array([column, row]), (side, side), score, **more)


class Sure(BoxDetector):
    """Finds what it was given, and misbehaves on request."""

    kind = "sure"
    count: int = 1
    how: str = "well"

    def boxes(self, frame, camera, prior):
        assert prior.body is not None
        assert prior.ground == 0.5
        if self.how == "raise":
            raise ValueError("no idea")
        far = box(score=0.1)
        return {
            "well": (box(kind="robot", id=7), far, *(far,) * (self.count - 2))[: self.count],
            "list": [box()],
            "text": ("there",),
            "nan": (box(math.nan),),
            "outside": (box(400.0),),
            "empty": (box(side=0.0),),
            "too sure": (box(score=1.5),),
            "id": (box(id="7"),),
        }[self.how]


def seen(detectors, frame, contain=None, body=ABOVE):
    eye = VisionPipeline(CAMERA, detectors)
    believed = priors(body=body)._replace(ground=0.5, noise=ViewNoise(height=0.1))
    return eye.look(eye.begin(), Observation(frame.at, frame=frame), believed, contain)


PICTURE = Frame(1.0, np.zeros((240, 320), np.uint8))


def test_a_box_becomes_a_place_on_the_ground_below():
    ground = seen([Sure()], PICTURE).ground
    (it,) = ground.detections
    assert it.position == pytest.approx([3.0, 1.0])
    assert it.height == pytest.approx(2.5)  # the ground lies 0.5 m below the take-off point
    assert it.size == pytest.approx(47.0 / 277.0 * 2.5 / GroundRobot().diameter)
    assert (it.detector, it.kind, it.id, it.score) == ("sure", "robot", 7, 0.9)
    assert ground.at == 1.0
    assert np.ptp(ground.view, axis=0) == pytest.approx(2.5 / 277.0 * np.array([239.0, 319.0]))


def test_ready_boxes_serve_where_no_image_is_drawn():
    frame = Frame(1.0, None, (), (box(score=0.4), box(30.0)))
    found = seen([Sure()], frame).ground.detections
    assert [it.score for it in found] == [0.9, 0.4]
    assert found[0].position == pytest.approx([3.0, 1.0 - 129.5 / 277.0 * 2.5])


@pytest.mark.parametrize(
    ("detectors", "frame", "body"),
    [
        ([], PICTURE, ABOVE),
        ([Sure()], PICTURE, None),
        ([Sure()], Frame(1.0, None, ()), ABOVE),
        ([], Frame(1.0, None, (), (box(),)), ABOVE),
    ],
    ids=["no detector", "vehicle's pose unknown", "neither image nor boxes", "boxes not asked for"],
)
def test_where_nothing_can_be_said_there_is_no_ground_frame(detectors, frame, body):
    assert seen(detectors, frame, body=body).ground is None


def test_a_frame_that_shows_nothing_is_known_to_show_nothing():
    assert seen([Sure(count=0)], PICTURE).ground.detections == ()
    assert seen([Sure()], Frame(1.0, None, (), ())).ground.detections == ()


def test_a_repeated_frame_is_no_frame():
    eye = VisionPipeline(CAMERA, [Sure()])
    believed = priors(body=ABOVE)._replace(ground=0.5)
    memory = eye.begin()
    answers = []
    for at, column in ((1.0, 100.0), (1.05, 100.0), (1.1, 101.0)):
        frame = Frame(at, None, (), (box(column),))
        memory, looks, _, ground = eye.look(memory, Observation(at, frame=frame), believed)
        answers.append((looks[-1].silent, ground is None))
    assert answers == [(False, False), (True, True), (False, False)]


def test_twenty_boxes_of_a_detector_count_the_surest_first():
    found = seen([Sure(count=50)], PICTURE).ground.detections
    assert len(found) == 20
    assert found[0].score == 0.9


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("raise", "raised ValueError: no idea"),
        ("list", "returned list, expected a tuple of BoxDetections"),
        ("text", "returned a tuple with str, expected a BoxDetection"),
        ("nan", "returned a box with centre of a wrong type, not finite or out of range"),
        ("outside", "returned a box centred at (400, 120) px, outside the image"),
        ("empty", "returned a box with size of a wrong type, not finite or out of range"),
        ("too sure", "returned a box with score of a wrong type, not finite or out of range"),
        ("id", "returned a box with detector, kind or id of a wrong type, not finite or out of"),
    ],
)
def test_what_a_detector_does_wrong_is_noted_and_the_others_count(how, why):
    contain = Containment()
    ground = seen([Sure(how=how), Sure()], PICTURE, contain).ground
    (failure,) = contain.take()
    assert failure.startswith(f"sure {why}")
    assert len(ground.detections) == 1
    assert seen([Sure(how=how)], PICTURE, contain).ground is None
