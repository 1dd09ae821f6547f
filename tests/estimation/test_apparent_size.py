"""What the size of a box says about a tower, and where it says nothing."""

from __future__ import annotations

import pytest

from missionkit.estimation.target_tracking.apparent_size import size_evidence, sizes_of_obstacles

DIAMETER = 0.34


def test_a_tower_hides_behind_its_robot_seen_from_straight_above():
    expected = sizes_of_obstacles(0.0, 2.5, DIAMETER)
    assert expected[0] == 1.0
    assert (
        size_evidence(1.0, 0.0, 2.5, DIAMETER) > -1.0
    )  # most towers hide: it hardly says "target"


@pytest.mark.parametrize("offset", [0.6, 1.0, 1.5])
def test_from_aside_the_size_tells_them_apart(offset):
    assert size_evidence(1.0, offset, 2.5, DIAMETER) < -2.0
    for size in sizes_of_obstacles(offset, 2.5, DIAMETER):
        assert size_evidence(float(size), offset, 2.5, DIAMETER) > 2.0


def test_a_tower_reaches_as_far_as_its_top_is_seen():
    """The top, 1 m high and 0.05 m wide at 0.8 m aside, is seen against the ground at 1.417 m."""
    top = (0.8 + 0.05) * 2.5 / 1.5
    assert sizes_of_obstacles(0.8, 2.5, DIAMETER)[0] == pytest.approx(0.5 + (top - 0.8) / DIAMETER)


@pytest.mark.parametrize("size", [1e-6, 0.1, 50.0, 1e9])
def test_no_box_decides_alone(size):
    for offset, height in ((0.0, 0.5), (5.0, 2.5), (0.3, 0.01)):
        assert abs(size_evidence(size, offset, height, DIAMETER)) < 6.0
