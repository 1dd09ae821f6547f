"""`preflight --set`: safe parameters, written after asking, and read back."""

import io

import pytest
from vehicle.flying import sitl

from missionkit.cli import preflight_command as command
from missionkit.cli.preflight_command import PreflightOptions, preflight
from missionkit.errors import ExitCode, UsageError
from missionkit.sitl.parameter_protocol import TABLES
from missionkit.vehicle.autopilot_dialect import ARDUPILOT, PX4
from missionkit.vehicle.failsafe_parameters import FailsafeLevel
from missionkit.vehicle.preflight.parameter_setting import Written, proposed, write


class Keeper:
    """An autopilot's parameters; one that refuses changes keeps what it has."""

    def __init__(self, refuses=False, **values):
        self.values, self.refuses = values, refuses

    def set_parameter(self, name, value):
        if not self.refuses:
            self.values[name] = value
        return not self.refuses

    def parameter(self, name):
        return self.values.get(name)


def test_a_real_ardupilots_time_out_comes_first():
    found = {"GUID_TIMEOUT": 3.0, "FS_EKF_ACTION": 0.0, "FENCE_ENABLE": 0.0}
    changes = proposed(ARDUPILOT, found)
    assert [(it.parameter, it.to) for it in changes] == [
        ("GUID_TIMEOUT", 1.0),
        ("FS_EKF_ACTION", 1),
    ]
    assert changes[0].question.startswith("GUID_TIMEOUT is 3: it flies on for that long (s)")


@pytest.mark.parametrize("dialect", [PX4, ARDUPILOT])
def test_what_is_written_is_judged_safe_and_exists(dialect):
    for failsafe in dialect.failsafes:
        if failsafe.safe is not None:
            assert failsafe.judge(failsafe.safe)[0] is FailsafeLevel.GOOD
    table = TABLES[dialect.name.lower()]
    names = {name for it in dialect.thresholds for name in it.parameters}
    assert {*names, *(it.parameter for it in dialect.failsafes)} <= table.keys()
    defaults = {change.parameter for change in proposed(dialect, table)}
    assert ("GUID_TIMEOUT" in defaults) == (dialect is ARDUPILOT)


def test_what_was_not_read_or_is_safe_already_is_left_alone():
    assert proposed(PX4, {"COM_OF_LOSS_T": None, "COM_OBL_RC_ACT": 5.0}) == ()


def test_what_is_read_back_counts():
    (change,) = proposed(ARDUPILOT, {"GUID_TIMEOUT": 3.0})
    assert write(Keeper(), change).says == "GUID_TIMEOUT was 3, is 1"
    refused = write(Keeper(refuses=True, GUID_TIMEOUT=3.0), change)
    assert not refused.good
    assert refused.says == "GUID_TIMEOUT was 3, is still 3: check it by hand"
    assert "could not be read back" in Written(change, None).says


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_it_asks_and_writes_over_the_wire(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setattr(command.sys, "stdin", Terminal("y\n\n\n"))
    with sitl("ardupilot") as autopilot:
        preflight(PreflightOptions(autopilot.url, write=True))
        printed = capsys.readouterr().out
        values = {
            name: autopilot.ask(parameter=name)["value"]
            for name in ("GUID_TIMEOUT", "BATT_FS_LOW_ACT", "BATT_FS_CRT_ACT")
        }
    assert values == {"GUID_TIMEOUT": 1.0, "BATT_FS_LOW_ACT": 0, "BATT_FS_CRT_ACT": 0}
    assert "GUID_TIMEOUT is 3: it flies on" in printed
    assert "GUID_TIMEOUT was 3, is 1" in printed
    assert "BATT_FS_LOW_ACT stays 0" in printed


def test_integers_of_px4_are_written_too(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    with sitl("px4") as autopilot:
        autopilot.ask(parameter="COM_OBL_RC_ACT", value=7)
        preflight(PreflightOptions(autopilot.url, write=True, yes=True))
        assert autopilot.ask(parameter="COM_OBL_RC_ACT")["value"] == 5
        assert autopilot.ask(parameter="COM_OF_LOSS_T")["value"] == 1.0
        code = preflight(PreflightOptions(autopilot.url))
    printed = capsys.readouterr().out
    assert "COM_OBL_RC_ACT was 7, is 5" in printed
    assert code is ExitCode.SUCCESS


@pytest.mark.parametrize(
    ("wanted", "says"),
    [
        (PreflightOptions("udpin://127.0.0.1:14801", write=True), "add --yes"),
        (PreflightOptions("udpin://127.0.0.1:14801", as_json=True, write=True), "leave out --json"),
    ],
)
def test_it_writes_nothing_without_a_terminal(wanted, says, monkeypatch):
    monkeypatch.setattr(command.sys, "stdin", io.StringIO(""))
    with pytest.raises(UsageError, match=says):
        preflight(wanted)
