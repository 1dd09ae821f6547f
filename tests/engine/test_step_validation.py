"""Steps that a behaviour may return, and those that are refused."""

from __future__ import annotations

import numpy as np
import pytest
from misbehaving import ANSWERS

from missionkit.engine.step_validation import fault_of
from missionkit.messages import Action, Goal, Guidance, Step

GUIDANCE = "a Step with guidance of a wrong type or not finite"
FAULTS = {
    "nothing": "NoneType, expected a Step",
    "a number": "int, expected a Step",
    **dict.fromkeys(
        (
            *("no guidance", "a list", "no place", "two axes", "words", "nan", "endless"),
            *("no speed", "nan speed", "nan velocity", "nan yaw"),
        ),
        GUIDANCE,
    ),
    **dict.fromkeys(("nan goal", "no goal"), GUIDANCE.replace("guidance", "goal")),
    **{
        f"{odd} {part}": GUIDANCE.replace("guidance", part)
        for odd, part in (("odd", "action"), ("nan", "height"), ("odd", "payload"), ("odd", "note"))
    },
}


@pytest.mark.parametrize("name", ANSWERS)
def test_mistakes_are_described(name):
    assert fault_of(ANSWERS[name]) == FAULTS.get(name, "")


@pytest.mark.parametrize(
    "step",
    [
        Step(),
        Step(Guidance(np.array([1, 2, 3]), 2)),
        Step(Guidance(np.zeros(3, np.float32), np.float32(2), np.zeros(3), np.float64(0.1))),
        Step(action=Action.LAND, height=3, payload="sprayer", done=np.True_, note="x"),
        Step(goal=Goal(np.zeros(3), 0.5, 1.0), memory=object()),
    ],
)
def test_what_is_right_passes(step):
    assert fault_of(step) == ""
