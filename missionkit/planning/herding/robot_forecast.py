"""Where a ground robot will be, by its clock and without random turns.

Imported late: it compiles kernels. A row of the state is one robot, at the indices below, in the
arena's axes (`arena_frame`); its sides are crossed at ± half the arena's side.
"""

from __future__ import annotations

import math

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled

X, Y = 0, 1  # m
HEADING = 2  # rad, off the direction to the goal, clockwise
SPIN_LEFT = 3  # s
REVERSAL_IN = 4  # s, 0 or less while it waits for a spin to end
SIZE = 5
INSIDE, HOME, LOST = 0, 1, 2


@compiled
def crossed(x: float, y: float, dx: float, dy: float, half: float) -> int:
    """Say where a straight way from (x, y) by (dx, dy) leaves the arena: INSIDE, HOME or LOST.

    Args:
        x: m, start.
        y: m.
        dx: m, the way.
        dy: m.
        half: m, of the arena's side.
    """
    ends_x, ends_y = x + dx, y + dy
    if abs(ends_x) < half and abs(ends_y) < half:
        return INSIDE
    first, where = math.inf, INSIDE
    if ends_x >= half:
        first, where = (half - x) / max(dx, 1e-9), HOME
    elif ends_x <= -half:
        first, where = (half + x) / max(-dx, 1e-9), LOST
    if abs(ends_y) >= half and (half - math.copysign(y, dy)) / max(abs(dy), 1e-9) < first:
        return LOST
    return where


@compiled
def forecast(state: Mat, dt: float, half: float, robot: GroundRobot) -> int:
    """Move one robot (SIZE,) by `dt` (s) in place; say whether it left the arena: then it stops.

    Args:
        state: of the robot.
        dt: s.
        half: m, of the arena's side.
        robot: how it drives.
    """
    left = dt
    while left > 1e-9:
        if state[SPIN_LEFT] <= 0.0 and state[REVERSAL_IN] <= 1e-9:
            state[REVERSAL_IN] += robot.reversal_every
            state[SPIN_LEFT] = robot.spin_time
        if state[SPIN_LEFT] > 0.0:
            step = min(left, float(state[SPIN_LEFT]))
            state[HEADING] += math.pi / robot.spin_time * step
            state[SPIN_LEFT] -= step
            if state[SPIN_LEFT] < 1e-9:
                state[SPIN_LEFT] = 0.0
        else:
            step = min(left, float(state[REVERSAL_IN]))
            dx = robot.speed * step * math.cos(state[HEADING])
            dy = robot.speed * step * math.sin(state[HEADING])
            where = crossed(state[X], state[Y], dx, dy, half)
            state[X] += dx
            state[Y] += dy
            if where != INSIDE:
                return where
        state[REVERSAL_IN] -= step
        left -= step
    return INSIDE
