"""Statistics over many flights of one fleet: conflicts, successes, least distances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from scipy.stats import chi2

from missionkit.campaigns.statistics import ConfidenceInterval, wilson
from missionkit.recorder.fleet_summary import FleetSummary


class FleetStatistics(NamedTuple):
    """What many flights of a fleet showed."""

    runs: int
    conflicts: int
    in_conflict: ConfidenceInterval  # share of runs with a conflict
    rate: ConfidenceInterval  # conflicts per hour in which all vehicles fly
    collided: ConfidenceInterval  # share of runs with a collision
    success: dict[str, ConfidenceInterval]  # of each vehicle
    least: float | None  # m, of all runs


def fleet_statistics(runs: Sequence[FleetSummary], hours: float) -> FleetStatistics:
    """Return the statistics of flights of one fleet.

    Args:
        runs: one summary for each flight, at least one.
        hours: time of flight of all runs.
    """
    count, conflicts = len(runs), sum(it.conflicts for it in runs)
    names = [it.vehicle for it in runs[0].vehicles]
    won = dict.fromkeys(names, 0)
    for it in runs:
        for member in it.vehicles:
            won[member.vehicle] += member.outcome == "success"
    least = [pair.least for it in runs for pair in it.encounters]
    return FleetStatistics(
        runs=count,
        conflicts=conflicts,
        in_conflict=wilson(sum(it.conflicts > 0 for it in runs), count),
        rate=poisson_rate(conflicts, hours),
        collided=wilson(sum(bool(it.collisions) for it in runs), count),
        success={name: wilson(won[name], count) for name in names},
        least=min(least, default=None),
    )


def poisson_rate(events: int, hours: float, confidence: float = 0.95) -> ConfidenceInterval:
    """Return a rate (1/h) with its exact interval.

    χ²(α/2, 2n) / 2T ≤ λ ≤ χ²(1 - α/2, 2n + 2) / 2T.  Source: F. Garwood, "Fiducial limits for the
    Poisson distribution", Biometrika 28, 1936.

    Args:
        events: n.
        hours: T, above 0.
        confidence: 1 - α, of the two-sided interval.
    """
    tail = 0.5 * (1.0 - confidence)
    low = 0.0 if events == 0 else float(chi2.ppf(tail, 2 * events)) / (2.0 * hours)
    return ConfidenceInterval(
        events / hours, low, float(chi2.ppf(1.0 - tail, 2 * events + 2)) / (2.0 * hours)
    )
