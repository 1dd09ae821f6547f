"""A real camera that the mission file names."""

import pytest
from cli.conftest import HOP
from documents import document

from missionkit.chart.catalogue import builtin
from missionkit.chart.load import parse
from missionkit.cli import fly
from missionkit.errors import FileError
from missionkit.perception.camera import Camera

ADDRESS = "udpin://127.0.0.1:14540"
DEVICE = HOP.replace("use: none", "use: device, source: 2")


@pytest.fixture
def opening(monkeypatch):
    """Say which source the vehicle's camera would open, None: it has no real one."""
    monkeypatch.setattr(fly, "opened", lambda source: source)
    monkeypatch.setattr(fly, "Device", lambda open_, *_: open_())
    monkeypatch.setattr(fly, "MavsdkVehicle", lambda _, camera, *__, **___: camera)
    return lambda text, source: fly.vehicle_of(
        ADDRESS, parse(text, "hop", builtin()), source=source
    )


@pytest.mark.parametrize(
    ("camera", "reason"),
    [
        ("use: device", "a device needs its source: a number, a file or a URL"),
        ("use: none, source: 0", "source belongs to use: device"),
        ("source: 0", "source belongs to use: device"),
        ("use: device, source: -1", "must be at least 0"),
        ("use: device, source: ''", "source"),
    ],
)
def test_a_device_and_its_source_belong_together(camera, reason):
    with pytest.raises(FileError, match=reason):
        parse(HOP.replace("use: none", camera), "hop", builtin())


@pytest.mark.parametrize("source", [0, "film.mp4", "rtsp://10.0.0.2/stream"])
def test_the_vehicle_opens_the_source_of_the_mission(source, opening):
    assert Camera(use="device", source=source).source == source
    assert opening(DEVICE.replace("source: 2", f"source: {source}"), None) == source


@pytest.mark.parametrize("text", [DEVICE, HOP])
def test_the_command_line_names_another(text, opening):
    assert opening(text, 0) == 0
    assert opening(text, "other.mp4") == "other.mp4"


@pytest.mark.parametrize("command", [["run", "--headless"], ["campaign", "--runs", "1"]])
def test_the_simulator_refuses_it_before_it_makes_a_folder(command, call, hop):
    hop.write_text(DEVICE)
    result = call(command[0], "hop.yaml", *command[1:])
    assert result.exit_code == 2
    assert "the simulator has no device: fly with --vehicle" in result.stderr
    assert not (hop.parent / "runs").exists()


def test_a_parameter_lets_the_simulator_have_its_own(call, hop):
    text = DEVICE.replace("params: {", "params: {camera: {use: device, source: 2}, ")
    hop.write_text(text.replace("camera: {use: device, source: 2}\n", "camera: $camera\n"))
    assert call("run", "hop.yaml", "--headless").exit_code == 2
    assert call("run", "hop.yaml", "--headless", "--set", "camera={use: none}").exit_code == 0


def test_a_device_sees(call, hop):
    blind = document("tests/checks/21-no-camera.yaml")
    hop.write_text(blind)
    assert "[no-camera]" in call("validate", "hop.yaml").stderr
    hop.write_text(blind.replace("use: none", "use: device, source: 0"))
    assert "[no-camera]" not in call("validate", "hop.yaml").stderr
