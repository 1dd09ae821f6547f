"""The ground that objects stand on: by the newest distance, else as high as the take-off point."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from missionkit.engine.ground_below import RANGE_SD, STALE, ground_below
from missionkit.geometry import Transform, from_euler, vec
from missionkit.messages import Range

TILTED = Transform(from_euler(math.radians(60.0), 0.0, 0.0), vec(1.0, 2.0, -2.0))
STATE = SimpleNamespace(covariance=np.diag([9.0, 9.0, 0.25, *[0.0] * 3, *[1e-4] * 3, *[0.0] * 6]))


def below(distance, now=1.0, pose=TILTED):
    navigator = SimpleNamespace(pose_at=lambda _known, at: pose if at == 0.9 else None)
    return ground_below(navigator, None, STATE, distance, now)


def test_a_recent_distance_says_where_the_ground_is():
    ground, noise = below(Range(0.9, 3.0))
    assert ground == pytest.approx(-2.0 + 1.5)  # the sensor looks 60 deg off the vertical
    assert noise.height == RANGE_SD
    assert noise.attitude == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("distance", "now"), [(None, 1.0), (Range(0.9, 3.0), 0.95 + STALE), (Range(0.3, 3.0), 0.7)]
)
def test_otherwise_it_is_as_high_as_the_take_off_point(distance, now):
    ground, noise = below(distance, now)
    assert ground == 0.0
    assert noise.height == pytest.approx(0.5)
    assert noise.position == 0.0
