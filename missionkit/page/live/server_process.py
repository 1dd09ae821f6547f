"""The process of a page's server: `python -m missionkit.page.live.server_process LINK SOCKET FILE`.

It is given the numbers of three open files: its end of the link to the flight, the socket that
listens, and a file with what does not change. It ends soon after the flight.
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import socket
import sys
from pathlib import Path

from missionkit.page.live.live_source import LiveSource
from missionkit.page.live.message_link import MessageLink
from missionkit.page.server.binding import Binding
from missionkit.page.server.page_source import StaticFacts
from missionkit.page.server.serving import server_of
from missionkit.page.server.sessions import Tokens
from missionkit.page.server.why_desk import WhyDesk

LAST_WORDS = 1.0  # s in which browsers learn how the flight ended
NICENESS = 5  # the flight goes first


def run(link: MessageLink, bound: socket.socket, said: dict[str, object]) -> None:
    """Serve the page until the flight has gone.

    Args:
        link: to the flight.
        bound: socket that listens.
        said: what does not change.
    """
    binding = dict(said["binding"])  # type: ignore[call-overload]
    certificate, key = (None if it is None else Path(it) for it in binding["tls"])
    tiles = None if binding["tiles"] is None else Path(binding["tiles"])
    where = Binding(binding["host"], binding["port"], certificate, key, tiles)
    tokens = Tokens(*said["tokens"])  # type: ignore[misc]
    static = StaticFacts(said["mission"], str(said["chart"]))  # type: ignore[arg-type]

    why = WhyDesk(Path(str(said["run"])), [Path(it) for it in said["plugins"]], growing=True)  # type: ignore[attr-defined]

    async def serving() -> None:
        loop = asyncio.get_running_loop()

        def ended() -> None:
            loop.call_later(LAST_WORDS, lambda: setattr(server, "should_exit", True))

        source = LiveSource(static, link, why, ended)
        server = server_of(source, where, bound, tokens)
        source.attach(loop)
        await server.serve(sockets=[bound])

    asyncio.run(serving())


def main() -> None:
    """Serve what the arguments name."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the flight's
    os.nice(NICENESS)
    link, bound, file = (int(it) for it in sys.argv[1:4])
    with os.fdopen(file, encoding="utf-8") as stream:
        said = json.load(stream)
    run(MessageLink(socket.socket(fileno=link)), socket.socket(fileno=bound), said)


if __name__ == "__main__":
    main()
