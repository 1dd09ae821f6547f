"""Trust in the position estimate."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import ONLY_TRUE, Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Metres, Seconds

DIVERGED = Quantity("filter diverged", most=1.0, whole=True)
POSITION_SD = Quantity("position sd", unit="m")
FIX_AGE = Quantity("time since the last fix", unit="s")


class EstimateBad(Guard):
    """Holds when the filter has diverged or its horizontal 1-sigma exceeds `position_sd`."""

    kind: ClassVar[str] = "estimate_bad"
    position_sd: Metres = Field(default=5.0, gt=0)

    @override
    def check(self, seen: Estimate) -> Verdict:
        if seen.health.diverged:
            return Verdict(holds=True, why=seen.health.cause or "the filter has diverged")
        return Verdict.above(seen.health.position_sd, self.position_sd)

    @override
    def region(self) -> Region:
        return Region(({DIVERGED: ONLY_TRUE}, {POSITION_SD: Interval.above(self.position_sd)}))


class GnssLost(ComparedGuard):
    """Holds when no position fix was accepted for `longer_than`."""

    kind: ClassVar[str] = "gnss_lost"
    longer_than: Seconds = 5.0

    @override
    def measured(self, seen: Estimate) -> float | str:
        if seen.health.gnss_at is None:
            return "no fix was accepted yet"
        return seen.now - seen.health.gnss_at

    @override
    def comparison(self) -> Comparison:
        return Comparison(FIX_AGE, "above", self.longer_than)
