from __future__ import annotations

import pytest

from missionkit.recorder import track as tracks
from missionkit.recorder.track import Span


def test_visits_and_guard_spans_have_no_gaps_and_no_overlaps(flight):
    track = tracks.begin()
    for record, truth in flight():
        tracks.add(track, record, truth)
    assert [it.state for it in track.visits] == [
        "idle", "gps", "visual", "search", "visual", "task", "return", "land",
    ]  # fmt: skip
    ends = [it.end for it in track.visits[:-1]]
    assert ends == [it.start for it in track.visits[1:]]
    assert ends == [pytest.approx(at) for at, _ in track.transitions]
    assert [it.holds for it in track.guards["marker-sure"]] == [None, False, True, False, True]
    assert len(track.guards["battery"]) == 1
    assert track.guards["battery"][0] == Span(0.0, track.times[-1], holds=False)


def test_a_guard_not_asked_for_a_while_starts_a_new_span(flight):
    track = tracks.begin()
    for record, truth in flight(35.0):
        tracks.add(track, record, truth)
    first, second = track.guards["converged"]
    assert first.end == pytest.approx(26.0)
    assert second.start == pytest.approx(30.05)


def test_a_problem_that_lasts_is_kept_once(flight):
    track = tracks.begin()
    for record, truth in flight(35.0):
        tracks.add(track, record, truth)
    assert track.problems == [(pytest.approx(27.05), "search: height above 2 m is not kept")]


def test_without_truth_the_track_has_none(flight):
    track = tracks.begin()
    for record, _ in flight(1.0):
        tracks.add(track, record, None)
    assert track.true == []
    assert len(track.estimated) == len(track.times) == 20
