"""The guardian's way to the autopilot, over real sockets of the loopback interface."""

import os
import socket
from contextlib import contextmanager

import pytest

from missionkit.vehicle.guardian import mavlink_frames
from missionkit.vehicle.guardian.autopilot_link import Line, Poller, open_link
from missionkit.vehicle.guardian.mavlink_frames import FrameRoute

FRAME = mavlink_frames.still(FrameRoute(1, 1, 1, 1), 7, 99)
LIMIT = 200  # looks of at most 0.05 s


class End:
    """Frames received from a link, and those waiting to be sent."""

    def __init__(self):
        self.taken, self.poller = [], Poller()

    def until(self, holds):
        for _ in range(LIMIT):
            if holds():
                return
            self.poller.wait(0.05)
        assert holds()


@contextmanager
def server():
    with socket.create_server(("127.0.0.1", 0)) as listening:
        listening.settimeout(5.0)
        yield listening


def test_a_closed_connection_is_reopened_and_frames_arrive_whole():
    end = End()
    with server() as listening:
        link = open_link("tcpout", *listening.getsockname(), end.poller, end.taken.extend)
        first, _ = listening.accept()
        first.sendall(FRAME + FRAME[:9])
        end.until(lambda: end.taken == [FRAME])
        first.close()
        end.until(lambda: link._file is None)
        link.write(FRAME)  # lost: there is no peer
        link.maintain()
        with listening.accept()[0] as second:
            second.sendall(FRAME)
            end.until(lambda: end.taken == [FRAME, FRAME])
            link.write(FRAME)
            end.poller.wait(0.05)
            assert second.recv(1000) == FRAME


def test_the_newest_connection_counts():
    end = End()
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        address = probe.getsockname()
    link = open_link("tcpin", *address, end.poller, end.taken.extend)
    with socket.create_connection(address) as old:
        old.sendall(FRAME)
        end.until(lambda: end.taken == [FRAME])
        with socket.create_connection(address) as new:
            new.sendall(FRAME)
            end.until(lambda: len(end.taken) == 2)
            link.write(FRAME)
            new.settimeout(5.0)
            assert new.recv(1000) == FRAME
    link._server.close()


def test_what_waits_for_a_slow_line_can_be_dropped():
    end = End()
    ours, theirs = socket.socketpair()
    with theirs:
        theirs.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        link = Line(ours.detach, end.poller, end.taken.extend)
        for _ in range(20_000):
            link.write(FRAME)
        assert 0 < len(link._waiting) < 10_000
        link.drop()
        assert not link._waiting


def test_every_caller_is_answered_and_noise_is_ignored():
    end = End()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        address = probe.getsockname()
    link = open_link("udpin", *address, end.poller, end.taken.extend)
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as autopilot,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as noise,
    ):
        noise.sendto(b"hello", address)
        autopilot.sendto(FRAME, address)
        end.until(lambda: end.taken == [FRAME])
        link.write(FRAME)
        autopilot.settimeout(5.0)
        assert autopilot.recv(1000) == FRAME
        noise.settimeout(0.0)
        with pytest.raises(BlockingIOError):
            noise.recv(1000)
    link._socket.close()


def test_the_autopilots_frames_gather_and_what_is_urgent_passes_at_once():
    served, poller = [], Poller(gathered=60.0)  # s; the test would never wait for it
    autopilot, frames = socket.socketpair()
    mission, setpoints = socket.socketpair()
    with autopilot, frames, mission, setpoints:
        poller.add(frames.fileno(), lambda _: served.append(frames.recv(100)))
        poller.add(setpoints.fileno(), lambda _: served.append(setpoints.recv(100)), urgent=True)
        autopilot.send(b"first")
        poller.wait(5.0)
        autopilot.send(b"second")
        autopilot.send(b", third")
        mission.send(b"setpoint")
        poller.wait(5.0)
        assert served == [b"first", b"setpoint"]
        poller.wait(5.0)
        assert served == [b"first", b"setpoint", b"second, third"]


@pytest.mark.parametrize(("device", "baud"), [("/dev/null", 57600), ("/dev/nowhere", 57600)])
def test_a_device_that_is_not_serial_is_reported(device, baud):
    with pytest.raises(OSError, match=r"serial line|No such file"):
        open_link("serial", device, baud, Poller(), list)


def test_an_unknown_baud_rate_is_reported():
    ours, theirs = os.openpty()
    with pytest.raises(OSError, match="12345 is not a baud rate"):
        open_link("serial", os.ttyname(theirs), 12345, Poller(), list)
    os.close(ours)
    os.close(theirs)
