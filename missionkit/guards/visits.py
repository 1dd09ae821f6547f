"""Where the mission has been."""

from __future__ import annotations

from typing import Any, ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.plugin import CompositeGuard
from missionkit.plugin_protocols import Inputs, NamedInput

EPSILON = 1e-6  # s


class Visits(NamedTuple):
    """Memory of `visited`."""

    times: int = 0
    lasted: float | None = None  # s, of the present visit at the last tick; None: elsewhere


class Visited(CompositeGuard):
    """Holds once `state` has commanded the vehicle in `at_least` visits, the present one included.

    A state without states inside, by its name; one that is left in the tick in which it is entered
    does not count.
    """

    kind: ClassVar[str] = "visited"
    state: str = Field(description="whose behaviour commanded")
    at_least: int = Field(default=1, ge=1, le=1000, description="visits")

    @override
    def named_inputs(self) -> tuple[NamedInput, ...]:
        return (NamedInput("state", self.state, ("state",)),)

    @override
    def begin(self) -> Visits:
        return Visits()

    @override
    def advance(self, memory: Any, seen: Estimate) -> Visits:
        been: Visits = memory
        if seen.state != self.state:
            return been._replace(lasted=None)
        lasted = seen.now - seen.entered_at  # stands still during a pause
        fresh = been.lasted is None or lasted < been.lasted - EPSILON
        return Visits(been.times + fresh, lasted)

    @override
    def check(self, memory: Any, seen: Estimate, inputs: Inputs) -> Verdict:
        return Verdict.at_least(float(memory.times), float(self.at_least), "visits")
