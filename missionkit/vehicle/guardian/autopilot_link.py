"""The real link: bytes from and to the autopilot over UDP, TCP or a serial line; nothing blocks."""

from __future__ import annotations

import os
import select
import socket
import termios
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

from missionkit.vehicle.guardian.mavlink_frames import split

LINK_READ_BYTES = 65536
AT_ONCE = 64  # datagrams read in one go
GATHERED = 0.01  # s (of the vehicle) in which the autopilot's frames gather into full datagrams
CALLERS_KEPT = 8
LINE_BACKLOG = 4096  # bytes that wait for a slow line; what comes then is lost
Handler = Callable[[int], None]
Peer = tuple[object, ...]  # host, port, and more for IPv6


class Poller:
    """File descriptors that are waited for together.

    Args:
        gathered: how long (s) a descriptor that is not urgent rests after it was served.
    """

    def __init__(self, gathered: float = GATHERED) -> None:
        self._epoll = select.epoll()
        self._handlers: dict[int, Handler] = {}
        self._urgent = select.epoll()
        self._patient: set[int] = set()
        self._gathered = gathered
        self._rest = False  # one that is not urgent was served just now

    def add(self, descriptor: int, handler: Handler, *, urgent: bool = False) -> None:
        """Call `handler(events)` when there is something to read; what is not urgent can wait.

        Args:
            descriptor: of a file that epoll can wait for.
            handler: gets the events of epoll.
            urgent: whether it is served even while bytes to the autopilot wait.
        """
        self._handlers[descriptor] = handler
        self._epoll.register(descriptor, select.EPOLLIN)
        if urgent:
            self._urgent.register(descriptor, select.EPOLLIN)
        else:
            self._patient.add(descriptor)

    def writing(self, descriptor: int, *, wanted: bool) -> None:
        """Call it also when it can be written to."""
        more = select.EPOLLOUT if wanted else 0
        self._epoll.modify(descriptor, select.EPOLLIN | more)

    def remove(self, descriptor: int) -> None:
        """Wait for it no more."""
        del self._handlers[descriptor]
        self._patient.discard(descriptor)
        for epoll in (self._epoll, self._urgent):
            with suppress(OSError):
                epoll.unregister(descriptor)

    def wait(self, seconds: float) -> None:
        """Wait for at most so long, the rest added, and call the handlers that have something."""
        found = self._urgent.poll(self._gathered) if self._rest else []
        found = found or self._epoll.poll(seconds)
        self._rest = any(descriptor in self._patient for descriptor, _ in found)
        for descriptor, events in found:
            handler = self._handlers.get(descriptor)
            if handler is not None:
                handler(events)


class AutopilotLink(Protocol):
    """The way to the autopilot."""

    def write(self, data: bytes) -> None:
        """Send whole frames; lost where that would have to wait."""

    def maintain(self) -> None:
        """Connect again where that is needed; called about once a second."""

    def drop(self) -> None:
        """Forget what waits to be sent."""


Take = Callable[[list[bytes]], None]


def open_link(scheme: str, place: str, number: int, poller: Poller, take: Take) -> AutopilotLink:
    """Open the link to an autopilot; `take` gets whole frames.

    Args:
        scheme: udpin, udpout, tcpin, tcpout or serial.
        place: host, or path of a device.
        number: port, or baud rate.
        poller: calls the link when bytes have come.
        take: called with each frame, complete and intact.

    Raises:
        OSError: it cannot be opened.
    """
    if scheme in {"udpin", "udpout"}:
        return Datagrams(place, number, poller, take, out=scheme == "udpout")
    if scheme == "tcpin":
        return Listener(place, number, poller, take)
    return Line(lambda: _opened(scheme, place, number), poller, take)


