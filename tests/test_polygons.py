"""Polygons on the ground, against matplotlib's paths and a brute force over sampled edges."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.path import Path

from missionkit import polygons

SQUARE = ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0))
NOTCHED = (
    (0.0, 0.0),
    (20.0, 0.0),
    (20.0, 20.0),
    (12.0, 20.0),
    (10.0, 14.0),
    (8.0, 20.0),
    (0.0, 20.0),
)


def star(rng, count):
    """Return a polygon around the origin, by increasing angle: never crossing itself."""
    turns = np.sort(rng.uniform(0.0, 2.0 * math.pi, count))
    reach = rng.uniform(2.0, 30.0, count)
    return tuple(
        zip((reach * np.cos(turns)).tolist(), (reach * np.sin(turns)).tolist(), strict=True)
    )


@pytest.mark.parametrize("seed", range(6))
def test_inside_and_distance_of_random_polygons(seed):
    rng = np.random.default_rng(seed)
    shape = star(rng, 11)
    path = Path(np.array([*shape, shape[0]]), closed=True)
    share = np.linspace(0.0, 1.0, 4001)[:, None]
    fence = np.vstack([np.array(a) + share * (np.array(b) - a) for a, b in polygons.edges(shape)])
    for spot in rng.uniform(-30.0, 30.0, (60, 2)):
        away = float(np.hypot(*(fence - spot).T).min())
        found = polygons.margin(shape, (float(spot[0]), float(spot[1])))
        assert abs(found) == pytest.approx(away, abs=1e-2)
        assert (found > 0.0) == path.contains_point(spot)


@pytest.mark.parametrize("shape", [SQUARE, SQUARE[::-1], NOTCHED, NOTCHED[::-1]])
@pytest.mark.parametrize("by", [0.5, -0.5, 0.0])
def test_widened_keeps_the_distance(shape, by):
    wider = polygons.widened(shape, by)
    inner, outer = (shape, wider) if by >= 0.0 else (wider, shape)
    assert polygons.inside_of(inner, outer)
    for a, b in polygons.edges(inner):
        middle = 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])
        assert polygons.margin(outer, middle) == pytest.approx(abs(by), abs=1e-6)
    assert (polygons.area(wider) > 0.0) == (polygons.area(shape) > 0.0)


def test_what_would_overlap_is_not_widened():
    assert polygons.widened(NOTCHED, 3.0) is None
    assert polygons.widened(SQUARE, -6.0) is None


@pytest.mark.parametrize(
    ("shape", "says"),
    [
        (SQUARE, ""),
        (NOTCHED, ""),
        (SQUARE[:2], "needs at least 3 corners, got 2"),
        ((SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]), "the edges 1 to 2 and 3 to 4 cross"),
        ((*SQUARE, SQUARE[0]), "the last corner repeats the first"),
        ((SQUARE[0], SQUARE[0], *SQUARE[1:]), "corners 1 and 2 are the same"),
        (((0.0, 0.0), (4.0, 0.0), (8.0, 0.0)), "cross"),
        (((0.0, 0.0), (5.0, 0.0), (3.0, 0.0), (5.0, 5.0)), "the edges 1 to 2 and 2 to 3 cross"),
        (tuple((math.cos(n), math.sin(n)) for n in range(600)), "may have 500 corners, got 600"),
    ],
)
def test_what_is_no_polygon(shape, says):
    found = polygons.unfit(shape)
    assert says in found
    assert bool(says) == bool(found)


def test_inside_of():
    assert polygons.inside_of(((1.0, 1.0), (2.0, 1.0), (2.0, 2.0)), SQUARE)
    assert polygons.inside_of(SQUARE, SQUARE)
    bridging = ((1.0, 19.0), (19.0, 19.0), (19.0, 18.0), (1.0, 18.0))  # corners in, edges out
    assert not polygons.inside_of(bridging, NOTCHED)


def test_cuts_along_a_line():
    assert sorted(polygons.cuts(SQUARE, (-10.0, 5.0), (30.0, 5.0))) == pytest.approx([0.25, 0.5])
    assert list(polygons.cuts(SQUARE, (1.0, 1.0), (9.0, 9.0))) == []
