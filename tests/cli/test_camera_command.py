"""`missionkit camera check` says what a source shows, or why it shows nothing."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import typer.testing

from missionkit.cli.camera import camera

PHOTO = Path(__file__).resolve().parents[2].parent / "shared/data/aruco/single_markers.jpg"


def call(*words):
    return typer.testing.CliRunner().invoke(camera, [str(it) for it in words])


@pytest.mark.skipif(not PHOTO.exists(), reason="the photograph is not there")
def test_markers_of_a_photograph_are_seen_and_drawn(tmp_path):
    out = tmp_path / "seen.png"
    done = call("check", PHOTO, "--out", out)
    assert done.exit_code == 0, done.output
    assert "23, 40, 62, 98, 124, 203" in done.output
    assert (cv2.imread(str(out)) != cv2.imread(str(PHOTO))).any()


def test_a_file_that_is_no_image_is_refused(tmp_path):
    (tmp_path / "text.jpg").write_text("no image")
    done = call("check", tmp_path / "text.jpg")
    assert done.exit_code != 0
    assert "no image comes from it" in done.output


def test_a_device_that_is_not_there_is_refused():
    done = call("check", "97")
    assert done.exit_code != 0
    assert "no image comes from it" in done.output


def test_a_calibration_without_views_says_how_many_are_needed(tmp_path):
    blank = tmp_path / "blank.png"
    cv2.imwrite(str(blank), np.full((480, 640), 255, np.uint8))
    done = call("calibrate", blank)
    assert done.exit_code != 0
    assert "seen in 0 images; 8 are needed" in done.output
