"""Battery."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity
from missionkit.units import Fraction, Seconds

CHARGE = Quantity("battery", most=1.0)


class BatteryBelow(ComparedGuard):
    """Holds once the charge is under `floor`; unknown if the reading is older than `max_age`."""

    kind: ClassVar[str] = "battery_below"
    floor: Fraction
    max_age: Seconds = 5.0

    @override
    def measured(self, seen: Estimate) -> float | str:
        if seen.battery is None:
            return "no battery reading yet"
        age = seen.now - seen.battery.at
        if age > self.max_age:
            return f"battery reading is {age:.1f} s old"
        return seen.battery.charge

    @override
    def comparison(self) -> Comparison:
        return Comparison(CHARGE, "below", self.floor)
