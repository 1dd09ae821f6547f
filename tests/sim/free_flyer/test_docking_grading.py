from __future__ import annotations

import math

import numpy as np
import pytest
from docking import WORLD, Hand

from missionkit.sim.free_flyer.docking_grading import grade_docking
from missionkit.sim.kernel_layout import TRACK_WIDTH

PLACE = Hand(WORLD).place


def rows(*places: np.ndarray, armed: bool = False, crashed: bool = False) -> np.ndarray:
    """Return a track of a second between places, armed but at its end."""
    out = np.zeros((len(places), TRACK_WIDTH))
    out[:, 0] = np.arange(len(places))
    out[:, 1:4] = places
    out[:, 7:11] = WORLD.berth.pose.rotation
    out[:, 15] = 1.0
    out[-1, 15], out[-1, 14] = float(armed), float(not armed)
    out[-1, 17] = float(crashed)
    return out


def test_distance_counts_outside_the_corridor_and_the_side_inside():
    track = rows(PLACE(0.5), PLACE(0.1, 0.2), PLACE(0.05, 0.01), PLACE(0.002, 0.003))
    grade = grade_docking(track, WORLD, 1.5)
    assert grade.docked
    assert grade.centre_distance == pytest.approx(math.hypot(0.2, 0.2))
    assert grade.separation == pytest.approx(math.hypot(0.2, 0.2) - 0.1 * math.sqrt(3.0))
    assert grade.sideways == pytest.approx(0.01)
    assert grade.position_error == pytest.approx(math.hypot(0.002, 0.003))
    assert (grade.duration, grade.impulse, grade.keep_out_time) == (2.0, 1.5, 0.0)


def test_the_keep_out_sphere_is_noticed():
    track = rows(PLACE(0.5), PLACE(0.0, 0.12), PLACE(0.0, 0.13), PLACE(0.0))
    grade = grade_docking(track, WORLD, 0.0)
    assert grade.keep_out_time == 2.0
    assert grade.separation == pytest.approx(math.hypot(0.12, 0.1) - 0.1 * math.sqrt(3.0))


@pytest.mark.parametrize(
    ("track", "docked", "safe"),
    [
        (rows(PLACE(0.5), PLACE(0.019)), True, True),
        (rows(PLACE(0.5), PLACE(0.021)), False, True),
        (rows(PLACE(0.5), PLACE(0.0), armed=True), False, False),
        (rows(PLACE(0.5), PLACE(0.0), crashed=True), False, False),
    ],
)
def test_docked_is_held_within_the_tolerances_unhurt(track, docked, safe):
    grade = grade_docking(track, WORLD, 0.0)
    assert (grade.docked, grade.safe) == (docked, safe)


def test_what_is_not_finite_is_none_in_a_report():
    written = grade_docking(rows(PLACE(0.1), PLACE(0.0)), WORLD, 0.0).as_dict()
    assert written["centre_distance"] is written["separation"] is None
    assert written["docked"] is True
