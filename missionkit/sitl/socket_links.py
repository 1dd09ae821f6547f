"""UDP and TCP sockets as links: `udpout:HOST:PORT`, `udpin:HOST:PORT`, `tcpin:HOST:PORT`.

`udpout` talks to that port at once, as PX4 does to 14540 and 14550; `udpin` and `tcpin` wait for
somebody, as ArduPilot does on 5760.
"""

from __future__ import annotations

import re
import selectors
import socket
from typing import Protocol

from missionkit.errors import UsageError, VehicleError
from missionkit.sitl.mavlink_autopilot import MavlinkAutopilot
from missionkit.sitl.peer_channel import Channel

LINK_FORM = re.compile(r"(?P<kind>udpout|udpin|tcpin):(//)?(?P<host>[^:/]+):(?P<port>\d+)")
Address = tuple[str, int]
MOST_PEERS = 8  # of one udpin link
SOCKET_READ_BYTES = 65536
TCP_BACKLOG = 1 << 20  # bytes waiting for a slow TCP peer; more are lost


class SocketLink(Protocol):
    """One socket and the peers behind it."""

    address: Address

    def close(self) -> None:
        """Let go of the socket."""


def open_link(
    text: str, autopilot: MavlinkAutopilot, selector: selectors.BaseSelector
) -> SocketLink:
    """Open a link.

    Args:
        text: `udpout:HOST:PORT`, `udpin:HOST:PORT` or `tcpin:HOST:PORT`.
        autopilot: hears what comes in.
        selector: the sockets are registered there.

    Raises:
        UsageError: not of the form above.
        VehicleError: the port is taken.
    """
    match = LINK_FORM.fullmatch(text)
    if match is None:
        forms = "udpout:HOST:PORT, udpin:HOST:PORT or tcpin:HOST:PORT"
        raise UsageError(f"cannot read the link {text!r}; the form is {forms}")
    address = (match["host"], int(match["port"]))
    try:
        if match["kind"] == "tcpin":
            return TcpLink(autopilot, selector, address)
        return UdpLink(autopilot, selector, address, out=match["kind"] == "udpout")
    except OSError as error:
        raise VehicleError(f"link {text}: {error.strerror or error}") from error


class UdpLink:
    """Datagrams to and from one peer (`out`) or any sender."""

    def __init__(
        self,
        autopilot: MavlinkAutopilot,
        selector: selectors.BaseSelector,
        address: Address,
        *,
        out: bool,
    ) -> None:
        self._autopilot = autopilot
        self._peers: dict[Address, Channel] = {}
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(0.0)
        self._socket.bind(("127.0.0.1", 0) if out else address)
        self.address: Address = address if out else self._socket.getsockname()
        if out:
            self._meet((socket.gethostbyname(address[0]), address[1]))
        selector.register(self._socket, selectors.EVENT_READ, self._read)

    def _meet(self, peer: Address) -> Channel:
        if len(self._peers) >= MOST_PEERS:
            oldest = next(iter(self._peers))
            self._autopilot.disconnect(self._peers.pop(oldest))
        self._peers[peer] = channel = self._autopilot.connect(lambda data: self._write(data, peer))
        return channel

    def _write(self, data: bytes, peer: Address) -> None:
        try:
            self._socket.sendto(data, peer)
        except OSError:  # no receiver, or the buffer is full: UDP loses packets
            return

    def _read(self) -> None:
        while True:
            try:
                data, peer = self._socket.recvfrom(SOCKET_READ_BYTES)
            except BlockingIOError:
                return
            except OSError:  # an earlier packet was refused
                continue
            channel = self._peers.get(peer) or self._meet(peer)
            channel.take(data, self._autopilot.state.now)

    def close(self) -> None:
        """Let go of the socket."""
        self._socket.close()


class TcpLink:
    """A port where peers connect."""

    def __init__(
        self, autopilot: MavlinkAutopilot, selector: selectors.BaseSelector, address: Address
    ) -> None:
        self._autopilot = autopilot
        self._selector = selector
        self._peers: dict[socket.socket, TcpPeer] = {}
        self._socket = socket.create_server(address)
        self._socket.settimeout(0.0)
        self.address: Address = self._socket.getsockname()
        selector.register(self._socket, selectors.EVENT_READ, self._accept)

    def _accept(self) -> None:
        try:
            connection, _ = self._socket.accept()
        except OSError:  # gone again
            return
        connection.settimeout(0.0)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        peer = TcpPeer(connection)
        channel = self._autopilot.connect(peer.write)
        self._peers[connection] = peer
        self._selector.register(
            connection, selectors.EVENT_READ, lambda: self._read(connection, channel)
        )

    def _read(self, connection: socket.socket, channel: Channel) -> None:
        try:
            data = connection.recv(SOCKET_READ_BYTES)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if data:
            channel.take(data, self._autopilot.state.now)
            return
        self._selector.unregister(connection)
        self._autopilot.disconnect(channel)
        del self._peers[connection]
        connection.close()

    def close(self) -> None:
        """Let go of all sockets."""
        for connection in self._peers:
            connection.close()
        self._socket.close()


class TcpPeer:
    """Writes to a connection without ever waiting for it."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._waiting = bytearray()

    def write(self, data: bytes) -> None:
        """Send what fits now, keep the rest."""
        if len(self._waiting) < TCP_BACKLOG:
            self._waiting += data
        try:
            sent = self._connection.send(self._waiting)
        except OSError:  # full, or gone: reading will tell
            return
        del self._waiting[:sent]
