"""Where robots may be that a vehicle sees only now and then: particles with a clock each.

Imported late: it compiles kernels. `P` is (robots, particles, SIZE): states of `robot_forecast` and
whether the robot has left the arena. A particle drives as a robot does: random turns at the
boundaries of its clock, reversals, out of the arena.

- A sighting of a robot keeps the particles that agree with it, and with whether it spins; their
  place and heading become what was seen, their clocks stay. This is how clocks are learnt.
- A place that is in view and shows no robot loses its particles.
- Where none is left the robot may be anywhere, or has any clock.

Source: N. Gordon, D. Salmond, A. Smith, "Novel approach to nonlinear/non-Gaussian Bayesian state
estimation", 1993.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled
from missionkit.planning.herding.robot_forecast import (
    HEADING,
    INSIDE,
    REVERSAL_IN,
    SPIN_LEFT,
    X,
    Y,
    forecast,
)

GONE = 5  # not 0: it has left the arena
SIZE = 6
Seeds = npt.NDArray[np.uint64]  # (1,), state of the generator
PLACE_SD = 0.3  # m, how far a particle may be off a sighting
HEADING_SD = 0.3  # rad
SPIN_SLACK = 0.7  # s, in which a spin that begins or ends says nothing


@compiled
def uniform(seeds: Seeds) -> float:
    """Return the next of a series of numbers in [0, 1).  Source: G. Steele, SplitMix, 2014."""
    seeds[0] += np.uint64(0x9E3779B97F4A7C15)
    z = seeds[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return float((z ^ (z >> np.uint64(31))) >> np.uint64(11)) / 9007199254740992.0


@compiled
def move(P: Mat, dt: float, half: float, robot: GroundRobot, seeds: Seeds) -> None:
    """Move all particles in place.

    Args:
        P: of all robots.
        dt: s, less than 5.
        half: m, of the arena's side.
        robot: how it drives.
        seeds: of the generator.
    """
    largest = 2.0 * robot.turn_offset * robot.turn_time / robot.wheel_base
    every = robot.turn_every
    for r in range(P.shape[0]):
        for i in range(P.shape[1]):
            it = P[r, i]
            if it[GONE] > 0.0:
                continue
            before = math.floor(it[REVERSAL_IN] / every)
            if forecast(it, dt, half, robot) != INSIDE:
                it[GONE] = 1.0
            if math.floor(it[REVERSAL_IN] / every) != before:
                it[HEADING] += largest * (2.0 * uniform(seeds) - 1.0)


@compiled
def agreement(P: Mat, seen: Mat) -> float:
    """Return how well a robot's particles (n, SIZE) agree with a sighting (x, y, heading).

    0 to 1; a little more for a robot that may be anywhere.
    """
    total = 1e-4 * float(P[:, X].std() + P[:, Y].std())
    for it in P:
        if it[GONE] == 0.0:
            total += _alike(it, seen)
    return total / len(P)


@compiled
def _alike(it: Mat, seen: Mat) -> float:
    off = (it[HEADING] - seen[2] + math.pi) % (2.0 * math.pi) - math.pi
    if it[SPIN_LEFT] > 0.0:
        off = 0.0
    square = (it[X] - seen[0]) ** 2 + (it[Y] - seen[1]) ** 2
    return math.exp(-0.5 * (square / PLACE_SD**2 + (off / HEADING_SD) ** 2))


@compiled
def found(P: Mat, seen: Mat, robot: GroundRobot, seeds: Seeds) -> None:
    """Condition a robot's particles (n, SIZE) on being found again, in place.

    Args:
        P: of one robot.
        seen: (3,), m, m, rad, where it is found.
        robot: how it drives.
        seeds: of the generator.
    """
    kept, weights = P.copy(), np.zeros(len(P))
    for i in range(len(P)):
        weights[i] = 0.0 if kept[i, GONE] > 0.0 else _alike(kept[i], seen)
    _drawn(P, kept, weights, robot, seeds)


@compiled
def follow(
    P: Mat, seen: Mat, spins: float, caused: float, robot: GroundRobot, seeds: Seeds
) -> None:
    """Condition a robot's particles (n, SIZE) on a robot in view, in place.

    Args:
        P: of one robot.
        seen: (3,), m, m, rad.
        spins: s for which it has spun, 0: it drives, NaN: it spins, not known since when.
        caused: s that the spin takes which a bump or a touch began, 0: its own clock.
        robot: how it drives.
        seeds: of the generator.
    """
    kept, weights = P.copy(), np.zeros(len(P))
    for i in range(len(P)):
        it = kept[i]
        spun = robot.spin_time - it[SPIN_LEFT] if it[SPIN_LEFT] > 0.0 else 0.0
        fits = caused > 0.0 or abs(spun - spins) < SPIN_SLACK or _soon(it, spins, robot)
        if math.isnan(spins):
            fits = it[SPIN_LEFT] > 0.0 or it[REVERSAL_IN] < SPIN_SLACK
        weights[i] = 1.0 if fits and it[GONE] == 0.0 else 0.0
    _drawn(P, kept, weights, robot, seeds)
    for it in P:
        it[X], it[Y], it[HEADING], it[GONE] = seen[0], seen[1], seen[2], 0.0
        if spins > 0.0 and caused > 0.0:
            it[SPIN_LEFT] = max(0.0, caused - spins)
        elif spins > 0.0:
            it[REVERSAL_IN] = robot.reversal_every - spins
            it[SPIN_LEFT] = max(0.0, robot.spin_time - spins)
        elif spins == 0.0 and it[SPIN_LEFT] < robot.spin_time - SPIN_SLACK:
            it[SPIN_LEFT] = 0.0


@compiled
def _soon(it: Mat, spins: float, robot: GroundRobot) -> bool:
    """Say whether the clock of a particle is about to say what is seen already."""
    ahead = it[REVERSAL_IN] < SPIN_SLACK and 0.0 < spins < 2.0 * SPIN_SLACK
    ending = spins > robot.spin_time - SPIN_SLACK and it[SPIN_LEFT] == 0.0
    return ahead or ending


@compiled
def _drawn(P: Mat, kept: Mat, weights: Mat, robot: GroundRobot, seeds: Seeds) -> None:
    """Draw particles by their weights, evenly spaced; of none, clocks of which nothing is known."""
    total = weights.sum()
    if total < 1e-6:
        for it in P:
            it[GONE], it[SPIN_LEFT] = 0.0, 0.0
            it[REVERSAL_IN] = robot.reversal_every * uniform(seeds)
        return
    step = total / len(P)
    at, j, sum_so_far = step * uniform(seeds), 0, weights[0]
    for i in range(len(P)):
        while sum_so_far < at and j < len(P) - 1:
            j += 1
            sum_so_far += weights[j]
        P[i] = kept[j]
        at += step


@compiled
def unseen(P: Mat, spot: Mat, sight: float, half: float, robot: GroundRobot, seeds: Seeds) -> None:
    """Condition a robot's particles (n, SIZE) on not being in view, in place.

    Args:
        P: of one robot.
        spot: (2,), m, on the floor below the vehicle.
        sight: m, around it, in which a robot would be seen for sure.
        half: m, of the arena's side.
        robot: how it drives.
        seeds: of the generator.
    """
    kept, weights = P.copy(), np.ones(len(P))
    hidden = True
    for i in range(len(P)):
        it = kept[i]
        if it[GONE] == 0.0 and math.hypot(it[X] - spot[0], it[Y] - spot[1]) < sight:
            weights[i], hidden = 0.02, False
    if hidden:
        return
    _drawn(P, kept, weights, robot, seeds)
    for it in P:
        if it[GONE] == 0.0 and math.hypot(it[X] - spot[0], it[Y] - spot[1]) < sight:
            it[X], it[Y] = half * (2.0 * uniform(seeds) - 1.0), half * (2.0 * uniform(seeds) - 1.0)
            it[HEADING] = 2.0 * math.pi * uniform(seeds)


@compiled
def densest(P: Mat, sight: float) -> tuple[int, float]:
    """Return which particle (n, SIZE) has most others within sight, and their share.

    Every sixth is tried and every second counted; -1: all have left.
    """
    best, most = -1, 0
    for i in range(0, len(P), 6):
        if P[i, GONE] > 0.0:
            continue
        near = 0
        for j in range(0, len(P), 2):
            dx, dy = P[j, X] - P[i, X], P[j, Y] - P[i, Y]
            if P[j, GONE] == 0.0 and dx * dx + dy * dy < sight * sight:
                near += 1
        if near > most:
            best, most = i, near
    return best, most / ((len(P) + 1) // 2)


@compiled
def near(P: Mat, which: int, sight: float, most: int) -> Mat:
    """Return one particle and up to `most` (m, SIZE) spread over those within sight of it.

    Args:
        P: of one robot.
        which: of the particles.
        sight: m.
        most: how many.
    """
    count = 0
    chosen = np.zeros(len(P), dtype=np.int64)
    for j in range(len(P)):
        away = math.hypot(P[j, X] - P[which, X], P[j, Y] - P[which, Y])
        if P[j, GONE] == 0.0 and away < sight:
            chosen[count] = j
            count += 1
    kept = min(count, most)
    found = np.zeros((1 + kept, P.shape[1]))
    found[0] = P[which]
    for k in range(kept):
        found[1 + k] = P[chosen[k * count // kept]]
    return found
