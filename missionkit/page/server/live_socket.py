"""The WebSocket of the page: a snapshot, then what changed, the latest only."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from contextlib import suppress

from starlette.websockets import WebSocket, WebSocketDisconnect

from missionkit.engine.clock import stopwatch
from missionkit.page.server.board import HAPPENINGS
from missionkit.page.server.page_source import Feed, PageError

PERIOD = 0.05  # s between two messages at least
SLOW = 0.5  # s; a message that took longer is followed by a snapshot
LONGEST_MESSAGE = 4096  # bytes, of a browser


async def serve_live(socket: WebSocket, feed: Feed) -> None:
    """Show a browser the latest until it goes; one that does not read holds up nothing but itself.

    Args:
        socket: accepted.
        feed: what it is shown.
    """
    listening = asyncio.create_task(_listen(socket, feed))
    sending = asyncio.create_task(_send(socket, feed))
    try:
        await asyncio.wait((listening, sending), return_when=asyncio.FIRST_COMPLETED)
    finally:
        feed.close()
        for task in (listening, sending):
            task.cancel()
            with suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError, OSError):
                await task


async def _send(socket: WebSocket, feed: Feed) -> None:
    before: Mapping[str, str] | None = None
    while True:
        await feed.changed()
        number, values = feed.read()
        begun = stopwatch()
        await socket.send_text(message_of(number, values, before))
        took = stopwatch() - begun
        before = values if took < SLOW else None
        await asyncio.sleep(max(0.0, PERIOD - took))


def message_of(number: int, values: Mapping[str, str], before: Mapping[str, str] | None) -> str:
    """Return the next message.

    Args:
        number: of the values.
        values: JSON text by key.
        before: what the browser has; None: nothing.
    """
    kind = "snapshot" if before is None else "delta"
    known = before or {}
    parts = [
        f'"{key}":{text}'
        for key, text in values.items()
        if before is None or (text != "[]" if key in HAPPENINGS else known.get(key) != text)
    ]
    return f'{{"t":"{kind}","seq":{number}{"".join(f",{part}" for part in parts)}}}'


async def _listen(socket: WebSocket, feed: Feed) -> None:
    while True:
        text = await socket.receive_text()
        if len(text) > LONGEST_MESSAGE:
            return
        try:
            message = json.loads(text)
        except ValueError:
            return
        if isinstance(message, dict):
            with suppress(PageError):
                feed.heard(message)
