"""A behaviour whose vehicle something else has flown away for a while continues where it was."""

from __future__ import annotations

import math

import numpy as np
import pytest
from flying import Flown, fly, places
from playing import marker

from missionkit.behaviors.area_search import ExpandingSquare
from missionkit.behaviors.climb import Climb
from missionkit.behaviors.loiter import Loiter
from missionkit.behaviors.orbit import Orbit
from missionkit.behaviors.point_at import PointAt
from missionkit.behaviors.spiral import Spiral
from missionkit.behaviors.waypoints import Waypoints

TOWER = {"tower": marker(20.0, 10.0, -8.0), "mast": marker(0.0, 10.0, -8.0)}
START = (14.0, 10.0, -8.0)
AWAY = 15.0  # s, at 2 m/s


def flight(behavior, absent: tuple[float, float] = (1e9, 1e9), seconds: float = 80.0):
    return fly(behavior, START, seconds, lambda _: TOWER, absent=absent)


def off(some: np.ndarray, line: np.ndarray) -> float:
    """Return how far (m) the farthest of some places is from a line of places."""
    gaps = np.linalg.norm(some[:, None, :] - line[None, :, :], axis=2)
    return float(gaps.min(axis=1).max())


def counted(flown: list[Flown], middle: float) -> list[Flown]:
    """Return the ticks without the way back: from when it is where it was interrupted."""
    after = [it for it in flown if it.seen.now > middle]
    left = places([it for it in flown if it.seen.now <= middle])[-1]
    gaps = [math.dist(it.seen.position, left) for it in after]
    back = next(count for count, gap in enumerate(gaps) if gap < 1.5)
    return [it for it in flown if it.seen.now <= middle] + after[back:]


@pytest.mark.parametrize(
    ("behavior", "seconds"),
    [
        (Orbit(target="tower", radius=6.0, turns=1.5), 80.0),
        (Orbit(target="tower", radius=6.0, turns=1, height=8, to_height=16), 80.0),
        (Orbit(target="tower", radius=6.0, seconds=12), 80.0),
        (Spiral(target="tower", back=0, speed=1.0), 20.0),
        (ExpandingSquare(spacing=3, outer=6), 80.0),
        (Climb(height=20), 80.0),
        (PointAt(target="mast", within_deg=0.5), 80.0),
        (Loiter(seconds=9), 80.0),
        (Waypoints(places=[{"at": START, "wait": 9}]), 80.0),
    ],
)
def test_what_was_flown_before_and_after_is_the_whole(behavior, seconds):
    whole = flight(behavior, seconds=seconds)
    middle = 0.4 * whole[-1].seen.now
    flown = flight(behavior, (middle, middle + AWAY), seconds + 3.0 * AWAY)
    assert flown[-1].step.done == whole[-1].step.done
    done = counted(flown, middle)
    assert off(places(whole), places(done)) < 1.4  # of an orbit by time: its end
    if whole[-1].step.done:
        assert len(done) == pytest.approx(len(whole), abs=60)
