"""PMTiles version 3: one file, its directory sorted along a Hilbert curve.

Source: the PMTiles version 3 specification (Protomaps, public domain).
"""

from __future__ import annotations

import gzip
import struct
import zlib
from bisect import bisect_right
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from missionkit.errors import UsageError

PMTILES_MAGIC = b"PMTiles"
HEADER = struct.Struct("<7sB11Q6B")
IMAGES = {2: "png", 3: "jpg", 4: "webp"}
NONE, GZIP = 1, 2  # compressions
DEEPEST = 4  # directories in each other
MOST_ENTRIES = 1 << 20  # of one directory
MOST_BYTES = 1 << 26  # of a directory, unpacked


class DirectoryEntry(NamedTuple):
    """Tiles that are the same, or a directory if there are none."""

    first: int  # number along the curve
    tiles: int
    offset: int
    length: int


class PmTiles:
    """An open file.

    Args:
        path: of the file.

    Raises:
        UsageError: it is damaged, of another version, or its tiles are no images.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        with path.open("rb") as stream:
            head = stream.read(HEADER.size)
        if len(head) < HEADER.size:
            raise UsageError(f"--tiles {path}: the file ends in its header")
        said = HEADER.unpack(head)
        version, places, bits = said[1], said[2:13], said[13:]
        if version != 3:
            raise UsageError(f"--tiles {path}: PMTiles version {version}; this reads version 3")
        _, self._packing, self._tile_packing, kind, self.min_zoom, self.max_zoom = bits
        if kind not in IMAGES:
            raise UsageError(f"--tiles {path}: its tiles are not images (png, jpg or webp)")
        if not {self._packing, self._tile_packing} <= {NONE, GZIP}:
            raise UsageError(f"--tiles {path}: its compression is unknown; known: none, gzip")
        self.format = IMAGES[kind]
        root, root_length, _, _, self._leaves, _, self._data, *_ = places
        self._root = self._directory(root, root_length)

    def tile(self, zoom: int, column: int, row: int) -> bytes | None:
        """Return an image; None: there is none.

        Args:
            zoom: of the tile.
            column: from the west.
            row: from the north.
        """
        number, entries = number_of(zoom, column, row), self._root
        for _ in range(DEEPEST):
            at = bisect_right(entries, number, key=lambda entry: entry.first) - 1
            if at < 0:
                return None
            entry = entries[at]
            if entry.tiles:
                inside = number < entry.first + entry.tiles
                return self._tile(entry) if inside else None
            entries = self._directory(self._leaves + entry.offset, entry.length)
        return None

    def _tile(self, entry: DirectoryEntry) -> bytes:
        data = self._read(self._data + entry.offset, entry.length)
        return gzip.decompress(data) if self._tile_packing == GZIP else data

    def _directory(self, offset: int, length: int) -> list[DirectoryEntry]:
        try:
            data = self._read(offset, length)
            return entries_of(_unpacked(data) if self._packing == GZIP else data)
        except (zlib.error, RuntimeError, StopIteration, ValueError) as error:
            raise UsageError(f"--tiles {self._path}: a directory is damaged") from error

    def _read(self, offset: int, length: int) -> bytes:
        with self._path.open("rb") as stream:
            stream.seek(offset)
            return stream.read(min(length, MOST_BYTES))


def _unpacked(data: bytes) -> bytes:
    return zlib.decompressobj(16 + zlib.MAX_WBITS).decompress(data, MOST_BYTES)


def number_of(zoom: int, column: int, row: int) -> int:
    """Return the number of a tile along the Hilbert curves of all zooms.

    Args:
        zoom: of the tile.
        column: from the west.
        row: from the north.
    """
    number = ((1 << (2 * zoom)) - 1) // 3
    x, y = column, row
    for bit in range(zoom - 1, -1, -1):
        side = 1 << bit
        right, lower = side & x, side & y
        number += ((3 * right) ^ lower) << bit
        if not lower:
            if right:
                x, y = side - 1 - x, side - 1 - y
            x, y = y, x
    return number


def entries_of(data: bytes) -> list[DirectoryEntry]:
    """Return the entries of a directory, unpacked.

    Raises:
        RuntimeError: the directory ends too early.
        ValueError: it is longer than any should be.
    """
    numbers = _numbers(data)
    count = next(numbers)
    if count > MOST_ENTRIES:
        raise ValueError(count)
    steps, counts, lengths, offsets = ([next(numbers) for _ in range(count)] for _ in range(4))
    found: list[DirectoryEntry] = []
    first = 0
    for step, run, length, offset in zip(steps, counts, lengths, offsets, strict=True):
        first += step
        behind = found[-1].offset + found[-1].length if found else 0
        found.append(DirectoryEntry(first, run, offset - 1 if offset else behind, length))
    return found


def _numbers(data: bytes) -> Iterator[int]:
    """Yield numbers of seven bits a byte, the last byte of each below 128."""
    value = shift = 0
    for byte in data:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            yield value
            value = shift = 0
