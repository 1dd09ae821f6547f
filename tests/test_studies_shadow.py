"""The study of one robot held in view: its rows and its picture."""

from __future__ import annotations

import numpy as np
import pytest

from studies import shadow
from studies.shadow import Watched, Way, row

TIMES = np.arange(12.0, 70.0, 0.05)


def watched(farthest: float, tracks: int = 1, *, finished: bool = True) -> Watched:
    """A flight in which the robot is 3 px along and 4 px up, and once as far up as given."""
    pixels = np.tile((3.0, 4.0), (len(TIMES), 1))
    pixels[np.searchsorted(TIMES, 31.0), 1] = farthest
    return Watched(TIMES, pixels, tracks, (30.0, 50.0), finished)


@pytest.mark.parametrize(
    ("flight", "held"),
    [
        (watched(100.0), True),
        (watched(-121.0), False),
        (watched(100.0, tracks=2), False),
        (watched(100.0, finished=False), False),
        (Watched(np.array([]), np.empty((0, 2)), 0, (), True), False),
    ],
)
def test_a_robot_is_held_by_one_track_within_the_image(flight, held):
    assert flight.held is held


def test_the_row_and_the_page_hold_the_results(tmp_path, monkeypatch):
    flights = {0: watched(100.0), 1: watched(-130.0)}
    monkeypatch.setattr(shadow, "flown", lambda seed, way: flights[seed])
    found = row(Way(), list(flights.values()))
    assert found[:3] == ("drawn", "`switched`", "`imm`")
    assert found[3].startswith("1 of 2")
    assert found[5:] == ("115, 130", "115")
    shadow.main(["--flights", "2", "--workers", "1", "--out", str(tmp_path)])
    text = (tmp_path / "shadow.md").read_text()
    assert "Held in 1 of 2" in text
    assert text.count("| boxes  |") == 4
    assert (tmp_path / "shadow.png").stat().st_size > 10_000
