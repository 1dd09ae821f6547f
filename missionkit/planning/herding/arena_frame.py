"""The arena's own axes: x towards the goal line, y to its right, from the arena's centre."""

from __future__ import annotations

import math

from missionkit.messages.herd import Arena

Spot = tuple[float, float]


def to_arena(arena: Arena, spot: Spot) -> Spot:
    """Return x towards the goal line and y to the right of it (m) of a place north, east (m)."""
    n, e = spot[0] - arena.north, spot[1] - arena.east
    c, s = math.cos(arena.goal), math.sin(arena.goal)
    return c * n + s * e, c * e - s * n


def from_arena(arena: Arena, spot: Spot) -> Spot:
    """Return north and east (m) of a place in the arena's axes (m)."""
    x, y = spot
    c, s = math.cos(arena.goal), math.sin(arena.goal)
    return arena.north + c * x - s * y, arena.east + s * x + c * y
