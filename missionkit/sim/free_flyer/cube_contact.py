"""Contact of two cubes, and what it does to the chaser.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat, Vec3, to_matrix
from missionkit.jit import compiled
from missionkit.sim.free_flyer import flyer_layout as at
from missionkit.sim.free_flyer.flyer_layout import DockGeometry, Flyer

matrix_of = compiled(to_matrix)


@compiled
def axis(n: int, axes: Mat, others: Mat, line: Vec3) -> bool:
    """Write the n-th unit axis that may separate two cubes into `line`; False if it is none.

    Three of each cube, then the products of an edge of one with an edge of the other.

    Args:
        n: 0 to 14.
        axes: (3, 3), a cube's axes as columns, world.
        others: (3, 3), the other's.
        line: (3,), overwritten.
    """
    for c in range(3):
        if n < 3:
            line[c] = axes[c, n]
        elif n < 6:
            line[c] = others[c, n - 3]
        else:
            a, b = (n - 6) // 3, (n - 6) % 3
            d, e = (c + 1) % 3, (c + 2) % 3
            line[c] = axes[d, a] * others[e, b] - axes[e, a] * others[d, b]
    size = math.sqrt(line[0] * line[0] + line[1] * line[1] + line[2] * line[2])
    if size < 1e-6:  # parallel edges: the faces' axes decide
        return False
    for c in range(3):
        line[c] /= size
    return True


@compiled
def reach(line: Vec3, axes: Mat, half: float) -> float:
    """Return how far (m) a cube reaches from its centre along a unit axis.

    Args:
        line: (3,), unit, world.
        axes: (3, 3), the cube's axes as columns, world.
        half: of an edge, m.
    """
    total = 0.0
    for c in range(3):
        total += abs(line[0] * axes[0, c] + line[1] * axes[1, c] + line[2] * axes[2, c])
    return half * total


@compiled
def overlap(offset: Vec3, axes: Mat, half: float, others: Mat, other: float, push: Vec3) -> float:
    """Return how deep (m) two cubes overlap, 0 if they do not.

    They do not if their shadows on one of 15 axes are apart. `push` becomes the unit axis of least
    overlap, from the other cube to this one.
    Source: Gottschalk, Lin, Manocha, "OBBTree", SIGGRAPH 1996, section 5.

    Args:
        offset: (3,), m, from the other's centre to this one's.
        axes: (3, 3), this cube's axes as columns.
        half: m, half its side.
        others: (3, 3), the other's axes.
        other: m, half its side.
        push: (3,) result.
    """
    least = math.inf
    line = np.empty(3)
    for n in range(15):
        if not axis(n, axes, others, line):
            continue
        apart = line[0] * offset[0] + line[1] * offset[1] + line[2] * offset[2]
        depth = reach(line, axes, half) + reach(line, others, other) - abs(apart)
        if depth <= 0.0:
            return 0.0
        if depth < least:
            least = depth
            for c in range(3):
                push[c] = line[c] if apart >= 0.0 else -line[c]
    return least


@compiled
def in_corridor(x: Vec3, dock: DockGeometry) -> bool:
    """Tell whether the chaser is in the docking corridor; `Corridor.sideways` for kernels."""
    along = aside = 0.0
    for c in range(3):
        along += (x[c] - dock.place[c]) * dock.normal[c]
    for c in range(3):
        aside += (x[c] - dock.place[c] - along * dock.normal[c]) ** 2
    wide = dock.radius + dock.slope * max(0.0, along)
    return -dock.depth <= along <= dock.length and aside <= wide * wide


@compiled
def touch(x: Vec3, memory: Vec3, body: Flyer, dock: DockGeometry) -> None:
    """Take the gap to the target, and keep the chaser out of it.

    A slow touch in the corridor stops the motion into the target, without rebound and friction.
    Any other touch is a crash: the chaser stops there, and its thrusters are off.

    Args:
        x: (13,) state of the chaser, changed in place.
        memory: by `flyer_layout`; clearance and crash are noted in it.
        body: the chaser.
        dock: the target, its corridor, and the closing speed (m/s) that is too hard.
    """
    offset = np.empty(3)
    for c in range(3):
        offset[c] = x[c] - dock.target[c]
    apart = math.sqrt(offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2])
    inside = in_corridor(x, dock)
    if not inside:
        memory[at.CLEARANCE] = min(memory[at.CLEARANCE], apart - dock.touching)
    if apart >= dock.touching or not dock.solid:
        return
    push = np.empty(3)
    depth = overlap(offset, matrix_of(x[6:10]), body.half, dock.axes, dock.half, push)
    if depth <= 0.0:
        return
    speed = x[3] * push[0] + x[4] * push[1] + x[5] * push[2]
    for c in range(3):
        x[c] += depth * push[c]
        x[3 + c] -= min(0.0, speed) * push[c]
    if not inside or speed < -dock.hard:
        memory[at.CRASHED], memory[at.ARMED] = 1.0, 0.0
