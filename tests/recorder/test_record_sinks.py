"""Recorders may fail or stall: the flight reports it in a sentence and never waits."""

import errno
import threading

import pytest

from missionkit.recorder import record_sinks
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.record_reader import read
from missionkit.recorder.record_sinks import (
    Background,
    Inline,
    Reports,
    contained,
)


def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device", "runs/flight.mcap")


FULL = "the record: No space left on device (runs/flight.mcap); the flight continues"


@pytest.mark.parametrize("kind", [Inline, Background])
def test_a_failing_sink_is_reported_once_and_not_retried(kind):
    reports, done = Reports(), []
    out = kind("the record", reports)
    for job in (lambda: done.append(1), full, full, lambda: done.append(2)):
        out.put(job)
    out.close()
    assert reports.all == [FULL]
    assert (reports.take(), reports.take()) == ((FULL,), ())
    assert done == [1]


@pytest.mark.parametrize("kind", [Inline, Background])
def test_a_persistent_sink_continues_after_a_failure(kind):
    reports, done = Reports(), []
    out = kind("the record", reports, persistent=True)
    for job in (full, lambda: done.append(2), full):
        out.put(job)
    out.close()
    assert (reports.all, done) == ([FULL], [2])


class Stuck:
    """A disk that does not answer until it is let go."""

    def __init__(self):
        self.asked, self.answer = threading.Event(), threading.Event()

    def __call__(self):
        self.asked.set()
        self.answer.wait()


def test_a_hanging_disk_blocks_nothing_and_dropped_ticks_are_reported():
    reports, done, disk = Reports(), [], Stuck()
    out = Background("the record", reports, room=3)
    out.put(disk)
    disk.asked.wait()
    for number in range(5):
        out.put(lambda number=number: done.append(number))
    assert reports.take() == (
        "the record has a gap: the disk does not keep up; the flight continues",
    )
    disk.answer.set()
    out.close()
    assert done == [0, 1, 2]
    assert reports.take() == ("the record lacks 2 ticks: the disk did not keep up",)


def test_of_checkpoints_the_newest_waits_and_none_is_missed():
    reports, done, disk = Reports(), [], Stuck()
    out = Background("checkpoints", reports, room=1, newest=True)
    out.put(disk)
    disk.asked.wait()
    for number in range(5):
        out.put(lambda number=number: done.append(number))
    disk.answer.set()
    out.close()
    assert (done, reports.all) == ([4], [])


@pytest.mark.parametrize("waiting", [0, 1])
def test_the_end_of_a_flight_does_not_wait_forever(monkeypatch, waiting):
    monkeypatch.setattr(record_sinks, "DISK_TIMEOUT", 0.05)
    reports, disk = Reports(), Stuck()
    out = Background("the record", reports, room=1)
    out.put(disk)
    disk.asked.wait()
    for _ in range(waiting):
        out.put(disk)
    out.close()
    assert reports.all == ["the end of the record is missing: the disk has not answered for 0.05 s"]
    out.put(full)
    out.close()
    disk.answer.set()


def test_an_observer_that_raises_is_reported_and_called_again():
    reports, calls = Reports(), []

    def observe(now):
        calls.append(now)
        raise ValueError("no terminal")

    safe = contained("keys", observe, reports)
    safe(1.0)
    safe(2.0)
    assert (calls, reports.all) == (
        [1.0, 2.0],
        ["keys: ValueError: no terminal; the flight continues"],
    )


def test_a_record_written_behind_the_flight_is_the_same(tmp_path, flight):
    digests, reports = [], Reports()
    for name in ("direct", "behind"):
        (tmp_path / name).mkdir()
        out = None if name == "direct" else Background("the record", reports, room=2000)
        recorder = FlightRecorder(tmp_path / name, sink=out)
        for record, truth in flight(60.0):
            recorder.write(record, None, truth)
        digests.append(recorder.close())
    assert digests[0] == digests[1] != ""
    assert reports.all == []


def test_a_removed_record_file_is_reported_and_the_track_kept(tmp_path, flight):
    reports = Reports()
    recorder = FlightRecorder(tmp_path, sink=Inline("the record", reports))
    for record, truth in flight(2.0):
        recorder.write(record, None, truth)
        if record.now == 1.0:
            (tmp_path / "flight.mcap").unlink()
    assert recorder.close() == ""
    where = tmp_path / "flight.mcap"
    assert reports.all == [
        f"the record: it was removed while being written ({where}); the flight continues"
    ]
    assert len(recorder.track.times) == 40


def test_what_was_recorded_before_the_disk_was_full_can_be_read(tmp_path, flight, monkeypatch):
    reports = Reports()
    recorder = FlightRecorder(tmp_path, sink=Inline("the record", reports))
    for record, truth in flight(2.0):
        if record.now >= 1.0:
            monkeypatch.setattr(recorder._channels, "publish", full)
        recorder.write(record, None, truth)
    recorder.close()
    assert [entry.at for entry in read(tmp_path / "flight.mcap", "/pose")][-1] == pytest.approx(
        0.95
    )
    assert reports.all == [FULL]
