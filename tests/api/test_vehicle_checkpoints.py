"""What a checkpoint of a flight with a vehicle says when the flight resumes from it."""

from types import SimpleNamespace

import pytest
from rehearsed import short_stage

from missionkit.api.vehicle_checkpoints import (
    Afield,
    Before,
    VehicleCheckpointWriter,
    before,
    woken,
)
from missionkit.engine.flight_state import FlightState
from missionkit.engine.prepared_mission import begin
from missionkit.recorder import flight_track
from missionkit.recorder.record_sinks import Inline, Reports
from missionkit.vehicle.telemetry.observer import Datum

MISSION = """\
initial: ground
states: {ground: {kind: idle, transitions: [{to: land, after: 1}]}, land: {kind: land}}
"""


def vehicle(link, control):
    observer = SimpleNamespace(datum=Datum(), settle=lambda _: None)
    return SimpleNamespace(observer=observer, link_state=link, control_state=control)


@pytest.mark.parametrize(
    ("link", "control", "said"),
    [
        ("live", "commanding", ()),
        ("live", "ground", ()),
        ("silent", "doubting", ("the link was silent at the last checkpoint",)),
        (
            "live",
            "pilot",
            (
                "control had been given up at the last checkpoint (pilot); "
                "resuming gives it back to the mission",
            ),
        ),
    ],
)
def test_the_states_of_link_and_control_are_saved_and_told_on_resume(link, control, said, tmp_path):
    track, reports = flight_track.begin(), Reports()
    flown, sink = SimpleNamespace(track=track), Inline("checkpoints", reports)
    save = VehicleCheckpointWriter(tmp_path, vehicle(link, control), flown, "digest", sink)
    save(FlightState(begin(short_stage(MISSION).plan)), ("it was lost",))
    assert reports.all == []
    past = before(tmp_path, "digest")
    assert isinstance(past, Before)
    assert isinstance(past.saved, Afield)
    assert (past.saved.link, past.saved.control) == (link, control)
    assert woken(past, vehicle("live", "ground"), 1.0).notes == ("it was lost", *said)
