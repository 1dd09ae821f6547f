from __future__ import annotations

import json

import pytest
from documents import document, table
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.sitl.command_protocol import HANDLERS
from missionkit.sitl.control_socket import REQUESTS
from missionkit.sitl.flight_modes import MODE_TABLES, FlightTask
from missionkit.sitl.parameter_protocol import TABLES
from missionkit.sitl.stream_scheduler import DEFAULT_RATES, MESSAGE_BUILDERS, MISSING_MESSAGES
from missionkit.sitl.wire_faults import WIRE

PAGE = document("docs/reference/sitl.md")


def rate(dialect: str, number: int) -> str:
    if number in DEFAULT_RATES[dialect]:
        return f"{DEFAULT_RATES[dialect][number]:g}"
    return "—" if number in MISSING_MESSAGES[dialect] else "asked"


def test_messages_are_those_of_the_page() -> None:
    names = sorted((mavlink.mavlink_map[number].msgname, number) for number in MESSAGE_BUILDERS)
    assert table(PAGE, "Messages") == [
        [f"`{name}`", rate("px4", number), rate("ardupilot", number)] for name, number in names
    ]


def test_commands_are_those_of_the_page() -> None:
    documented = {int(row[1]): row[0].strip("`") for row in table(PAGE, "Commands")}
    enum = mavlink.enums["MAV_CMD"]
    assert documented == {number: enum[number].name.removeprefix("MAV_CMD_") for number in HANDLERS}


def test_modes_are_those_of_the_page() -> None:
    rows = {row[2]: row[:2] for row in table(PAGE, "Modes")}
    assert set(rows) == set(FlightTask)
    for column, dialect in enumerate(MODE_TABLES.values()):
        for flight, row in rows.items():
            names = [mode.name for mode in dialect.modes if mode.does == flight]
            assert row[column].replace("—", "").split() == names


@pytest.mark.parametrize(("name", "heading"), [("px4", "Parameters"), ("ardupilot", "ArduPilot's")])
def test_parameters_are_those_of_the_page(name: str, heading: str) -> None:
    assert table(PAGE, heading) == [
        [f"`{key}`", f"{value:.10g}"] for key, value in TABLES[name].items()
    ]


def test_faults_are_those_of_the_page() -> None:
    documented = {row[0].strip("`"): row[2] for row in table(PAGE, "Faults")}
    assert documented == {name: kind.effect for name, kind in WIRE.items()}


def test_requests_are_those_of_the_page() -> None:
    requests = [json.loads(row[0].strip("`")) for row in table(PAGE, "Control socket")]
    assert {next(iter(request)) for request in requests} == {*REQUESTS, "quit"}
