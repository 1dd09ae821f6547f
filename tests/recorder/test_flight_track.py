from __future__ import annotations

import pytest

from missionkit.recorder import flight_track as tracks
from missionkit.recorder.flight_track import Span


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


def test_a_guard_not_evaluated_for_a_while_starts_a_new_span(flight):
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
    (it,) = track.problems
    assert (it.at, it.says) == (pytest.approx(27.05), "search: height above 2 m is not kept")
    assert (it.last, it.times) == (pytest.approx(27.95), 1)


def test_a_problem_repeated_with_other_numbers_is_one_line_of_the_summary(flight):
    track = tracks.begin()
    for k, (record, _) in enumerate(flight(3.0)):
        said = (f"pad was last seen {0.01 * k:.2f} s ago", f"marker {k // 30}: odd") * (k % 10 > 4)
        tracks.add(track, record._replace(problems=said), None)
    assert [it.line() for it in track.problems] == [
        "0.25 s: pad was last seen 0.05 s ago (6 times until 2.95 s)",
        "0.25 s: marker 0: odd (3 times until 1.45 s)",
        "1.75 s: marker 1: odd (3 times until 2.95 s)",
    ]


def test_what_is_kept_for_a_checkpoint_does_not_grow_with_the_flight(flight):
    track, kept = tracks.begin(), None
    for record, truth in flight(30.0):
        tracks.add(track, record, truth)
        if kept is None and record.now >= 5.0:
            kept = tracks.without_rows(track)
            before = [it.copy() for it in kept[4:]], {k: list(v) for k, v in kept.guards.items()}
    assert ([it.copy() for it in kept[4:]], dict(kept.guards)) == before
    assert [it.state for it in kept.visits] == ["idle", "gps"]
    assert kept.times == kept.estimated == kept.true == kept.cycles == []


def test_without_truth_the_track_has_none(flight):
    track = tracks.begin()
    for record, _ in flight(1.0):
        tracks.add(track, record, None)
    assert track.true == []
    assert len(track.estimated) == len(track.times) == 20
