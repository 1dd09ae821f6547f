"""From where a pad is sure to be in view: closed forms, and the promise itself."""

from __future__ import annotations

import math

import pytest

from missionkit.planning.pad_view import ViewCone, deviation_height, entry_radius

CONE = ViewCone(math.radians(25.0), sigmas=2.0, descent=1.5, acceleration=2.5, least=0.6)


def test_each_of_the_three_reasons_has_its_closed_form():
    assert deviation_height(CONE, 0.0) == 0.6
    slow = CONE._replace(descent=0.1)
    assert deviation_height(slow, 0.5) == pytest.approx(1.0 / math.tan(math.radians(25.0)))
    fast = CONE._replace(descent=3.0)
    assert deviation_height(fast, 0.2) == pytest.approx(3.0 * (0.3 + 2.0 * math.sqrt(0.4 / 2.5)))


@pytest.mark.parametrize("sd", [0.01, 0.1, 0.3, 1.0])
def test_at_the_cones_edge_a_pad_that_is_k_sigma_off_is_in_view(sd):
    height = deviation_height(CONE, sd)
    radius = entry_radius(CONE, sd, height)
    assert radius + CONE.sigmas * sd <= height * math.tan(CONE.half_angle) + 1e-12
    assert radius >= 0.0


def test_the_worse_the_estimate_the_earlier_it_deviates():
    heights = [deviation_height(CONE, 0.05 * n) for n in range(20)]
    assert heights == sorted(heights)
    assert heights[-1] > 3.0 * heights[0]
