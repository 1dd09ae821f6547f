"""What turning a ground robot at a certain moment is worth, by the table of `value_iteration`.

Imported late: it compiles kernels. Robots are states of `robot_forecast`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled
from missionkit.planning.herding.robot_forecast import (
    HEADING,
    HOME,
    INSIDE,
    REVERSAL_IN,
    SPIN_LEFT,
    X,
    Y,
    forecast,
)
from missionkit.planning.herding.value_iteration import Table, interpolated

SETTLED = 1e-6  # s
KEPT = 0.85  # m, from obstacle robots' centres to where it lands
UP = 2.0  # s after the turn, until it is clear of a place
NOBODY = np.zeros((0, 5))


class Timing(NamedTuple):
    """How long the vehicle takes."""

    speed: float  # m/s
    acceleration: float  # m/s²
    land: float  # s, from above the robot's way to the bump
    touch: float  # s, from above the robot to the touch
    climb: float  # s, back to the height of flight
    again: float  # s, from one touch of a robot to the next
    lead: float  # m, ahead of the robot where it lands
    reach: float  # m, that it flies level as it descends
    price: float  # of a second


class Spins(NamedTuple):
    """What turns a robot: so many spins, one after the other."""

    lasting: float  # s, each
    again: float  # s, from the begin of one to that of the next
    number: int


class Outlook(NamedTuple):
    """What is known about all robots."""

    V: Table  # of `value_iteration`
    half: float  # m, of the arena's side
    robot: GroundRobot
    others: Mat = NOBODY  # (n, 5), obstacle robots: x, y (m), heading (rad), m/s, rad/s


@compiled
def obstructed(x: float, y: float, begin: float, end: float, others: Mat) -> bool:
    """Say whether an obstacle robot comes too near to a place from one time (s) to another.

    Args:
        x: m, arena axes.
        y: m.
        begin: s from now.
        end: s from now.
        others: (n, 5), of `Outlook`.
    """
    for it in others:
        t = max(0.0, begin)
        while t <= end:
            half = 0.5 * it[4] * t
            chord = it[3] * t * (math.sin(half) / half if abs(half) > SETTLED else 1.0)
            dx = it[0] + chord * math.cos(it[2] + half) - x
            dy = it[1] + chord * math.sin(it[2] + half) - y
            if dx * dx + dy * dy < KEPT * KEPT:
                return True
            t += 0.5
    return False


@compiled
def blocked(state: Mat, at: float, timing: Timing, known: Outlook) -> bool:
    """Say whether an obstacle robot is in the way of turning a robot at a time.

    Args:
        state: (SIZE,), of the robot, now.
        at: s, of the turn.
        timing: of the vehicle.
        known: the arena and the robots.
    """
    if len(known.others) == 0:
        return False
    there = state.copy()
    forecast(there, at, known.half, known.robot)
    x = there[X] + timing.lead * math.cos(there[HEADING])
    y = there[Y] + timing.lead * math.sin(there[HEADING])
    return obstructed(x, y, at - timing.land, at + UP, known.others)


@compiled
def travel_time(distance: float, speed: float, acceleration: float) -> float:
    """Return how long (s) a flight takes, from rest to rest.

    Args:
        distance: m.
        speed: m/s, largest.
        acceleration: m/s², largest.
    """
    if distance < speed * speed / acceleration:
        return 2.0 * math.sqrt(distance / acceleration)
    return distance / speed + speed / acceleration


@compiled
def worth(state: Mat, time_left: float, known: Outlook) -> float:
    """Return the value of a robot (SIZE,), 0 to 1; the state is changed.

    Args:
        state: of the robot.
        time_left: s, of the mission.
        known: the table, the arena and the robots.
    """
    every, left = known.robot.turn_every, time_left
    for _ in range(4):
        due = state[REVERSAL_IN]
        wait = max(0.0, due - every * math.floor(due / every + SETTLED))
        free = state[SPIN_LEFT] <= wait
        step = min(left, wait if free else wait + 10.0 * SETTLED)
        where = forecast(state, step, known.half, known.robot)
        if where != INSIDE:
            return 1.0 if where == HOME else 0.0
        left -= step
        if left <= SETTLED:
            return 0.0
        if free:
            break
    return _at_turn(state, left, known)


@compiled
def _at_turn(state: Mat, left: float, known: Outlook) -> float:
    """Return V at a turn, between the two numbers of steps of the robot's clock next to `left`."""
    turns = round(state[REVERSAL_IN] / known.robot.turn_every) % 4
    cycles = (left / known.robot.turn_every - turns) / 4.0
    low = math.floor(cycles)
    total = 0.0
    for extra in range(2):
        k = turns + 4 * (low + extra)
        share = cycles - low if extra else 1.0 - (cycles - low)
        if k > 0 and share > 0.0:
            plane = known.V[min(k, turns + 4 * ((len(known.V) - 1 - turns) // 4))]
            total += share * interpolated(plane, state[X], state[Y], state[HEADING], known.half)
    return total


@compiled
def gain(state: Mat, at: float, spins: Spins, time_left: float, known: Outlook) -> float:
    """Return how much more a robot is worth if it is turned, NaN if it cannot be.

    Args:
        state: (SIZE,), now.
        at: s, until it is turned.
        spins: what turns it.
        time_left: s, of the mission.
        known: the table, the arena and the robots.
    """
    turned = state.copy()
    if at >= time_left or forecast(turned, at, known.half, known.robot) != INSIDE:
        return math.nan
    if turned[SPIN_LEFT] > 0.0 or turned[REVERSAL_IN] <= SETTLED:
        return math.nan
    left = time_left - at
    alone = worth(turned.copy(), left, known)
    turned[SPIN_LEFT] = spins.lasting
    for _ in range(spins.number - 1):
        where = forecast(turned, spins.again, known.half, known.robot)
        if where != INSIDE or turned[SPIN_LEFT] > 0.0:
            return math.nan
        left -= spins.again
        turned[SPIN_LEFT] = spins.lasting
    return worth(turned, left, known) - alone


@compiled
def meeting(state: Mat, vehicle: Mat, after: float, timing: Timing, known: Outlook) -> float:
    """Return when (s) the vehicle can turn a robot at the earliest, inf if it leaves before.

    Args:
        state: (SIZE,), of the robot.
        vehicle: (2,), m, arena axes.
        after: s, from above the robot's way to the turn.
        timing: of the vehicle.
        known: the arena and the robots.
    """
    at = after
    for _ in range(4):
        there = state.copy()
        if forecast(there, at, known.half, known.robot) != INSIDE:
            return math.inf
        x = there[X] + timing.lead * math.cos(there[HEADING])
        y = there[Y] + timing.lead * math.sin(there[HEADING])
        distance = math.hypot(x - vehicle[0], y - vehicle[1])
        level = max(0.0, distance - timing.reach)
        at = after + travel_time(level, timing.speed, timing.acceleration)
    return at


@compiled
def best_turn(
    samples: Mat,
    weights: Mat,
    vehicle: Mat,
    delays: Mat,
    time_left: float,
    touches: int,
    timing: Timing,
    known: Outlook,
) -> tuple[float, float, int]:
    """Return the best turn of a robot: net value, delay (s), touches (0: landing in front).

    The value is -inf if it cannot be turned where it most likely is, the first sample.

    Args:
        samples: (n, SIZE), states that it may be in.
        weights: (n,), their probabilities; they add up to less than 1 if it may not be found.
        vehicle: (2,), m, arena axes.
        delays: (d,), s, of the begin of the descent after the earliest.
        time_left: s, of the mission.
        touches: most touches on top; 0: it lands in front only.
        timing: of the vehicle.
        known: the table, the arena and the robots.
    """
    best, best_delay, best_way = -math.inf, 0.0, 0
    whole = known.robot.spin_time
    for way in range(touches + 1):
        after = timing.touch if way > 0 else timing.land
        earliest = meeting(samples[0], vehicle, after, timing, known)
        if earliest == math.inf:
            continue
        spins = Spins(0.25 * whole if way > 0 else whole, timing.again, max(1, way))
        busy = timing.climb + (spins.number - 1) * timing.again
        for delay in delays:
            at = earliest + delay
            if blocked(samples[0], at, timing, known):
                continue
            found = _mean_gain(samples, weights, at, spins, time_left, known)
            found -= timing.price * (at + busy)
            if found > best:
                best, best_delay, best_way = found, delay, way
    return best, best_delay, best_way


@compiled
def best_on_arrival(
    samples: Mat,
    share: float,
    vehicle: Mat,
    delays: Mat,
    time_left: float,
    touches: int,
    timing: Timing,
    known: Outlook,
) -> tuple[float, float, int]:
    """Return the value of a flight to a robot whose state is known on arrival, as `best_turn` does.

    Args:
        samples: (n, SIZE), states that it may be in, equally likely.
        share: chance that it is near there at all; else the flight was in vain.
        vehicle: (2,), m, arena axes.
        delays: (d,), s, of the begin of the descent after the earliest.
        time_left: s, of the mission.
        touches: most touches on top.
        timing: of the vehicle.
        known: the table, the arena and the robots.
    """
    away = math.hypot(samples[0, X] - vehicle[0], samples[0, Y] - vehicle[1])
    vain = -timing.price * travel_time(away, timing.speed, timing.acceleration)
    one = np.ones(1)
    total, best, delay, way = 0.0, -math.inf, 0.0, 0
    for i in range(len(samples)):
        found = best_turn(
            samples[i : i + 1], one, vehicle, delays, time_left, touches, timing, known
        )
        total += max(found[0], vain) / len(samples)
        if found[0] > best:
            best, delay, way = found
    return share * total + (1.0 - share) * vain, delay, way


@compiled
def _mean_gain(
    samples: Mat, weights: Mat, at: float, spins: Spins, time_left: float, known: Outlook
) -> float:
    total = 0.0
    for i in range(len(samples)):
        more = gain(samples[i], at, spins, time_left, known)
        if not math.isnan(more):
            total += weights[i] * more
        elif i == 0:
            return -math.inf
    return total
