"""Safe values for the parameters that the pre-flight report judges unsafe: written, read back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from missionkit.vehicle.autopilot_dialect import Dialect
from missionkit.vehicle.failsafe_parameters import FailsafeLevel
from missionkit.vehicle.link.message_link import MessageLink


class ParameterChange(NamedTuple):
    """A parameter with a value that is not safe, and the one to write."""

    parameter: str
    was: float
    to: float
    why: str

    @property
    def question(self) -> str:
        """Question to the operator."""
        return f"{self.parameter} is {self.was:g}: {self.why}. Write {self.to:g}?"


class Written(NamedTuple):
    """Result of a change; `now` is the value read back, None if there was none."""

    change: ParameterChange
    now: float | None

    @property
    def good(self) -> bool:
        """Whether the autopilot has the value."""
        return self.now is not None and abs(self.now - self.change.to) < 1e-6

    @property
    def says(self) -> str:
        """The outcome, for people."""
        name, was, to, _ = self.change
        if self.good:
            return f"{name} was {was:g}, is {to:g}"
        found = "could not be read back" if self.now is None else f"is still {self.now:g}"
        return f"{name} was {was:g}, {found}: check it by hand"


def proposed(
    dialect: Dialect, parameters: Mapping[str, float | None]
) -> tuple[ParameterChange, ...]:
    """Return what to write, the most urgent first; what was not read is left alone."""
    changes = []
    for failsafe in dialect.failsafes:
        was = parameters.get(failsafe.parameter)
        if was is None or failsafe.safe is None:
            continue
        level, why = failsafe.judge(was)
        if level is not FailsafeLevel.GOOD:
            changes.append(
                ParameterChange(failsafe.parameter, was, failsafe.safe, why.partition(";")[0])
            )
    return tuple(changes)


def write(wire: MessageLink, change: ParameterChange) -> Written:
    """Write one parameter and read it back. Blocks the calling thread."""
    wire.set_parameter(change.parameter, change.to)  # what counts is what is read back
    return Written(change, wire.parameter(change.parameter))
