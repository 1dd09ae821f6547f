"""Guards that must hold for a while, where it is open since when they have."""

from __future__ import annotations

import math

from missionkit.chart.checks.exploration.oracle import LONG_AGO, Oracle
from missionkit.chart.semantics.compiled_chart import CompiledTransition


class LongAgo:
    """Since when a guard has held: chosen when it is asked for.

    Args:
        oracle: chooses.
        way: whose guard it is.
        others: of the same tick; one guard has held as long for all that wait for it.
    """

    def __init__(self, oracle: Oracle, way: CompiledTransition, others: list[LongAgo]) -> None:
        self.oracle = oracle
        self.way = way
        self.others = others
        self.since: float | None = None

    def __rsub__(self, now: float) -> float:
        if self.since is None:
            situation, source = self.oracle.situation, self.way.source
            able = not source or situation.ages.get(source, math.inf) >= self.way.hold
            refused = any(it.since == now and self._longer_than(it) for it in self.others)
            self.since = LONG_AGO if able and not refused and situation.pick(2) else now
        return now - self.since

    def _longer_than(self, other: LongAgo) -> bool:
        mine, its = self.way, other.way
        return mine.ask is its.ask and mine.source == its.source and mine.hold >= its.hold
