"""Camera."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import WindowGuard

MISSED = Quantity("frames missing in a row", whole=True)


class CameraSilent(WindowGuard):
    """Holds once `frames` expected frames in a row were missing or repeated (a frozen camera)."""

    kind: ClassVar[str] = "camera_silent"
    frames: int = Field(default=20, ge=1)

    @override
    def begin(self) -> int:
        return 0

    @override
    def advance(self, memory: Any, seen: Estimate) -> int:
        count: int = memory
        for look in seen.looks:
            count = count + 1 if look.silent else 0
        return count

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        return Verdict.at_least(float(memory), float(self.frames))

    @override
    def region(self) -> Region:
        return Region.of(MISSED, Interval.at_least(self.frames))
