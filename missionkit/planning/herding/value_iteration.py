"""The chance that one ground robot comes home, if somebody turns it at a price: value iteration.

Imported late: it compiles kernels. Time runs in steps of 5 s, from one random turn of the robot
to the next; its clock reverses it at every fourth. With k steps left, at place x, y and heading h
(arena axes), before the turn or reversal of that moment,

    V_k(x, y, h) = max over actions a of  E[V_{k-1}(next)] - price(a),   V_0 = 0;

V is 1 for a robot that has crossed the goal line and 0 for one that has left the arena elsewhere.
Actions: none; a bump, which turns it by 180 deg; n touches, each of which turns it by 45 deg
clockwise. The random turn is uniform, taken at `NODES` midpoints; V is interpolated linearly.

Source: a Lagrangian relaxation of the one vehicle that all robots share, as in P. Whittle,
"Restless bandits", 1988; the robots by correction P4.5.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled
from missionkit.planning.herding.robot_forecast import HOME, INSIDE, crossed

Table = npt.NDArray[np.float32]
NODES = 5


@compiled
def values(
    steps: int, cells: int, headings: int, half: float, prices: tuple[float, float], it: GroundRobot
) -> Table:
    """Return V, (steps + 1, headings, cells, cells) for k, h, x, y, in float32.

    Args:
        steps: of 5 s.
        cells: nodes along each axis of the arena, both edges included.
        headings: of the circle; divisible by 8, so that touches lead from node to node.
        half: m, of the arena's side.
        prices: of a bump and of a touch; infinite: not done.
        it: how the robot drives.
    """
    V = np.zeros((steps + 1, headings, cells, cells), dtype=np.float32)
    drives = np.zeros((5, headings, cells, cells), dtype=np.float32)
    times = _times(it)
    for k in range(1, steps + 1):
        for way in range(5):
            if way < 3 or prices[1] < math.inf:
                _expected(V[k - 1], drives[way], times[way], half, it)
        for h in range(headings):
            back = (h + headings // 2) % headings
            if k % 4 == 0:  # its own reversal; a bump before or after it turns it once more
                V[k, h] = np.maximum(drives[1, back], drives[2, h] - np.float32(prices[0]))
            else:
                V[k, h] = np.maximum(drives[0, h], drives[1, back] - np.float32(prices[0]))
            if k % 4 != 0 and prices[1] < math.inf:
                _touched(V[k, h], drives, h, prices[1])
    return V


@compiled
def _times(it: GroundRobot) -> tuple[float, float, float, float, float]:
    """Return how long (s) a robot drives in a step: all of it, after one spin, two, touches."""
    whole, quarter = it.turn_every, 0.25 * it.spin_time
    return (whole, whole - it.spin_time, 0.0, whole - quarter, max(0.0, whole - 2.0 * quarter))


@compiled
def _touched(best: Table, drives: Table, h: int, price: float) -> None:
    """Take n touches at the begin of a step where they are worth more."""
    headings = len(drives[0])
    eighth = headings // 8
    one = drives[3, (h + eighth) % headings] - np.float32(price)
    two = drives[4, (h + 2 * eighth) % headings] - np.float32(2.0 * price)
    best[:] = np.maximum(best, np.maximum(one, two))


@compiled
def _expected(later: Table, found: Table, time: float, half: float, it: GroundRobot) -> None:
    """Fill `found` (h, x, y) with E[V] after a random turn and `time` s of driving at h."""
    headings = len(later)
    largest = 2.0 * it.turn_offset * it.turn_time / it.wheel_base
    turning = min(time, it.turn_time)
    for h in range(headings):
        found[h, :, :] = 0.0
        for node in range(NODES):
            turn = largest * (2.0 * (node + 0.5) / NODES - 1.0)
            before = 2.0 * math.pi * h / headings
            straight = time - turning
            mid, after = before + 0.5 * turn, before + turn
            dx = it.speed * (turning * math.cos(mid) + straight * math.cos(after))
            dy = it.speed * (turning * math.sin(mid) + straight * math.sin(after))
            _shifted(later, found[h], (dx, dy, after), half)


@compiled
def _shifted(later: Table, found: Table, way: tuple[float, float, float], half: float) -> None:
    """Add to `found` (x, y) a share of V after the way (m, m) at a heading (rad)."""
    dx, dy, heading = way
    cells = len(found)
    size = 2.0 * half / (cells - 1)
    share = np.float32(1.0 / NODES)
    for i in range(cells):
        x = i * size - half
        for j in range(cells):
            y = j * size - half
            where = crossed(x, y, dx, dy, half)
            if where == INSIDE:
                found[i, j] += share * interpolated(later, x + dx, y + dy, heading, half)
            elif where == HOME:
                found[i, j] += share


@compiled
def interpolated(V: Table, x: float, y: float, heading: float, half: float) -> float:
    """Return V between its nodes.

    Args:
        V: (h, x, y), of one step.
        x: m, place in the arena.
        y: m.
        heading: rad.
        half: m, of the arena's side.
    """
    headings, cells = V.shape[0], V.shape[1]
    u = (x + half) / (2.0 * half) * (cells - 1)
    v = (y + half) / (2.0 * half) * (cells - 1)
    w = heading / (2.0 * math.pi) * headings
    i = min(max(math.floor(u), 0), cells - 2)
    j = min(max(math.floor(v), 0), cells - 2)
    floor = math.floor(w)
    u, v, w = u - i, v - j, w - floor
    total = 0.0
    for turn in range(2):
        plane = V[(floor + turn) % headings]
        near = (1.0 - v) * plane[i, j] + v * plane[i, j + 1]
        far = (1.0 - v) * plane[i + 1, j] + v * plane[i + 1, j + 1]
        total += (w if turn else 1.0 - w) * ((1.0 - u) * near + u * far)
    return total
