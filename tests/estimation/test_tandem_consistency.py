"""Whether the free flyer's filters are as good as they say: NEES over 100 seeds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from free_flights import error, flyer, measured, nees, truth_started, wandering
from scipy.stats import chi2

from missionkit.estimation.tandem_ekf import initialization
from missionkit.estimation.tandem_ekf.parameters import CompoundEkf, TandemEkf

SEEDS = 100
MOTION = wandering(3)
END = len(MOTION.times) - 1
PARTS = (slice(0, 6), slice(6, 9), slice(0, 9))
"""Translation, attitude, both."""


class Ensemble(NamedTuple):
    nees: np.ndarray  # (3,) mean over the seeds, of PARTS
    rms: np.ndarray  # (9,) error at the end
    rejected: float  # measurements refused a flight
    diverged: int  # observations after which it was said
    lost: int  # flights whose translation is off by more than 6 degrees of freedom allow


def bounds(dof, chance=1e-3):
    """Two-sided limits of the mean of SEEDS independent NEES."""
    low, high = chi2.ppf((chance, 1.0 - chance), SEEDS * dof) / SEEDS
    return low, high


def ensemble(kind, *, vision, outliers=0.0, seeds=SEEDS, **changes):
    """Fly all seeds."""
    navigator = flyer(kind, **changes)
    rows, errors, refused, diverged = [], [], [], 0
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        known, count = truth_started(navigator, MOTION, rng), 0
        for seen in measured(MOTION, rng, vision=vision, outliers=outliers):
            known = navigator.propagate(known, seen)
            count += known.rejected > 0
            diverged += navigator.read(known).health.diverged
        state = navigator.read(known)
        rows.append([nees(state, MOTION, END, part) for part in PARTS])
        errors.append(error(state, MOTION, END))
        refused.append(count)
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    lost = int((np.array(rows)[:, 0] > chi2.ppf(0.99999, 6)).sum())
    return Ensemble(np.mean(rows, axis=0), rms, float(np.mean(refused)), diverged, lost)


@pytest.mark.parametrize(
    ("kind", "vision"), [(TandemEkf, False), (CompoundEkf, False), (CompoundEkf, True)]
)
def test_errors_are_as_large_as_the_filter_says(kind, vision):
    flights = ensemble(kind, vision=vision)
    assert flights.diverged == 0
    for value, dof in zip(flights.nees, (6, 3, 9), strict=True):
        low, high = bounds(dof)
        assert low < value < high


def test_with_vision_the_tandem_filters_are_a_little_too_sure_of_the_place():
    """They leave out that place and attitude err together; the attitude's own is exact."""
    flights = ensemble(TandemEkf, vision=True)
    low, high = bounds(3)
    assert low < flights.nees[1] < high
    assert bounds(6)[0] < flights.nees[0] < 1.6 * 6
    assert flights.rms[0:3].max() < 0.003
    assert flights.rms[6:9].max() < 0.004


KNOWN = {"position_sd": 0.01, "vision": False, "seeds": 40}
"""A start that is known so well that the gate can tell an outlier from the first range on."""


@pytest.mark.parametrize("kind", [TandemEkf, CompoundEkf])
def test_outliers_are_refused_and_change_little(kind):
    clean = ensemble(kind, **KNOWN)
    assert clean.rejected < 0.2
    for outliers in (0.02, 0.10):
        dirty = ensemble(kind, outliers=outliers, **KNOWN)
        assert dirty.diverged == 0
        assert dirty.rejected > 0.6 * outliers * 60  # observations that end in a refusal
        assert np.linalg.norm(dirty.rms[:3]) < 1.25 * np.linalg.norm(clean.rms[:3])


def test_without_the_gate_outliers_ruin_the_estimate(monkeypatch):
    gated = ensemble(TandemEkf, outliers=0.10, **KNOWN)
    monkeypatch.setattr(initialization, "chdtri", lambda dof, tail: 1e9)
    believed = ensemble(TandemEkf, outliers=0.10, **KNOWN)
    assert np.linalg.norm(believed.rms[:3]) > 3.0 * np.linalg.norm(gated.rms[:3])


def test_underweighting_keeps_a_far_start_from_being_too_sure():
    """A start 0.3 m off bends the ranges: with S = H P Hᵀ + R the filter believes them too soon.

    Some flights then settle elsewhere and refuse what would bring them back.
    """
    plain = ensemble(TandemEkf, vision=False, position_sd=0.3)
    weighted = ensemble(TandemEkf, vision=False, position_sd=0.3, underweight=0.2)
    assert plain.lost >= 5
    assert weighted.lost <= plain.lost / 3
