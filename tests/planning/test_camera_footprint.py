"""What a camera sees of the ground."""

from __future__ import annotations

import pytest

from missionkit.perception.camera_section import Camera, Mount
from missionkit.planning.camera_footprint import footprint


def model(**mount):
    return Camera(width=800, height=600, focal=500, mount=Mount(**mount)).model()


def test_straight_down_it_is_the_image_over_the_focal_length():
    seen = footprint(model(tilt_deg=90), 20.0)
    assert seen.across == pytest.approx(20.0 * 800 / 500)
    assert seen.along == pytest.approx(20.0 * 600 / 500)
    assert seen.pixel == pytest.approx(20.0 / 500)
    on_its_side = footprint(model(tilt_deg=90, roll_deg=90), 20.0)
    assert on_its_side.across == pytest.approx(20.0 * 600 / 500)


def test_tilted_the_narrow_end_counts():
    """Rays at the lower edge look down by tilt + atan(300/500): w = h 800/500 / (sin, cos)."""
    seen, straight = footprint(model(tilt_deg=70), 20.0), footprint(model(tilt_deg=90), 20.0)
    # the edge nearer to the vehicle: depth along the axis is less than the height over sin(tilt)
    assert seen.across < straight.across
    assert seen.pixel == pytest.approx(20.0 / 500 / 0.93969, rel=1e-4)


@pytest.mark.parametrize("tilt", [0, 30, -90])
def test_a_horizon_is_no_ground(tilt):
    assert footprint(model(tilt_deg=tilt), 20.0) is None
