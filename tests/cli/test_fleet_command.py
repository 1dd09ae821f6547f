"""`missionkit fleet`: what it refuses, what it leaves, and that no process stops the others."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading

import pytest
from fleets import LEG

from missionkit.cli import fleet_over_mavlink as over_mavlink
from missionkit.cli.fleet_members import FleetOptions, members_of
from missionkit.engine.clock import stopwatch

NAMED = LEG.replace("near: {use: separation_below,", "near: {use: separation_below, vehicle: up,")
AT_HOME = "origin: {lat: 47, lon: 8, alt: 400}\n"


@pytest.fixture
def leg(tmp_path):
    path = tmp_path / "leg.yaml"
    path.write_text(LEG)
    (tmp_path / "named.yaml").write_text(NAMED.replace("mission: leg", "mission: named"))
    (tmp_path / "placed.yaml").write_text(LEG + AT_HOME)
    return path


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["leg.yaml"], "a fleet is of two missions or more; `missionkit run` flies one"),
        (["leg.yaml", "leg.yaml"], "2 vehicles are called 'leg': name them, as in one=FILE"),
        (["a=leg.yaml", "=leg.yaml"], "=leg.yaml: expected MISSION.yaml or NAME=MISSION.yaml"),
        (["a=leg.yaml", "b=leg.yaml"], "a and b start 0.00 m apart: give each mission a"),
        (["a=leg.yaml", "b=leg.yaml", "--fault", "gnss_lost"], "--fault gnss_lost: say for which"),
        (["a=leg.yaml", "b=leg.yaml", "--fault", "c:gnss_lost"], "--fault c:gnss_lost: no such"),
        (["a=leg.yaml", "b=leg.yaml", "--set", "c:height=3"], "--set c:height=3: no such vehicle"),
        (["a=leg.yaml", "b=leg.yaml", "--set", "hight=3"], "--set hight=3: no mission has such a"),
        (["a=leg.yaml", "b=leg.yaml", "--set", "height"], "--set height: expected NAME=VALUE"),
        (["a=leg.yaml", "named.yaml"], "separation_below of vehicle 'up', which is not another"),
        (["a=leg.yaml", "b=leg.yaml", "--workers", "2"], "--workers needs --runs"),
        (["a=leg.yaml", "b=leg.yaml", "--system", "2"], "--system is given 1 times, for 2 miss"),
        (["a=leg.yaml", "b=leg.yaml", "--vehicle", "udpin://127.0.0.1:1"], "--vehicle is given 1"),
        (["a=leg.yaml", "b=leg.yaml", "--sitl", "px4"], "needs an 'origin' over MAVLink"),
        (["a=placed.yaml", "b=placed.yaml", "--sitl", "x"], "--sitl x: must be one of px4, ardu"),
    ],
)
def test_a_mistake_is_one_sentence(call, leg, words, sentence):
    result = call("fleet", *words)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert sentence in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_it_leaves_a_folder_for_each_vehicle_and_a_summary(call, leg, tmp_path):
    words = ["west=leg.yaml", "east=leg.yaml", "--seed", "3", "--json", "--separation", "9.5"]
    for setting in ("height=3", "to=[3, 0]", "east:start=[0, 9]", "east:to=[3, 9]"):
        words += ["--set", setting]
    result = call("fleet", *words)
    told = json.loads(result.stdout)
    assert result.exit_code == 1, "a conflict is no success"
    assert [it["outcome"] for it in told["vehicles"]] == ["success", "success"]
    assert told["encounters"][0]["conflicts"] >= 1
    folder = tmp_path / "runs" / "fleet-seed3"
    assert json.loads((folder / "fleet.json").read_text()) == {
        key: value for key, value in told.items() if key != "folder"
    }
    for name in ("west", "east"):
        left = {path.name for path in (folder / name).iterdir()}
        assert left == {
                "flight.mcap", "journal.mcap", "mission.yaml", "summary.json", "track.png",
            }  # fmt: skip
    parameters = json.loads((folder / "east" / "summary.json").read_text())["parameters"]
    assert parameters == {"start": [0, 9], "to": [3, 9], "height": 3}


def test_many_seeds_count_conflicts_with_an_interval(call, leg, tmp_path):
    words = ["west=leg.yaml", "east=leg.yaml", "--runs", "2", "--workers", "1", "--json"]
    for setting in ("height=2", "to=[1, 0]", "east:start=[0, 9]", "east:to=[1, 9]"):
        words += ["--set", setting]
    result = call("fleet", *words)
    told = json.loads(result.stdout)
    assert result.exit_code == 0
    assert (told["runs"], told["conflicts"], told["in_conflict"]["low"]) == (2, 0, 0.0)
    assert 0.5 < told["in_conflict"]["high"] < 0.9
    lines = (tmp_path / told["folder"] / "flights.jsonl").read_text().splitlines()
    assert [json.loads(line)["seed"] for line in lines] == [0, 1]


WAITS = """
import signal, sys
signal.signal(signal.SIGINT, lambda *_: sys.exit(7))
print("flying", flush=True)
signal.pause()
"""


def test_a_process_that_is_killed_stops_no_other_and_ctrl_c_ends_all(leg, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(over_mavlink, "_words", lambda *_: [sys.executable, "-S", "-c", WAITS])
    watched, running = over_mavlink._watch, []

    def watching(crew, monitor):
        def kill_one_then_interrupt():
            logs = [tmp_path / f"{it.member.name}.log" for it in crew]
            deadline = stopwatch() + 30.0
            while not all(log.read_text() == "flying\n" for log in logs):
                assert stopwatch() < deadline
            crew[1].process.kill()
            crew[1].process.wait(10.0)
            running.extend(it.running for it in crew)
            os.kill(os.getpid(), signal.SIGINT)

        thread = threading.Thread(target=kill_one_then_interrupt)
        thread.start()
        watched(crew, monitor)
        thread.join()

    monkeypatch.setattr(over_mavlink, "_watch", watching)
    wanted = FleetOptions(("a=placed.yaml", "b=placed.yaml", "c=placed.yaml"), sitl="px4")
    found = over_mavlink.fly_over_mavlink(wanted, members_of(wanted), tmp_path)
    assert running == [True, False, True]
    assert [(it.vehicle, it.reason) for it in found.vehicles] == [
        ("a", "flying"),
        ("b", "its process died, signal SIGKILL"),
        ("c", "flying"),
    ]
    assert {it.outcome for it in found.vehicles} == {"lost"}
