"""What a tracker knows about targets: how they move, where they head, when they reverse."""

from __future__ import annotations

import math
from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.geometry import wrap
from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate, Target, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.messages.robot_modes import LIKELY
from missionkit.plugin import Guard
from missionkit.units import Degrees, Fraction, Seconds

ModeName = Literal["straight", "spin", "circling", "standing"]
COUNTED = {
    "any": Quantity("tracked targets in view", whole=True),
    "target": Quantity("targets in view", whole=True),
    "obstacle": Quantity("obstacle robots in view", whole=True),
}


class TargetMode(Guard):
    """Holds while a tracked target moves by `mode` with a probability of `at_least`.

    The probabilities are those of the tracker's models of motion (P4, section III-C): `straight`,
    `spin`, `circling` as an obstacle robot does; with `estimator: static`, `standing`. Unknown
    until the target's heading is known.
    """

    kind: ClassVar[str] = "target_mode"
    target: str
    mode: ModeName = Field(description="model of motion")
    at_least: Fraction = Field(default=0.5, description="probability")

    @override
    def check(self, seen: Estimate) -> Verdict:
        found = seen.targets.get(self.target)
        if found is None:
            return Verdict.unknown(f"{self.target} is not tracked")
        if not found.modes:
            return Verdict.unknown(f"it is not known yet how {self.target} moves")
        probability = found.modes.get(self.mode)
        if probability is None:
            return Verdict.unknown(f"the tracker has no mode {self.mode!r}")
        return Verdict.at_least(probability, self.at_least, found.name)

    @override
    def region(self) -> Region:
        probability = Quantity(f"{self.mode} of {self.target}", most=1.0, sees=self.target)
        return Region.of(probability, Interval.at_least(self.at_least))


class TargetHeading(Guard):
    """Holds while a tracked target heads within `within_deg` of the direction `heading_deg`.

    Directions are those of a compass. Unknown while the heading is not known, or less certain than
    `sd_deg`.
    """

    kind: ClassVar[str] = "target_heading"
    target: str
    heading_deg: Degrees
    within_deg: Degrees = Field(default=45.0, gt=0, le=180)
    sd_deg: Degrees = Field(default=20.0, gt=0, description="largest 1-sigma of a known heading")

    @override
    def check(self, seen: Estimate) -> Verdict:
        found = seen.targets.get(self.target)
        if found is None:
            return Verdict.unknown(f"{self.target} is not tracked")
        sd = found.heading_sd
        if found.heading is None or sd is None:
            return Verdict.unknown(f"the heading of {self.target} is not known yet")
        if math.degrees(sd) > self.sd_deg:
            return Verdict.unknown(f"its heading is uncertain by {math.degrees(sd):.0f} deg")
        off = math.degrees(abs(wrap(found.heading - math.radians(self.heading_deg))))
        return Verdict.at_most(off, self.within_deg, found.name)

    @override
    def region(self) -> Region:
        off = f"heading of {self.target} off {self.heading_deg:g} deg"
        quantity = Quantity(off, most=180.0, unit="deg", sees=self.target)
        return Region.of(quantity, Interval.at_most(self.within_deg))


class TargetsInView(ComparedGuard):
    """Holds while `at_least` tracked targets were seen within the last `within` seconds.

    `what` counts those alone that are likelier a `target`, or an `obstacle` robot, than not.
    """

    kind: ClassVar[str] = "targets_in_view"
    at_least: int = Field(default=1, ge=1, le=100, description="targets")
    what: Literal["any", "target", "obstacle"] = Field(default="any", description="is counted")
    within: Seconds = 0.5

    @override
    def measured(self, seen: Estimate) -> float | str:
        tracked = [it for name, it in seen.targets.items() if it.classes and it.name == name]
        return float(sum(self._counts(it, seen.now) for it in tracked))

    def _counts(self, it: Target, now: float) -> bool:
        fresh = it.seen_at is not None and now - it.seen_at <= self.within
        return fresh and (self.what == "any" or it.classes.get(self.what, 0.0) > LIKELY)

    @override
    def comparison(self) -> Comparison:
        return Comparison(COUNTED[self.what], "at_least", float(self.at_least))


class TimeToReversal(Guard):
    """Holds while a tracked target reverses by its clock in `at_most`, or `at_least`, seconds.

    A ground robot turns round every 20 s; a bump turns it too and leaves the clock alone. Unknown
    until a spin was seen whole, and while the spins that were seen contradict each other.
    """

    kind: ClassVar[str] = "time_to_reversal"
    target: str
    at_most: Seconds | None = Field(default=None, description="greatest time")
    at_least: Seconds | None = Field(default=None, description="least time")

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.at_least is None) == (self.at_most is None):
            raise ValueError("expected one of 'at_least' and 'at_most'")
        return self

    @override
    def check(self, seen: Estimate) -> Verdict:
        found = seen.targets.get(self.target)
        if found is None:
            return Verdict.unknown(f"{self.target} is not tracked")
        if found.reversal_in is None:
            return Verdict.unknown(f"the clock of {self.target} is not known yet")
        if self.at_most is not None:
            return Verdict.at_most(found.reversal_in, self.at_most, found.name)
        return Verdict.at_least(found.reversal_in, self.at_least or 0.0, found.name)

    @override
    def region(self) -> Region:
        quantity = Quantity(f"time to the reversal of {self.target}", unit="s", sees=self.target)
        if self.at_most is not None:
            return Region.of(quantity, Interval.at_most(self.at_most))
        return Region.of(quantity, Interval.at_least(self.at_least or 0.0))
