"""Wald's test of a stream of detections."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, NamedTuple, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import WindowGuard
from missionkit.units import Fraction

Share = Annotated[Fraction, Field(gt=0, lt=1)]
ErrorRate = Annotated[Fraction, Field(gt=0, lt=0.5)]


class Evidence(NamedTuple):
    """The test in progress, and what the last one decided."""

    ratio: float = 0.0  # logarithm of the likelihood ratio
    frames: int = 0  # in this test
    present: bool | None = None


class Sprt(WindowGuard):
    """Holds once detections prove that a target is there, until they prove that it is not.

    Λ = Σ ln(p1 / p0) for a frame with it, ln((1 - p1) / (1 - p0)) for one without;
    there at Λ ≥ ln((1 - β) / α), not there at Λ ≤ ln(β / (1 - α)), in between the test continues.
    Source: A. Wald, "Sequential tests of statistical hypotheses", 1945; frames are taken as
    independent.

    After a decision the test begins again, and the decision stands until the next one; before the
    first one the guard is unknown. A frame that never came, or a frozen one, is one without the
    target, as for `aruco_confidence`.
    """

    kind: ClassVar[str] = "sprt"
    target: str
    p0: Share = Field(default=0.05, description="share of frames with a detection if it is absent")
    p1: Share = Field(default=0.6, description="share of frames with a detection if it is there")
    alpha: ErrorRate = Field(default=0.01, description="risk of finding it although it is absent")
    beta: ErrorRate = Field(default=0.01, description="risk of missing it although it is there")

    @model_validator(mode="after")
    def _apart(self) -> Self:
        if self.p0 >= self.p1:
            raise ValueError(f"p0 ({self.p0:g}) must be below p1 ({self.p1:g})")
        return self

    @property
    def upper(self) -> float:
        """Λ at which the target is there."""
        return math.log((1.0 - self.beta) / self.alpha)

    @property
    def lower(self) -> float:
        """Λ at which it is not."""
        return math.log(self.beta / (1.0 - self.alpha))

    @override
    def begin(self) -> Evidence:
        return Evidence()

    @override
    def advance(self, memory: Any, seen: Estimate) -> Evidence:
        state: Evidence = memory
        for look in seen.looks:
            state = self.taken(state, found=self.target in look.seen)
        return state

    def taken(self, state: Evidence, *, found: bool) -> Evidence:
        """Return the test after one more frame."""
        decided = not self.lower < state.ratio < self.upper
        ratio, frames = (0.0, 0) if decided else (state.ratio, state.frames)
        if found:
            ratio += math.log(self.p1 / self.p0)
        else:
            ratio += math.log((1.0 - self.p1) / (1.0 - self.p0))
        present = state.present
        if ratio >= self.upper:
            present = True
        elif ratio <= self.lower:
            present = False
        return Evidence(ratio, frames + 1, present)

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        ratio, frames, present = memory
        why = f"log likelihood ratio of {frames} frames"
        if present is None:
            return Verdict(None, f"not decided yet: {why}", ratio, self.upper, ratio - self.upper)
        threshold = self.lower if present else self.upper
        return Verdict(present, why, ratio, threshold, ratio - threshold)

    @override
    def region(self) -> Region:
        test = f"p0 {self.p0:g}, p1 {self.p1:g}, {self.lower:.3g} to {self.upper:.3g}"
        name = f"log likelihood ratio of {self.target} ({test})"
        ratio = Quantity(name, least=-math.inf, sees=self.target)
        return Region(
            ({ratio: Interval.above(self.lower)},), ({ratio: Interval.at_least(self.upper)},)
        )
