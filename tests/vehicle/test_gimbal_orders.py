"""The gimbal over MAVLink: what is sent and when, what is said of failures, what a status means."""

from __future__ import annotations

import math

import pytest
from vehicle.test_time import Wall

from missionkit.geometry import from_euler
from missionkit.messages import GimbalAngles
from missionkit.vehicle.command.device_orders import ATTEMPTS, REFUSED
from missionkit.vehicle.command.gimbal_orders import (
    CONFIGURE,
    MOUNT_CONTROL,
    PITCHYAW,
    GimbalOrders,
)
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.telemetry.gimbal_attitude import IN_EARTH_FRAME, angles_of

DOWN = GimbalAngles(math.radians(-90.0), math.radians(20.0))


class Manager:
    """A gimbal manager that answers as `results` says, and an unknown command not at all."""

    def __init__(self, results):
        self.wall, self.received, self.said, self.events = Wall(), [], [], []
        self.results = results
        self.cache = Cache(self.wall)
        self.orders = GimbalOrders(self, self.cache, self.said.append, self.events.append)

    def send(self, name, **fields):
        assert name == "COMMAND_LONG"
        self.received.append((fields["command"], *(fields[f"param{n}"] for n in range(1, 8))))
        result = self.results.get(fields["command"])
        if result is not None:
            self.wall.now += 0.01
            self.cache.put("COMMAND_ACK", {"command": fields["command"], "result": result})

    def ticks(self, count, wanted):
        for _ in range(count):
            self.orders.want(wanted)
            self.wall.now += 0.05


def test_control_is_taken_once_and_an_acknowledged_order_is_sent_once():
    made = Manager({CONFIGURE: 0, PITCHYAW: 0})
    made.ticks(40, DOWN)
    configure, order = made.received
    assert configure == (CONFIGURE, -2.0, -2.0, -1.0, -1.0, 0.0, 0.0, 0.0)
    assert order[:2] == (PITCHYAW, pytest.approx(-90.0))
    assert order[2:] == (pytest.approx(20.0), None, None, 44.0, 0.0, 0.0)
    made.ticks(1, DOWN._replace(yaw=0.5))
    assert [it[0] for it in made.received[2:]] == [PITCHYAW]
    assert made.said == []


def test_a_gimbal_that_follows_gets_ten_orders_a_second_at_most():
    made = Manager({CONFIGURE: 0, PITCHYAW: 0})
    for n in range(100):
        made.ticks(1, DOWN._replace(yaw=0.02 * n))
    assert len(made.received) - 1 <= 10 * made.wall.now
    assert made.received[-1][2] == pytest.approx(math.degrees(0.02 * 99), abs=3.0)


def test_without_the_protocol_the_mount_is_controlled():
    made = Manager({CONFIGURE: 3, PITCHYAW: 3, MOUNT_CONTROL: 0})
    made.ticks(20, DOWN)
    made.ticks(20, DOWN._replace(yaw=0.0))
    assert [it[0] for it in made.received] == [CONFIGURE, PITCHYAW, MOUNT_CONTROL, MOUNT_CONTROL]
    assert made.received[2][1:4] == (pytest.approx(-90.0), 0.0, pytest.approx(20.0))
    assert made.received[2][7] == 2.0
    assert made.said == []


@pytest.mark.parametrize(
    ("results", "said", "count"),
    [({CONFIGURE: 0, PITCHYAW: 2}, "denied", 1), ({CONFIGURE: 0}, "no answer", ATTEMPTS)],
)
def test_a_failure_is_reported_once(results, said, count):
    made = Manager(results)
    made.ticks(100, DOWN)
    assert [it[0] for it in made.received].count(PITCHYAW) == count
    assert made.said == [f"gimbal: {said}"]
    assert made.events == [REFUSED]


def test_after_a_pilot_control_is_asked_for_again():
    made = Manager({CONFIGURE: 0, PITCHYAW: 0})
    made.ticks(5, DOWN)
    made.orders.drop()
    made.ticks(5, DOWN)
    assert [it[0] for it in made.received] == [CONFIGURE, PITCHYAW] * 2


@pytest.mark.parametrize(
    ("flags", "heading", "yaw"),
    [(44, None, 0.7), (12, None, 0.7), (IN_EARTH_FRAME, 0.5, 0.2), (IN_EARTH_FRAME, None, None)],
)
def test_yaw_from_north_needs_the_heading(flags, heading, yaw):
    cache = Cache(Wall())
    if heading is not None:
        q = from_euler(0.1, 0.2, heading)
        cache.put("ATTITUDE_QUATERNION", {f"q{n}": q[n - 1] for n in range(1, 5)})
    fields = {"q": from_euler(0.0, -0.4, 0.7).tolist(), "flags": flags}
    angles = angles_of(fields, cache)
    assert angles is None if yaw is None else angles == (pytest.approx(-0.4), pytest.approx(yaw))


@pytest.mark.parametrize("q", [[None, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], []])
def test_an_attitude_that_is_none_is_not_known(q):
    assert angles_of({"q": q, "flags": 44}, Cache(Wall())) is None
