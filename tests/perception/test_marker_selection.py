from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import target, tilted

from missionkit.geometry import vec
from missionkit.messages import Detection, Sighting
from missionkit.perception.marker_selection import (
    Candidate,
    area_of,
    plausible,
    select,
)


def candidate(position, area, *, sd=0.05, number=23):
    seen = Detection("DICT_6X6_250", number, np.zeros((4, 2)), area)
    sighting = Sighting(0.0, "trunk", number, tilted(3.0), sd, 0.1, 0.2, False, seen)
    return Candidate(sighting, None if position is None else vec(*position))


@given(
    st.lists(st.floats(1, 50), min_size=4, max_size=4),
    st.floats(0, 6.28),
    st.tuples(st.floats(-500, 500), st.floats(-500, 500)),
)
@settings(derandomize=True, database=None)
def test_the_area_is_the_shoelace_formulas(reach, turn, middle):
    angles = turn + np.array([0.0, 1.4, 3.1, 4.6])
    corners = np.array(middle) + np.array(reach)[:, None] * np.stack(
        [np.cos(angles), np.sin(angles)], axis=1
    )
    x, y = corners.T
    shoelace = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    assert area_of(corners) == pytest.approx(shoelace, rel=1e-6, abs=1e-6)


def test_without_a_goal_the_largest_marker_is_taken():
    small, large = candidate((3, 0, 0), 400), candidate((9, 0, 0), 900)
    assert select([small, large], None) is large


def test_with_a_goal_the_nearest_marker_is_taken_however_small():
    decoy, true = candidate((9, 4, 0), 900), candidate((3, 0, 0), 400)
    assert select([decoy, true], vec(3.2, 0, 0)) is true


def test_of_several_markers_at_the_same_place_the_largest_is_taken():
    small, large = candidate((3.0, 0, 0), 100, number=1), candidate((3.1, 0, 0), 900, number=2)
    decoy = candidate((5, 0, 0), 2000)
    assert select([small, large, decoy], vec(3, 0, 0)) is large


def test_without_an_own_pose_the_size_decides():
    unplaced = [candidate(None, 400), candidate(None, 900)]
    assert select(unplaced, vec(3, 0, 0)) is unplaced[1]


@pytest.mark.parametrize(
    ("sd", "gap", "believed"),
    [(0.1, 2.9, True), (0.1, 3.1, False), (2.0, 9.9, True), (2.0, 10.1, False)],
)
def test_a_sighting_far_from_its_target_is_refused(sd, gap, believed):
    prior = target(position=(6.0, 0.0, 0.0), sd=sd)
    assert plausible(candidate((6.0 + gap, 0, 0), 400, sd=0.0), prior) is believed


def test_nothing_is_refused_without_something_to_compare():
    assert plausible(candidate((99, 0, 0), 400), None)
    assert plausible(candidate(None, 400), target())
