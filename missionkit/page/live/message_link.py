"""The link between a flight and its page's server: whole messages, and neither waits for the other.

A pair of sockets that keep messages apart. A message for which there is no room is not sent, and
what a side that has gone was to be told is dropped.
"""

from __future__ import annotations

import errno
import json
import socket
from collections.abc import Iterator
from typing import Any

LONGEST = 180_000  # bytes; longer messages do not fit the socket's buffer
MOST_AT_ONCE = 20  # messages taken in one go
TEXT, IMAGE = b"T", b"I"


class MessageLink:
    """One end of the link.

    Args:
        end: of a pair of sockets.
    """

    def __init__(self, end: socket.socket) -> None:
        end.settimeout(0.0)
        self.end = end
        self.broken = False

    def send(self, message: dict[str, Any]) -> bool:
        """Send a message if there is room; return whether it was sent."""
        return self._put(TEXT + json.dumps(message, separators=(",", ":")).encode())

    def send_image(self, number: int, jpeg: bytes) -> bool:
        """Send an image if there is room; return whether it was sent.

        Args:
            number: of the image.
            jpeg: its data.
        """
        return self._put(IMAGE + number.to_bytes(8, "big") + jpeg)

    def _put(self, data: bytes) -> bool:
        if self.broken or len(data) > LONGEST:
            return False
        try:
            self.end.send(data, socket.MSG_NOSIGNAL)
        except BlockingIOError:
            return False
        except OSError as error:
            self.broken = not _is_full(error)
            return False
        return True

    def received(self) -> Iterator[dict[str, Any] | tuple[int, bytes]]:
        """Yield what has arrived: messages, and images with their numbers."""
        for _ in range(MOST_AT_ONCE):
            try:
                data = self.end.recv(LONGEST + 16)
            except BlockingIOError:
                return
            except OSError:
                data = b""
            if not data:
                self.broken = True
                return
            if data[:1] == IMAGE:
                yield int.from_bytes(data[1:9], "big"), data[9:]
            else:
                yield json.loads(data[1:])

    def close(self) -> None:
        """End the link."""
        self.broken = True
        self.end.close()


def _is_full(error: OSError) -> bool:
    return error.errno in {errno.ENOBUFS, errno.ENOMEM}


def pair() -> tuple[socket.socket, socket.socket]:
    """Return the two ends of a link."""
    return socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
