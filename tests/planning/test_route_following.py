"""Following a route, flown by a body that answers late."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from samples import calm

from missionkit.planning.route_following import OnRoute, RoutePoint, follow, time_of

TICK = 0.05
START = (0.0, 0.0, -10.0)


def flown(route, seconds=200.0, start=START, blocked=(1e9, 1e9)):
    """Return times, places, speeds and what was reached; between `blocked` (s) it flies away."""
    p, v = np.array(start), np.zeros(3)
    on, rows, reached = OnRoute(start, 0.0), [], []
    for n in range(round(seconds / TICK)):
        now = n * TICK
        if blocked[0] <= now < blocked[1]:
            v = np.array((0.0, 3.0, 0.0))
            p = p + TICK * v
            continue
        it = follow(route, on, calm(now=now, position=p, velocity=v))
        on = it.on
        wanted = 0.9 * (it.position - p) + (0.0 if it.velocity is None else it.velocity)
        wanted *= min(1.0, it.speed / max(1e-9, np.linalg.norm(wanted)))
        v = v + (wanted - v) * TICK / 0.3
        p = p + TICK * v
        rows.append((now, *p, np.linalg.norm(v)))
        if it.reached is not None:
            reached.append((now, it.reached))
            if it.reached + 1 == len(route):
                break
    return np.array(rows), reached


def off(places, corners):
    """Distance of each place from a row of straight legs."""
    best = np.full(len(places), np.inf)
    for a, b in pairwise(map(np.array, corners)):
        way = b - a
        share = np.clip((places - a) @ way / (way @ way), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(places - a - share[:, None] * way, axis=1))
    return best


SQUARE = [(50.0, 0.0, -10.0), (50.0, 50.0, -10.0), (0.0, 50.0, -20.0), (0.0, 0.0, -10.0)]


@pytest.mark.parametrize("radius", [0.5, 3.0, 8.0])
def test_corners_are_cut_by_no_more_than_their_radius_and_never_too_fast(radius):
    route = [RoutePoint(at, 6.0, radius=radius) for at in SQUARE]
    rows, reached = flown(route)
    assert [at for _, at in reached] == [0, 1, 2, 3]
    assert off(rows[:, 1:4], [START, *SQUARE]).max() < 0.5 * radius + 0.5
    assert rows[:, 4].max() < 6.1
    by_radius = {0.5: 1.5, 3.0: 2.5, 8.0: 3.9}[radius]  # sqrt(1.5 r), and what a late body adds
    corners = rows[[np.abs(rows[:, 0] - at).argmin() for at, _ in reached[:2]], 4]
    assert corners.max() < by_radius


def test_it_comes_to_rest_where_it_is_to_stop():
    route = [RoutePoint(at, 6.0, stop=at == SQUARE[1]) for at in SQUARE]
    rows, reached = flown(route)
    at = {which: when for when, which in reached}[1]
    there = rows[np.abs(rows[:, 0] - at).argmin() - 1]
    assert there[4] < 0.5
    assert math.dist(there[1:4], SQUARE[1]) < 1.0


def test_a_steep_leg_is_flown_as_fast_as_the_vehicle_climbs_and_descends():
    up, down = (0.0, 5.0, -60.0), (0.0, 10.0, -10.0)
    rows, _ = flown([RoutePoint(up, 8.0), RoutePoint(down, 8.0)])
    sinking = np.diff(rows[:, 3]) / TICK
    assert sinking.min() > -2.2
    assert sinking.max() < 1.4
    assert off(rows[:, 1:4], [START, up, down]).max() < 1.0


def test_a_flight_that_was_interrupted_goes_on_a_little_before_that():
    route = [RoutePoint(at, 6.0) for at in SQUARE]
    rows, reached = flown(route, blocked=(6.0, 20.0))
    assert [at for _, at in reached] == [0, 1, 2, 3]
    left = rows[rows[:, 0] < 6.0][-1, 1]
    after = rows[rows[:, 0] >= 20.0]
    back = np.flatnonzero(np.abs(after[:, 2]) < 1.0)[0]
    assert after[back, 1] == pytest.approx(left - 3.0, abs=1.5)
    end = np.flatnonzero(after[:, 1] > 45.0)[0]
    assert np.abs(after[back:end, 2]).max() < 1.0  # what was missed is flown on the line


def test_places_that_are_the_same_and_legs_that_turn_back_are_flown():
    there = (20.0, 0.0, -10.0)
    rows, reached = flown([RoutePoint(it, 5.0) for it in (START, there, there, START, there)])
    assert [at for _, at in reached] == [0, 1, 2, 3, 4]
    assert rows[:, 1].max() < 21.0


@pytest.mark.parametrize("speed", [2.0, 6.0])
def test_the_time_of_a_route_is_known_before(speed):
    route = [RoutePoint(at, speed) for at in SQUARE]
    _, reached = flown(route)
    assert time_of(route, START) == pytest.approx(reached[-1][0], rel=0.15)
