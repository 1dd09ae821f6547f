"""`missionkit camera check` says what a source shows, or why it shows nothing."""

from __future__ import annotations

import re

import cv2
import pytest
from cli.filming import MARKED, Driver, call, film, wall_with
from photographs import PHOTO, drawn

from missionkit.vehicle.camera import image_stream


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """Write a mission that has a device."""
    monkeypatch.chdir(tmp_path)

    def write(source):
        path = tmp_path / "missions" / "desk.yaml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(MARKED % source)
        return path

    return write


@pytest.fixture(params=["drawn", "real"])
def photo(request, tmp_path):
    """A photograph in a file."""
    if request.param == "drawn":
        cv2.imwrite(str(tmp_path / "photo.png"), drawn())
        return tmp_path / "photo.png"
    if not PHOTO.exists():
        pytest.skip(f"the real photograph is not there: {PHOTO}")
    return PHOTO


def test_markers_of_a_photograph_are_seen_and_drawn(photo, tmp_path):
    out = tmp_path / "seen.png"
    done = call("check", photo, "--out", out)
    assert done.exit_code == 0, done.output
    assert "markers in the picture: 23, 40, 62, 98, 124, 203" in done.output
    assert (cv2.imread(str(out)) != cv2.imread(str(photo))).any()


def test_the_markers_of_a_mission_are_listed_with_their_distances(photo, desk, tmp_path):
    done = call("check", photo, "--mission", desk(0))
    assert done.exit_code == 0, done.output
    # 35 px of 0.1 m at a focal length of 628 px, seen from aslant
    away = re.search(r"marker 23 of desk \(DICT_6X6_250, 0.1 m\): in 1 of 1, (\S+) m", done.output)
    assert 1.5 < float(away[1]) < 1.9
    assert "marker 7 of desk (DICT_6X6_250, 0.1 m): not seen" in done.output
    assert "other markers in the picture: 40, 62, 98, 124, 203" in done.output
    assert (tmp_path / "camera.png").exists()


def test_the_film_of_a_mission_lies_beside_it_and_says_the_distance(desk):
    path = desk("film.avi")
    film(path.parent / "film.avi", [wall_with(23), wall_with(23, 102), wall_with(3)])
    done = call("check", "--mission", path)
    assert done.exit_code == 0, done.output
    assert done.output.startswith("3 images of 640x480\n")
    away = re.search(r"in 2 of 3, (\S+) m away ± (\S+), corners fit to (\S+) px", done.output)
    assert float(away[1]) == pytest.approx(0.1 * 628 / 101, abs=0.01)
    assert 0.003 < float(away[2]) < 0.012
    assert float(away[3]) < 0.5
    assert "other markers" not in done.output  # the picture is the last that shows one of its own


def test_unseen_markers_set_the_exit_code(desk):
    path = desk("film.avi")
    film(path.parent / "film.avi", [wall_with(3)])
    done = call("check", "--mission", path)
    assert done.exit_code == 1
    assert "marker 23 of desk (DICT_6X6_250, 0.1 m): not seen" in done.output
    assert "other markers in the picture: 3" in done.output


def test_a_marker_too_small_to_count_is_reported(desk):
    path = desk("film.avi")
    path.write_text(path.read_text().replace("id: 23,", "id: 23, min_area: 20000,"))
    film(path.parent / "film.avi", [wall_with(23)])
    assert "area outside 20000 to 250000 px²" in call("check", "--mission", path).output


def test_a_marker_upside_down_is_reported(desk):
    path = desk("film.avi")
    film(path.parent / "film.avi", [wall_with(23)[::-1, ::-1].copy()])
    done = call("check", "--mission", path)
    assert "upside down in the image: is the camera mounted upside down?" in done.output
    film(path.parent / "film.avi", [wall_with(23)])
    assert "upside down" not in call("check", "--mission", path).output


def test_images_of_another_size_are_refused(desk):
    path = desk("film.avi")
    film(path.parent / "film.avi", [wall_with(23, size=(320, 240))])
    done = call("check", "--mission", path)
    assert done.exit_code == 2
    assert "its images are 320 x 240, not 640 x 480, which the mission is calibrated" in done.output


@pytest.mark.parametrize(
    ("stamps", "expected"),
    [
        (True, r"\n30 ms old on arrival, by the driver's timestamps; latency of the mission: 50"),
        (False, r"\nthe driver does not report their age; latency of the mission: 50 ms\n"),
    ],
)
def test_the_age_of_the_images_is_reported_if_the_driver_stamps_them(
    stamps, expected, desk, monkeypatch
):
    driver = Driver(wall_with(23), stamps)
    monkeypatch.setattr(image_stream, "opened", {2: driver}.get)
    monkeypatch.setattr(image_stream, "wall", lambda: driver.now)
    done = call("check", "--mission", desk(2), "--images", 3)
    assert done.exit_code == 0, done.output
    assert re.search(expected, done.output)
    assert re.search(r"^3 images of 640x480, 25.0 a second; mission: 25\n", done.output)
    assert (cv2.CAP_PROP_FRAME_WIDTH, 640) in driver.asked
    assert (cv2.CAP_PROP_FPS, 25.0) in driver.asked


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["text.jpg"], "text.jpg: no image comes from it: is it an image, a video or a stream?"),
        (["97"], "97: no image comes from it: is it plugged in, and does no other program use it?"),
        (["http://127.0.0.1:1/x"], "http://127.0.0.1:1/x: no image comes from it: does it stream"),
        (["phot.jpg"], "camera phot.jpg: no such file in .; did you mean 'photo.jpg'?"),
        ([], "name a SOURCE: device number, file or URL; or a --mission with a device"),
        (
            ["--mission", "blind.yaml"],
            "the camera of mission 'desk' is not a device: give a SOURCE",
        ),
        (["photo.jpg", "--dictionary", "DICT_6X6"], "there is no marker dictionary 'DICT_6X6'"),
        (["photo.jpg", "--out", "no/a.png"], "no/a.png: could not write the picture"),
        (["photo.jpg", "--out", "a.txt"], "a.txt: could not write the picture"),
    ],
)
def test_impossible_checks_are_reported_in_a_line(words, reason, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "text.jpg").write_text("no image")
    (tmp_path / "blind.yaml").write_text(MARKED.replace("use: device, source: %s, ", ""))
    cv2.imwrite("photo.jpg", wall_with(3))
    done = call("check", *words)
    assert done.exit_code == 2
    assert done.output.startswith(reason)
    assert done.output.count("\n") == 1
