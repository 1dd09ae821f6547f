"""A mission flown over the wire from Python: `missionkit.fly`."""

import shutil
import threading

import numpy as np
from vehicle.flying import sitl
from vehicle.test_wire_mission import TRIP

import missionkit
from missionkit.api.run_origin import differences, found_origin, origin_of, stamp
from missionkit.api.vehicle_checkpoints import before
from missionkit.recorder.run_summary import read_summary


def test_observers_that_fail_or_wait_cost_their_records_and_never_the_flight(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    path, folder, released = tmp_path / "trip.yaml", tmp_path / "record", threading.Event()
    path.write_text(TRIP + "settings: {time_limit: 90}\n")
    states, killed = [], tmp_path / "killed"

    def watches(record, _):
        states.append(record.state)
        if record.state == "land":
            released.set()

    def copies(record, _):
        if record.state == "out" and (folder / "checkpoint.json").exists() and not killed.exists():
            try:
                shutil.copytree(folder, killed)
            except OSError:  # a file was replaced just then
                shutil.rmtree(killed)

    def fails(record, _):
        raise ValueError("no idea")

    def waits(record, _):
        released.wait()

    mission = missionkit.load(path)
    with sitl(speed=4.0) as autopilot:
        summary = missionkit.fly(
            mission,
            autopilot.url,
            observers=[watches, fails, waits, copies],
            folder=folder,
            speed=autopilot.speed,
        )
        truth = autopilot.truth
    assert summary.outcome == "success", summary.reason
    assert summary.reason.endswith("as reported by the vehicle")
    assert list(dict.fromkeys(states)) == ["idle", "out", "land"]
    assert np.hypot(truth["position"][0] - 8.0, truth["position"][1] - 3.0) < 3.0
    assert any("observer 2: ValueError: no idea" in problem for problem in summary.problems)
    assert read_summary(folder).outcome == "success"
    assert (folder / "flight.mcap").stat().st_size > 0
    assert [part.difference for part in missionkit.replay(folder)] == [None]
    assert not {"origin.json", "checkpoint.json"} & {it.name for it in folder.iterdir()}
    origin = found_origin(killed)  # as a killed program would have left it
    assert list(differences(origin, origin_of(mission.model, path))) == []
    resumed = before(killed, stamp(origin))
    assert not resumed.changed
    assert resumed.saved.course.memory.now > 0.0
    assert resumed.track.times
