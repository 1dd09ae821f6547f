"""The geotag log of a flight's photos."""

from __future__ import annotations

import csv

import numpy as np
import pytest
from rehearsed import flown

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.geodesy import Origin
from missionkit.recorder import photo_log
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.geographic_messages import Georeference
from missionkit.rehearsal.stage import stage
from missionkit.sim.world import World

TEXT = """\
missionkit: 1
mission: photos
camera: {use: none}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.2}, to: land}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 3}
    transitions: [{to: photos, when: done}]
  photos:
    kind: custom
    behavior: {use: photo, count: 3, every: 0.5}
    transitions: [{to: drop, when: done}, {to: land, after: 30}]
  drop:
    kind: custom
    behavior: {use: gripper, action: release, wait: 0.5}
    transitions: [{to: land, when: done}, {to: land, after: 30}]
  land: {kind: land}
"""
ORIGIN = Origin(47.4, 8.5, 500.0)


def test_each_photo_has_its_row_and_the_simulator_its_devices(tmp_path):
    flight = flown(stage(parse(TEXT, "m", builtin()), builtin(), World(world="empty"), 0))
    reference = Georeference.fixed(ORIGIN, lambda: 1_700_000_000.0)
    with FlightRecorder(tmp_path, reference=reference) as recorder:
        for record in flight.records:
            recorder.write(record)
    with (tmp_path / "photos.csv").open() as file:
        rows = list(csv.DictReader(file))
    vehicle = flight.ready.vehicle
    assert vehicle.devices == {"gripper 1": 0.0}
    assert [row["photo"] for row in rows] == ["1", "2", "3"]
    assert [float(row["time_s"]) for row in rows] == pytest.approx(vehicle.photos, abs=0.06)
    for row in rows:
        place = ORIGIN.local(
            *(float(row[key]) for key in ("latitude_deg", "longitude_deg", "altitude_m"))
        )
        told = [float(row[key]) for key in ("north_m", "east_m", "down_m")]
        assert place == pytest.approx(told, abs=0.01)
        now = float(row["time_s"])
        truth = vehicle.track.rows
        at = truth[np.argmin(np.abs(truth[:, 0] - now)), 1:4]
        assert np.linalg.norm(at - told) < 2.5  # by satellites
        assert row["utc"].startswith("2023-11-14T22:13:2")


@pytest.mark.parametrize("torn", ["", "4,12.3"])
def test_a_resumed_flight_counts_on(tmp_path, torn):
    path = tmp_path / "photos.csv"
    assert photo_log.last_number(path) == 0
    photo_log.append(path, [f"{n},1.0\n" for n in (1, 2, 3)])
    with path.open("a") as file:
        file.write(torn)
    number = photo_log.last_number(path)
    assert number == (4 if torn else 3)
    photo_log.append(path, [f"{number + 1},2.0\n"])
    with path.open() as file:
        numbers = [int(row["photo"]) for row in csv.DictReader(file)]
    assert numbers == [1, 2, 3, *([4] if torn else []), number + 1]
