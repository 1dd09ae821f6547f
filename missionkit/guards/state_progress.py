"""Progress of the active state."""

from __future__ import annotations

from typing import Any, ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import norm
from missionkit.guards.comparison import ComparedGuard, Comparison, FlagGuard
from missionkit.guards.distances import GOAL_DISTANCE
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import WindowGuard
from missionkit.units import Metres, Seconds

DONE_QUANTITY = Quantity("done", most=1.0, whole=True, at_entry="zero")
TIME_IN_STATE = Quantity("time in the state", unit="s", at_entry="zero")
NO_NEARER = Quantity("time no nearer to the goal", unit="s", at_entry="zero")


class Done(FlagGuard):
    """Holds when the active state's behaviour says it has finished."""

    kind: ClassVar[str] = "done"

    @override
    def quantity(self) -> Quantity:
        return DONE_QUANTITY

    @override
    def raised(self, seen: Estimate) -> bool:
        return seen.done


class Elapsed(ComparedGuard):
    """Holds once the active state has been active for `longer_than`; `after:` as a guard."""

    kind: ClassVar[str] = "elapsed"
    longer_than: Seconds

    @override
    def measured(self, seen: Estimate) -> float | str:
        return seen.now - seen.entered_at

    @override
    def comparison(self) -> Comparison:
        return Comparison(TIME_IN_STATE, "at_least", self.longer_than)


class Approach(NamedTuple):
    """The nearest the vehicle has been to its goal in this state, and when."""

    entered_at: float
    nearest: float
    at: float


class GoalUnreachable(WindowGuard):
    """Holds while the goal is further than `further_than` and came no nearer for `longer_than`.

    ||e_p|| > e_max for t > t_threshold  (P1, section 7.2, failsafe 3)

    The paper's timer restarts whenever the distance shrinks by `progress`, so that a
    long leg is not taken for an unreachable goal. Without commands, before `--resume`, it
    stands still.
    """

    kind: ClassVar[str] = "goal_unreachable"
    further_than: Metres = Field(default=1.5, gt=0)
    longer_than: Seconds = 20.0
    progress: Metres = Field(default=0.5, gt=0)

    @override
    def begin(self) -> Approach | None:
        return None

    @override
    def advance(self, memory: Any, seen: Estimate) -> Approach | None:
        best: Approach | None = memory
        if seen.goal is None:
            return None
        distance = norm(seen.position - seen.goal.position)
        if (
            best is None
            or best.entered_at != seen.entered_at
            or distance < best.nearest - self.progress
        ):
            return Approach(seen.entered_at, distance, seen.now)
        return best

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        best: Approach | None = memory
        if best is None or seen.goal is None:
            return Verdict.unknown("the behaviour has no goal yet")
        distance = norm(seen.position - seen.goal.position)
        if distance <= self.further_than:
            return Verdict.above(distance, self.further_than, "distance to the goal, m")
        return Verdict.above(seen.now - best.at, self.longer_than, "no nearer, s")

    @override
    def resumed(self, memory: Any, gap: float) -> Approach | None:
        best: Approach | None = memory
        return None if best is None else best._replace(at=best.at + gap)

    @override
    def region(self) -> Region:
        stuck = {
            GOAL_DISTANCE: Interval.above(self.further_than),
            NO_NEARER: Interval.above(self.longer_than),
        }
        return Region((stuck,))
