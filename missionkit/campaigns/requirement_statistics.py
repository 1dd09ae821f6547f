"""The requirements of a mission over the flights of a campaign."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np

from missionkit.campaigns.run_row import Row
from missionkit.campaigns.statistics import ConfidenceInterval, wilson

LOW_QUANTILE = 0.05
_RANK = {False: 0, None: 1, True: 2}


class RequirementStatistics(NamedTuple):
    """How often a requirement was fulfilled, and by how much."""

    name: str
    flights: int
    fulfilled: int
    broken: int  # the others are undecided
    share: ConfidenceInterval  # fulfilled; an undecided one counts as not fulfilled
    worst: float | None  # robustness, in the unit of the guard that decides
    low: float | None  # robustness that 5 % of the flights stay below
    seed: int  # of the worst flight


def requirement_statistics(rows: Sequence[Row]) -> tuple[RequirementStatistics, ...]:
    """Return the statistics of each requirement, in the order of the file.

    Args:
        rows: of one variant; those without a flight say nothing and do not count.
    """
    names = dict.fromkeys(name for row in rows for name in row.requirements)
    return tuple(_of(name, [row for row in rows if name in row.requirements]) for name in names)


def _of(name: str, rows: Sequence[Row]) -> RequirementStatistics:
    results = [row.requirements[name] for row in rows]
    worst = min(rows, key=lambda row: _badness(*row.requirements[name]))
    numbers = [robustness for _, robustness in results if robustness is not None]
    fulfilled = sum(met is True for met, _ in results)
    return RequirementStatistics(
        name,
        len(rows),
        fulfilled,
        sum(met is False for met, _ in results),
        wilson(fulfilled, len(rows)),
        worst.requirements[name][1],
        float(np.quantile(numbers, LOW_QUANTILE)) if numbers else None,
        worst.seed,
    )


def _badness(met: bool | None, robustness: float | None) -> tuple[int, float]:  # noqa: FBT001
    without = -inf if met is False else inf
    return _RANK[met], without if robustness is None else robustness
