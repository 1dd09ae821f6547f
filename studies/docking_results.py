"""Means, paired differences and shares of the docking study's flights."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from missionkit.campaigns.statistics import ConfidenceInterval, bootstrap
from studies.docking_flight import Docking
from studies.statistics import wilson

SEED = 3  # of the resampling


def chosen(runs: Sequence[Docking], rule: str, variant: str = "paper") -> list[Docking]:
    """Return the flights of a rule in a variant, by seed."""
    mine = [run for run in runs if run.order.rule == rule and run.order.variant == variant]
    return sorted(mine, key=lambda run: run.order.seed)


def pairs(
    first: Sequence[Docking], second: Sequence[Docking], measure: str
) -> list[tuple[float, float]]:
    """Return a measure of both flights of each seed that docked by both."""
    others = {run.order.seed: getattr(run, measure) for run in second}
    both = [
        (getattr(run, measure), others[run.order.seed]) for run in first if run.order.seed in others
    ]
    return [pair for pair in both if not math.isnan(sum(pair))]


def gain(first: Sequence[Docking], second: Sequence[Docking], measure: str) -> ConfidenceInterval:
    """Return by how much (%) the mean of a measure changes from the first flights to the second.

    Pair by pair on the same seeds, with a paired bootstrap interval of 95 %.
    """
    values = np.array(pairs(first, second, measure)).reshape(-1, 2).T

    def ratio(drawn: np.ndarray) -> np.ndarray:
        means = values[:, np.asarray(drawn, dtype=int)].mean(axis=-1)
        return np.asarray(100.0 * (means[1] / means[0] - 1.0))

    rows = list(np.arange(values.shape[1], dtype=float))
    return bootstrap(rows, ratio, np.random.default_rng(SEED))


def mean(runs: Sequence[Docking], measure: str) -> float:
    """Return the mean of a measure over the flights that have it."""
    values = [getattr(run, measure) for run in runs if not math.isnan(getattr(run, measure))]
    return float(np.mean(values)) if values else math.nan


def share(runs: Sequence[Docking]) -> str:
    """Return the share that docked, with Wilson's interval."""
    good = sum(run.docked for run in runs)
    low, high = wilson(good, len(runs))
    return f"{good} of {len(runs)} ({100.0 * low:.1f} to {100.0 * high:.1f} %)"


def percent(found: ConfidenceInterval) -> str:
    """Return a change with its interval."""
    if math.isnan(found.value):
        return "—"
    return f"{found.value:+.1f} % [{found.low:+.1f}, {found.high:+.1f}]"
