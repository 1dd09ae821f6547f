"""A mission file flown over the wire, unchanged."""

import numpy as np
import pytest
from typer.testing import CliRunner
from vehicle.flying import sitl
from vehicle.message_filter import MessageFilter
from vehicle.on_a_mission import stay

from missionkit.api.vehicle_flight import fly_vehicle, vehicle_of
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.app import app
from missionkit.cli.preflight_command import PreflightOptions, preflight
from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.prepared_mission import prepare
from missionkit.errors import ExitCode, UsageError
from missionkit.geodesy import Origin
from missionkit.geometry import vec
from missionkit.sitl.geodetic import ZURICH
from missionkit.vehicle.guardian.policy import Patience

TRIP = """
missionkit: 1
mission: trip
camera: {use: none}
dwell: 0.5
targets: {tree: {position: [8.0, 3.0, -3.0]}}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 3.0}
    transitions: [{to: out, when: done}]
  out:
    kind: gps
    behavior: {use: go_to, target: tree, speed: 3.0}
    transitions: [{to: land, when: done}, {to: land, after: 30}]
  land:
    kind: land
"""
HERE = Origin(*ZURICH)  # where the simulated autopilot is armed


def elsewhere(text):
    """Return the mission with an origin 20 m from where it is armed, and the tree in degrees."""
    tree, origin = HERE.place(vec(8.0, 3.0, 0.0)), HERE.place(vec(-12.0, 16.0, 0.0))
    place = f"{{lat: {tree[0]:.9f}, lon: {tree[1]:.9f}, above_home: 3}}"
    written = f"origin: {{lat: {origin[0]:.9f}, lon: {origin[1]:.9f}, alt: 488}}\ntargets"
    return text.replace("[8.0, 3.0, -3.0]", place).replace("targets", written)


@pytest.mark.parametrize(("dialect", "text"), [("px4", elsewhere(TRIP)), ("ardupilot", TRIP)])
def test_a_mission_is_flown_as_it_is_in_the_simulator(dialect, text, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    mission = parse(text, "trip", builtin())
    states, plan = [], prepare(mission, builtin())
    with sitl(dialect) as autopilot:
        vehicle = vehicle_of(autopilot.url, mission, speed=autopilot.speed)
        flown = fly_vehicle(
            plan,
            vehicle,
            (lambda record, _: states.append(record.state),),
            speed=autopilot.speed,
        )
        truth = autopilot.truth
    assert flown.end is FlightEnd.LANDED
    assert not flown.aborted
    assert list(dict.fromkeys(states)) == ["idle", "out", "land"]
    assert np.hypot(truth["position"][0] - 8.0, truth["position"][1] - 3.0) < 3.0
    assert not truth["armed"]


def test_the_preflight_command_prints_and_says_by_its_exit_code(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    with sitl(speed=1.0) as autopilot:
        assert preflight(PreflightOptions(autopilot.url)) is ExitCode.SUCCESS
        text = capsys.readouterr().out
        autopilot.ask(parameter="COM_OBL_RC_ACT", value=7)
        assert preflight(PreflightOptions(autopilot.url, as_json=True)) is ExitCode.ENDED_SAFELY
    assert "PX4 at udpin://" in text
    assert "COM_OF_LOSS_T" in text
    assert '"level": "bad"' in capsys.readouterr().out


def test_the_guardians_timeouts_are_real_time_at_any_speed():
    mission = parse(TRIP, "trip", builtin())
    vehicle = vehicle_of("udpin://127.0.0.1:14540", mission, speed=6.0)
    assert vehicle._guard == Patience(brake=3.0, hold=6.0)
    assert vehicle_of("udpin://127.0.0.1:14540", mission)._guard == Patience(brake=0.5, hold=1.0)


def test_a_drawn_camera_needs_a_world():
    mission = parse(TRIP.replace("use: none", "use: corners"), "trip", builtin())
    with pytest.raises(UsageError, match="needs a world"):
        vehicle_of("udpin://127.0.0.1:14540", mission)


def test_a_run_does_not_begin_while_the_preflight_report_says_no(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    (tmp_path / "stay.yaml").write_text(stay(after=0.5))
    words = ["run", str(tmp_path / "stay.yaml"), "--headless", "--out", str(tmp_path / "runs")]
    with sitl() as autopilot:
        autopilot.ask(parameter="COM_LOW_BAT_ACT", value=0)
        MessageFilter(autopilot).change("BATTERY_STATUS", battery_remaining=12)
        words += ["--vehicle", autopilot.url, "--speed", str(autopilot.speed)]
        refused = CliRunner().invoke(app, words)
        assert refused.exit_code == 1, refused.output
        assert "not fit to fly, so it was not armed:\n  - battery: 12%" in refused.stderr
        assert "--anyway overrides this" in refused.stderr
        assert "400" not in {it["which"][:3] for it in autopilot.notes("command")}
        flown = CliRunner().invoke(app, [*words, "--anyway"])
        assert flown.exit_code == 0, flown.output
        assert autopilot.truth["on_ground"]
