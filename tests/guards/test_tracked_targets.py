"""Guards over what a tracker knows."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from samples import calm

from missionkit.guards.tracked_targets import (
    TargetHeading,
    TargetMode,
    TargetsInView,
    TimeToReversal,
)
from missionkit.messages import Target

ROBOT = Target(
    "robot_4",
    np.array([2.0, 0.0, 0.0]),
    0.02,
    None,
    None,
    seen_at=9.8,
    velocity=np.array([0.33, 0.0, 0.0]),
    heading=math.radians(350.0) - 4 * math.pi,  # headings are not wrapped
    heading_sd=math.radians(3.0),
    modes={"straight": 0.7, "spin": 0.3},
    classes={"target": 0.9, "obstacle": 0.1},
    confidence=1.0,
    reversal_in=6.0,
)
BORN = ROBOT._replace(heading=None, heading_sd=None, modes={}, reversal_in=None)


@pytest.mark.parametrize(
    ("guard", "robot", "holds", "value"),
    [
        (TargetMode(target="tracked", mode="spin", at_least=0.3), ROBOT, True, 0.3),
        (TargetMode(target="tracked", mode="spin"), ROBOT, False, 0.3),
        (TargetMode(target="tracked", mode="circling"), ROBOT, None, None),
        (TargetMode(target="tracked", mode="spin"), BORN, None, None),
        (TargetMode(target="tracked", mode="spin"), None, None, None),
        (TargetHeading(target="tracked", heading_deg=0, within_deg=11), ROBOT, True, 10.0),
        (TargetHeading(target="tracked", heading_deg=-25, within_deg=11), ROBOT, False, 15.0),
        (TargetHeading(target="tracked", heading_deg=0, sd_deg=2), ROBOT, None, None),
        (TargetHeading(target="tracked", heading_deg=0), BORN, None, None),
        (TargetHeading(target="tracked", heading_deg=0), None, None, None),
        (TimeToReversal(target="tracked", at_most=6), ROBOT, True, 6.0),
        (TimeToReversal(target="tracked", at_most=5.9), ROBOT, False, 6.0),
        (TimeToReversal(target="tracked", at_least=6.1), ROBOT, False, 6.0),
        (TimeToReversal(target="tracked", at_least=6), ROBOT, True, 6.0),
        (TimeToReversal(target="tracked", at_most=6), BORN, None, None),
        (TimeToReversal(target="tracked", at_most=6), None, None, None),
    ],
)
def test_verdict(guard, robot, holds, value):
    targets = {} if robot is None else {"robot_4": robot, "tracked": robot}
    verdict = guard.check(calm(targets=targets))
    assert verdict.holds is holds
    assert verdict.value == (None if value is None else pytest.approx(value))
    if value is not None:
        assert verdict.why == "robot_4"
        ((quantity, interval),) = guard.region().may[0].items()
        assert (interval.low <= value <= interval.high) is holds
        assert quantity.sees == "tracked"
        inside = verdict.margin if holds else -verdict.margin
        assert inside >= 0.0
    else:
        assert verdict.why


def robots():
    """Three robots, one of them an obstacle robot and one not seen for a second; and a pole."""
    third = ROBOT._replace(name="robot_7", classes={"target": 0.2, "obstacle": 0.8})
    lost = ROBOT._replace(name="robot_9", seen_at=9.0)
    pole = Target("pole", np.zeros(3), 0.1, None, None, 9.9)
    return {"robot_4": ROBOT, "robot_7": third, "robot_9": lost, "pole": pole, "tracked": ROBOT}


@pytest.mark.parametrize(("what", "count"), [("any", 2.0), ("target", 1.0), ("obstacle", 1.0)])
def test_targets_in_view_are_counted_once(what, count):
    for least in (1, 2, 3):
        verdict = TargetsInView(at_least=least, what=what).check(calm(targets=robots()))
        assert (verdict.holds, verdict.value) == (count >= least, count)
    assert TargetsInView().check(calm()).holds is False


def test_one_limit_is_asked_for():
    with pytest.raises(ValidationError, match="expected one of 'at_least' and 'at_most'"):
        TimeToReversal(target="tracked", at_most=3, at_least=1)
    with pytest.raises(ValidationError, match="expected one of 'at_least' and 'at_most'"):
        TimeToReversal(target="tracked")
