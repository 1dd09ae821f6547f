"""MBTiles 1.3: tiles in a table of SQLite, rows counted from the south."""

from __future__ import annotations

import sqlite3
from pathlib import Path

from missionkit.errors import UsageError

SQLITE_MAGIC = b"SQLite format 3\0"
IMAGES = {"png": "png", "jpg": "jpg", "jpeg": "jpg", "webp": "webp"}
ONE_TILE = (
    "select tile_data from tiles where zoom_level = ? and tile_column = ? and tile_row = ? limit 1"
)


class MbTiles:
    """An open file.

    Args:
        path: of the file; it is only read.

    Raises:
        UsageError: it holds no tiles, or tiles that are no images.
    """

    def __init__(self, path: Path) -> None:
        self._file = sqlite3.connect(
            f"{path.absolute().as_uri()}?mode=ro", uri=True, check_same_thread=False
        )
        try:
            said = dict(self._file.execute("select name, value from metadata"))
            zooms = self._file.execute("select min(zoom_level), max(zoom_level) from tiles")
            least, most = zooms.fetchone()
        except sqlite3.Error as error:
            self._file.close()
            raise UsageError(f"--tiles {path}: it is no file of tiles: {error}") from error
        found = IMAGES.get(str(said.get("format", "png")).lower())
        if found is None or least is None:
            self._file.close()
            why = "it is empty" if least is None else f"its tiles are {said['format']}, not images"
            raise UsageError(f"--tiles {path}: {why}")
        self.min_zoom, self.max_zoom, self.format = int(least), int(most), found

    def tile(self, zoom: int, column: int, row: int) -> bytes | None:
        """Return an image; None: there is none.

        Args:
            zoom: of the tile.
            column: from the west.
            row: from the north.
        """
        south = (1 << zoom) - 1 - row
        try:
            found = self._file.execute(ONE_TILE, (zoom, column, south)).fetchone()
        except sqlite3.Error:
            return None
        return bytes(found[0]) if found and isinstance(found[0], bytes) else None

    def close(self) -> None:
        """Close the file."""
        self._file.close()
