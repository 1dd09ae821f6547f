"""Images that are upside down, and markers that are."""

from __future__ import annotations

import math

import numpy as np
import pytest
from rehearsed import flown, precise_stage
from scenes import CAMERA, LEVEL, corners_of, marker_at, priors, seen_from, with_corners

from missionkit.geometry import Transform, from_euler, multiply
from missionkit.perception.aruco import Aruco
from missionkit.perception.vision_pipeline import VisionPipeline

TRUNK = Aruco(target="trunk", id=23, size=0.4)
SPOT = marker_at(6.0, 0.5, 0.2)


def look(corners, *, marker=TRUNK, body=LEVEL):
    eye = VisionPipeline(CAMERA, [marker])
    memory, _, sightings, _ = eye.look(
        eye.begin(), with_corners(1.0, (23, corners)), priors(body=body)
    )
    return sightings, [it.message for it in memory.warnings]


def turned(corners):
    """Return the corners in the image of a camera that is mounted upside down."""
    return np.array([CAMERA.width - 1.0, CAMERA.height - 1.0]) - corners


def hanging(roll_deg):
    roll = from_euler(0.0, 0.0, math.radians(roll_deg))
    marker = Transform(multiply(SPOT.rotation, roll), SPOT.translation)
    return corners_of(seen_from(LEVEL, marker), 0.4)


def test_an_image_upside_down_shows_no_upright_marker_and_is_reported():
    sightings, (message,) = look(turned(hanging(0.0)))
    assert sightings == ()
    assert message == (
        "marker 23 (DICT_6X6_250) of trunk is upside down in the image and not used: is the "
        "camera mounted upside down? If the marker hangs so, set 'upright: false'"
    )


@pytest.mark.parametrize("roll_deg", [-100.0, -45.0, 0.0, 30.0, 100.0])
def test_a_marker_that_hangs_askew_is_used(roll_deg):
    sightings, messages = look(hanging(roll_deg))
    assert (len(sightings), messages) == (1, [])


def test_a_marker_that_may_hang_in_any_way_is_used():
    loose = TRUNK.model_copy(update={"upright": False})
    assert len(look(turned(hanging(0.0)), marker=loose)[0]) == 1


def test_a_vehicle_that_does_not_know_its_attitude_calls_nothing_upside_down():
    assert len(look(turned(hanging(0.0)), body=None)[0]) == 1


def test_in_flight_it_is_reported_at_the_first_sight():
    """Sightings that pull the target under the ground led the vehicle down and astray."""
    flight = flown(precise_stage("camera_flipped", limit=13.5))
    told = [r for r in flight.records for it in r.problems if "is upside down in the image" in it]
    assert len(told) == 1
    assert told[0].estimate.events == ("marker_upside_down",)
    assert not any(r.estimate.sightings for r in flight.records)
