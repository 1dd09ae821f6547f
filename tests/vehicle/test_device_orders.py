"""Orders to devices over MAVLink: each once, until acknowledged; what fails is said."""

from __future__ import annotations

import pytest
from vehicle.test_time import Wall

from missionkit.messages import Device, DeviceOrder
from missionkit.vehicle.command.device_orders import (
    ATTEMPTS,
    DIGICAM_CONTROL,
    GRIPPER,
    IMAGE_START_CAPTURE,
    REFUSED,
    SET_RELAY,
    SET_SERVO,
    DeviceQueue,
)
from missionkit.vehicle.link.message_cache import Cache

PHOTO = DeviceOrder(Device.CAMERA, 1, 7.0)
SERVO = DeviceOrder(Device.SERVO, 5, 1900.0)


class Devices:
    """An autopilot that answers as `results` says, and an unknown command not at all."""

    def __init__(self, results):
        self.wall, self.received, self.said, self.events = Wall(), [], [], []
        self.results = results
        self.cache = Cache(self.wall)
        self.queue = DeviceQueue(self, self.cache, self.said.append, self.events.append)

    def send(self, name, **fields):
        assert name == "COMMAND_LONG"
        self.received.append((fields["command"], *(fields[f"param{n}"] for n in range(1, 6))))
        result = self.results.get(fields["command"])
        if result is not None:
            self.wall.now += 0.01
            self.cache.put("COMMAND_ACK", {"command": fields["command"], "result": result})

    def ticks(self, count, *orders):
        for n in range(count):
            self.queue.want(orders if n == 0 else ())
            self.wall.now += 0.05


@pytest.mark.parametrize(
    ("order", "sent"),
    [
        (PHOTO, (IMAGE_START_CAPTURE, 0.0, 0.0, 1.0, 7.0, 0.0)),
        (SERVO, (SET_SERVO, 5.0, 1900.0, 0.0, 0.0, 0.0)),
        (DeviceOrder(Device.RELAY, 1, 1.0), (SET_RELAY, 0.0, 1.0, 0.0, 0.0, 0.0)),
        (DeviceOrder(Device.GRIPPER, 1, 0.0), (GRIPPER, 1.0, 0.0, 0.0, 0.0, 0.0)),
    ],
)
def test_an_order_is_sent_once_when_it_is_acknowledged(order, sent):
    made = Devices({sent[0]: 0})
    made.ticks(20, order)
    assert made.received == [sent]
    assert made.said == []


def test_two_photos_are_two_commands_one_after_the_other():
    made = Devices({IMAGE_START_CAPTURE: 0})
    made.ticks(10, PHOTO, PHOTO._replace(value=8.0))
    assert [it[4] for it in made.received] == [7.0, 8.0]


def test_without_the_camera_protocol_the_old_command_takes_photos_from_then_on():
    made = Devices({IMAGE_START_CAPTURE: 3, DIGICAM_CONTROL: 0})
    made.ticks(10, PHOTO)
    made.ticks(10, PHOTO)
    assert [it[0] for it in made.received] == [
        IMAGE_START_CAPTURE,
        DIGICAM_CONTROL,
        DIGICAM_CONTROL,
    ]
    assert made.received[-1][5] == 1.0
    assert made.said == []


def test_no_answer_is_asked_for_again_then_reported_and_what_waits_goes_on():
    made = Devices({SET_SERVO: 0})
    made.ticks(60, PHOTO, SERVO)
    sent = [it[0] for it in made.received]
    assert sent == [IMAGE_START_CAPTURE] * ATTEMPTS + [SET_SERVO]
    assert made.said == ["camera 1: no answer"]
    assert made.events == [REFUSED]


def test_a_refusal_is_reported_once():
    made = Devices({SET_SERVO: 2})
    made.ticks(20, SERVO)
    assert len(made.received) == 1
    assert made.said == ["servo 5: denied"]
    assert made.events == [REFUSED]


def test_what_waits_is_dropped_when_someone_else_commands():
    made = Devices({})
    made.ticks(1, PHOTO, SERVO)
    made.queue.drop()
    made.ticks(60)
    assert len(made.received) == 1
