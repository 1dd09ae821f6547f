"""Link to the vehicle."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity
from missionkit.units import Seconds

SILENCE = Quantity("link silence", unit="s")


class LinkLost(ComparedGuard):
    """Holds once the vehicle's heartbeat has been silent for `longer_than`."""

    kind: ClassVar[str] = "link_lost"
    longer_than: Seconds = 3.0

    @override
    def measured(self, seen: Estimate) -> float | str:
        if seen.status is None:
            return "no heartbeat yet"
        return seen.now - seen.status.at

    @override
    def comparison(self) -> Comparison:
        return Comparison(SILENCE, "above", self.longer_than)
