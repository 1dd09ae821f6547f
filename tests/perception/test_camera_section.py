from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from pydantic import ValidationError

from missionkit.geometry import vec
from missionkit.perception.camera_section import Camera, Mount

AHEAD, RIGHT, DOWN = vec(1, 0, 0), vec(0, 1, 0), vec(0, 0, 1)


def test_a_level_camera_sees_forward_along_z_right_along_x_down_along_y():
    mount = Camera(mount=Mount(position=(0, 0, 0))).model().mount
    np.testing.assert_allclose(mount.apply(vec(0, 0, 1)), AHEAD, atol=1e-15)
    np.testing.assert_allclose(mount.apply(vec(1, 0, 0)), RIGHT, atol=1e-15)
    np.testing.assert_allclose(mount.apply(vec(0, 1, 0)), DOWN, atol=1e-15)


def test_tilt_turns_the_view_downwards_and_the_mount_shifts_it():
    mount = Mount(position=(0.1, 0.0, 0.2), tilt_deg=90).transform()
    np.testing.assert_allclose(mount.apply(vec(0, 0, 1)), vec(0.1, 0.0, 1.2), atol=1e-15)
    half = Mount(position=(0, 0, 0), tilt_deg=30).transform().apply(vec(0, 0, 1))
    np.testing.assert_allclose(half, vec(np.sqrt(0.75), 0.0, 0.5), atol=1e-15)


def test_focal_length_pair_and_calibration_matrix_give_the_same_lens():
    K = [[628.158, 0, 324.099], [0, 628.156, 260.908], [0, 0, 1]]
    matrix = Camera(matrix=K, distortion=(0.0995, -0.206, 0.00754, 0.00336, 0)).model()
    pair = Camera(focal_x=628.158, focal_y=628.156, centre=(324.099, 260.908)).model()
    np.testing.assert_array_equal(matrix.matrix, pair.matrix)
    assert matrix.distortion.shape == (5,)


def test_the_centre_is_the_middle_of_the_pixel_grid():
    model = Camera(width=640, height=480, focal=554, rate=25).model()
    np.testing.assert_array_equal(model.matrix, [[554, 0, 319.5], [0, 554, 239.5], [0, 0, 1]])
    assert model.period == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ({"focal_x": 500}, "belong together"),
        ({"focal": 500, "focal_x": 500, "focal_y": 500}, "either focal"),
        ({"focal": 500, "matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}, "already holds"),
        ({"matrix": [[1, 2, 0], [0, 1, 0], [0, 0, 1]]}, "must be"),
        ({"matrix": [[0, 0, 0], [0, 1, 0], [0, 0, 1]]}, "must be"),
        ({"focal": -1}, "greater than or equal to 1"),
        ({"width": 100_000_000}, "less than or equal to 8192"),
        ({"rate": 1e9}, "less than or equal to 200"),
        ({"use": "vhs"}, "rendered"),
        ({"frames": 20}, "not permitted"),
    ],
)
def test_a_lens_that_makes_no_sense_is_refused(section, said):
    with pytest.raises(ValidationError, match=said):
        Camera.model_validate(section)


def test_the_sections_of_the_mission_file_load_without_opencv():
    light = "camera_section aruco apriltag blob haar.detector template.detector"
    code = "import sys; " + "".join(f"import missionkit.perception.{m}; " for m in light.split())
    code += "sys.exit('cv2' in sys.modules or 'scipy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_pan_turns_to_the_right_before_the_tilt_and_roll_about_the_optical_axis():
    pan = Mount(position=(0, 0, 0), pan_deg=90).transform()
    np.testing.assert_allclose(pan.apply(vec(0, 0, 1)), RIGHT, atol=1e-15)
    both = Mount(position=(0, 0, 0), pan_deg=90, tilt_deg=30).transform()
    np.testing.assert_allclose(both.apply(vec(0, 0, 1)), vec(0.0, np.sqrt(0.75), 0.5), atol=1e-15)
    roll = Mount(position=(0, 0, 0), roll_deg=90).transform()  # its right side now looks down
    np.testing.assert_allclose(roll.apply(vec(0, 0, 1)), AHEAD, atol=1e-15)
    np.testing.assert_allclose(roll.apply(vec(1, 0, 0)), DOWN, atol=1e-15)


def test_p4_s_camera_is_tilted_and_rolled():
    """L_cb of P4 (12) has the optical axis as x: R_x(beta) R_y(alpha) (correction P4.3)."""
    alpha, beta = 0.7, 0.3
    sa, ca, sb, cb = np.sin(alpha), np.cos(alpha), np.sin(beta), np.cos(beta)
    printed = np.array([[ca, 0, -sa], [sb * sa, cb, sb * ca], [cb * sa, -sb, cb * ca]])
    ours = Mount(
        position=(0, 0, 0), tilt_deg=-np.degrees(alpha), roll_deg=np.degrees(beta)
    ).transform()
    axes = np.column_stack([ours.apply(v) for v in (vec(0, 0, 1), vec(1, 0, 0), vec(0, 1, 0))])
    np.testing.assert_allclose(axes.T, printed, atol=1e-15)
