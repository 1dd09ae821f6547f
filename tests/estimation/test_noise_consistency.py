"""The NIS test of sightings, against scipy's chi-square."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from samples import calm
from scipy.stats import chi2

from missionkit.estimation.error_state_ekf.consistency import (
    CONSISTENT_BELOW,
    FREEDOM,
    LARGEST_NIS,
    MEAN_WINDOW,
    NOISY_ABOVE,
    NisAverage,
    averaged,
    misfit,
)
from missionkit.geometry import vec
from missionkit.goal_pose import facing
from missionkit.guards.converged import Converged
from missionkit.messages import Goal, Target


def after(epsilons, scatter=None):
    scatter = NisAverage() if scatter is None else scatter
    for epsilon in epsilons:
        scatter = averaged(scatter, float(epsilon))
    return scatter


def test_the_bound_is_that_of_chance() -> None:
    assert (
        pytest.approx(chi2.ppf(0.9999, FREEDOM * MEAN_WINDOW) / (FREEDOM * MEAN_WINDOW), abs=0.02)
        == NOISY_ABOVE
    )


def test_modelled_noise_never_raises_an_alarm_and_twice_as_much_always_does() -> None:
    rng = np.random.default_rng(7)
    alarms = 0
    for _ in range(200):
        epsilons = chi2.rvs(FREEDOM, size=2 * MEAN_WINDOW, random_state=rng)
        alarms += bool(misfit(after(epsilons)))
        assert misfit(after(4.0 * epsilons))
    assert alarms == 0


def test_few_samples_decide_nothing_and_old_noise_is_forgotten() -> None:
    noisy = after([30.0] * MEAN_WINDOW)
    assert misfit(after([30.0] * (MEAN_WINDOW - 1))) == ""
    assert "3.2 times" in misfit(noisy)
    assert misfit(after([3.0] * 4 * MEAN_WINDOW, noisy)) == ""


def test_what_did_not_fit_is_doubted_until_it_clearly_fits() -> None:
    noisy = after([30.0] * MEAN_WINDOW)
    between = after([FREEDOM * 0.5 * (CONSISTENT_BELOW + NOISY_ABOVE)] * 10 * MEAN_WINDOW, noisy)
    assert between.mean < NOISY_ABOVE
    assert misfit(between)
    assert (
        misfit(after([FREEDOM * 0.5 * (CONSISTENT_BELOW + NOISY_ABOVE)] * 10 * MEAN_WINDOW)) == ""
    )


def test_one_false_marker_is_not_noise() -> None:
    assert misfit(after([3.0] * MEAN_WINDOW + [1e9])) == ""


@given(st.lists(st.floats(min_value=0.0) | st.just(math.nan), max_size=120))
def test_the_mean_is_finite_whatever_comes(epsilons) -> None:
    scatter = after(epsilons)
    assert math.isfinite(scatter.mean)
    assert 0.0 <= scatter.mean <= LARGEST_NIS
    assert scatter.taken <= MEAN_WINDOW


def test_convergence_is_not_accepted_while_the_noise_does_not_fit() -> None:
    trunk = Target("trunk", vec(10.0, 0.0, -3.0), 0.05, facing(math.pi), 0.02, 10.0)
    goal = Goal(vec(8.8, 0.0, -3.0), None, 10.0, "trunk")
    place, still = vec(8.8, 0.0, -3.0), vec(0.0, 0.0, 0.0)
    seen = calm(now=10.0, position=place, velocity=still, targets={"trunk": trunk}, goal=goal)
    assert Converged().check(seen).holds is True
    doubtful = seen._replace(
        health=seen.health._replace(misfit=misfit(after([30.0] * MEAN_WINDOW)))
    )
    verdict = Converged().check(doubtful)
    assert verdict.holds is None
    assert "filter's noise" in verdict.why
