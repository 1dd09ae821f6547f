"""Detection confidence over a sliding window."""

from __future__ import annotations

from typing import Any, ClassVar, NamedTuple, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import WindowGuard
from missionkit.units import Fraction


class Window(NamedTuple):
    """The last frames as bits, the newest lowest, and the hysteresis latch."""

    hits: int = 0
    frames: int = 0
    sure: bool = False


class ArucoConfidence(WindowGuard):
    """Holds while the target was found in enough of the last `window` frames.

    γ(t) = (1/W) Σ I_detected(i) over the last W frames;  C_aruco = γ ≥ θ  (P1, section 1.3)

    Becomes true at γ ≥ `enter` and false below `exit` (hysteresis). A frame that never came, or a
    frozen one, counts as a miss, so that a dead camera lowers the confidence (correction P1.7).
    """

    kind: ClassVar[str] = "aruco_confidence"
    target: str
    window: int = Field(default=30, ge=1, le=10_000)
    enter: Fraction = 0.7
    exit: Fraction = 0.5

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.exit > self.enter:
            raise ValueError(f"exit ({self.exit}) must not be above enter ({self.enter})")
        return self

    @override
    def begin(self) -> Window:
        return Window()

    @override
    def advance(self, memory: Any, seen: Estimate) -> Window:
        state: Window = memory
        hits, frames = state.hits, state.frames
        mask = (1 << self.window) - 1
        for look in seen.looks:
            hits = ((hits << 1) | (self.target in look.seen)) & mask
            frames = min(frames + 1, self.window)
        confidence = hits.bit_count() / self.window
        return Window(hits, frames, confidence >= (self.exit if state.sure else self.enter))

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        state: Window = memory
        if state.frames == 0:
            return Verdict.unknown("no frame was due yet")
        confidence = state.hits.bit_count() / self.window
        threshold = self.exit if state.sure else self.enter
        return Verdict(state.sure, "", confidence, threshold, confidence - threshold)

    @override
    def region(self) -> Region:
        return Region(
            ({confidence_of(self.target): Interval.at_least(self.exit)},),
            ({confidence_of(self.target): Interval.at_least(self.enter)},),
        )


def confidence_of(target: str) -> Quantity:
    """Return the share of the last frames in which a target was found."""
    return Quantity(f"confidence of {target}", most=1.0, sees=target)
