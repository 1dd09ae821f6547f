"""The payload is on while the mission says so, and never longer."""

import pytest
from vehicle.test_time import Wall

from missionkit.vehicle.command.payload import RELEASED, SET_ACTUATOR, Payload
from missionkit.vehicle.link.message_cache import Cache

AGAIN = 0.6  # s, until it is sent again


class Actuator:
    """Remembers its commands; acknowledges them as long as it is heard."""

    def __init__(self, pace=1.0):
        self.wall, self.received, self.heard = Wall(), [], True
        self.cache = Cache(self.wall)
        self.payload = Payload(self, self.cache, pace)

    def send(self, name, **fields):
        assert (name, fields["command"]) == ("COMMAND_LONG", SET_ACTUATOR)
        self.received.append(fields["param1"])
        if self.heard:
            self.wall.now += 0.01
            self.cache.put("COMMAND_ACK", {"command": SET_ACTUATOR, "result": 0})

    def tick(self, name):
        self.wall.now += AGAIN
        self.payload.want(name)


def test_it_is_reported_once_per_change():
    made = Actuator()
    for name in (None, "sprayer", "sprayer", None, None):
        made.tick(name)
    assert made.received == [1.0, -1.0]


def test_an_unacknowledged_command_is_sent_again():
    made = Actuator()
    made.heard = False
    for _ in range(3):
        made.tick("sprayer")
    made.heard = True
    for _ in range(3):
        made.tick("sprayer")
    assert made.received == [1.0] * 4


def test_at_the_end_it_is_switched_off():
    made = Actuator()
    made.tick("sprayer")
    made.wall.now += 0.1
    made.payload.release()
    assert made.received == [1.0, -1.0]


def test_at_the_end_only_active_actuators_are_switched_off():
    made = Actuator()
    made.payload.release()
    made.tick("sprayer")
    made.tick(None)
    made.payload.release()
    assert made.received == [1.0, -1.0]


@pytest.mark.parametrize("pace", [0.5, 1.0, 8.0])
def test_at_the_end_it_waits_two_seconds_of_the_vehicle_for_an_answer(pace, monkeypatch):
    made = Actuator(pace)
    made.tick("sprayer")
    made.wall.now += 0.1
    made.heard, begun = False, made.wall.now

    def pass_time(_, timeout):
        made.wall.now += timeout

    monkeypatch.setattr(made.cache, "wait", pass_time)
    made.payload.release()
    assert made.wall.now - begun == pytest.approx(RELEASED / pace, abs=0.5 / pace)
    assert made.received.count(-1.0) >= 4
