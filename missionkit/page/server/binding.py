"""Where the page is served, and how a browser gets in."""

from __future__ import annotations

import ipaddress
import socket
from pathlib import Path
from typing import NamedTuple

from missionkit.errors import UsageError
from missionkit.page.server.sessions import Tokens

USUAL_HOST, USUAL_PORT = "127.0.0.1", 8123
EVERY_ADDRESS = frozenset(("0.0.0.0", "::", ""))  # noqa: S104 - refused


class Binding(NamedTuple):
    """Where the page is served."""

    host: str = USUAL_HOST
    port: int | None = None  # None: the usual one, or any if that is taken
    certificate: Path | None = None
    key: Path | None = None
    tiles: Path | None = None  # file of map tiles

    @property
    def secure(self) -> bool:
        """Whether it is served over TLS."""
        return self.certificate is not None


def binding(
    text: str | None,
    certificate: Path | None = None,
    key: Path | None = None,
    tiles: Path | None = None,
) -> Binding:
    """Read where to serve.

    Args:
        text: HOST:PORT, or HOST, or PORT; None: the usual address.
        certificate: file of the TLS certificate.
        key: file of its key.
        tiles: file of map tiles.

    Raises:
        UsageError: it is not of that form, or others could reach the page without TLS.
    """
    host, port = _parsed(text)
    if (certificate is None) != (key is None):
        raise UsageError("--tls-cert and --tls-key belong together: name both files")
    for file in (certificate, key):
        if file is not None and not file.is_file():
            raise UsageError(f"{file}: there is no such file")
    if host in EVERY_ADDRESS:
        raise UsageError(
            f"{text}: name the address of this computer that browsers will open, such as "
            "192.168.1.20:8123: the page answers under that name alone"
        )
    if not is_loopback(host) and certificate is None:
        raise UsageError(
            f"{text}: others could read and change what passes: serve it over TLS, with --tls-cert "
            "and --tls-key, or on 127.0.0.1"
        )
    return Binding(host, port, certificate, key, tiles)


def _parsed(text: str | None) -> tuple[str, int | None]:
    if text is None:
        return USUAL_HOST, None
    host, colon, port = text.rpartition(":") if not text.isdecimal() else (USUAL_HOST, ":", text)
    if not colon or text.endswith("]"):
        host, port = text, str(USUAL_PORT)
    host = host.removeprefix("[").removesuffix("]")
    if not port.isdecimal() or int(port) > 65535:
        raise UsageError(f"{text}: expected HOST:PORT, such as 127.0.0.1:{USUAL_PORT}")
    return host, int(port)


def listening(where: Binding) -> socket.socket:
    """Return a socket that listens.

    Raises:
        UsageError: the address is not this computer's, or the port is taken.
    """
    ports = (USUAL_PORT, 0) if where.port is None else (where.port,)
    family = socket.AF_INET6 if ":" in where.host else socket.AF_INET
    for port in ports:
        found = socket.socket(family, socket.SOCK_STREAM)
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            found.bind((where.host, port))
        except OSError as error:
            found.close()
            if port != ports[-1]:
                continue
            why = error.strerror or str(error)
            raise UsageError(
                f"{where.host}:{port}: the page cannot be served there: {why}"
            ) from error
        found.listen(128)
        return found
    raise AssertionError  # the last port returns or raises


class PageAddress(NamedTuple):
    """How a browser gets in."""

    url: str  # "http://127.0.0.1:8123/"
    tokens: Tokens | None

    @property
    def pilot(self) -> str:
        """Address of who may act."""
        return self.url if self.tokens is None else f"{self.url}#token={self.tokens.pilot}"

    @property
    def view(self) -> str:
        """Address of who may look."""
        return self.url if self.tokens is None else f"{self.url}#token={self.tokens.view}"


def address_of(where: Binding, bound: socket.socket, tokens: Tokens | None) -> PageAddress:
    """Return how a browser gets in.

    Args:
        where: the page is served.
        bound: the socket.
        tokens: that open a session; None: none is needed.
    """
    scheme = "https" if where.secure else "http"
    shown = f"[{where.host}]" if ":" in where.host else where.host
    return PageAddress(f"{scheme}://{shown}:{bound.getsockname()[1]}/", tokens)


def is_loopback(host: str) -> bool:
    """Say whether an address can be reached from this computer alone."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:  # a name
        return False
