"""The study of hovers: its statistics, its page, and one short hover."""

from __future__ import annotations

import numpy as np
import pytest

from studies import hover
from studies.hover_flight import ALONE, BIASED, METHODS, P2, WHOLE, Hover
from studies.hover_flight import hover as fly


def made(seed: int) -> Hover:
    """A hover whose final errors are known: 0.6 m for P2, 0.3 m with the bias, 1.8 m alone."""
    rng = np.random.default_rng(seed)
    errors = 0.3 * rng.standard_normal((len(METHODS), 61, 2))
    errors[P2] *= 2.0
    errors[ALONE] *= 6.0
    claimed = np.array([0.6, 0.3, 0.3, np.nan, np.nan])
    return Hover(seed, errors, np.full((5, 2), 0.4), np.full((5, 2), 0.05), claimed)


HOVERS = [made(seed) for seed in range(400)]
SIGHTS = [
    it._replace(
        errors=0.1 * it.errors[WHOLE : WHOLE + 1],
        wander=it.wander[:1],
        velocity=it.velocity[:1],
        claimed=np.array([0.03]),
    )
    for it in HOVERS
]


def test_the_interval_of_a_spread_holds_it_as_often_as_it_says():
    rng, inside = np.random.default_rng(0), 0
    for _ in range(600):
        _, low, high = hover.spread(2.0 * rng.standard_normal(40))
        inside += low < 2.0 < high
    assert inside / 600 == pytest.approx(0.95, abs=0.03)


def test_flights_are_compared_in_pairs():
    rng = np.random.default_rng(0)
    errors = rng.standard_normal(300)
    value, low, high = hover.ratio(errors, 3.0 * errors)
    assert (value, low, high) == pytest.approx((3.0, 3.0, 3.0))
    _, low, high = hover.ratio(errors, 3.0 * rng.standard_normal(300))
    assert 2.4 < low < 3.0 < high < 3.7


def test_white_noise_sums_up_to_the_floor():
    lowest = hover.floor(300.0)
    assert lowest[-1] == pytest.approx([0.3004, 0.3863], abs=1e-4)
    assert hover.white(0, 0.1, 60.0) == pytest.approx(np.sqrt(0.006017 * 0.1 * 60.0), rel=0.1)


def test_the_page_shows_the_spreads_and_the_assumptions(tmp_path):
    hover.write(HOVERS, SIGHTS, 300.0, tmp_path, "the command")
    text = (tmp_path / "hover.md").read_text()
    (row,) = [
        line for line in text.splitlines() if line.startswith("| P2's filter") and "to" in line
    ]
    assert float(row.split("|")[2].split()[0]) == pytest.approx(0.6, rel=0.1)
    assert "| P2, Table I" in text
    assert "SVO) | 0.130" in " ".join(text.split())
    (row,) = [
        line
        for line in text.splitlines()
        if line.startswith("| `ud_vision_ekf`, 400") and "to" in line
    ]
    assert float(row.split("|")[2].split()[0]) == pytest.approx(0.03, rel=0.1)
    assert "95 %" in text
    assert "gyro bias 0.003 rad/s" in text
    assert "$" not in text
    assert (tmp_path / "hover.png").stat().st_size > 20_000


def test_a_hover_starts_without_error_and_fusion_has_the_better_velocity():
    result = fly((7, 20.0))
    assert result.errors.shape == (len(METHODS), 5, 2)
    assert not result.errors[:, 0].any()
    assert np.abs(result.errors[:, -1]).max() < 1.5
    assert (result.velocity[BIASED] < result.velocity[ALONE]).all()
    assert np.isnan(result.claimed[ALONE])
