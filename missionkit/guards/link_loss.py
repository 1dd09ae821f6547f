"""Link to the vehicle."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Seconds

SILENCE = Quantity("link silence", unit="s")


class LinkLost(Guard):
    """Holds once the vehicle's heartbeat has been silent for `longer_than`."""

    kind: ClassVar[str] = "link_lost"
    longer_than: Seconds = 3.0

    @override
    def check(self, seen: Estimate) -> Verdict:
        if seen.status is None:
            return Verdict.unknown("no heartbeat yet")
        return Verdict.above(seen.now - seen.status.at, self.longer_than)

    @override
    def region(self) -> Region:
        return Region.of(SILENCE, Interval.above(self.longer_than))
