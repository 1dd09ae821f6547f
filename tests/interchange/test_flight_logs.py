"""Logs of autopilots become flight records, and requirements are checked on them."""

from __future__ import annotations

import json

import pytest
from logs import ALT, BEGAN, LAT, LON, SECONDS, dataflash, tlog, ulog
from typer.testing import CliRunner

from missionkit.chart.text.foreign_files import HEAD, foreign_kind
from missionkit.cli.app import app
from missionkit.interchange.flight_logs.reading import READERS
from missionkit.recorder.record_reader import read

WRITERS = {"flight.ulg": ulog, "flight.tlog": tlog, "flight.bin": dataflash}
MISSION = f"""
missionkit: 1
mission: strip
origin: {{lat: {LAT}, lon: {LON}, alt: {ALT}}}
initial: up
states:
  up: {{kind: idle, behavior: {{use: take_off}}, transitions: [{{to: land, when: done}}]}}
  land: {{kind: land}}
requirements:
  - {{name: low, always: {{use: inside_fence, north: [-5, 80], east: [-5, 5], height: 30}}}}
  - {{name: near, always: {{use: inside_fence, north: [-5, 30], east: [-5, 5], height: 30}}}}
  - {{name: charged, never: {{use: battery_below, floor: 0.4}}}}
"""


def run(path, *options):
    return CliRunner().invoke(app, ["log", str(path), "--out", str(path.parent / "runs"), *options])


@pytest.fixture(scope="module", params=sorted(WRITERS))
def flown(request, tmp_path_factory):
    """Return the file, what the command says, and the folder it wrote."""
    folder = tmp_path_factory.mktemp("log")
    path = WRITERS[request.param](folder / request.param)
    mission = folder / "strip.yaml"
    mission.write_text(MISSION)
    result = run(path, "--mission", str(mission))
    return path, result, next((folder / "runs").iterdir())


def test_the_record_has_positions_modes_battery_and_messages(flown):
    path, _, folder = flown
    rows = {}
    for entry in read(folder / "flight.mcap"):
        rows.setdefault(entry.topic, []).append((entry.at, entry.data))
    places = [it["pose"]["position"] for _, it in rows["/pose"]]
    assert len(places) == pytest.approx(SECONDS * 5, abs=2)
    assert max(it["x"] for it in places) == pytest.approx(60.0, abs=0.3)
    assert min(it["z"] for it in places) == pytest.approx(-20.0, abs=0.05)
    states = list(dict.fromkeys(it["state"] for _, it in rows["/state"]))
    begins = "hold" if path.suffix == ".ulg" else "loiter"  # each autopilot's own word
    assert states == [f"mode {it}" for it in (begins, "mission", "land")]
    status = [it for _, it in rows["/status"]]
    assert (status[0]["armed"], status[5]["armed"], status[-1]["armed"]) == (False, True, False)
    assert status[10]["charge"] == pytest.approx(0.8, abs=0.02)
    assert status[10]["voltage"] == pytest.approx(15.8, abs=0.05)
    assert rows["/estimate"][50][1]["yaw_deg"] == pytest.approx(28.6, abs=0.1)
    assert any("Takeoff detected" in it["message"] for _, it in rows["/log"])
    fix = rows["/fix"][0][1]
    assert (fix["latitude"], fix["altitude"]) == (pytest.approx(LAT, abs=1e-6), pytest.approx(ALT))
    assert rows["/origin"][0][1]["utc"].startswith("2025-06-15T15:06")
    assert (folder / "track.png").stat().st_size > 10_000


def test_requirements_are_checked_on_it(flown):
    _, result, _ = flown
    lines = result.output.splitlines()
    assert any(line.startswith("fulfilled: low") for line in lines)
    assert any(line.startswith("broken: near") for line in lines)
    assert any(line.startswith("fulfilled: charged") for line in lines)
    assert result.exit_code == 1


def test_the_ledger_counts_every_type_of_message(flown):
    _, _, folder = flown
    ledger = json.loads((folder / "ledger.json").read_text())
    assert sum(ledger["counts"].values()) == ledger["items"] >= 5
    assert BEGAN > 0


@pytest.mark.parametrize("name", sorted(WRITERS))
@pytest.mark.parametrize("share", [0.5, 0.97])
def test_a_log_that_is_cut_short_is_read_up_to_there(tmp_path, name, share):
    path = WRITERS[name](tmp_path / name)
    raw = path.read_bytes()
    kind = foreign_kind(raw)
    path.write_bytes(raw[: int(share * len(raw))])
    found = READERS[kind](path)
    times = [it.at for it in found.samples]
    assert max(times) - min(times) == pytest.approx(share * SECONDS, abs=3.0)


def test_noise_within_a_log_is_skipped(tmp_path):
    path = tlog(tmp_path / "flight.tlog")
    whole = READERS[foreign_kind(path.read_bytes())](path)
    raw = path.read_bytes()
    middle = len(raw) // 2
    path.write_bytes(raw[:middle] + bytes(range(256)) + raw[middle:])
    found = READERS[foreign_kind(raw)](path)
    assert found.damaged > 0
    assert len(whole.samples) - 12 <= len(found.samples) < len(whole.samples) + 5


def test_what_is_no_log_is_refused(tmp_path):
    path = tmp_path / "flight.ulg"
    path.write_bytes(b"hello")
    assert "not a log that missionkit knows" in run(path).output
    path.write_bytes(b"QGC WPL 110\n")
    assert "missionkit import" in run(path).output
    assert run(tmp_path / "none.bin").exit_code == 2
    assert foreign_kind(tlog(tmp_path / "a.tlog").read_bytes()[:HEAD])
