"""The arithmetic of the Haar detector against brute force, and boosting by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.perception.haar import kernels
from missionkit.perception.haar.features import SIDE, pool
from missionkit.perception.haar.gentle_boost import StageGoal, boosted

POOL = pool(step=5, least=6)


def image(seed=0, shape=(40, 52)):
    return np.random.default_rng(seed).integers(0, 256, shape).astype(np.uint8)


def by_hand(window, rectangles, weights):
    """Return a feature's value by summing pixels."""
    total = sum(
        weight * window[y : y + h, x : x + w].astype(float).sum()
        for (x, y, w, h), weight in zip(rectangles.tolist(), weights.tolist(), strict=True)
    )
    return total / (window.size * window.astype(float).std())


def test_integral_images_are_sums_over_all_above_and_to_the_left():
    picture = image().astype(float)
    sums, squares = kernels.integrated(image())
    np.testing.assert_array_equal(sums[1:, 1:], picture.cumsum(axis=0).cumsum(axis=1))
    np.testing.assert_array_equal(squares[1:, 1:], (picture**2).cumsum(axis=0).cumsum(axis=1))
    assert kernels.inside(sums, 7, 3, 11, 5) == picture[3:8, 7:18].sum()
    assert (sums[0] == 0).all()
    assert (sums[:, 0] == 0).all()


def test_features_are_contrasts_that_brightness_and_its_scale_do_not_change():
    patches = np.array([image(seed, (SIDE, SIDE)) for seed in range(3)])
    V = kernels.values(patches, *POOL, 1.0)
    for j in range(0, len(POOL.weights), 37):
        expected = [by_hand(it, POOL.rectangles[j], POOL.weights[j]) for it in patches]
        assert V[j] == pytest.approx(expected, rel=1e-4, abs=1e-6)
    darker = (patches // 4 + 30).astype(np.uint8)
    exact = (patches // 4 * 4).astype(np.uint8)
    change = kernels.values(darker, *POOL, 1.0) - kernels.values(exact, *POOL, 1.0)
    assert np.abs(change).max() < 1e-4
    flat = np.full((1, SIDE, SIDE), 90, np.uint8)
    assert np.abs(kernels.values(flat, *POOL, 3.0)).max() < 1e-6


def test_every_feature_fits_into_the_window_and_weighs_nothing_in_all():
    rectangles, weights = pool()
    assert (rectangles[..., :2] >= 0).all()
    assert (rectangles[..., :2] + rectangles[..., 2:] <= SIDE).all()
    assert (weights * rectangles[..., 2] * rectangles[..., 3]).sum(axis=1) == pytest.approx(0.0)


def least_squares_stump(V, w, y):
    """Return the least weighted squared error of any stump, by trying all."""
    best = math.inf
    for row in V:
        for threshold in np.unique(row)[1:]:
            low = row < threshold
            a, b = (np.average(y[part], weights=w[part]) for part in (low, ~low))
            best = min(best, float((w * (y - np.where(low, a, b)) ** 2).sum()))
    return best


@pytest.mark.parametrize("seed", range(4))
def test_the_best_stump_is_the_best_of_all(seed):
    rng = np.random.default_rng(seed)
    V = np.round(rng.normal(0.0, 1.0, (5, 40)), 1).astype(np.float32)  # with equal values
    y = np.where(rng.random(40) < 0.4, 1.0, -1.0)
    w = rng.uniform(0.1, 1.0, 40)
    w /= w.sum()
    order = np.argsort(V, axis=1, kind="stable").astype(np.int32)
    j, threshold, low, high = kernels.best_stump(V, order, w, y)
    f = np.where(V[j] < threshold, low, high)
    assert float((w * (y - f) ** 2).sum()) == pytest.approx(least_squares_stump(V, w, y))


def test_gentle_boosting_by_hand():
    """Four samples at 1, 2, 3, 4 with answers -, +, -, +.

    First stump: weights 1/4 each; a threshold of 1.5 leaves -1 and (1 - 1 + 1)/3 = 1/3, as good as
    one of 3.5. Second: weights exp(-1), exp(-1/3), exp(1/3), exp(-1/3) times 1/4.
    """
    V = np.array([[1.0, 2.0, 3.0, 4.0]], np.float32)
    y = np.array([-1.0, 1.0, -1.0, 1.0])
    stage = boosted(V, y, StageGoal(keep=1.0, let_through=0.0, most_stumps=2))
    first, second = stage.stumps
    assert (first.threshold, first.low, first.high) == pytest.approx((1.5, -1.0, 1.0 / 3.0))
    w = np.exp([-1.0, -1.0 / 3.0, 1.0 / 3.0, -1.0 / 3.0])
    cuts = {
        cut: [np.average(y[part], weights=w[part]) for part in (V[0] < cut, V[0] >= cut)]
        for cut in (1.5, 2.5, 3.5)
    }
    errors = {
        cut: float((w * (y - np.where(V[0] < cut, *both)) ** 2).sum()) for cut, both in cuts.items()
    }
    best = min(errors, key=errors.__getitem__)
    assert second.threshold == best == 3.5
    assert (second.low, second.high) == pytest.approx(tuple(cuts[best]))


def test_a_stage_keeps_the_positives_it_promised_and_stops_when_good_enough():
    rng = np.random.default_rng(3)
    y = np.repeat([1.0, -1.0], 200)
    V = (rng.normal(0.0, 1.0, (30, 400)) + 0.7 * y * (np.arange(30) < 6)[:, None]).astype(
        np.float32
    )
    stage = boosted(V, y, StageGoal(keep=0.98, let_through=0.3, most_stumps=40))
    F = np.sum([it.answers(V[it.feature]) for it in stage.stumps], axis=0)
    assert (F[y > 0] >= stage.limit).mean() >= 0.98
    assert (F[y < 0] >= stage.limit).mean() <= 0.3
    assert len(stage.stumps) < 40
