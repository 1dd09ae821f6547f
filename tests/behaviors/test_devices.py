"""Devices of the payload: what they are ordered, how often, and where photos are taken."""

from __future__ import annotations

import numpy as np
import pytest
from behaviors.playing import TICK, at, play, status

from missionkit.behaviors.devices import Gripper, Photo, SetRelay, SetServo
from missionkit.behaviors.survey import Survey
from missionkit.geometry import vec
from missionkit.messages import CameraModel, Device, DeviceOrder
from missionkit.perception.camera_section import Camera

SQUARE = ((0.0, 0.0), (0.0, 20.0), (30.0, 20.0), (30.0, 0.0))


def orders(steps):
    return [order for step in steps for order in step.orders]


@pytest.mark.parametrize(
    ("behavior", "order"),
    [
        (SetServo(number=5, pulse=1900), DeviceOrder(Device.SERVO, 5, 1900.0)),
        (SetRelay(number=2, switch="open"), DeviceOrder(Device.RELAY, 2, 0.0)),
        (SetRelay(), DeviceOrder(Device.RELAY, 1, 1.0)),
        (Gripper(action="grab"), DeviceOrder(Device.GRIPPER, 1, 1.0)),
    ],
)
def test_one_order_then_it_waits(behavior, order):
    steps = play(behavior, [at(n * TICK, 1.0, 2.0, -5.0) for n in range(60)])
    assert orders(steps) == [order]
    assert steps[0].orders
    done = next(n for n, step in enumerate(steps) if step.done)
    assert done * TICK == pytest.approx(behavior.wait, abs=2 * TICK)
    assert all(step.guidance.position.tolist() == [1.0, 2.0, -5.0] for step in steps)


def test_on_the_ground_it_flies_nowhere():
    (step,) = play(Gripper(), [at(0.0, 1.0, 2.0, 0.0, status=status(in_air=False))])
    assert step.guidance is None
    assert step.orders


def test_photos_wait_until_the_vehicle_is_slow_but_not_for_ever():
    photo = Photo(count=2, every=1.0, patience=2.0)
    fast = [at(n * TICK, 0.0, 0.0, -5.0, velocity=vec(2.0, 0.0, 0.0)) for n in range(20)]
    slow = [at((20 + n) * TICK, 0.0, 0.0, -5.0) for n in range(40)]
    steps = play(photo, [*fast, *slow])
    taken = [n for n, step in enumerate(steps) if step.orders]
    assert taken == [20, 40]
    assert [order.value for order in orders(steps)] == [1.0, 2.0]
    assert steps[-1].done
    moving = {"velocity": vec(2.0, 0.0, 0.0)}
    never = play(photo, [at(n * TICK, 0.0, 0.0, -5.0, **moving) for n in range(45)])
    assert [n for n, step in enumerate(never) if step.orders] == [40]


def photographed(survey, speed=4.0):
    """Where photos are taken by a vehicle that flies the survey's lines exactly."""
    start = vec(*survey.way((0.0, 0.0, -10.0), {})[0])
    places = [np.array(p) for p in survey.way((0.0, 0.0, -10.0), {})]
    memory, now, place, spots = survey.begin(at(0.0, *start)), 0.0, start, []
    for goal in places[1:]:
        while np.linalg.norm(goal - place) > 1e-6:
            way = goal - place
            length = float(np.linalg.norm(way))
            place = place + way * min(1.0, speed * TICK / length)
            now += TICK
            step = survey.step(at(now, *place, velocity=speed * way / length), memory)
            memory = step.memory
            spots += [place] * len(step.orders)
    return np.array(spots)


def test_a_survey_takes_photos_at_its_spacing_and_only_over_the_area():
    survey = Survey(
        polygon=SQUARE, height=10.0, spacing=6.0, angle_deg=0.0, photo_every=3.0, entry="south-west"
    )
    spots = photographed(survey)
    east = np.round(spots[:, 1], 3)
    for line in np.unique(east):
        north = np.sort(spots[east == line, 0])
        assert north.min() >= -0.3
        assert north.max() <= 30.3
        assert np.diff(north) == pytest.approx(3.0, abs=0.25)
        assert north[0] < 3.0
        assert north[-1] > 27.0
    assert len(np.unique(east)) == len(survey.lines((0.0, 0.0)))


def test_the_spacing_of_photos_follows_from_the_camera():
    camera: CameraModel = Camera(use="corners", mount={"tilt_deg": 90}).model()
    survey = Survey(polygon=SQUARE, height=10.0, front_overlap=0.75).with_camera(camera)
    rows, focal = camera.height, camera.matrix[1, 1]
    assert survey.photo_every == pytest.approx(0.25 * 10.0 * rows / focal, rel=0.02)


def test_two_ways_to_say_the_spacing_are_one_too_many():
    with pytest.raises(ValueError, match="not both"):
        Survey(polygon=SQUARE, height=10.0, front_overlap=0.75, photo_every=2.0)
