"""One conversation with one peer: its parser, its sequence numbers, its streams."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from missionkit.sitl.link_weather import Weather, Wire
from missionkit.sitl.pymavlink_dialect import Message, mavlink

COMPONENT = 1  # MAV_COMP_ID_AUTOPILOT1: MAVSDK takes no other one for an autopilot
DATAGRAM_BYTES = 1400  # within the MTU of Ethernet


class Sender(NamedTuple):
    """Sender of a message."""

    system: int
    component: int


class Channel:
    """MAVLink 2 with one peer.

    Args:
        write: gives bytes to the peer.
        system: own MAVLink system id.
        weather: what the faults do to packets.
    """

    def __init__(self, write: Callable[[bytes], None], system: int, weather: Weather) -> None:
        self.heard = False  # has the peer ever sent anything?
        self.streams: dict[int, StreamSchedule] = {}
        self.pending: list[Message] = []  # a long answer, sent little by little
        self._write = write
        self._mav = mavlink.MAVLink(None, system, COMPONENT)
        self._mav.robust_parsing = True
        self._down: Wire[bytes] = Wire(weather, "down")
        self._up: Wire[Message] = Wire(weather, "up")

    def send(self, message: Message, now: float) -> None:
        """Send a message at `now` (s)."""
        data = message.pack(self._mav)
        self._mav.seq = (self._mav.seq + 1) % 256
        self._down.put(data, now)

    def take(self, data: bytes, now: float) -> None:
        """Hear these bytes at `now` (s)."""
        for message in self._mav.parse_buffer(data) or ():
            if message.get_type() != "BAD_DATA":
                self._up.put(message, now)

    def messages(self, now: float) -> list[Message]:
        """Return the messages that have arrived by `now` (s)."""
        arrived = self._up.due(now)
        self.heard = self.heard or bool(arrived)
        return arrived

    def flush(self, now: float) -> None:
        """Give to the peer what is due at `now` (s), as few datagrams as carry it."""
        datagram = b""
        for data in self._down.due(now):
            if len(datagram) + len(data) > DATAGRAM_BYTES:
                self._write(datagram)
                datagram = b""
            datagram += data
        if datagram:
            self._write(datagram)


class StreamSchedule:
    """When a stream is due, and what was sent last."""

    def __init__(self, interval: float, now: float) -> None:
        self.interval = interval  # s
        self.last: Message | None = None
        self.sensors_sent = (-1.0, -1.0)  # s, of the field and pressure in the last HIGHRES_IMU
        self._next = now

    def due(self, now: float) -> bool:
        """Tell whether a message is due at `now` (s); if so, wait for the next."""
        if now < self._next - 1e-6:
            return False
        self._next = max(self._next + self.interval, now)
        return True


def sender(message: Message) -> Sender:
    """Return who sent a message."""
    return Sender(message.get_srcSystem(), message.get_srcComponent())
