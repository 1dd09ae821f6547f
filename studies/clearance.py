"""Clearance of a flight from the obstacles in its way."""

from __future__ import annotations

import numpy as np

from missionkit.geometry import Mat
from missionkit.sim.obstacle_distance import nearest_gap, table
from missionkit.sim.world import Marker, World


def on_the_way(world: World, marker: Marker, positions: Mat) -> float:
    """Return the least clearance (m) from the obstacles other than the one under the marker.

    Working at the marker brings the vehicle close to what carries it; this leaves it out, so that
    what remains is how obstacles are passed. Infinite where nothing else stands.

    Args:
        world: obstacles and the vehicle's radius.
        marker: the one that the mission works at.
        positions: (N, 3), m, NED, true.
    """
    things = table(world)
    if not len(things):
        return np.inf
    north, east, down = marker.position
    gaps = [nearest_gap(thing[None], north, east, -down) for thing in things]
    others = np.delete(things, int(np.argmin(gaps)), axis=0)
    nearest = min(nearest_gap(others, n, e, -d) for n, e, d in positions.tolist())
    return float(nearest) - world.quadrotor.radius
