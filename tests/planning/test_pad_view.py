"""From where a pad is sure to be in view: closed forms, and the promise itself."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.geometry import conjugate, rotate
from missionkit.perception.camera_section import Camera
from missionkit.planning.pad_view import ViewCone, cone_below, deviation_height, entry_radius

CONE = ViewCone(math.radians(25.0), sigmas=2.0, descent=1.5, acceleration=2.5, least=0.6)


def test_each_of_the_three_reasons_has_its_closed_form():
    assert deviation_height(CONE, 0.0) == 0.6
    slow = CONE._replace(descent=0.1)
    assert deviation_height(slow, 0.5) == pytest.approx(1.0 / math.tan(math.radians(25.0)))
    fast = CONE._replace(descent=3.0)
    assert deviation_height(fast, 0.2) == pytest.approx(3.0 * (0.3 + 2.0 * math.sqrt(0.4 / 2.5)))


@pytest.mark.parametrize("sd", [0.01, 0.1, 0.3, 1.0])
def test_at_the_cones_edge_a_pad_that_is_k_sigma_off_is_in_view(sd):
    height = deviation_height(CONE, sd)
    radius = entry_radius(CONE, sd, height)
    assert radius + CONE.sigmas * sd <= height * math.tan(CONE.half_angle) + 1e-12
    assert radius >= 0.0


def test_the_worse_the_estimate_the_earlier_it_deviates():
    heights = [deviation_height(CONE, 0.05 * n) for n in range(20)]
    assert heights == sorted(heights)
    assert heights[-1] > 3.0 * heights[0]


def pixels(camera, half_angle):
    """Pixels of the rays that make this angle with the vertical below a level vehicle."""
    turn = np.linspace(0.0, 2.0 * math.pi, 360)
    out = math.sin(half_angle)
    rays = np.array([out * np.cos(turn), out * np.sin(turn), 0 * turn + math.cos(half_angle)]).T
    local = np.array([rotate(conjugate(camera.mount.rotation), ray) for ray in rays])
    at = (camera.matrix @ local.T).T
    return at[:, :2] / at[:, 2:]


@pytest.mark.parametrize("tilt", [60.0, 68.0, 90.0])
def test_the_cone_below_just_fits_into_the_image(tilt):
    camera = Camera.model_validate({"focal": 300.0, "mount": {"tilt_deg": tilt}}).model()
    most = cone_below(camera)
    inside, outside = pixels(camera, most - 0.001), pixels(camera, most + 0.001)
    size = np.array((camera.width, camera.height)) - 0.5
    assert ((inside > -0.5) & (inside < size)).all()
    assert not ((outside > -0.5) & (outside < size)).all()


def test_a_camera_that_looks_ahead_sees_no_cone_below():
    assert cone_below(Camera().model()) < 0.0
