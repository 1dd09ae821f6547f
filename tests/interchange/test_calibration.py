"""Calibrations of ROS and OpenCV become the same camera."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import yaml

from missionkit.chart.text.foreign_files import ForeignKind, foreign_kind
from missionkit.interchange.bounded_input import ForeignFileError
from missionkit.interchange.calibration import camera_text
from missionkit.interchange.ledger import Ledger
from missionkit.perception.camera_section import Camera

K = np.array([[554.25, 0.0, 320.5], [0.0, 556.75, 240.25], [0.0, 0.0, 1.0]])
D = np.array([-0.28, 0.07, 0.0002, -0.0001, 0.013])
ROS = """image_width: 640
image_height: 480
camera_name: narrow
camera_matrix:
  rows: 3
  cols: 3
  data: [554.25, 0, 320.5, 0, 556.75, 240.25, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.28, 0.07, 0.0002, -0.0001, 0.013]}
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
"""


def read(raw):
    ledger = Ledger("file", "calibration")
    section = yaml.safe_load(camera_text(raw, ledger))["camera"]
    return Camera(**section).model(), ledger


def opencv(path, distortion=D):
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("image_width", 640)
    storage.write("image_height", 480)
    storage.write("camera_matrix", K)
    storage.write("distortion_coefficients", distortion)
    storage.write("avg_reprojection_error", 0.31)
    storage.release()
    return path.read_bytes()


@pytest.mark.parametrize("suffix", ["1.0.yaml", "1.2.yaml", ".xml"])
def test_opencv(tmp_path, suffix):
    raw = opencv(tmp_path / f"camera{suffix}")
    if suffix == "1.0.yaml":  # as OpenCV up to 4 writes
        raw = raw.replace(b"%YAML 1.2", b"%YAML:1.0")
    assert foreign_kind(raw) is ForeignKind.OPENCV
    model, ledger = read(raw)
    np.testing.assert_allclose(model.matrix, K)
    np.testing.assert_allclose(model.distortion, D)
    assert (model.width, model.height) == (640, 480)
    assert ledger.counts() == {"kept": 4, "approximated": 0, "refused": 1}


def test_ros():
    assert foreign_kind(ROS.encode()) is ForeignKind.ROS_CAMERA
    model, ledger = read(ROS.encode())
    np.testing.assert_allclose(model.matrix, K)
    np.testing.assert_allclose(model.distortion, D)
    assert ledger.counts() == {"kept": 5, "approximated": 0, "refused": 2}


@pytest.mark.parametrize(
    ("raw", "says"),
    [
        (ROS.replace("plumb_bob", "equidistant"), "distortion_model 'equidistant'"),
        (ROS.replace("image_width: 640\n", ""), "the size of its images"),
        (ROS.replace("0, 556.75", "0"), "3 x 3"),
        (ROS.replace("554.25, 0,", "554.25, 3,"), "matrix must be"),
        (ROS.replace("640", "4"), "width"),
        (ROS.replace("-0.28", ".nan"), "line 9, column 5.: .nan is not a finite"),
        (ROS.replace("0.013]", "0.013, 0.4, 0, 0]"), "rational"),
        ("%YAML:1.0\n---\nimage_width: [1", "line 3, column 14"),
    ],
)
def test_other_lenses_are_refused(raw, says):
    with pytest.raises(ForeignFileError, match=says):
        read(raw.encode())
