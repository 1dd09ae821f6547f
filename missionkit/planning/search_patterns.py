"""Search patterns about a datum, the place where something was last.

Source: IMO and ICAO, IAMSAR Manual, volume II, chapter 5: expanding square (SS), sector (VS).
"""

from __future__ import annotations

import math

from missionkit.messages.occupancy import Spot

MOST_LEGS = 2_000


def expanding_square(spacing: float, outer: float, heading: float, turn: int) -> list[Spot]:
    """Return the corners of an expanding square about the origin: legs of s, s, 2s, 2s, 3s, ...

    It ends when the square reaches `outer` on all sides.

    Args:
        spacing: s, m, between neighbouring legs.
        outer: m, from the datum to the last legs.
        heading: rad, of the first leg.
        turn: 1 to the right, -1 to the left.

    Raises:
        ValueError: it would have too many legs.
    """
    rings = max(1, math.ceil(outer / spacing - 1e-9))
    if 4 * rings > MOST_LEGS:
        raise ValueError(
            f"a square out to {outer:g} m at a spacing of {spacing:g} m has {4 * rings} legs: "
            f"at most {MOST_LEGS}"
        )
    row, at = [(0.0, 0.0)], (0.0, 0.0)
    for leg in range(4 * rings + 1):
        length = spacing * (min(leg, 4 * rings - 1) // 2 + 1)
        course = heading + turn * leg * 0.5 * math.pi
        at = at[0] + length * math.cos(course), at[1] + length * math.sin(course)
        row.append(at)
    return row


def sector(radius: float, heading: float, turn: int, passes: int = 1) -> list[Spot]:
    """Return the corners of a sector search: three equilateral triangles that meet at the datum.

    Each leg is a radius long, each turn 120 degrees to the same side; the datum is crossed three
    times, the last time at the end. A second pass is turned by 30 degrees.

    Args:
        radius: m.
        heading: rad, of the first leg.
        turn: 1 to the right, -1 to the left.
        passes: how often, each turned against the one before.
    """
    row = [(0.0, 0.0)]
    for count in range(passes):
        first = heading + turn * math.radians(30.0) * count
        for triangle in range(3):
            for corner in (4, 5):  # sixths of a turn; the two outer corners of a triangle
                at = first + turn * (corner - 4 + 4 * triangle) * math.pi / 3.0
                row.append((radius * math.cos(at), radius * math.sin(at)))
            row.append((0.0, 0.0))
    return row
