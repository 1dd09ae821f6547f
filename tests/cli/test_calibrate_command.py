"""`missionkit camera calibrate` finds a lens, and `board` draws what it needs."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from boards import LENS, MATRIX, astray, photographs
from cli.filming import MARKED, Driver, call, film, wall_with
from documents import document

from missionkit.perception.camera_section import Camera
from missionkit.vehicle.camera import image_stream

VIEWS = [f"views/{n:02}.png" for n in range(24)]
NUMBER = r"-?\d+(\.\d+)?(e-\d+)?"


def section(done):
    """Return the camera that was printed, as a mission would have it."""
    assert done.exit_code == 0, done.output
    return Camera(**yaml.safe_load(done.stdout)["camera"])


def test_a_lens_is_found_from_image_files(tmp_path):
    for n, it in enumerate(photographs(24)):
        cv2.imwrite(str(tmp_path / f"view{n:02}.png"), it)
    done = call("calibrate", *sorted(tmp_path.glob("view*.png")))
    found = section(done)
    assert done.stderr == ""
    assert (found.width, found.height) == (640, 480)
    np.testing.assert_allclose(found.matrix, MATRIX, atol=1.0)
    np.testing.assert_allclose(found.distortion, LENS, atol=0.01)
    assert astray(found.matrix, found.distortion).max() < 1.2
    assert re.search(r"^# reprojection error 0.0\d+ px over 24 views\n", done.stdout)
    assert re.search(r"^# they cover [89]\d% of the image, the board tilted", done.stdout, re.M)
    assert re.search(r"^# standard deviations: fx 0.\d+, .*, k1 0.00\d+, ", done.stdout, re.M)
    assert "cannot distinguish k3 from 0" in done.stdout


def test_a_lens_is_calibrated_from_a_film_and_doubts_are_reported(tmp_path):
    film(tmp_path / "film.avi", photographs(16, reach=0.7, tilt=0.25))
    done = call("calibrate", tmp_path / "film.avi")
    found = section(done)
    assert np.median(astray(found.matrix, found.distortion)) < 4.0
    assert re.search(r"warning: the board covers \d\d% of the image", done.stderr)


def test_a_calibration_without_views_says_how_many_are_needed(tmp_path):
    blank = tmp_path / "blank.png"
    cv2.imwrite(str(blank), np.full((480, 640), 255, np.uint8))
    done = call("calibrate", blank)
    assert done.exit_code == 2
    assert "seen in 0 images; 8 are needed" in done.output


def test_an_invalid_size_is_refused(tmp_path):
    done = call("calibrate", "0", "--size", "big")
    assert done.exit_code == 2
    assert "--size big: expected WIDTHxHEIGHT" in done.output


def test_the_size_is_requested_from_the_device(monkeypatch):
    driver = Driver(wall_with(23))
    monkeypatch.setattr(image_stream, "opened", {0: driver}.get)
    call("calibrate", "0", "--size", "1280x720", "--images", 1)
    assert (cv2.CAP_PROP_FRAME_HEIGHT, 720) in driver.asked


def test_the_board_is_drawn_and_is_what_a_calibration_looks_for(tmp_path):
    out = tmp_path / "board.png"
    done = call("board", "--out", out)
    assert done.exit_code == 0, done.output
    assert f"wrote {out}: 280 x 200 mm" in done.output
    assert "seen in 1 images; 8 are needed" in call("calibrate", out).output


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--out", "board.pdf"], "board.pdf: expected a file that ends in .png"),
        (["--square", "40", "--marker", "30"], "a board of more than 3 m is not drawn"),
        (["--columns", "20", "--rows", "20"], "20x20 squares need 200 markers; DICT_4X4_50 has 50"),
    ],
)
def test_a_board_that_cannot_be_drawn_is_refused(words, reason, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = call("board", *words)
    assert done.exit_code == 2
    assert done.output.startswith(reason)
    assert list(tmp_path.iterdir()) == []


def test_the_how_to_is_what_the_commands_do(tmp_path, monkeypatch):
    page = document("docs/how-to/calibrate-a-camera.md")
    monkeypatch.chdir(tmp_path)
    Path("views").mkdir()
    for n, it in enumerate(photographs(24)):
        cv2.imwrite(f"views/{n:02}.png", it)
    Path("mission.yaml").write_text(MARKED % 0)
    monkeypatch.setattr(image_stream, "opened", {0: Driver(wall_with(23))}.get)
    printed = {}
    for line in re.findall(r"^missionkit camera (.*)$", page, re.M):
        name, *words = shlex.split(line.replace("views/*.png", " ".join(sorted(VIEWS))))
        done = call(name, *words)
        assert done.exit_code == 0, done.output
        printed[line] = done.stdout
    found = printed["calibrate views/*.png"]
    assert found.splitlines()[4:7] == ["camera:", "  width: 640", "  height: 480"]
    (shown,) = re.findall(r"^```\n(# repro.*?)```", page, re.M | re.S)
    assert re.sub(NUMBER, "N", shown) == re.sub(NUMBER, "N", found)
    assert "30 images of 640x480" in printed["check --mission mission.yaml --out seen.png"]
