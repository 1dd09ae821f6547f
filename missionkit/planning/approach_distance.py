"""How near a behaviour may bring the vehicle to the obstacle that it works on."""

from __future__ import annotations

import numpy as np

from missionkit.geometry import Vec3
from missionkit.messages import Points
from missionkit.planning.firas import Distances

OWN_RADIUS = 1.2  # m, around a work: what stands there is what it hangs on
ROOM = 0.2  # m, that a vehicle at its goal may still move towards what it works on
LEAST_GAP = 0.1  # m, kept from the object of a task, whatever the goal


def kept_distances(points: Points, work: Vec3, goal: Vec3, body: float, full: float) -> Distances:
    """Return what is to be kept (N,), m, of each point near a work and its goal.

    Args:
        points: (N, 3), m, NED, of a scan.
        work: (3,), m, NED, that the behaviour works on.
        goal: (3,), m, NED, where it wants to be.
        body: m, radius of the vehicle.
        full: m, to be kept of everything else.
    """
    own = np.hypot(points[:, 0] - work[0], points[:, 1] - work[1]) <= OWN_RADIUS
    apart = np.hypot(points[:, 0] - goal[0], points[:, 1] - goal[1])
    asked = apart[own].min() - ROOM if own.any() else full
    least = min(full, max(body + LEAST_GAP, float(asked)))
    return np.where(own, least, full)
