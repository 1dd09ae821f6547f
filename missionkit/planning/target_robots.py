"""Where a tracked ground robot drives: straight on, or on after the half turn that it is in."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.messages import Target
from missionkit.messages.robot_modes import spins

ROBOT = GroundRobot()


def stands_for(target: Target) -> float:
    """Return how long (s) a target stands yet: while it spins; inf: it is not known until when."""
    if not spins(target):
        return 0.0
    return math.inf if target.spin_left is None else target.spin_left


def way_out(target: Target) -> Mat:
    """Return the direction (2,), north and east, in which a target drives on.

    After a spin whose end is known that is where it heads then.
    """
    heading, stands = target.heading or 0.0, stands_for(target)
    if math.isfinite(stands):
        heading += ROBOT.spin_rate * stands
    return np.array((math.cos(heading), math.sin(heading)))


def place_ahead(target: Target, ahead: float, after: float) -> Mat:
    """Return the place (2,), m, north and east, ahead of where a target will be.

    Args:
        target: that is tracked, with a heading.
        ahead: m, of its centre.
        after: s from now.
    """
    driven = ROBOT.speed * max(0.0, after - stands_for(target))
    place: Mat = target.position[:2] + (ahead + driven) * way_out(target)
    return place
