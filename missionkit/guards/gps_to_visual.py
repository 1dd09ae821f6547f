"""The paper's composed guard for handing over from GPS to vision."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.guards.detection_confidence import ArucoConfidence, Window
from missionkit.guards.distances import (
    GOAL_DISTANCE,
    NearGoal,
    Within,
    distance_to,
)
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Region
from missionkit.plugin import WindowGuard
from missionkit.units import Fraction, Metres


class GpsToVisual(WindowGuard):
    """Holds when the marker is sure, in range, and the GPS leg has nearly arrived.

    G_gps→visual = C_aruco ∧ C_range ∧ C_proximity  (P1, section 1.2)

    The verdict is that of the first part that fails; the three parts exist as guards of their own.
    """

    kind: ClassVar[str] = "gps_to_visual"
    target: str
    range: Metres = Field(default=8.0, gt=0)
    tolerance: Metres = Field(default=4.0, gt=0)
    window: int = Field(default=30, ge=1, le=10_000)
    confidence: Fraction = 0.7

    @cached_property
    def _sure(self) -> ArucoConfidence:
        exit_at = min(0.5, self.confidence)
        return ArucoConfidence(
            target=self.target, window=self.window, enter=self.confidence, exit=exit_at
        )

    @override
    def begin(self) -> Window:
        return self._sure.begin()

    @override
    def advance(self, memory: Any, seen: Estimate) -> Window:
        return self._sure.advance(memory, seen)

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        verdicts = (
            self._sure.check(memory, seen),
            Within(of=self.target, radius=self.range).check(seen),
            NearGoal(radius=self.tolerance).check(seen),
        )
        failing = [verdict for verdict in verdicts if verdict.holds is False]
        unknown = [verdict for verdict in verdicts if verdict.holds is None]
        return (failing or unknown or list(verdicts))[0]

    @override
    def region(self) -> Region:
        sure = self._sure.region()
        near = {
            distance_to(self.target): Interval.at_most(self.range),
            GOAL_DISTANCE: Interval.at_most(self.tolerance),
        }
        may, surely = sure.may, sure.surely or sure.may
        return Region(({**may[0], **near},), ({**surely[0], **near},))
