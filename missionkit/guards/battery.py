"""Battery."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Fraction, Seconds

CHARGE = Quantity("battery", most=1.0)


class BatteryBelow(Guard):
    """Holds once the charge is under `floor`; unknown if the reading is older than `max_age`."""

    kind: ClassVar[str] = "battery_below"
    floor: Fraction
    max_age: Seconds = 5.0

    @override
    def check(self, seen: Estimate) -> Verdict:
        if seen.battery is None:
            return Verdict.unknown("no battery reading yet")
        age = seen.now - seen.battery.at
        if age > self.max_age:
            return Verdict.unknown(f"battery reading is {age:.1f} s old")
        return Verdict.below(seen.battery.charge, self.floor)

    @override
    def region(self) -> Region:
        return Region.of(CHARGE, Interval.below(self.floor))
