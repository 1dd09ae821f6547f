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
    silent: int = 0  # the same frames, 1: it never came
    tracked: float | None = None  # a tracked target's own γ; None: it is not tracked


class ArucoConfidence(WindowGuard):
    """Holds while the target was found in enough of the last `window` frames.

    γ(t) = (1/W) Σ I_detected(i) over the last W frames;  C_aruco = γ ≥ θ  (P1, section 1.3)

    Becomes true at γ ≥ `enter` and false below `exit` (hysteresis). A frame that never came, or a
    frozen one, counts as a miss, so that a dead camera lowers the confidence (correction P1.7).

    A tracked target has a γ of its own, over the last frames that should have shown it; times the
    share of the window's frames that came, it is what counts.
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
        hits, frames, silent = state.hits, state.frames, state.silent
        mask = (1 << self.window) - 1
        for look in seen.looks:
            hits = ((hits << 1) | (self.target in look.seen)) & mask
            silent = ((silent << 1) | look.silent) & mask
            frames = min(frames + 1, self.window)
        target = seen.targets.get(self.target)
        own = None if target is None else target.confidence
        following = Window(hits, frames, state.sure, silent, own)
        return following._replace(sure=self._share(following) >= self._threshold(following))

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        state: Window = memory
        if state.frames == 0:
            return Verdict.unknown("no frame was due yet")
        confidence, threshold = self._share(state), self._threshold(state)
        return Verdict(state.sure, "", confidence, threshold, confidence - threshold)

    def _share(self, state: Window) -> float:
        if state.tracked is None:
            return state.hits.bit_count() / self.window
        return state.tracked * (1.0 - state.silent.bit_count() / self.window)

    def _threshold(self, state: Window) -> float:
        return self.exit if state.sure else self.enter

    @override
    def region(self) -> Region:
        return Region(
            ({confidence_of(self.target): Interval.at_least(self.exit)},),
            ({confidence_of(self.target): Interval.at_least(self.enter)},),
        )


def confidence_of(target: str) -> Quantity:
    """Return the share of the last frames in which a target was found."""
    return Quantity(f"confidence of {target}", most=1.0, sees=target)
