"""Search patterns against the manual's closed forms."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from missionkit.planning.search_patterns import expanding_square, sector


def turns(row):
    """The turns (deg) between the legs of a row of corners."""
    ways = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(row)]
    return [round(math.degrees((b - a + math.pi) % math.tau - math.pi)) for a, b in pairwise(ways)]


@pytest.mark.parametrize(("heading", "turn"), [(0.0, 1), (0.7, -1)])
def test_the_legs_of_a_square_grow_by_one_spacing_every_second_leg(heading, turn):
    row = expanding_square(4.0, 12.0, heading, turn)
    legs = [math.dist(a, b) for a, b in pairwise(row)]
    assert legs == pytest.approx([4, 4, 8, 8, 12, 12, 16, 16, 20, 20, 24, 24, 24])
    assert set(turns(row)) == {90 * turn}
    assert math.atan2(row[1][1], row[1][0]) == pytest.approx(heading)


def test_a_square_leaves_no_gap_wider_than_its_spacing():
    row = np.array(expanding_square(4.0, 12.0, 0.0, 1))
    rng = np.random.default_rng(0)
    for spot in rng.uniform(-12.0, 12.0, (300, 2)):
        a, b = row[:-1], row[1:]
        way = b - a
        share = np.clip(((spot - a) * way).sum(1) / (way * way).sum(1), 0.0, 1.0)
        assert np.linalg.norm(spot - a - share[:, None] * way, axis=1).min() <= 4.0 / 2 + 1e-9 or (
            np.abs(spot).max() > 8.0
        )
    with pytest.raises(ValueError, match="at most"):
        expanding_square(0.01, 100.0, 0.0, 1)


def test_a_sector_search_turns_by_120_degrees_and_crosses_the_datum():
    row = sector(15.0, 0.5, 1)
    assert [math.dist(a, b) for a, b in pairwise(row)] == pytest.approx([15.0] * 9)
    assert turns(row) == [120, 120, 0, 120, 120, 0, 120, 120]
    assert [math.hypot(*spot) < 1e-9 for spot in row] == [True, False, False] * 3 + [True]
    outer = sorted(math.degrees(math.atan2(e, n) - 0.5) % 360 for n, e in row if (n, e) != (0, 0))
    assert outer == pytest.approx([0, 60, 120, 180, 240, 300])
    twice = sector(15.0, 0.0, -1, passes=2)
    angles = {round(math.degrees(math.atan2(e, n))) % 30 for n, e in twice}
    assert len(twice) == 19
    assert angles == {0}
