"""Vehicles of other kinds are refused, and several on one link are distinguished."""

import asyncio
import copy

import pytest
from typer.testing import CliRunner
from vehicle.flying import SPEED, flying, sitl
from vehicle.message_filter import MessageFilter

from missionkit.cli.app import app
from missionkit.errors import VehicleError
from missionkit.sitl.sitl_server import Setup, serving

FIXED_WING, ROVER, HELICOPTER, QUADROTOR = 1, 10, 4, 2  # MAV_TYPE


def connected(autopilot, tmp_path, **options):
    """Connect; return the system id that answered, and the dialect's name."""

    async def connect():
        async with flying(autopilot, tmp_path, **options) as flight:
            return flight.vehicle.link.system_id, flight.vehicle.dialect.name

    return asyncio.run(connect())


@pytest.mark.parametrize(
    ("dialect", "kind", "name"),
    [
        ("ardupilot", FIXED_WING, "fixed wing"),
        ("ardupilot", ROVER, "ground rover"),
        ("px4", FIXED_WING, "fixed wing"),
        ("px4", 22, "VTOL"),
    ],
)
def test_a_vehicle_that_is_not_a_multicopter_is_refused_by_name(dialect, kind, name, tmp_path):
    with sitl(dialect) as autopilot:
        MessageFilter(autopilot).change("HEARTBEAT", type=kind)
        with pytest.raises(VehicleError, match=rf"system 1 is not flown: it is a {name} \(MAV"):
            connected(autopilot, tmp_path)
        assert {it["which"][:3] for it in autopilot.notes("command")} <= {"512"}  # its version
        assert not autopilot.truth["armed"]


@pytest.mark.parametrize("command", [["preflight"], ["fence", "stay.yaml"], ["run"]])
def test_every_command_refuses_it(command, tmp_path, monkeypatch):
    mission = tmp_path / "stay.yaml"
    mission.write_text(FENCED)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    with sitl() as autopilot:
        MessageFilter(autopilot).change("HEARTBEAT", type=FIXED_WING)
        url, out = autopilot.url, str(tmp_path)
        words = {
            "preflight": ["preflight", url],
            "fence": ["fence", url, str(mission)],
            "run": ["run", str(mission), "--vehicle", url, "--headless", "--out", out],
        }[command[0]]
        done = CliRunner().invoke(app, words)
    assert done.exit_code == 3, done.output
    assert "it is a fixed wing (MAV_TYPE 1); missionkit flies multicopters" in done.stderr


FENCED = """
missionkit: 1
mission: stay
camera: {use: none}
initial: idle
guards: {inside: {use: inside_fence, north: [-40, 40], east: [-40, 40], height: 20}}
states:
  idle: {kind: idle, transitions: [{to: land, after: 1}]}
  land: {kind: land}
failsafes: [{name: fence, when: {not: inside}, to: land}]
"""


def test_a_helicopter_is_flown_and_one_odd_packet_does_not_refuse_a_quadrotor(tmp_path):
    with sitl("ardupilot") as autopilot:
        link = MessageFilter(autopilot)
        link.change("HEARTBEAT", type=HELICOPTER)
        assert connected(autopilot, tmp_path) == (1, "ArduPilot")
        odd = iter([FIXED_WING])

        def once(message):
            message.type = next(odd, QUADROTOR)
            return [message]

        link.on("HEARTBEAT", once)
        assert connected(autopilot, tmp_path) == (1, "ArduPilot")


def test_several_vehicles_are_listed_and_one_is_named(tmp_path):
    with sitl("px4") as autopilot:
        port = autopilot.url.rpartition(":")[2]
        second = Setup(
            dialect="ardupilot", links=(f"udpout:127.0.0.1:{port}",), speed=SPEED, system=7
        )
        with serving(second):
            both = r"several .*: system 1 \(px4 multicopter\), system 7 \(ardupilot multicopter\)"
            with pytest.raises(VehicleError, match=both + ".*--system 1"):
                connected(autopilot, tmp_path)
            assert connected(autopilot, tmp_path, system=7) == (7, "ArduPilot")
            assert connected(autopilot, tmp_path, system=1) == (1, "PX4")
            with pytest.raises(VehicleError, match=r"no autopilot with system id 9 .*system 1"):
                connected(autopilot, tmp_path, system=9, patience=1.0)


def test_a_system_is_named_for_a_vehicle_only(tmp_path):
    done = CliRunner().invoke(app, ["run", "stay.yaml", "--system", "3"])
    assert (done.exit_code, "--system needs --vehicle" in done.stderr) == (2, True)


@pytest.mark.parametrize("command", ["preflight", "run"])
def test_two_vehicles_with_one_id_are_refused_by_every_command(command, tmp_path, monkeypatch):
    """Their clocks started together: only that both answer a question tells them apart."""
    mission = tmp_path / "stay.yaml"
    mission.write_text(FENCED)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))

    def twice(message):
        other = copy.copy(message)
        other.tc1 += 7_000
        return [message, other]

    with sitl() as autopilot:
        MessageFilter(autopilot).on("TIMESYNC", twice)
        words = {
            "preflight": ["preflight", autopilot.url],
            "run": ["run", str(mission), "--vehicle", autopilot.url, "--headless"],
        }[command]
        done = CliRunner().invoke(app, [*words, *(["--out", str(tmp_path)] * (command == "run"))])
        assert not autopilot.truth["armed"]
    assert done.exit_code == 1, done.output
    assert "two vehicles use the same system id" in done.output
