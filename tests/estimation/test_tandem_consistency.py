"""Whether the free flyer's filters are as good as they say: NEES over 100 seeds."""

from __future__ import annotations

import numpy as np
import pytest
from free_flights import error, flyer, measured, nees, truth_started, wandering
from scipy.stats import chi2

from missionkit.estimation.tandem_ekf.parameters import CompoundEkf, TandemEkf

SEEDS = 100
MOTION = wandering(4)
END = len(MOTION.times) - 1
TRANSLATION, ATTITUDE, ALL = slice(0, 6), slice(6, 9), slice(0, 9)


def bounds(dof, chance=1e-4):
    """Two-sided limits of the mean of SEEDS independent NEES."""
    low, high = chi2.ppf((chance, 1.0 - chance), SEEDS * dof) / SEEDS
    return low, high


def ensemble(kind, *, vision, outliers=0.0):
    """Fly all seeds; return NEES (SEEDS, 3) of translation, attitude and both, and errors."""
    navigator = flyer(kind)
    rows, errors = [], []
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        known = truth_started(navigator, MOTION, rng)
        for seen in measured(MOTION, rng, vision=vision, outliers=outliers):
            known = navigator.propagate(known, seen)
        state = navigator.read(known)
        assert not state.health.diverged
        rows.append([nees(state, MOTION, END, part) for part in (TRANSLATION, ATTITUDE, ALL)])
        errors.append(error(state, MOTION, END))
    return np.mean(rows, axis=0), np.sqrt(np.mean(np.square(errors), axis=0))


@pytest.mark.parametrize("kind", [TandemEkf, CompoundEkf])
def test_by_ranges_alone_the_errors_are_as_large_as_the_filter_says(kind):
    mean, _ = ensemble(kind, vision=False)
    for value, dof in zip(mean, (6, 3, 9), strict=True):
        low, high = bounds(dof)
        assert low < value < high
