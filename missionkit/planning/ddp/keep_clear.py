"""Obstacles for a plan: what a scan sees, walls of a map, and targets that move."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import lru_cache

import numpy as np

from missionkit.geometry import Mat
from missionkit.messages import Occupancy, Spot, Target
from missionkit.planning.ddp.point_mass import Obstacle

SPACING = 0.3  # m, of two places nearer than that one counts
MOST = 60  # places of one kind that a plan keeps clear of: the nearest


def standing(places: Mat, here: Spot, reach: float, radius: float) -> Iterator[Obstacle]:
    """Yield obstacles at the nearest places, thinned.

    Args:
        places: (n, 2), m, north and east, of any number.
        here: of the vehicle.
        reach: m, beyond which none matters.
        radius: m, to be kept from each.
    """
    gaps = np.hypot(*(places - here).T)
    near = np.flatnonzero(gaps <= reach)  # what is not finite is not near
    near = near[np.argsort(gaps[near], kind="stable")]
    _, first = np.unique(np.floor(places[near] / SPACING), axis=0, return_index=True)
    for north, east in places[near[np.sort(first)[:MOST]]].tolist():
        yield no_nearer(Obstacle((north, east), (0.0, 0.0), radius), here)


@lru_cache(maxsize=2)
def walls(known: Occupancy) -> Mat:
    """Return the middles (n, 2), m, of a map's blocked cells."""
    cells = np.argwhere(np.isinf(known.costs)) + 0.5
    return np.array([known.spot(row, column) for row, column in cells.tolist()]).reshape(-1, 2)


def half_diagonal(known: Occupancy) -> float:
    """Return how far (m) a blocked cell reaches from its middle."""
    return known.resolution * math.sqrt(0.5)


def moving(targets: Iterable[Target], here: Spot, radius: float) -> Iterator[Obstacle]:
    """Yield targets as obstacles that keep their velocity.

    Args:
        targets: with a velocity if they are tracked.
        here: of the vehicle, m, north and east.
        radius: m, to be kept between the centres, beside one standard deviation of the place.
    """
    for target in targets:
        north, east, _ = target.position.tolist()
        speed = (0.0, 0.0) if target.velocity is None else tuple(target.velocity[:2].tolist())
        sure = radius + target.position_sd
        if math.isfinite(north + east + speed[0] + speed[1] + sure):
            yield no_nearer(Obstacle((north, east), (speed[0], speed[1]), sure), here)


def no_nearer(obstacle: Obstacle, here: Spot) -> Obstacle:
    """Return the obstacle with a radius that leads a vehicle inside it no nearer."""
    gap = math.dist(obstacle.place, here)
    return obstacle if gap >= obstacle.radius else obstacle._replace(radius=gap)
