"""A file of raster map tiles: MBTiles (SQLite) or PMTiles version 3."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from missionkit.errors import UsageError
from missionkit.page.tiles.mbtiles import SQLITE_MAGIC, MbTiles
from missionkit.page.tiles.pmtiles import PMTILES_MAGIC, PmTiles


class TileFile(Protocol):
    """Tiles of web Mercator: column from the west, row from the north."""

    @property
    def min_zoom(self) -> int:
        """The coarsest zoom."""

    @property
    def max_zoom(self) -> int:
        """The finest zoom."""

    @property
    def format(self) -> str:
        """Format of its images: png, jpg or webp."""

    def tile(self, zoom: int, column: int, row: int) -> bytes | None:
        """Return an image; None: there is none.

        Args:
            zoom: of the tile.
            column: from the west.
            row: from the north.
        """


def tile_file(path: Path) -> TileFile:
    """Open a file of tiles.

    Raises:
        UsageError: it is none, or its tiles are no images.
    """
    try:
        with path.open("rb") as stream:
            begin = stream.read(len(SQLITE_MAGIC))
    except OSError as error:
        raise UsageError(f"--tiles {path}: {error.strerror}") from error
    if begin == SQLITE_MAGIC:
        return MbTiles(path)
    if begin.startswith(PMTILES_MAGIC):
        return PmTiles(path)
    raise UsageError(f"--tiles {path}: expected a file of tiles, .mbtiles or .pmtiles")


def facts_of(tiles: TileFile | None) -> dict[str, object] | None:
    """Return what the page is told of tiles."""
    if tiles is None:
        return None
    return {"min_zoom": tiles.min_zoom, "max_zoom": tiles.max_zoom, "format": tiles.format}
