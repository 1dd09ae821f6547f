"""Readiness to fly."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.guards.battery import CHARGE
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import ONLY_TRUE, Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Fraction, Seconds

READY_QUANTITY = Quantity("ready by its own checks", most=1.0, whole=True)


class Ready(Guard):
    """Holds when a position is known and the vehicle passes its own checks with `charge` left."""

    kind: ClassVar[str] = "ready"
    charge: Fraction = 0.5
    max_age: Seconds = 5.0

    @override
    def check(self, seen: Estimate) -> Verdict:
        if seen.status is None or seen.battery is None:
            return Verdict.unknown("nothing received from the vehicle yet")
        if seen.now - seen.status.at > self.max_age:
            return Verdict.unknown("the vehicle has gone silent")
        if not seen.health.aligned:
            return Verdict(holds=False, why="the estimate is not aligned yet")
        if not seen.health.placed:
            return Verdict(holds=False, why="no position was accepted recently")
        if not seen.status.ready:
            return Verdict(holds=False, why="the vehicle's own checks fail")
        return Verdict.at_least(seen.battery.charge, self.charge)

    @override
    def region(self) -> Region:
        return Region(({READY_QUANTITY: ONLY_TRUE, CHARGE: Interval.at_least(self.charge)},))
