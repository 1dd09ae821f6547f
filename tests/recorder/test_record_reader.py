from __future__ import annotations

import pytest

from missionkit.errors import UsageError
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.record_reader import raw_messages, read


@pytest.fixture
def whole(tmp_path, flight):
    with FlightRecorder(tmp_path) as recorder:
        for record, truth in flight(30.0):
            recorder.write(record, None, truth)
    return tmp_path / "flight.mcap"


def test_entries_come_in_the_order_of_time(whole):
    times = [entry.at for entry in read(whole)]
    assert times == sorted(times)
    assert times[-1] == pytest.approx(29.95)


def test_only_the_requested_topics(whole):
    assert {entry.topic for entry in read(whole, "/goal", "/status")} == {"/goal", "/status"}


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7, 0.9])
def test_a_file_cut_anywhere_gives_its_complete_messages(whole, tmp_path, share):
    everything = list(raw_messages(whole))
    data = whole.read_bytes()
    for extra in range(0, 400, 29):
        part = tmp_path / "part.mcap"
        part.write_bytes(data[: int(len(data) * share) + extra])
        rest = list(raw_messages(part))
        assert rest == everything[: len(rest)]
    assert len(rest) > 0.5 * share * len(everything)


@pytest.mark.parametrize("size", [8, 9, 17, 60, 300, 2000])
def test_a_file_cut_in_its_beginning_gives_nothing(whole, tmp_path, size):
    part = tmp_path / "part.mcap"
    part.write_bytes(whole.read_bytes()[:size])
    assert list(raw_messages(part)) == []


def test_a_file_that_is_not_a_record_is_refused(tmp_path):
    note = tmp_path / "note.mcap"
    note.write_text("not a record")
    with pytest.raises(UsageError, match="not a flight record"):
        list(read(note))
    with pytest.raises(UsageError, match="No such file"):
        list(read(tmp_path / "missing.mcap"))


def test_a_record_still_being_written_holds_every_tick(tmp_path, flight):
    recorder = FlightRecorder(tmp_path)
    for record, truth in flight(2.0):
        recorder.write(record, None, truth)
        *_, last = read(tmp_path / "flight.mcap", "/pose")
        assert last.at == pytest.approx(record.now)
    recorder.close()
