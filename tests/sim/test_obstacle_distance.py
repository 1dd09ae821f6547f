from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.sim.obstacle_distance import (
    cast,
    gap,
    nearest_gap,
    ring,
    table,
)
from missionkit.sim.world import Box, Cylinder, Sphere, World

WORLD = World(
    world="shapes",
    obstacles=(
        Cylinder(use="cylinder", at=(5.0, 1.0), radius=1.0, height=4.0),
        Box(use="box", min=(-4.0, -6.0), max=(-2.0, 6.0), height=3.0, bottom=1.0),
        Sphere(use="sphere", at=(2.0, -5.0, -3.0), radius=1.5),
    ),
)
THINGS = table(WORLD)


def march(start: np.ndarray, way: np.ndarray, reach: float = 30.0) -> float:
    """Sphere tracing: an independent way to where the ray first touches."""
    far = 0.0
    while far < reach:
        n, e, d = start + far * way
        step = nearest_gap(THINGS, n, e, -d)
        if step < 1e-7:
            return far
        far += step
    return math.inf


def test_rays_agree_with_sphere_tracing(rng: np.random.Generator) -> None:
    hits = 0
    for _ in range(800):
        start = rng.uniform((-8, -8, -5), (8, 8, 0))
        if nearest_gap(THINGS, start[0], start[1], -start[2]) < 0:
            continue
        way = rng.standard_normal(3)
        way /= np.linalg.norm(way)
        expected = march(start, way)
        assert cast(THINGS, start, way) == pytest.approx(expected, abs=1e-4)
        hits += math.isfinite(expected)
    assert hits > 60


def test_distances_agree_with_sampled_surfaces(rng: np.random.Generator) -> None:
    angle, z = rng.uniform(0, 2 * math.pi, 40000), rng.uniform(0, 4, 40000)
    side = np.column_stack((5 + np.cos(angle), 1 + np.sin(angle), z))
    r = np.sqrt(rng.uniform(0, 1, 40000))
    lid = np.column_stack((5 + r * np.cos(angle), 1 + r * np.sin(angle), np.full(40000, 4.0)))
    surface = np.concatenate((side, lid))
    for point in rng.uniform((2, -2, 0.5), (8, 4, 7), (30, 3)):
        nearest = np.linalg.norm(surface - point, axis=1).min()
        assert abs(gap(THINGS[0], *point)) == pytest.approx(nearest, abs=0.06)


@pytest.mark.parametrize(
    ("point", "distance"),
    [
        ((5.0, 3.0, 2.0), 1.0),
        ((5.0, 1.0, 2.0), -1.0),
        ((5.0, 5.0, 8.0), 5.0),
        ((-1.0, 0.0, 2.0), 1.0),
        ((-3.0, 0.0, 0.5), 0.5),
        ((-3.0, 0.0, 2.5), -0.5),
        ((2.0, -5.0, 5.0), 0.5),
    ],
)
def test_known_distances(point: tuple[float, float, float], distance: float) -> None:
    assert nearest_gap(THINGS, *point) == pytest.approx(distance)


def test_scan_sees_the_cylinder_ahead_where_it_is() -> None:
    points = ring(THINGS, np.array([0.0, 1.0, -2.0]), 0.0, 12.0, np.zeros(72))
    assert points[0] == pytest.approx([4.0, 0.0, 0.0], abs=1e-9)
    assert np.abs(points[:, 2]).max() == 0.0


def test_scan_does_not_see_beyond_its_reach_or_over_the_top() -> None:
    start = np.array([0.0, 1.0, -2.0])
    near = ring(THINGS, start, 0.0, 3.0, np.zeros(72))
    assert np.linalg.norm(near, axis=1).max() <= 3.0
    assert len(ring(THINGS, np.array([0.0, 1.0, -9.0]), 0.0, 12.0, np.zeros(72))) == 0


def test_an_empty_world_is_infinitely_clear() -> None:
    empty = table(World(world="empty"))
    assert nearest_gap(empty, 0.0, 0.0, 0.0) == math.inf
    assert cast(empty, np.zeros(3), np.array([1.0, 0.0, 0.0])) == math.inf
