"""Serving the page on a socket that listens."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import suppress

import uvicorn

from missionkit.page.server.application import application
from missionkit.page.server.binding import Binding, PageAddress, address_of, listening
from missionkit.page.server.origin_check import Addresses
from missionkit.page.server.page_source import PageSource
from missionkit.page.server.sessions import Sessions, Tokens
from missionkit.page.tiles.tile_file import tile_file


def server_of(
    source: PageSource, where: Binding, bound: socket.socket, tokens: Tokens | None
) -> uvicorn.Server:
    """Return a server that is ready to run on a socket.

    Args:
        source: what the page is of.
        where: it is served.
        bound: the socket.
        tokens: that open a session; None: whoever reaches the page may do everything.

    Raises:
        UsageError: the file of map tiles cannot be used.
    """
    port = bound.getsockname()[1]
    addresses = Addresses.of(where.host, port, secure=where.secure)
    cookie, tiles = f"missionkit_{port}", None if where.tiles is None else tile_file(where.tiles)
    app = application(source, Sessions(tokens), addresses, cookie, tiles)
    return uvicorn.Server(
        uvicorn.Config(
            app,
            ws="websockets-sansio",
            ws_max_size=65536,
            ws_max_queue=8,
            ws_per_message_deflate=False,
            lifespan="off",
            log_config=None,
            access_log=False,
            server_header=False,
            proxy_headers=False,
            timeout_graceful_shutdown=1,
            ssl_certfile=where.certificate,
            ssl_keyfile=None if where.key is None else str(where.key),
        )
    )


def serve(
    source: PageSource,
    where: Binding,
    tokens: Tokens | None,
    announce: Callable[[PageAddress], None],
) -> None:
    """Serve a page until it is interrupted.

    Args:
        source: what the page is of.
        where: it is served.
        tokens: that open a session; None: none is needed.
        announce: says how to get in, once the page can be reached.

    Raises:
        UsageError: the address cannot be served, or the file of map tiles not be used.
    """
    with listening(where) as bound:
        server = server_of(source, where, bound, tokens)
        announce(address_of(where, bound, tokens))
        with suppress(KeyboardInterrupt):  # the server has ended in order by then
            server.run(sockets=[bound])
