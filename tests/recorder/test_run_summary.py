from __future__ import annotations

import json

import pytest
from pydantic import ValidationError

from missionkit.messages import Cycle
from missionkit.recorder import flight_track as tracks
from missionkit.recorder.run_summary import (
    read_summary,
    summarise,
    timing_of,
    write_summary,
)


def test_a_summary_survives_the_disk(tmp_path, flight):
    track = tracks.begin()
    for record, truth in flight():
        tracks.add(track, record, truth)
    summary = summarise(
        track,
        mission="precision-task",
        outcome="success",
        reason="landed",
        seed=7,
        faults=("hide:trunk@30+6",),
        parameters={"cruise": 5.0},
        grade={"position_error": 0.04, "touched": False},
        record_hash="ab12",
    )
    path = write_summary(tmp_path, summary)
    assert read_summary(tmp_path) == summary
    assert list(tmp_path.iterdir()) == [path]
    written = json.loads(path.read_text())
    assert written["duration"] == pytest.approx(59.95)
    assert written["states"][1]["state"] == "gps"
    assert written["states"][1]["duration"] == pytest.approx(18.0)
    assert written["transitions"][2]["reason"] == "when target_lost for 2.0 s"
    assert written["problems"] == ["27.05 s: search: height above 2 m is not kept"]


def test_the_duration_of_a_track_that_begins_late_is_its_own(flight):
    track = tracks.begin()
    for record, truth in flight(12.0):
        if record.now >= 5.0:
            tracks.add(track, record, truth)
    summary = summarise(track, mission="m", outcome="success", reason="landed")
    assert summary.duration == pytest.approx(track.times[-1] - 5.0)


def test_timing_gives_percentiles_in_milliseconds():
    cycles = [Cycle(0.001 * k, 0.002, 0.0, overruns=k // 50) for k in range(101)]
    timing = timing_of(cycles)
    assert timing is not None
    assert timing.sense.p50 == pytest.approx(50.0)
    assert timing.sense.p99 == pytest.approx(99.0)
    assert timing.total.max == pytest.approx(102.0)
    assert (timing.ticks, timing.overruns) == (101, 2)


def test_an_empty_timing_counts_as_missing():
    assert timing_of([]) is None
    assert summarise(tracks.begin(), mission="m", outcome="crash", reason="x").timing is None


def test_an_outcome_is_one_of_three():
    with pytest.raises(ValidationError, match="outcome"):
        summarise(tracks.begin(), mission="m", outcome="fine", reason="")
