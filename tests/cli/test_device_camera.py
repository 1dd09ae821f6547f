"""A real camera that the mission file names: rehearsed by drawing, opened with a vehicle."""

import json

import pytest
from cli.conftest import HOP
from documents import ROOT, document
from samples import calm

from missionkit.api import vehicle_camera, vehicle_flight
from missionkit.api.vehicle_outcome import with_remarks
from missionkit.chart.load import load, parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import FileError, UsageError
from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.messages import Command, Mode, Observation, Record
from missionkit.perception.camera_section import Camera
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.world import World
from missionkit.vehicle.camera.frame_source import Rendered
from missionkit.vehicle.telemetry.reported_pose import Pose

ADDRESS = "udpin://127.0.0.1:14540"
DEVICE = HOP.replace("use: none", "use: device, source: 2")
EMPTY = World(world="empty")
STILL = vec(0.0, 0.0, 0.0)
POSE = Pose(1.0, Transform(IDENTITY, vec(0.0, 0.0, -2.0)), STILL, STILL)


def named(source):
    return DEVICE.replace("source: 2", f"source: {source}")


@pytest.fixture
def opening(monkeypatch, tmp_path):
    """Say which source the vehicle's camera would open, or return the camera that is drawn."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(vehicle_camera, "opened", lambda source: source)
    monkeypatch.setattr(vehicle_camera, "Device", lambda open_, *_: open_())
    monkeypatch.setattr(vehicle_flight, "MavsdkVehicle", lambda _, camera, *__, **___: camera)
    return lambda text, source=None, folder=tmp_path: vehicle_flight.vehicle_of(
        ADDRESS, parse(text, "hop", builtin()), EMPTY, source=source, folder=folder
    )


@pytest.mark.parametrize(
    ("camera", "reason"),
    [
        ("use: device", "a device needs its source: a number, a file or a URL"),
        ("use: none, source: 0", "source belongs to use: device"),
        ("source: 0", "source belongs to use: device"),
        ("use: device, source: -1", "must be at least 0"),
        ("use: device, source: 10000", "must be at least 0 and below 10000"),
        ("use: device, source: ''", "source"),
    ],
)
def test_a_device_and_its_source_belong_together(camera, reason):
    with pytest.raises(FileError, match=reason):
        parse(HOP.replace("use: none", camera), "hop", builtin())


@pytest.mark.parametrize("source", [0, "rtsp://10.0.0.2/stream", "/dev/video7"])
def test_the_vehicle_opens_the_source_of_the_mission(source, opening):
    assert Camera(use="device", source=source).source == source
    assert opening(named(source)) == source


def test_digits_in_quotes_are_the_number_of_a_device(opening):
    assert opening(named("'3'")) == 3
    assert opening(HOP, "3") == 3


@pytest.mark.parametrize("text", [DEVICE, HOP])
def test_the_command_line_names_another(text, opening, tmp_path):
    (tmp_path / "other.mp4").touch()
    assert opening(text, 0) == 0
    assert opening(text, "other.mp4", folder=tmp_path / "elsewhere") == "other.mp4"


def test_the_video_path_is_relative_to_the_mission(opening, tmp_path):
    beside = tmp_path / "missions"
    beside.mkdir()
    (beside / "film.mp4").touch()
    assert opening(named("film.mp4"), folder=beside) == str(beside / "film.mp4")
    with pytest.raises(FileError, match=r"hop:4:9: camera source 'film.mp4': no such file in "):
        opening(named("film.mp4"), folder=tmp_path)


def test_a_missing_film_is_reported_with_the_nearest_name(opening, tmp_path):
    (tmp_path / "flight-3.mp4").touch()
    with pytest.raises(FileError, match=r"did you mean 'flight-3.mp4'\?"):
        opening(named("flight_3.mp4"))
    with pytest.raises(UsageError, match=r"camera fligt-3.mp4: .* did you mean 'flight-3.mp4'\?"):
        opening(HOP, "fligt-3.mp4")


def test_a_missing_film_is_reported_before_a_folder_is_made(call, hop):
    hop.write_text(named("film.mp4"))
    result = call("run", "hop.yaml", "--vehicle", ADDRESS, "--headless")
    assert result.exit_code == 2
    assert result.stderr.startswith("hop.yaml:4:9: camera source 'film.mp4': no such file")
    assert not (hop.parent / "runs").exists()


def test_a_camera_that_is_not_there_does_not_make_the_mission_wrong(call, hop):
    hop.write_text(named("film.mp4"))
    assert call("validate", "hop.yaml").exit_code == 0


def test_the_option_draws_instead_of_opening(opening):
    for text in (DEVICE, HOP):
        camera = opening(text, "rendered")
        assert isinstance(camera, Rendered)


def test_images_drawn_for_a_device_have_its_lens_distortion():
    section = Camera(use="device", source=0, width=320, height=240)
    frame = vehicle_camera.painter_of(section, EMPTY)(POSE, 1.0)
    assert frame.image.shape == (240, 320)


def test_the_option_needs_a_vehicle(call, hop):
    result = call("run", "hop.yaml", "--camera", "0", "--headless")
    assert result.exit_code == 2
    assert "--camera needs --vehicle" in result.stderr


@pytest.mark.parametrize("command", [["run", "--headless"], ["campaign", "--runs", "1"]])
def test_the_mission_of_a_device_is_rehearsed_as_it_is(command, call, hop):
    hop.write_text(DEVICE)
    result = call(command[0], "hop.yaml", *command[1:])
    assert result.exit_code == 0, result.stderr
    (summary,) = hop.parent.glob("runs/*/summary.json")
    assert "hop" in json.loads(summary.read_text())["mission"]


LENS = {"distortion": (-0.2, 0.05, 0.001, -0.001, 0.0), "latency": 0.1, "rate": 10.0}


def frames(**camera):
    """Return the images of the first second of the precision task, with when they came."""
    mission = load(ROOT / "missions" / "precision_task.yaml", builtin())
    changed = mission.model_copy(update={"camera": Camera(**LENS, **camera)})
    ready = stage(changed, builtin(), world_of(mission, ROOT / "missions"), seed=3)
    seen = [ready.vehicle.advance(0.05 * n) for n in range(1, 21)]
    return [(it.now, it.frame.at, it.frame.image.tobytes()) for it in seen if it.frame]


def test_the_simulator_draws_what_the_device_would_see():
    drawn = frames(use="rendered")
    assert len(drawn) == 9
    assert frames(use="device", source=2) == drawn


def test_a_device_sees(call, hop):
    blind = document("tests/checks/21-no-camera.yaml")
    hop.write_text(blind)
    assert "[no-camera]" in call("validate", "hop.yaml").stderr
    hop.write_text(blind.replace("use: none", "use: device, source: 0"))
    assert "[no-camera]" not in call("validate", "hop.yaml").stderr


def test_errors_of_the_camera_are_problems_of_the_flight():
    class Vehicle:
        camera_problem = ""

        def take_remarks(self):
            return ()

    reported, vehicle = [], Vehicle()
    tell = with_remarks((lambda record, _: reported.append(record.problems),), vehicle)
    record = Record(1.0, "idle", ("idle",), Mode.NONE, (), (), Command(), "", ("late",), calm())
    for vehicle.camera_problem in ("", "it cannot be opened", ""):
        tell(record, Observation(1.0))
    assert reported == [("late",), ("late", "camera: it cannot be opened"), ("late",)]
