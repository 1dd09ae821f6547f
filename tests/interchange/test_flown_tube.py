"""The tube holds the share of the flights that it says."""

from __future__ import annotations

import re

import numpy as np
import pytest
from typer.testing import CliRunner

from missionkit.cli.app import app
from missionkit.geodesy import Origin
from missionkit.interchange.flown_tube import by_visit, tube
from missionkit.interchange.tube_kml import tube_kml

SPREAD = 2.0  # m
ORIGIN = Origin(47.3977, 8.5456, 488.0)


@pytest.fixture(scope="module")
def flights():
    """40 m north-east at 10 m, each flight off to the side and in height by a normal amount."""
    generator = np.random.default_rng(7)
    along = np.linspace(0.0, 40.0, 30)
    across, up = generator.normal(0.0, SPREAD, 400), generator.normal(10.0, 0.5, 400)
    s = np.sqrt(0.5)
    return [
        np.column_stack([s * (along - a), s * (along + a), np.full(30, -h)])
        for a, h in zip(across, up, strict=True)
    ]


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_width_and_height_are_the_quantiles(flights, share):
    legs = tube(flights, share)
    factor = {0.5: 0.6745, 0.9: 1.6449}[share]  # of a normal distribution
    for leg in legs:
        for gate in leg:
            width = np.linalg.norm(gate[1] - gate[0])
            assert width == pytest.approx(2 * factor * SPREAD, rel=0.15)
            assert gate[2][2] - gate[0][2] == pytest.approx(2 * factor * 0.5, rel=0.15)
            assert (gate[1] - gate[0]) @ [1.0, 1.0, 0.0] == pytest.approx(0.0, abs=1e-6)


def test_all_flights_are_inside_of_the_widest(flights):
    right = np.array([-np.sqrt(0.5), np.sqrt(0.5)])
    sides = [float(path[0][:2] @ right) for path in flights]
    (first, *_) = tube(flights, 1.0)
    gate = [float(corner[:2] @ right) for corner in first.start]
    assert (min(gate), max(gate)) == pytest.approx((min(sides), max(sides)))


def test_a_climb_is_a_box_with_breadth_both_ways():
    paths = [np.array([[n, e, 0.0], [n, e, -20.0]]) for n, e in ((0, 0), (1, 0), (0, 3), (1, 3))]
    (first, *_) = tube(paths, 1.0)
    corners = np.concatenate(first)
    assert np.ptp(corners, axis=0)[:2] == pytest.approx([1.0, 3.0])


def test_flights_are_compared_visit_by_visit():
    here, there = np.array([[0.0, 0, 0], [1, 0, 0]]), np.array([[0.0, 0, 0], [0, 5, 0]])
    still = np.array([[0.0, 0, 0], [0, 0, 0]])
    found = by_visit([[("a", here), ("b", there), ("a", there)], [("a", here), ("b", still)]])
    assert {visit: len(paths) for visit, paths in found.items()} == {("a", 1): 2}


def test_volumes_stand_where_the_flights_were(flights):
    document = tube_kml({("out", 1): flights}, ORIGIN, "tube").decode()
    assert document.count("<Folder>") == 3
    numbers = re.findall(r"([\d.]+),([\d.]+),([\d.]+)", document)
    places = np.array(numbers, float)
    local = np.array([ORIGIN.local(lat, lon, alt) for lon, lat, alt in places[:200]])
    assert np.abs(local[:, 2] + 10.0).max() < 2.0
    assert np.hypot(local[:, 0], local[:, 1]).max() < 45.0


def test_a_campaign_without_records_says_what_to_do(tmp_path):
    result = CliRunner().invoke(app, ["export", str(tmp_path), "-o", str(tmp_path / "tube.kml")])
    assert result.exit_code == 2
    assert "--records" in result.output
