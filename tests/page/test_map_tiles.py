"""Map tiles come out of files, north side up, and what is none gets a sentence."""

import gzip
import sqlite3
import struct
from itertools import pairwise

import pytest
from browsing import Browser, port_of, served

from missionkit.errors import UsageError
from missionkit.page.recording.recording_source import RecordingSource
from missionkit.page.tiles.pmtiles import number_of
from missionkit.page.tiles.tile_file import tile_file


def mbtiles(path, form="png"):
    file = sqlite3.connect(path)
    file.execute("create table metadata (name text, value text)")
    file.execute("create table tiles (zoom_level, tile_column, tile_row, tile_data blob)")
    file.execute("insert into metadata values ('format', ?)", (form,))
    rows = [(0, 0, 0, b"world"), (1, 0, 1, b"north-west"), (1, 1, 0, b"south-east")]
    file.executemany("insert into tiles values (?, ?, ?, ?)", rows)
    file.commit()
    file.close()
    return path


def varint(value):
    data = bytearray()
    while value > 127:
        data.append(value & 127 | 128)
        value >>= 7
    return bytes([*data, value])


def directory(*entries):
    """Entries: number of the first tile, tiles, offset, length."""
    numbers = [len(entries)]
    firsts = [0, *(entry[0] for entry in entries)]
    numbers += [after - before for before, after in pairwise(firsts)]
    numbers += [entry[1] for entry in entries]
    numbers += [entry[3] for entry in entries]
    numbers += [entry[2] + 1 for entry in entries]
    return gzip.compress(b"".join(map(varint, numbers)))


def pmtiles(path, kind=2, version=3):
    images = b"worldnorth-westsea"
    leaf = directory((4, 1, 15, 3), (300, 1, 0, 5))
    root = directory((0, 1, 0, 5), (1, 2, 5, 10), (4, 0, 0, len(leaf)))
    start = 127
    places = (start, len(root), 0, 0, start + len(root), len(leaf))
    data = start + len(root) + len(leaf)
    head = struct.pack(
        "<7sB11Q6B", b"PMTiles", version, *places, data, len(images), 0, 0, 0, 1, 2, 1, kind, 0, 9
    )
    path.write_bytes(head.ljust(127, b"\0") + root + leaf + images)
    return path


def test_tiles_of_mbtiles_are_counted_from_the_north(tmp_path):
    tiles = tile_file(mbtiles(tmp_path / "a.mbtiles"))
    assert (tiles.min_zoom, tiles.max_zoom, tiles.format) == (0, 1, "png")
    assert tiles.tile(1, 0, 0) == b"north-west"
    assert tiles.tile(1, 1, 1) == b"south-east"
    assert tiles.tile(1, 0, 1) is None
    tiles.close()


def test_tiles_of_pmtiles_lie_along_a_hilbert_curve(tmp_path):
    # the examples of the specification
    assert [number_of(1, *at) for at in ((0, 0), (0, 1), (1, 1), (1, 0))] == [1, 2, 3, 4]
    assert number_of(2, 0, 0) == 5
    assert number_of(12, 3423, 1763) == 19078479
    tiles = tile_file(pmtiles(tmp_path / "a.pmtiles"))
    assert (tiles.min_zoom, tiles.max_zoom, tiles.format) == (0, 9, "png")
    assert tiles.tile(0, 0, 0) == b"world"
    assert tiles.tile(1, 0, 0) == tiles.tile(1, 0, 1) == b"north-west"  # a run of two
    assert tiles.tile(1, 1, 1) is None
    assert tiles.tile(1, 1, 0) == b"sea"  # in a leaf
    assert tiles.tile(9, 0, 0) is None


def test_what_is_no_file_of_images_gets_a_sentence(tmp_path):
    (tmp_path / "text").write_text("tiles")
    empty = sqlite3.connect(tmp_path / "empty.mbtiles")
    empty.execute("create table other (a)")
    empty.commit()
    empty.close()
    damaged = pmtiles(tmp_path / "damaged.pmtiles")
    damaged.write_bytes(damaged.read_bytes()[:140])
    wrong = {
        tmp_path / "text": "expected a file of tiles",
        tmp_path / "missing": "No such file",
        tmp_path / "empty.mbtiles": "it is no file of tiles",
        mbtiles(tmp_path / "vector.mbtiles", "pbf"): "its tiles are pbf, not images",
        pmtiles(tmp_path / "vector.pmtiles", kind=1): "not images",
        pmtiles(tmp_path / "old.pmtiles", version=2): "PMTiles version 2",
        damaged: "a directory is damaged",
    }
    for path, says in wrong.items():
        with pytest.raises(UsageError, match=says):
            tile_file(path)


def test_the_page_gets_them(recorded, tmp_path):
    source = RecordingSource(recorded)
    with served(source, tiles=pmtiles(tmp_path / "a.pmtiles")) as address:
        browser = Browser(port_of(address))
        assert browser.request("GET", "/api/tiles/0/0/0")[0] == 401
        browser.enter()
        facts = browser.get("/api/mission")["tiles"]
        assert facts == {"min_zoom": 0, "max_zoom": 9, "format": "png"}
        status, headers, data = browser.request("GET", "/api/tiles/1/1/0")
        assert (status, headers["content-type"], data) == (200, "image/png", b"sea")
        for path in ("1/1/1", "1/2/0", "10/0/0", "99999/0/0", "-1/0/0", "1/../../x"):
            assert browser.request("GET", f"/api/tiles/{path}")[0] == 404
