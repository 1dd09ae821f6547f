"""Files that are damaged or meant to harm: one sentence each, within bounds."""

from __future__ import annotations

import json

import pytest
from plans import FLAT, imported, mission_of, qgc, way
from typer.testing import CliRunner

from missionkit.cli.app import app
from missionkit.interchange import bounded_input
from missionkit.interchange.kml_writer import archive

KML = '<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2">{}</kml>'
BOMB = (
    '<?xml version="1.0"?><!DOCTYPE kml [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>'
    "<kml>&b;</kml>"
)
GOOD = qgc([way(47.398, 8.5456, 25)])


def zipped(size):
    return archive([("doc.kml", b"<kml>" + b" " * size)])


def run(tmp_path, data, *options, name="file.any"):
    path = tmp_path / name
    path.write_bytes(data)
    return CliRunner().invoke(app, ["import", str(path), *options])


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "the file is empty"),
        (GOOD[: len(GOOD) // 2], "not valid JSON in line 1"),
        (GOOD.replace(b'"items": [', b'"items": 7, "x": ['), "'items' is not a list"),
        (b'{"fileType": "Plan", "mission": []}', "'mission' is not a mapping"),
        (b'{"fileType": "Plan", "a": ' + b"[" * 5000 + b"]" * 5000 + b"}", "nested deeper"),
        (b'{"fileType": "Plan", "a": 1' + b"0" * 5000 + b"}", "not valid JSON"),
        (b'{"fileType": "Plan", "a": "\xff"}', "not UTF-8 text at byte 27"),
        (GOOD.decode().encode("utf-16"), ""),
        (b"\x7fELF\x02\x01\x01\x00" + bytes(100), "not a file that missionkit knows"),
        (KML.format("<Placemark>").encode(), "not valid XML in line 1"),
        (BOMB.encode(), "declares a DTD or entities"),
        (KML.format("<a>" * 200 + "</a>" * 200).encode(), "nested deeper"),
        (b'<?xml version="1.0" encoding="x-none"?><kml></kml>', "not valid XML"),
        (archive([("a.txt", b"")]), "no .kml file"),
        (zipped(1000)[:100], "damaged or cut short"),
        (b"QGC WPL 110\n", "no place on the earth"),
        (b'{"type": "FeatureCollection", "features": 3}', "'features' is not a list"),
    ],
)
def test_one_sentence(tmp_path, data, says):
    result = run(tmp_path, data)
    assert "Traceback" not in result.output
    if says:
        assert result.exit_code == 2
        assert says in result.output.splitlines()[-1]
    else:
        assert result.exit_code == 0


@pytest.mark.parametrize(
    "data",
    [
        {
            "fileType": "Plan",
            "mission": {"items": [{"type": "ComplexItem", "complexItemType": []}]},
        },
        {"type": "Feature", "geometry": {"type": ["Point"], "coordinates": [8, 47, 3]}},
        {"type": "Point", "coordinates": [8.5, 47.4], "bbox": {}},
        {"states": {"a": {"type": ["final"], "history": {}, "on": [], "entry": [{"type": {}}]}}},
        {"fileType": "Plan", "mission": {"items": [], "plannedHomePosition": [47.4, 8.5, 1e308]}},
    ],
)
def test_values_of_the_wrong_type(tmp_path, data):
    result = run(tmp_path, json.dumps(data).encode())
    assert result.exit_code in {0, 2}
    assert "Traceback" not in result.output
    assert result.exception is None or isinstance(result.exception, SystemExit)


@pytest.mark.parametrize("key", ["speed", "radius", "turns", "clockwise", "role", "reference"])
@pytest.mark.parametrize("value", [-1, 1e9, [], None])
def test_marks_that_were_edited_by_hand(tmp_path, key, value):
    mark = {
        **{"role": "circle", "height": 20, "reference": "above_home", "speed": 3},
        **{"radius": 9, "turns": 2, key: value},
    }
    point = {"type": "Point", "coordinates": [8.5457, 47.398]}
    rows = [{"type": "Feature", "properties": {"missionkit": mark}, "geometry": point}]
    rows.append({"type": "Feature", "properties": {}, "geometry": point})
    raw = json.dumps({"type": "FeatureCollection", "features": rows}).encode()
    mission_of(imported(raw, FLAT._replace(height=20.0))[0])


def test_an_archive_that_unpacks_to_too_much(tmp_path, monkeypatch):
    monkeypatch.setattr(bounded_input, "MOST_BYTES", 1 << 20)
    result = run(tmp_path, zipped((1 << 20) + 10))
    assert "unpacked it is larger than 1 MiB" in result.output
    result = run(tmp_path, b"x" * ((1 << 20) + 1))
    assert "larger than 1 MiB" in result.output


def test_every_cut_of_a_file_is_a_sentence(tmp_path):
    for end in range(1, len(GOOD), 97):
        result = run(tmp_path, GOOD[:end])
        assert result.exit_code == 2
        assert result.output.count("\n") <= 2


def test_nothing_is_overwritten(tmp_path):
    out = tmp_path / "out.yaml"
    assert run(tmp_path, GOOD, "-o", str(out)).exit_code == 0
    ledger = json.loads((tmp_path / "out.yaml.ledger.json").read_text())
    assert ledger["counts"] == {"kept": 1, "approximated": 0, "refused": 0}
    before = out.read_bytes()
    again = run(tmp_path, GOOD, "-o", str(out))
    assert again.exit_code == 2
    assert "--force" in again.output
    assert out.read_bytes() == before
    assert run(tmp_path, GOOD, "-o", str(out), "--force").exit_code == 0


def test_strict_writes_nothing_if_an_item_is_refused(tmp_path):
    raw = qgc([way(47.398, 8.5456, 25), way(0, 0, 3)])
    out = tmp_path / "out.yaml"
    assert run(tmp_path, raw, "-o", str(out), "--strict").exit_code == 2
    assert not out.exists()


@pytest.mark.parametrize("command", ["validate", "run", "explain"])
def test_where_a_mission_is_expected_a_plan_is_recognised(tmp_path, command):
    path = tmp_path / "wrong.yaml"
    path.write_bytes(GOOD)
    result = CliRunner().invoke(app, [command, str(path)])
    assert result.exit_code == 2
    assert "this is a QGroundControl plan" in result.output
    assert "missionkit import wrong.yaml" in result.output