class Datagrams:
    """UDP, with one peer that is called or any sender."""

    def __init__(self, host: str, port: int, poller: Poller, take: Take, *, out: bool) -> None:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self._peers: dict[Peer, None] = {}
        self._out = out
        if out:
            self._peers[address] = None
        else:
            self._socket.bind(address)
        self._socket.settimeout(0.0)
        self._take = take
        poller.add(self._socket.fileno(), self._read)

    def _read(self, _: int) -> None:
        frames: list[bytes] = []
        receive, peers = self._socket.recvfrom, self._peers
        for _ in range(AT_ONCE):
            try:
                data, peer = receive(LINK_READ_BYTES)
            except BlockingIOError:
                break
            except OSError:  # an earlier datagram was refused
                continue
            found = split(data)[0]
            if peer not in peers and found and not self._out:
                self._meet(peer)
            frames += found
        if frames:
            self._take(frames)

    def _meet(self, peer: Peer) -> None:
        if len(self._peers) >= CALLERS_KEPT:
            del self._peers[next(iter(self._peers))]
        self._peers[peer] = None

    def write(self, data: bytes) -> None:
        """Send to every peer."""
        for peer in self._peers:
            with suppress(OSError):
                self._socket.sendto(data, peer)

    def maintain(self) -> None:
        """Nothing to do."""

    def drop(self) -> None:
        """Nothing waits."""


class Line:
    """A stream of bytes that is opened again whenever it ends: a TCP connection, a serial line."""

    def __init__(self, connect: Callable[[], int] | None, poller: Poller, take: Take) -> None:
        self._connect = connect
        self._poller = poller
        self._take = take
        self._file: int | None = None
        self._rest = b""
        self._waiting = bytearray()
        if connect is not None:
            self.join(connect())

    def join(self, descriptor: int) -> None:
        """Use an open file, in place of the one before."""
        self._part()
        os.set_blocking(descriptor, False)
        self._file = descriptor
        self._poller.add(descriptor, self._ready)

    def _part(self) -> None:
        descriptor, self._file = self._file, None
        if descriptor is not None:
            self._poller.remove(descriptor)
            os.close(descriptor)
        self._rest = b""
        self._waiting.clear()

    def _ready(self, events: int) -> None:
        if events & select.EPOLLOUT:
            self._flush()
        if events & ~select.EPOLLOUT:
            self._read()

    def _read(self) -> None:
        if self._file is None:
            return
        try:
            data = os.read(self._file, LINK_READ_BYTES)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._part()
            return
        frames, self._rest = split(self._rest + data)
        if frames:
            self._take(frames)

    def write(self, data: bytes) -> None:
        """Send, or keep what does not fit now."""
        if self._file is None or len(self._waiting) > LINE_BACKLOG:
            return
        self._waiting += data
        self._flush()

    def _flush(self) -> None:
        if self._file is None:
            return
        try:
            sent = os.write(self._file, self._waiting)
        except BlockingIOError:
            sent = 0
        except OSError:  # reading will tell
            return
        del self._waiting[:sent]
        self._poller.writing(self._file, wanted=bool(self._waiting))

    def maintain(self) -> None:
        """Connect again."""
        if self._file is None and self._connect is not None:
            with suppress(OSError):
                self.join(self._connect())

    def drop(self) -> None:
        """Forget what waits to be sent: whole frames, and the rest of one that was begun."""
        self._waiting.clear()


class Listener(Line):
    """A TCP port where the autopilot connects; the newest connection counts."""

    def __init__(self, host: str, port: int, poller: Poller, take: Take) -> None:
        super().__init__(None, poller, take)
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        self._server = socket.create_server((host, port), family=family)
        self._server.settimeout(0.0)
        poller.add(self._server.fileno(), self._accept)

    def _accept(self, _: int) -> None:
        with suppress(OSError):
            connection, _ = self._server.accept()
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.join(connection.detach())


def _opened(scheme: str, place: str, number: int) -> int:
    """Return an open serial line, or a TCP connection under way."""
    if scheme == "serial":
        return _serial(place, number)
    family, _, _, _, address = socket.getaddrinfo(place, number, type=socket.SOCK_STREAM)[0]
    connection = socket.socket(family, socket.SOCK_STREAM)
    connection.settimeout(0.0)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    with suppress(BlockingIOError):
        connection.connect(address)
    return connection.detach()


def _serial(device: str, baud: int) -> int:
    speed = getattr(termios, f"B{baud}", None)
    if speed is None:
        raise OSError(f"{baud} is not a baud rate of this system")
    descriptor = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        control = termios.CS8 | termios.CREAD | termios.CLOCAL
        quiet = [0] * len(termios.tcgetattr(descriptor)[6])
        setting = [0, 0, control, 0, speed, speed, quiet]
        termios.tcsetattr(descriptor, termios.TCSANOW, setting)
        termios.tcflush(descriptor, termios.TCIOFLUSH)
    except termios.error as error:
        os.close(descriptor)
        raise OSError(f"{device} is not a serial line: {error.args[-1]}") from None
    return descriptor
