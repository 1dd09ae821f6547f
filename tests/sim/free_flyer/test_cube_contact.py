from __future__ import annotations

import math

import numpy as np
import pytest
from docking import WORLD, Hand, perfect
from scipy.optimize import linprog

from missionkit.geometry import exp, to_matrix
from missionkit.messages import Action
from missionkit.sim.free_flyer.cube_contact import overlap

UPRIGHT = np.eye(3)
HALF = 0.05


def depth(offset, axes=UPRIGHT, push=None) -> float:
    push = np.empty(3) if push is None else push
    return overlap(np.array(offset), np.ascontiguousarray(axes), HALF, UPRIGHT, HALF, push)


def test_cubes_overlap_by_their_faces():
    push = np.empty(3)
    assert depth((0.0, -0.098, 0.01), push=push) == pytest.approx(0.002)
    assert push == pytest.approx([0.0, -1.0, 0.0])
    assert depth((0.0, -0.1001, 0.01)) == 0.0


def test_corners_and_edges_reach_as_far_as_they_do():
    edge = to_matrix(exp(np.array([0.0, 0.0, math.pi / 4.0])))
    reach = HALF * (1.0 + math.sqrt(2.0))
    assert depth((reach - 0.001, 0.0, 0.0), edge) == pytest.approx(0.001)
    assert depth((reach + 0.001, 0.0, 0.0), edge) == 0.0


def test_overlap_agrees_with_a_linear_program():
    """A common point of both cubes exists or not: feasibility of 12 inequalities."""
    rng, both = np.random.default_rng(4), []
    for _ in range(150):
        axes = to_matrix(exp(rng.normal(size=3)))
        offset = rng.normal(size=3)
        offset *= rng.uniform(0.09, 0.18) / np.linalg.norm(offset)
        sides = np.concatenate((UPRIGHT, -UPRIGHT, axes.T, -axes.T))
        bounds = np.full(12, HALF) + np.concatenate(
            (np.zeros(6), axes.T @ offset, -axes.T @ offset)
        )
        found = linprog(np.zeros(3), A_ub=sides, b_ub=bounds, bounds=(None, None)).status == 0
        assert (depth(offset, axes) > 0.0) is found
        both.append(found)
    assert 20 < sum(both) < 130


def approach(out: float, speed: float, aside: float = 0.0, *, solid: bool = True) -> Hand:
    """Fly into the docked place from `out` (m) before it; already turned."""
    where = Hand(perfect()).place(out, aside)
    start = {"position": tuple(where.tolist()), "attitude_deg": (-90.0, 0.0, -90.0)}
    target = {**WORLD.target.model_dump(), "solid": solid}
    hand = Hand(perfect(start=start, target=target))
    hand.arm()
    hand.push((0.0, 0.0, 1.33 * speed / 2.0), (0.0, 0.0, 0.0), 2.0)
    hand.wait(12.0)
    return hand


def test_a_slow_touch_in_the_corridor_stops_the_chaser_at_the_face():
    truth = approach(0.15, 0.02).flyer.truth
    assert not truth.crashed
    assert truth.position == pytest.approx([1.0, 1.9, 1.0], abs=1e-9)
    assert truth.velocity == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize(("speed", "aside"), [(0.07, 0.0), (0.02, 0.09)])
def test_a_fast_touch_and_one_beside_the_corridor_are_crashes(speed, aside):
    hand = approach(0.15, speed, aside)
    assert hand.flyer.truth.crashed
    assert not hand.flyer.truth.armed
    stopped = hand.flyer.truth.position
    hand.push((0.1, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    assert hand.flyer.truth.position == pytest.approx(stopped)
    hand.act(Action.DISARM)
    hand.wait(0.3)
    assert "disarm_refused" in hand.events
    assert not hand.flyer.ready


def test_a_target_that_is_not_solid_is_flown_through():
    hand = approach(0.15, 0.02, 0.09, solid=False)
    assert not hand.flyer.truth.crashed
    assert hand.flyer.truth.position[1] > 1.95
    assert hand.flyer.truth.clearance < 0.0
