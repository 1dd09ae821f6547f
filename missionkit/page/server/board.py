"""The latest of what the page shows, for any number of readers, none of which it waits for."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping

from missionkit.page.facts.plain_values import text_of

HAPPENINGS = ("fired", "problems")  # lists of which every entry matters, not only the last
KEPT = 200  # happenings that a reader may be behind; a slower one finds them in the timeline


class Board:
    """Keeps the latest value of every key, as JSON text."""

    def __init__(self) -> None:
        self.sequence = 0
        self.values: dict[str, str] = {}
        self._happenings: dict[str, list[str]] = {key: [] for key in HAPPENINGS}
        self._counts = dict.fromkeys(HAPPENINGS, 0)
        self._readers: set[BoardReader] = set()

    def post(self, facts: Mapping[str, object]) -> None:
        """Take the latest values; keys that are absent keep theirs."""
        for key, value in facts.items():
            if key not in HAPPENINGS:
                self.values[key] = text_of(value)
            elif isinstance(value, list):
                self._happened(key, value)
        self.sequence += 1
        for reader in self._readers:
            reader.woken.set()

    def _happened(self, key: str, entries: list[object]) -> None:
        kept = self._happenings[key]
        kept += map(text_of, entries)
        self._counts[key] += len(entries)
        del kept[:-KEPT]

    def happened_since(self, key: str, count: int) -> tuple[int, list[str]]:
        """Return how many there have been of a kind, and those after the first `count`."""
        total, kept = self._counts[key], self._happenings[key]
        return total, kept[max(0, len(kept) - (total - count)) :] if total > count else []

    def reader(self) -> BoardReader:
        """Return a new reader."""
        reader = BoardReader(self)
        self._readers.add(reader)
        return reader

    def leave(self, reader: BoardReader) -> None:
        """Forget a reader."""
        self._readers.discard(reader)


class BoardReader:
    """One reader: sees the latest only, and everything that has happened since it last looked."""

    def __init__(self, board: Board) -> None:
        self._board = board
        self._counts = {key: board.happened_since(key, 0)[0] for key in HAPPENINGS}
        self.woken = asyncio.Event()
        if board.values:
            self.woken.set()

    async def changed(self) -> None:
        """Return once there is something that was not read."""
        await self.woken.wait()

    def read(self) -> tuple[int, dict[str, str]]:
        """Return the number of the latest, and its values as JSON text."""
        self.woken.clear()
        values = dict(self._board.values)
        for key in HAPPENINGS:
            self._counts[key], news = self._board.happened_since(key, self._counts[key])
            values[key] = f"[{','.join(news)}]"
        return self._board.sequence, values

    def close(self) -> None:
        """Leave the board."""
        self._board.leave(self)
