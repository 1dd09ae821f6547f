"""What a leaf guard may answer, and what each answer says of the quantities it reads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from missionkit.chart.checks.guard_regions import GuardRegion
from missionkit.chart.checks.interval_boxes import intersection, remains
from missionkit.chart.semantics.guard_compiler import FALSE_VERDICT, TRUE_VERDICT
from missionkit.messages import Verdict
from missionkit.messages.region import Box, Boxes, Interval, Quantity

UNKNOWN_VERDICT = Verdict.unknown("not known")


class Answer(StrEnum):
    """What a guard may answer; two of them where its user does not tell them apart."""

    HOLDS = "holds"
    FAILS = "fails"
    UNKNOWN = "unknown"
    NOT_TRUE = "fails or unknown"
    NOT_FALSE = "holds or unknown"


VERDICTS = {
    Answer.HOLDS: TRUE_VERDICT,
    Answer.FAILS: FALSE_VERDICT,
    Answer.UNKNOWN: UNKNOWN_VERDICT,
    Answer.NOT_TRUE: FALSE_VERDICT,
    Answer.NOT_FALSE: TRUE_VERDICT,
}
ASKED_IF_KNOWN = (Answer.FAILS, Answer.HOLDS)
ASKED_IF_TRUE = (Answer.NOT_TRUE, Answer.HOLDS)
ASKED_IF_FALSE = (Answer.FAILS, Answer.NOT_FALSE)
ASKED_FOR_BOTH = (Answer.FAILS, Answer.HOLDS, Answer.UNKNOWN)


@dataclass(slots=True)
class Leaf:
    """A guard that reads something outside the chart."""

    name: str
    truth: GuardRegion
    at_entry: GuardRegion  # its truth in the tick in which the commanding state is entered
    soonest: float  # s after entry at which it may hold
    options: tuple[Answer, ...] = ()
    known: bool = False  # it is never unknown

    def used(self, *, if_true: bool) -> None:
        """Note that something asks whether it is true, or whether it is false."""
        if self.known:
            self.options = ASKED_IF_KNOWN
            return
        wanted = ASKED_IF_TRUE if if_true else ASKED_IF_FALSE
        self.options = wanted if self.options in {(), wanted} else ASKED_FOR_BOTH


class Knowledge:
    """What some choices say of the quantities; what follows from one more is worked out once."""

    __slots__ = ("_after", "boxes", "open")

    def __init__(self, boxes: Boxes) -> None:
        self.boxes = boxes
        self.open: dict[tuple[str, bool], Sequence[tuple[Answer, Knowledge]]] = {}  # of leaves
        self._after: dict[str, Knowledge] = {}

    def after(self, choice: str, work: Callable[[], Boxes]) -> Knowledge:
        """Return what is known after one more choice."""
        known = self._after.get(choice)
        if known is None:
            known = self._after[choice] = Knowledge(work())
        return known


def left(boxes: Boxes, truth: GuardRegion, option: Answer) -> Boxes:
    """Return what an answer leaves of the boxes.

    Args:
        boxes: what is known so far.
        truth: of the guard.
        option: its answer.
    """
    if option is Answer.HOLDS:
        return intersection(boxes, truth.may, sure=False)
    if option is Answer.FAILS:
        return intersection(boxes, truth.may_not, sure=False)
    true = () if option is Answer.NOT_FALSE else truth.surely
    false = () if option is Answer.NOT_TRUE else truth.surely_not
    left = remains(boxes, (*true, *false))
    return boxes if left is None else left


def possible_at_entry(boxes: Boxes) -> Boxes:
    """Return what of the boxes is possible in the tick of entry."""
    return tuple(
        {quantity: span for quantity, span in box.items() if span is None or _stays(quantity)}
        for box in boxes
        if all(span is None or _enters(quantity, span) for quantity, span in box.items())
    )


def _stays(quantity: Quantity) -> bool:
    return quantity.at_entry == "kept"


def _enters(quantity: Quantity, span: Interval) -> bool:
    if quantity.at_entry == "zero":
        return span.low <= 0.0 and not (span.low_open and span.low == 0.0)
    return _stays(quantity)


def lasting(boxes: Iterable[Box]) -> float:
    """Return the least time (s) after entry that what begins at zero then needs."""
    least = [
        max((span.low for quantity, span in box.items() if span and _clock(quantity)), default=0.0)
        for box in boxes
    ]
    return max(min(least, default=0.0), 0.0)


def _clock(quantity: Quantity) -> bool:
    return quantity.at_entry == "zero" and quantity.unit == "s"
