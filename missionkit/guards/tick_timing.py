"""The engine's own timing."""

from __future__ import annotations

from typing import Any, ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import WindowGuard


class Overruns(NamedTuple):
    """Which of the last ticks overran, as bits, and the engine's count so far."""

    late: int = 0
    counted: int = 0


class TickOverrun(WindowGuard):
    """Holds once `count` of the last `window` ticks exceeded their budget of 50 ms.

    t_sense + t_process + t_control < 1 / f_control  (P1, section 9.1)
    """

    kind: ClassVar[str] = "tick_overrun"
    count: int = Field(default=5, ge=1)
    window: int = Field(default=20, ge=1, le=10_000)

    @override
    def begin(self) -> Overruns:
        return Overruns()

    @override
    def advance(self, memory: Any, seen: Estimate) -> Overruns:
        state: Overruns = memory
        late = int(seen.cycle.overruns > state.counted)
        mask = (1 << self.window) - 1
        return Overruns(((state.late << 1) | late) & mask, seen.cycle.overruns)

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        state: Overruns = memory
        return Verdict.at_least(float(state.late.bit_count()), float(self.count))

    @override
    def region(self) -> Region:
        return Region.of(late_of(self.window), Interval.at_least(self.count))


def late_of(window: int) -> Quantity:
    """Return how many of the last ticks were late."""
    return Quantity(f"late ticks of {window}", most=window, whole=True)
