"""How often an event was heard."""

from __future__ import annotations

from typing import Any, ClassVar, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.messages import Estimate, Verdict, is_event
from missionkit.plugin import WindowGuard


class Count(WindowGuard):
    """Holds once `event` was heard `at_least` times since the start of the mission.

    Events of the operator, of the vehicle and of behaviours count, such as the `event` of a
    waypoint or a photograph that an operator asks for. Those that the chart raises itself do not:
    a variable counts them. `photo` counts `photo.taken` as well, as it does for a transition. How
    often a state was entered is the guard `visited`.
    """

    kind: ClassVar[str] = "count"
    event: str = Field(description="to be counted; words joined by dots")
    at_least: int = Field(default=1, ge=1, le=100_000, description="times")

    @model_validator(mode="after")
    def _an_event(self) -> Self:
        if not is_event(self.event):
            raise ValueError(f"expected the name of an event, got {self.event!r}")
        return self

    @override
    def begin(self) -> int:
        return 0

    @override
    def advance(self, memory: Any, seen: Estimate) -> int:
        return int(memory) + sum(
            event == self.event or event.startswith(f"{self.event}.") for event in seen.events
        )

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        return Verdict.at_least(float(memory), float(self.at_least), "times")
