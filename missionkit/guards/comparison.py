"""Guards that compare one number with a threshold, or read one truth value, declared once."""

from __future__ import annotations

import abc
from collections.abc import Callable
from typing import Literal, NamedTuple

from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import ONLY_TRUE, Interval, Quantity, Region
from missionkit.plugin import Guard

Operator = Literal["below", "above", "at_least", "at_most"]
VERDICTS: dict[Operator, Callable[[float, float, str], Verdict]] = {
    "below": Verdict.below,
    "above": Verdict.above,
    "at_least": Verdict.at_least,
    "at_most": Verdict.at_most,
}
INTERVALS: dict[Operator, Callable[[float], Interval]] = {
    "below": Interval.below,
    "above": Interval.above,
    "at_least": Interval.at_least,
    "at_most": Interval.at_most,
}


class Comparison(NamedTuple):
    """A guard holds while its quantity is below, above, at least or at most the threshold."""

    quantity: Quantity
    operator: Operator
    threshold: float  # in the unit of the quantity
    why: str = ""  # what a verdict says of its value, for people


class ComparedGuard(Guard):
    """A guard that compares one number with a threshold.

    Its verdict, the region for the checks before flight and the tick's short cut all come from
    `comparison` and `measured`.
    """

    @abc.abstractmethod
    def comparison(self) -> Comparison:
        """Declare what is compared."""

    @abc.abstractmethod
    def measured(self, seen: Estimate) -> float | str:
        """Return the quantity's value, or why it is unknown."""

    @override
    def check(self, seen: Estimate) -> Verdict:
        return compiled(self)(seen)

    @override
    def region(self) -> Region:
        quantity, operator, threshold, _ = self.comparison()
        return Region.of(quantity, INTERVALS[operator](threshold))


class FlagGuard(Guard):
    """A guard that holds while one truth value is true.

    Its verdict, the region and the tick's short cut all come from `quantity` and `raised`.
    """

    @abc.abstractmethod
    def quantity(self) -> Quantity:
        """Declare what is read: 0 or 1."""

    @abc.abstractmethod
    def raised(self, seen: Estimate) -> bool:
        """Say whether it is true."""

    def reason(self, seen: Estimate) -> str:  # noqa: ARG002
        """Return why it is true, for people."""
        return ""

    @override
    def check(self, seen: Estimate) -> Verdict:
        if not self.raised(seen):
            return Verdict(holds=False)
        return Verdict(holds=True, why=self.reason(seen))

    @override
    def region(self) -> Region:
        return Region.of(self.quantity(), ONLY_TRUE)


def compiled(guard: ComparedGuard) -> Callable[[Estimate], Verdict]:
    """Return `check` of a guard, with its declaration read once."""
    _, operator, threshold, why = guard.comparison()
    measured, verdict = guard.measured, VERDICTS[operator]

    def check(seen: Estimate) -> Verdict:
        value = measured(seen)
        return Verdict.unknown(value) if isinstance(value, str) else verdict(value, threshold, why)

    return check
