"""Ground robots by their firmware's rules, exact in time: the truth that trackers are graded by.

Imported late: it compiles kernels. One row of the state is one robot, at the indices below.

- A target drives straight. Every 5 s it turns a little: an offset between its wheels for 0.85 s.
- Every 20 s, by a clock with a phase of its own, it reverses: a spin of 180 deg clockwise.
- A bump in front makes it spin by 180 deg, a touch on top by 45 deg. Neither moves the clock, and
  both are ignored during a spin. A reversal that is due during a spin follows it.
- A random turn that is due during a spin follows it; a spin that begins ends a random turn.
- An obstacle robot drives in a circle, whatever happens.

Source: the organisers' firmware (correction P4.4). What it does not say, and is ours: the
clock of a reversal that had to wait keeps its phase; a spin cuts a random turn short.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled

NORTH, EAST = 0, 1  # m
HEADING = 2  # rad, clockwise from north, not wrapped
SPIN_LEFT = 3  # s, 0 while it does not spin
REVERSAL_IN = 4  # s, 0 or less while it waits for a spin to end
TURN_IN = 5  # s, until the next random turn
TURN_LEFT = 6  # s, 0 while it does not turn
OFFSET = 7  # m/s, of the wheels in this turn; positive: clockwise
TURNS = 8  # random turns begun
OBSTACLE = 9  # 1: an obstacle robot
OUT = 10  # 0 in play; HOME or LOST: taken off the floor
OUT_AT = 11  # s, when it left
PRESSED = 12  # 1 while something rests on its plate
BUMPS, TOUCHES = 13, 14  # that it reacted to
SIZE = 15
HOME, LOST = 1.0, 2.0


def placed(places: Mat, headings: Mat, phases: Mat, robot: GroundRobot, *, obstacles: int) -> Mat:
    """Return the states (n, SIZE) of robots that start to drive.

    Args:
        places: (n, 2), m, north and east.
        headings: (n,), rad, clockwise from north.
        phases: (n,), s, until each one's first reversal.
        robot: how they drive.
        obstacles: the last so many are obstacle robots.
    """
    robots = np.zeros((len(places), SIZE))
    robots[:, :2], robots[:, HEADING] = places, headings
    robots[:, REVERSAL_IN] = phases
    robots[:, TURN_IN] = np.mod(phases, robot.turn_every)
    robots[len(places) - obstacles :, OBSTACLE] = 1.0
    return robots


def random_offsets(rng: np.random.Generator, robots: int, length: float, robot: GroundRobot) -> Mat:
    """Return the wheel offsets (robots, n), m/s, of all random turns in `length` s.

    Args:
        rng: where chance comes from.
        robots: how many.
        length: s of the simulation.
        robot: how they drive.
    """
    turns = math.ceil(length / robot.turn_every) + 2
    return rng.uniform(-robot.turn_offset, robot.turn_offset, (robots, turns))


@compiled
def advance(robots: Mat, offsets: Mat, robot: GroundRobot, dt: float) -> None:
    """Move all robots by `dt` (s), from event to event, in place.

    Args:
        robots: (n, SIZE) states.
        offsets: (n, k) m/s, of each one's random turns in their order.
        robot: how they drive.
        dt: s.
    """
    for i in range(len(robots)):
        if robots[i, OUT] > 0.0:
            continue
        if robots[i, OBSTACLE] > 0.0:
            _drive(robots[i], robot.speed, robot.speed / robot.circle_radius, dt)
            continue
        left = dt
        while left > 0.0:
            _begin_what_is_due(robots[i], offsets[i], robot)
            left -= _until_next_event(robots[i], robot, left)


@compiled
def bump(state: Mat, robot: GroundRobot) -> bool:
    """Hit the bumper of one robot (SIZE,); say whether it reacts."""
    reacts = _spin(state, robot.spin_time)
    state[BUMPS] += 1.0 if reacts else 0.0
    return reacts


@compiled
def touch(state: Mat, robot: GroundRobot) -> bool:
    """Touch one robot (SIZE,) on top; say whether it reacts."""
    reacts = _spin(state, 0.25 * robot.spin_time)
    state[TOUCHES] += 1.0 if reacts else 0.0
    return reacts


@compiled
def _spin(state: Mat, duration: float) -> bool:
    if state[OBSTACLE] > 0.0 or state[SPIN_LEFT] > 0.0:
        return False
    state[SPIN_LEFT] = duration
    state[TURN_LEFT] = 0.0
    return True


@compiled
def _begin_what_is_due(state: Mat, offsets: Mat, robot: GroundRobot) -> None:
    if state[SPIN_LEFT] > 0.0:
        return
    if state[REVERSAL_IN] <= 0.0:
        state[REVERSAL_IN] += robot.reversal_every
        _spin(state, robot.spin_time)
    elif state[TURN_IN] <= 0.0:
        state[TURN_IN] += robot.turn_every
        state[TURN_LEFT] = robot.turn_time
        state[OFFSET] = offsets[min(int(state[TURNS]), len(offsets) - 1)]
        state[TURNS] += 1.0


@compiled
def _until_next_event(state: Mat, robot: GroundRobot, left: float) -> float:
    """Move one robot until something begins or ends, at most by `left`; return by how much (s)."""
    if state[SPIN_LEFT] > 0.0:
        step = min(left, float(state[SPIN_LEFT]))
        _drive(state, 0.0, math.pi / robot.spin_time, step)
        state[SPIN_LEFT] = _less(state[SPIN_LEFT], step)
    else:
        step = min(left, float(state[REVERSAL_IN]), float(state[TURN_IN]))
        rate = 0.0
        if state[TURN_LEFT] > 0.0:
            step = min(step, float(state[TURN_LEFT]))
            rate = 2.0 * state[OFFSET] / robot.wheel_base
            state[TURN_LEFT] = _less(state[TURN_LEFT], step)
        _drive(state, robot.speed, rate, step)
    state[REVERSAL_IN] = _less(state[REVERSAL_IN], step)
    state[TURN_IN] = _less(state[TURN_IN], step)
    return step


@compiled
def _less(remaining: float, step: float) -> float:
    """Return what remains; what rounding leaves of the very end is nothing."""
    rest = remaining - step
    return 0.0 if abs(rest) < 1e-12 else rest


@compiled
def _drive(state: Mat, speed: float, rate: float, dt: float) -> None:
    """Drive along an arc, P4 (24) to (26), integrated exactly."""
    half = 0.5 * rate * dt
    chord = speed * dt * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    state[NORTH] += chord * math.cos(state[HEADING] + half)
    state[EAST] += chord * math.sin(state[HEADING] + half)
    state[HEADING] += 2.0 * half
