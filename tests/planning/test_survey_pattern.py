"""Lines over areas, checked against the areas themselves."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.path import Path

from missionkit.planning.polygon_strips import hull
from missionkit.planning.survey_pattern import (
    best_heading,
    corridor_lines,
    extended,
    survey_lines,
)
from missionkit.polygons import unfit

SQUARE = ((0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0))
ELL = ((0.0, 0.0), (60.0, 0.0), (60.0, 20.0), (20.0, 20.0), (20.0, 80.0), (0.0, 80.0))
COMB = (
    *((0.0, 0.0), (60.0, 0.0), (60.0, 10.0), (15.0, 10.0), (15.0, 20.0), (60.0, 20.0)),
    *((60.0, 30.0), (15.0, 30.0), (15.0, 40.0), (60.0, 40.0), (60.0, 50.0), (0.0, 50.0)),
)


def star(seed: int) -> tuple[tuple[float, float], ...]:
    """A simple polygon of any shape."""
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, math.tau, rng.integers(3, 12)))
    radii = rng.uniform(10.0, 60.0, len(angles))
    return tuple(
        (float(r * math.cos(a)), float(r * math.sin(a))) for a, r in zip(angles, radii, strict=True)
    )


def spots_in(polygon, seed: int, count: int = 400):
    rng = np.random.default_rng(seed)
    low, high = np.min(polygon, axis=0), np.max(polygon, axis=0)
    spots = rng.uniform(low, high, (count, 2))
    return spots[Path(polygon).contains_points(spots)]


def beside(spot, line):
    """How far a spot is from a line, None if it is not beside it."""
    a, b = np.array(line)
    way = (b - a) / np.linalg.norm(b - a)
    along, across = (spot - a) @ way, (spot - a) @ np.array((-way[1], way[0]))
    return abs(across) if -1e-6 <= along <= np.linalg.norm(b - a) + 1e-6 else None


@pytest.mark.parametrize("polygon", [SQUARE, ELL, COMB, *map(star, range(40))])
@pytest.mark.parametrize("angle", [None, 0.3])
def test_every_spot_of_an_area_lies_beside_a_line_within_half_a_spacing(polygon, angle):
    if unfit(polygon):
        pytest.fail("the polygon of the test is no simple one")
    heading = best_heading(polygon, 7.0) if angle is None else angle
    lines = survey_lines(polygon, 7.0, heading, (0.0, 0.0))
    for spot in spots_in(polygon, 1, 150):
        gaps = [gap for line in lines if (gap := beside(spot, line)) is not None]
        assert min(gaps) <= 3.5 + 1e-6


@pytest.mark.parametrize("seed", range(8))
def test_no_other_direction_has_fewer_lines(seed):
    polygon = star(seed)
    least = len(survey_lines(polygon, 7.0, best_heading(polygon, 7.0), (0.0, 0.0)))
    convex = hull(polygon)
    best = len(survey_lines(convex, 7.0, best_heading(convex, 7.0), (0.0, 0.0)))
    for angle in np.radians(range(0, 180, 3)):
        assert len(survey_lines(convex, 7.0, angle, (0.0, 0.0))) >= best
        assert len(survey_lines(polygon, 7.0, angle, (0.0, 0.0))) >= least - 2


@pytest.mark.parametrize("turned", [0.0, 0.4, 1.2, 2.9])
def test_a_rectangle_is_flown_along_its_long_side(turned):
    c, s = math.cos(turned), math.sin(turned)
    corners = ((0.0, 0.0), (100.0, 0.0), (100.0, 31.0), (0.0, 31.0))
    polygon = tuple((x * c - y * s, x * s + y * c) for x, y in corners)
    heading = best_heading(polygon, 10.0)
    assert math.isclose(heading % math.pi, turned % math.pi, abs_tol=1e-6)
    lines = survey_lines(polygon, 10.0, heading, "north-east")
    assert len(lines) == math.ceil(31.0 / 10.0)
    assert [math.dist(*line) for line in lines] == pytest.approx([100.0] * 4)
    assert [math.dist(a[1], b[0]) for a, b in pairwise(lines)] == pytest.approx([31.0 / 4] * 3)


@pytest.mark.parametrize(
    ("entry", "corner"),
    [
        *(("north-east", (40, 40)), ("south-east", (0, 40))),
        *(("south-west", (0, 0)), ("north-west", (40, 0)), ((50.0, -20.0), (40, 0))),
    ],
)
def test_it_begins_at_the_corner_asked_for(entry, corner):
    (start, _), *_ = survey_lines(SQUARE, 10.0, 0.0, entry)
    assert math.dist(start, corner) == pytest.approx(5.0)  # half a strip from the edge


def test_a_comb_is_flown_tooth_by_tooth():
    lines = survey_lines(COMB, 5.0, 0.0, (0.0, 0.0))
    across = [round(a[1], 1) for a, _ in lines]
    assert across == sorted(across)
    assert max(math.dist(a[1], b[0]) for a, b in pairwise(lines)) < 16.0
    up = survey_lines(COMB, 5.0, 0.5 * math.pi, (0.0, 0.0))
    assert len(up) == 3 + 3 * 9  # the back, and three teeth


def test_more_lines_than_anybody_flies_are_refused():
    with pytest.raises(ValueError, match="at most 2000"):
        survey_lines(SQUARE, 0.01, 0.0, "north-east")


def test_a_line_is_extended_at_both_ends():
    assert extended(((0.0, 0.0), (3.0, 4.0)), 5.0) == ((-3.0, -4.0), (6.0, 8.0))
    assert extended(((1.0, 1.0), (1.0, 1.0)), 5.0) == ((1.0, 1.0), (1.0, 1.0))


def test_a_corridor_is_flown_by_parallels_that_cover_it():
    centre = [(0.0, 0.0), (50.0, 0.0), (80.0, 40.0), (80.0, 90.0)]
    rows = corridor_lines(centre, 20.0, 6.0)
    assert len(rows) == 4
    for at, row in enumerate(rows):
        off = (at - 1.5) * 5.0
        straight = row if at % 2 == 0 else row[::-1]
        for (a, b), (p, q) in zip(pairwise(centre), pairwise(straight), strict=True):
            way = np.subtract(b, a) / math.dist(a, b)
            for spot in (p, q):
                east_of = np.subtract(spot, a) @ np.array((-way[1], way[0]))
                assert east_of == pytest.approx(off)
    assert [math.dist(a[-1], b[0]) for a, b in pairwise(rows)] == pytest.approx([5.0] * 3)


@pytest.mark.parametrize(
    ("centre", "breadth", "says"),
    [
        ([(0, 0), (50, 0), (0, 1)], 5, "turns back at spot 2"),
        ([(0, 0), (50, 0), (50, 5), (0, 5)], 60, "too wide for its bend"),
        ([(0, 0), (0, 0)], 5, "the same"),
    ],
)
def test_a_corridor_that_cannot_be_flown_is_refused(centre, breadth, says):
    with pytest.raises(ValueError, match=says):
        corridor_lines(centre, breadth, 3.0)
