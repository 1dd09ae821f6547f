"""The injection: in, work, out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import TICK, at, marker, play
from samples import calm

from missionkit.behaviors.inject import Inject
from missionkit.geometry import norm, vec
from missionkit.messages import Estimate, Target

PLACE = (20.0, 5.0, -3.0)
INJECT = Inject(
    target="trunk", standoff=(1.2, 0.0, 0.0), depth=0.4, hold=1.0, speed=0.1, patience=0.7
)


def story(seconds: float, unseen: tuple[float, float] = (math.inf, math.inf)) -> list[Estimate]:
    """A vehicle that follows the goal exactly; the marker is out of sight during `unseen` (s)."""
    estimates, depth = [], 0.0
    for n in range(round(seconds / TICK)):
        now, since = 10.0 + n * TICK, n * TICK
        hidden = unseen[0] <= since < unseen[1]
        seen_at = 10.0 + unseen[0] if hidden else now
        trunk = marker(*PLACE, seen_at=seen_at)
        depth = min(0.4, 0.1 * since)
        estimates.append(at(now, 18.8 + depth, 5.0, -3.0, targets={"trunk": trunk}))
    return estimates


def depths(steps) -> np.ndarray:
    return np.array([step.goal.position[0] - 18.8 for step in steps])


def test_it_moves_in_works_and_moves_back():
    steps = play(INJECT, story(9.6))
    phases = [step.note for step in steps]
    switches = [n for n in range(1, len(phases)) if phases[n] != phases[n - 1]]
    assert [phases[n] for n in switches] == ["injecting", "moving back"]
    start, end = (n * TICK for n in switches)
    assert start == pytest.approx(4.0, abs=TICK)  # 0.4 m at 0.1 m/s
    assert end - start == pytest.approx(1.0, abs=TICK)
    done = [step.done for step in steps].index(True) * TICK
    assert done - end == pytest.approx(4.0, abs=2 * TICK)
    assert steps[-1].goal.yaw == pytest.approx(0.0)


def test_the_actuator_is_on_only_while_it_works():
    for step in play(INJECT, story(9.6)):
        assert step.payload == ("injector" if step.note == "injecting" else None)


def test_the_goal_slides_at_its_speed_along_the_normal_and_says_so():
    steps = play(INJECT, story(9.6))
    gone = depths(steps)
    assert gone.max() == pytest.approx(0.4)
    assert gone[-1] == pytest.approx(0.0, abs=1e-9)
    assert np.abs(np.diff(gone)).max() <= 0.1 * TICK + 1e-9
    towards = vec(0.1, 0.0, 0.0)
    np.testing.assert_allclose(steps[20].guidance.velocity, towards, atol=1e-12)
    assert steps[90].guidance.velocity is None
    np.testing.assert_allclose(steps[130].guidance.velocity, -towards, atol=1e-12)
    for step in steps:
        assert not step.guidance.avoid
        assert norm(step.goal.position - vec(*PLACE)) >= 0.8 - 1e-9


def test_out_of_sight_the_goal_stands_still_and_moves_on_afterwards():
    steps = play(INJECT, story(8.0, unseen=(2.0, 4.0)))
    gone = depths(steps)
    waiting = slice(round(2.8 / TICK), round(4.0 / TICK))
    np.testing.assert_allclose(gone[waiting], gone[round(2.7 / TICK)], atol=0.1 * TICK + 1e-9)
    assert all(step.guidance.velocity is None for step in steps[waiting])
    assert np.abs(np.diff(gone)).max() <= 0.1 * TICK + 1e-9
    assert "injecting" in {step.note for step in steps}


def test_it_does_not_work_before_it_has_arrived():
    late = [
        at(
            10.0 + n * TICK,
            18.8,
            5.0,
            -3.0,
            targets={"trunk": marker(*PLACE, seen_at=10 + n * TICK)},
        )
        for n in range(round(8.0 / TICK))
    ]
    steps = play(INJECT, late)
    assert {step.note for step in steps} == {"moving in"}
    assert depths(steps).max() == pytest.approx(0.4)
    assert steps[-1].guidance.velocity is None


UNTURNED = Target("trunk", vec(*PLACE), 0.1, None, None, 10.0)


@pytest.mark.parametrize(
    ("targets", "note"),
    [
        ({}, "trunk was never seen"),
        ({"trunk": marker(*PLACE, seen_at=None)}, "trunk was never seen"),
        ({"trunk": UNTURNED}, "the orientation of trunk is unknown"),
    ],
)
def test_without_a_pose_it_holds(targets, note):
    (step,) = play(INJECT, [calm(targets=targets)])
    assert (step.guidance, step.payload, step.done, step.note) == (None, None, False, note)


def test_a_pose_that_comes_late_does_not_make_the_goal_leap():
    blind = [at(10.0 + n * TICK, 18.8, 5.0, -3.0) for n in range(60)]
    seen = [at(13.0, 18.8, 5.0, -3.0, targets={"trunk": marker(*PLACE, seen_at=13.0)})]
    steps = play(INJECT, blind + seen)
    assert depths(steps[-1:])[0] <= 0.02 + 1e-9


def test_zero_depth_works_in_place():
    steps = play(INJECT.model_copy(update={"depth": 0.0}), story(1.5)[:1] * 3)
    assert [step.note for step in steps] == ["injecting"] * 3
