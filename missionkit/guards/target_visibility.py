"""Seeing a target."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Seconds


class TargetSeen(Guard):
    """Holds when `target` was seen within the last `within` seconds."""

    kind: ClassVar[str] = "target_seen"
    target: str
    within: Seconds = 0.5

    @override
    def check(self, seen: Estimate) -> Verdict:
        at = _last_seen(seen, self.target)
        if at is None:
            return Verdict(holds=False, why=f"{self.target} was never seen")
        return Verdict.at_most(seen.now - at, self.within)

    @override
    def region(self) -> Region:
        return Region.of(time_since_seen(self.target), Interval.at_most(self.within))


class TargetLost(ComparedGuard):
    """Holds when `target` was not seen for `longer_than`: visual lock lost (P1, section 7.2).

    Counted from the last sighting, or from entry into the state if that is later.
    """

    kind: ClassVar[str] = "target_lost"
    target: str
    longer_than: Seconds = 2.0

    @override
    def measured(self, seen: Estimate) -> float | str:
        at = _last_seen(seen, self.target)
        since = seen.entered_at if at is None else max(at, seen.entered_at)
        return seen.now - since

    @override
    def comparison(self) -> Comparison:
        return Comparison(time_without(self.target), "at_least", self.longer_than)


def _last_seen(seen: Estimate, name: str) -> float | None:
    target = seen.targets.get(name)
    return None if target is None else target.seen_at


def time_since_seen(target: str) -> Quantity:
    """Return the time since a target was last seen."""
    return Quantity(f"time since {target} was seen", unit="s", sees=target)


def time_without(target: str) -> Quantity:
    """Return the time in the state in which a target was not seen, up to now."""
    return Quantity(f"time without {target}", unit="s", at_entry="zero", sees=target)
