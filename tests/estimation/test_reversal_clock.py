"""When a robot reverses next, by the spins that its track shows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.estimation.target_tracking.reversal_clock import (
    ReversalClock,
    advanced,
    reversal_in,
    spin_left,
)
from missionkit.estimation.target_tracking.tracker import MultiTargetTracker
from missionkit.ground_robot import GroundRobot
from missionkit.messages import GroundDetection, GroundFrame
from missionkit.sim import ground_robots

ROBOT = GroundRobot()
DT = 0.05


def clock_of(*spins: tuple[float, float], until: float, unseen=()) -> ReversalClock:
    """Return the clock after a target spun from one time to another, as a tracker notices it."""
    clock, before = ReversalClock(), 0.0
    for at in np.arange(0.0, until, DT).tolist():
        if any(start <= at < end for start, end in unseen):
            continue
        spinning = any(start + 0.15 <= at < end + 0.15 for start, end in spins)
        clock = advanced(clock, at, before, spins=spinning, robot=ROBOT)
        before = at
    return clock


HALF = ROBOT.spin_time


@pytest.mark.parametrize(
    ("spins", "until", "unseen", "expected"),
    [
        ((), 30.0, (), None),
        (((7.0, 7.0 + HALF),), 12.0, (), 15.0),
        (((7.0, 7.0 + 0.25 * HALF),), 12.0, (), None),  # a touch on top
        (((5.0, 5.0 + 2 * HALF),), 12.0, (), 5.0 + HALF + 20.0 - 12.0),  # the reversal waited
        (((7.0, 7.0 + HALF),), 29.0, (), None),  # no reversal at 27 s: that was a bump
        (((7.0, 7.0 + HALF),), 29.0, ((26.0, 29.0),), 18.0),  # nobody saw whether it reversed
        (((7.0, 7.0 + HALF), (12.0, 12.0 + HALF)), 16.0, (), None),  # one was a bump
        (((3.0, 3.0 + HALF), (7.0, 7.0 + HALF), (27.0, 27.0 + HALF)), 30.0, (), 17.0),
        (((7.0, 7.0 + HALF),), 12.0, ((6.0, 8.0),), None),  # not seen whole
    ],
)
def test_the_next_reversal_follows_from_spins_seen_whole(spins, until, unseen, expected):
    known = reversal_in(clock_of(*spins, until=until, unseen=unseen), until, ROBOT)
    assert known == (None if expected is None else pytest.approx(expected, abs=0.2))


@pytest.mark.parametrize(
    ("until", "unseen", "expected"),
    [
        (6.0, (), None),  # it drives
        (8.5, (), HALF - 1.5),
        (8.5, ((5.0, 7.5),), None),  # it spun already when it was seen again
        (8.5, ((5.0, 6.4),), HALF - 1.5),
        (10.0, (), None),  # over
    ],
)
def test_a_spin_whose_begin_was_seen_says_when_it_ends(until, unseen, expected):
    known = spin_left(clock_of((7.0, 7.0 + HALF), until=until, unseen=unseen), until, ROBOT)
    assert known == (None if expected is None else pytest.approx(expected, abs=0.1))


def test_a_tracked_robot_says_when_it_reverses():
    rng = np.random.default_rng(4)
    robots = ground_robots.placed(
        np.zeros((1, 2)), np.zeros(1), np.array([6.0]), ROBOT, obstacles=0
    )
    offsets = ground_robots.random_offsets(rng, 1, 40.0, ROBOT)
    tracker = MultiTargetTracker()
    memory = tracker.begin()
    off = []
    for k in range(600):
        ground_robots.advance(robots, offsets, ROBOT, DT)
        place = robots[0, :2] + rng.normal(0.0, 0.0135, 2)
        seen = GroundDetection("haar", place, 0.0135**2 * np.eye(2), 0.9, 1.0, 1.0, 2.5)
        memory = tracker.observe(memory, GroundFrame(k * DT, (seen,)))
        (known,) = tracker.targets(memory, k * DT).values() or (None,) if k > 5 else (None,)
        if known is not None and known.reversal_in is not None:
            off.append(
                math.remainder(known.reversal_in - robots[0, ground_robots.REVERSAL_IN], 20.0)
            )
    assert len(off) > 400
    assert np.max(np.abs(off)) < 0.4
