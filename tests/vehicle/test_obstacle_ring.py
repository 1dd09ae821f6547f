import math

import numpy as np
import pytest

from missionkit.geometry import from_euler, rotate
from missionkit.vehicle.telemetry.obstacle_ring import (
    points_of,
    refusal,
    ring_of,
    sectors,
    together,
)

NOWHERE = 1201  # cm, beyond the reach
TILTED = from_euler(0.2, -0.1, 1.0)
LEVEL = from_euler(0.0, 0.0, 0.0)


def ring(hits, **more):
    distances = [NOWHERE] * 72
    for index, distance in hits.items():
        distances[index] = distance
    return {
        "frame": 12, "distances": distances, "increment": 5, "increment_f": 0.0, "sensor_type": 0,
        "angle_offset": 0.0, "min_distance": 20, "max_distance": 1200, **more,
    }  # fmt: skip


def places(fields, attitude=TILTED):
    """The points from the vehicle, north, east, down."""
    assert refusal(fields, attitude) == ""
    return np.array([rotate(attitude, point) for point in points_of(fields, attitude)])


def at(distance, bearing):
    return distance * math.cos(bearing), distance * math.sin(bearing), 0.0


@pytest.mark.parametrize("frame", [8, 12])
def test_a_ring_of_the_body_is_level_and_begins_at_the_front(frame):
    world = places(ring({0: 300, 18: 500}, frame=frame))
    np.testing.assert_allclose(world, [at(3.0, 1.0), at(5.0, 1.0 + math.pi / 2)], atol=1e-9)


@pytest.mark.parametrize("frame", [0, 1])
def test_a_world_ring_begins_at_north_at_any_heading(frame):
    world = places(ring({0: 300, 18: 500}, frame=frame))
    np.testing.assert_allclose(world, [at(3.0, 0.0), at(5.0, math.pi / 2)], atol=1e-9)


@pytest.mark.parametrize("frame", [0, 12])
def test_offset_and_increment_are_clockwise_and_the_finer_increment_counts(frame):
    fields = ring({0: 300, 2: 400}, frame=frame, angle_offset=-30.0, increment_f=2.5)
    world = places(fields, LEVEL)
    angles = np.radians([-30.0, -25.0])
    np.testing.assert_allclose(world, [at(3.0, angles[0]), at(4.0, angles[1])], atol=1e-9)
    (one,) = places(ring({1: 300}, frame=frame, increment_f=-2.5), LEVEL)
    np.testing.assert_allclose(one, at(3.0, math.radians(-2.5)), atol=1e-9)


def test_unknown_is_not_an_obstacle_and_below_minimum_range_is_one():
    fields = ring({0: 65535, 1: 10, 2: 0, 3: 1200, 4: NOWHERE, 5: 20})
    reach = np.linalg.norm(points_of(fields, LEVEL), axis=1)
    np.testing.assert_allclose(reach, [0.10, 0.05, 12.0, 0.2])
    assert sectors(fields) == 71


def test_a_ring_of_the_body_needs_no_attitude_and_one_of_the_world_does():
    np.testing.assert_allclose(points_of(ring({0: 300}), None), [(3.0, 0.0, 0.0)], atol=1e-9)
    assert refusal(ring({0: 300}), None) == ""
    assert "attitude is not known" in refusal(ring({0: 300}, frame=0), None)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"frame": 21}, "MAV_FRAME 21; missionkit understands 0, 1, 8 and 12"),
        ({"increment": 0}, "no increment"),
        ({"distances": [65535] * 72}, "no distance in any direction"),
    ],
)
def test_a_ring_that_cannot_be_understood_is_refused_with_its_reason(change, why):
    assert why in refusal({**ring({}), **change}, LEVEL)


def test_rings_of_several_sensors_are_one_scan():
    front, rear = ring({0: 300}), ring({36: 400}, max_distance=800)
    scan = together([ring_of(front, 9.8, LEVEL), ring_of(rear, 10.0, LEVEL)])
    assert (scan.at, scan.range) == (10.0, 8.0)
    np.testing.assert_allclose(scan.points, [(3.0, 0.0, 0.0), (-4.0, 0.0, 0.0)], atol=1e-9)
    assert len(together([ring_of(front, 9.0, LEVEL), ring_of(rear, 10.0, LEVEL)]).points) == 1
    assert together([]) is None
