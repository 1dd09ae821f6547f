from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.sitl.parameter_protocol import TABLES

Make = Callable[..., Any]


def ask(station: Any, name: str) -> Any:
    station.send(mavlink.MAVLink_param_request_read_message(1, 1, name.encode(), -1))
    return station.last("PARAM_VALUE")


def test_the_list_is_complete_and_numbered(either: Any) -> None:
    either.send(mavlink.MAVLink_param_request_list_message(1, 1))
    either.run(0.2)
    got = either.all("PARAM_VALUE")
    names = TABLES[either.state.dialect.name]
    assert [value.param_index for value in got] == list(range(len(names)))
    assert {value.param_count for value in got} == {len(names)}
    assert {value.param_id for value in got} == set(names)


def test_px4_keeps_the_bytes_of_integers(station: Make) -> None:
    px4 = station("px4")
    raw = struct.unpack("<f", struct.pack("<i", 5))[0]
    px4.send(mavlink.MAVLink_param_set_message(1, 1, b"COM_OBL_RC_ACT", raw, 6))
    assert px4.state.parameters["COM_OBL_RC_ACT"] == 5
    answer = ask(px4, "COM_OBL_RC_ACT")
    assert (answer.param_type, struct.pack("<f", answer.param_value)) == (6, struct.pack("<i", 5))


def test_px4_keeps_negative_integers(station: Make) -> None:
    px4 = station("px4")
    raw = struct.unpack("<f", struct.pack("<i", -1))[0]
    px4.send(mavlink.MAVLink_param_set_message(1, 1, b"COM_OBL_RC_ACT", raw, 6))
    assert px4.state.parameters["COM_OBL_RC_ACT"] == -1


def test_ardupilot_sends_integers_as_numbers(station: Make) -> None:
    copter = station("ardupilot")
    copter.send(mavlink.MAVLink_param_set_message(1, 1, b"FS_GCS_ENABLE", 5.0, 9))
    assert copter.state.parameters["FS_GCS_ENABLE"] == 5
    answer = ask(copter, "FS_GCS_ENABLE")
    assert (answer.param_type, answer.param_value) == (4, 5.0)


def test_reals_are_kept(either: Any) -> None:
    name = "COM_OF_LOSS_T" if either.px4 else "GUID_TIMEOUT"
    either.send(mavlink.MAVLink_param_set_message(1, 1, name.encode(), 0.5, 9))
    assert either.last("PARAM_VALUE").param_value == 0.5
    assert ask(either, name).param_value == 0.5


def test_parameters_that_do_not_exist_are_not_answered(either: Any) -> None:
    either.send(mavlink.MAVLink_param_request_read_message(1, 1, b"NO_SUCH", -1))
    either.send(mavlink.MAVLink_param_set_message(1, 1, b"NO_SUCH", 1.0, 9))
    either.run(0.1)
    assert not either.all("PARAM_VALUE")


@pytest.mark.parametrize("index", [0, 7])
def test_parameters_are_read_by_index_too(either: Any, index: int) -> None:
    either.send(mavlink.MAVLink_param_request_read_message(1, 1, b"", index))
    assert either.last("PARAM_VALUE").param_index == index
