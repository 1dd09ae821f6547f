"""Staying above a tracked target: where it leads, and when it does not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import at, play

from missionkit.behaviors.shadow import Shadow
from missionkit.geometry import vec
from missionkit.messages import Target

EAST = math.radians(90.0)


def robot(north=1.0, east=0.5, *, spin=0.1, heading=EAST, name="robot_4"):
    modes = {} if heading is None else {"straight": 1.0 - spin, "spin": spin}
    return Target(name, vec(north, east, 0.2), 0.02, None, None, 9.9, heading=heading, modes=modes)


def guided(behavior, target):
    seen = at(10.0, 0.0, 0.0, -2.0, yaw=0.7, targets={"robot_4": target, "tracked": target})
    (step,) = play(behavior, [seen])
    return step


@pytest.mark.parametrize(
    ("lead", "spin", "leads"),
    [
        ("switched", 0.1, True),
        ("switched", 0.6, False),
        ("always", 0.6, True),
        ("never", 0.1, False),
    ],
)
def test_it_leads_by_the_heading_as_the_mode_says(lead, spin, leads):
    guidance = guided(Shadow(lead=lead, height=2.5), robot(spin=spin)).guidance
    np.testing.assert_allclose(guidance.position, (1.0, 0.5, -2.3))
    np.testing.assert_allclose(guidance.velocity, (0.0, 0.33 if leads else 0.0, 0.0), atol=1e-9)
    assert guidance.yaw == pytest.approx(0.7)


def test_a_target_without_a_heading_is_followed_by_its_place():
    step = guided(Shadow(), robot(heading=None))
    np.testing.assert_allclose(step.guidance.velocity, 0.0)
    assert not step.done
    assert step.note == "1.12 m off robot_4"


def test_it_is_done_above_the_target_and_holds_without_one():
    assert guided(Shadow(within=0.3), robot(0.2, 0.2)).done
    (lost,) = play(Shadow(), [at(10.0, 0.0, 0.0, -2.0)])
    assert (lost.guidance, lost.stop, lost.done) == (None, False, False)
    assert lost.note == "tracked is not tracked"
