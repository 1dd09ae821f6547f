"""Guards with a memory, fed tick by tick."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from samples import calm

from missionkit.guards.camera_silence import CameraSilent
from missionkit.guards.detection_confidence import ArucoConfidence
from missionkit.guards.gps_to_visual import GpsToVisual
from missionkit.guards.state_progress import GoalUnreachable
from missionkit.guards.tick_timing import TickOverrun
from missionkit.messages import Cycle, Goal, Look, Target

TRUNK = frozenset({"trunk"})


def look(found, silent=False):
    return Look(0.0, TRUNK if found else frozenset(), silent)


def fed(guard, looks):
    memory = guard.begin()
    for one in looks:
        memory = guard.advance(memory, calm(looks=(one,)))
    return memory


@given(st.lists(st.booleans(), min_size=1, max_size=80), st.integers(1, 30))
def test_confidence_is_the_share_of_the_last_frames(found, window):
    guard = ArucoConfidence(target="trunk", window=window, enter=0.7, exit=0.7)
    verdict = guard.check(fed(guard, map(look, found)), calm())
    share = sum(found[-window:]) / window
    assert verdict.value == pytest.approx(share)
    assert verdict.holds is (share >= 0.7)


def test_confidence_has_hysteresis():
    guard = ArucoConfidence(target="trunk", window=10, enter=0.7, exit=0.5)
    sequence = [True] * 7 + [False] * 20
    memory, answers = guard.begin(), []
    for found in sequence:
        memory = guard.advance(memory, calm(looks=(look(found),)))
        answers.append(guard.check(memory, calm()).holds)
    # sure from the 7th hit; hits fall out of the window from the 11th frame on
    assert answers == [False] * 6 + [True] * 6 + [False] * 15


def test_a_silent_camera_lowers_the_confidence():
    guard = ArucoConfidence(target="trunk", window=10, enter=0.7, exit=0.5)
    memory = fed(guard, [look(True)] * 10 + [look(False, silent=True)] * 6)
    assert guard.check(memory, calm()).holds is False


def test_a_tracked_target_brings_its_own_confidence_which_a_silent_camera_lowers():
    guard = ArucoConfidence(target="tracked", window=10, enter=0.7, exit=0.5)
    robot = Target("robot_4", np.zeros(3), 0.1, None, None, 10.0, confidence=0.8)
    memory, values = guard.begin(), []
    for silent in [False, True, True, True, True]:
        seen = calm(looks=(look(False, silent),), targets={"robot_4": robot, "tracked": robot})
        memory = guard.advance(memory, seen)
        values.append(guard.check(memory, seen).value)
    assert values == pytest.approx([0.8, 0.72, 0.64, 0.56, 0.48])
    assert guard.check(memory, seen).holds is False
    lost = guard.advance(memory, calm(looks=(look(False),)))
    assert guard.check(lost, calm()).value == 0.0


def test_confidence_is_unknown_before_the_first_frame():
    guard = ArucoConfidence(target="trunk")
    assert guard.check(guard.begin(), calm()).holds is None


def test_confidence_refuses_exit_above_enter():
    with pytest.raises(ValidationError, match="must not be above enter"):
        ArucoConfidence(target="trunk", enter=0.5, exit=0.7)


def test_camera_silent_counts_frames_in_a_row():
    guard = CameraSilent(frames=3)
    silent, good = look(False, silent=True), look(False)
    assert guard.check(fed(guard, [silent, silent, good, silent, silent]), calm()).holds is False
    assert guard.check(fed(guard, [good, silent, silent, silent]), calm()).holds is True


def test_tick_overrun_counts_within_its_window():
    guard = TickOverrun(count=2, window=3)
    memory, answers = guard.begin(), []
    for overruns in (0, 1, 1, 2, 2, 2, 2):
        memory = guard.advance(memory, calm(cycle=Cycle(overruns=overruns)))
        answers.append(guard.check(memory, calm()).holds)
    assert answers == [False, False, False, True, False, False, False]


def approach(guard, distances, entered_at=0.0):
    memory, answers = guard.begin(), []
    for now, distance in enumerate(distances):
        goal = Goal(np.array([distance, 0.0, -5.0]), None, float(now))
        seen = calm(now=float(now), goal=goal, entered_at=entered_at)
        memory = guard.advance(memory, seen)
        answers.append(guard.check(memory, seen).holds)
    return answers


def test_unreachable_when_no_nearer_for_long_enough():
    guard = GoalUnreachable(further_than=1.0, longer_than=3.0, progress=0.5)
    assert approach(guard, [9, 8, 7, 6.8, 6.9, 7.2, 7.0, 7.0]) == [False] * 6 + [True] * 2
    assert approach(guard, [9, 8, 7, 6, 5, 4, 3, 2, 0.9, 0.9, 0.9, 0.9, 0.9]) == [False] * 13


def test_unreachable_restarts_in_the_next_state():
    guard = GoalUnreachable(further_than=1.0, longer_than=3.0)
    seen = calm(now=9.0, goal=Goal(np.array([9.0, 0.0, -5.0]), None, 9.0), entered_at=0.0)
    memory = guard.advance(guard.advance(guard.begin(), seen), seen)
    later = calm(now=20.0, goal=seen.goal, entered_at=19.0)
    assert guard.check(guard.advance(memory, later), later).holds is False
    assert guard.check(guard.advance(None, calm()), calm()).holds is None


@pytest.mark.parametrize(
    ("hits", "distance", "goal_distance", "value"),
    [
        (30, 7.0, 3.0, 3.0),  # all hold: the last part's value is not asked for
        (20, 7.0, 3.0, 20 / 30),
        (30, 8.5, 3.0, 8.5),
        (30, 7.0, 4.5, 4.5),
    ],
)
def test_gps_to_visual_names_the_part_that_fails(hits, distance, goal_distance, value):
    guard = GpsToVisual(target="trunk", range=8.0, tolerance=4.0)
    seen = calm(
        targets={"trunk": Target("trunk", np.array([distance, 0, -5.0]), 0.1, None, None, 9.9)},
        goal=Goal(np.array([goal_distance, 0.0, -5.0]), None, 9.9),
    )
    memory = fed(guard, [look(False)] * (30 - hits) + [look(True)] * hits)
    verdict = guard.check(memory, seen)
    assert verdict.holds is (hits == 30 and distance < 8 and goal_distance < 4)
    if not verdict.holds:
        assert verdict.value == pytest.approx(value)
