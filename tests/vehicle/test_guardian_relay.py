"""The guardian as a relay, without an autopilot: frames it passes, drops and sends itself."""

import socket
from contextlib import contextmanager

import pytest

from missionkit.sitl.pymavlink_dialect import mavlink
from missionkit.vehicle.guardian.autopilot_link import Poller
from missionkit.vehicle.guardian.policy import Patience
from missionkit.vehicle.guardian.relay import Ends, Relay

PARAMETER = mavlink.MAVLink_param_request_read_message(1, 1, b"GUID_TIMEOUT", -1)
VELOCITY = mavlink.MAVLink_set_position_target_local_ned_message(
    9, 1, 1, 1, 0x5C7, 0, 0, 0, 2.0, 0, 0, 0, 0, 0, 0, 0
)


def ordered(command, *params):
    rest = (0.0,) * (7 - len(params))
    return mavlink.MAVLink_command_long_message(1, 1, command, 0, *params, *rest)


OFFBOARD = ordered(176, 1.0, 6.0)
ORDERS = [OFFBOARD, ordered(21), ordered(22), ordered(400, 1.0), VELOCITY]
HARMLESS = [PARAMETER, ordered(511, 32.0, 1e5), ordered(400, 0.0)]


class Autopilot:
    """Keeps what it is sent."""

    def __init__(self):
        self.heard = b""

    def write(self, data):
        self.heard += data

    def maintain(self):
        pass

    def drop(self):
        self.heard = b""

    def take(self):
        data, self.heard = self.heard, b""
        return mavlink.MAVLink(None).parse_buffer(data) or []


class Bench:
    """A relay between a mission's sockets and an autopilot."""

    def __init__(self, local, control, mission, words):
        self.autopilot, self.mission, self.words = Autopilot(), mission, words
        self.poller = Poller()
        ends, self.alone = Ends(local, control), []
        patience, spare = Patience(30.0, 60.0), frozenset((74,))
        self.relay = Relay(self.poller, ends, 1.0, patience, spare, lambda: self.alone.append(1))
        self.relay.link = self.autopilot

    def send(self, *messages):
        """Send messages of the mission; return what reaches the autopilot."""
        mav = mavlink.MAVLink(None, 245, 191)
        for message in messages:
            self.mission.send(message.pack(mav))
        self.poller.wait(1.0)
        return self.autopilot.take()

    def beat(self, mode, armed=True):
        beat = mavlink.MAVLink_heartbeat_message(2, 12, 0x80 if armed else 0, mode, 4, 3)
        self.relay.downwards([beat.pack(mavlink.MAVLink(None, 1, 1))])

    def act(self):
        self.relay._act()
        return self.autopilot.take()


@contextmanager
def bench():
    words, control = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    local = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    mission = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with words, control, local, mission:
        local.bind(("127.0.0.1", 0))
        mission.connect(local.getsockname())
        for end in (local, control):
            end.settimeout(0.0)
        mission.settimeout(5.0)
        yield Bench(local, control, mission, words)


def steered(it):
    it.beat(6 << 16)
    assert [one.get_type() for one in it.send(VELOCITY)] == ["SET_POSITION_TARGET_LOCAL_NED"]
    assert it.relay.guard.phase == "steered"


def test_all_passes_while_nothing_is_wrong():
    with bench() as it:
        for message in (*HARMLESS, *ORDERS):
            (passed,) = it.send(message)
            assert passed.get_type() == message.get_type()


def test_a_dead_mission_is_stopped_and_its_commands_are_blocked():
    with bench() as it:
        steered(it)
        it.words.shutdown(socket.SHUT_RDWR)
        it.poller.wait(1.0)
        assert it.alone == [1]
        (still,) = it.act()
        assert (still.vx, still.vy, still.vz, still.target_system) == (0.0, 0.0, 0.0, 1)
        for message in ORDERS:
            assert it.send(message) == []
        for message in HARMLESS:
            assert len(it.send(message)) == 1
        it.beat(6 << 16)
        (mode,) = (one for one in it.act() if one.get_type() == "COMMAND_LONG")
        assert (mode.command, mode.param2, mode.param3) == (176, 4.0, 3.0)
        assert not it.relay.guard.over
        it.beat(3 << 24 | 4 << 16)
        assert it.relay.guard.over


@pytest.mark.parametrize("last", [ordered(21), ordered(20), ordered(22)])
def test_a_mission_that_ends_during_a_command_leaves_the_autopilot_to_finish_it(last):
    with bench() as it:
        steered(it)
        it.send(last)
        it.words.shutdown(socket.SHUT_RDWR)
        it.poller.wait(1.0)
        assert it.relay.guard.over
        assert it.act() == []


def test_unused_streams_are_left_out_and_the_rest_comes_in_one_datagram():
    with bench() as it:
        it.send(PARAMETER)
        mav = mavlink.MAVLink(None, 1, 1)
        hud = mavlink.MAVLink_vfr_hud_message(0, 0, 0, 0, 0, 0).pack(mav)
        clock = mavlink.MAVLink_system_time_message(1, 2).pack(mav)
        it.relay.downwards([clock, hud, clock])
        assert it.mission.recv(4096) == clock + clock
