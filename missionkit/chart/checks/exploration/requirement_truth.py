"""What is known of guards and entries at the end of the ticks of an exploration."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeGuard, cast

from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.observations import Edge, Observed
from missionkit.chart.checks.guard_regions import GuardRegion
from missionkit.chart.checks.interval_boxes import covered, intersection
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.requirements import Moment
from missionkit.chart.semantics.guard_compiler import of_chart
from missionkit.chart.semantics.robustness import leaves, opened_up


class Truth(NamedTuple):
    """Whether something may hold and surely holds, and may fail and surely fails."""

    may: bool
    surely: bool
    may_not: bool
    surely_not: bool


HOLDS, FAILS = Truth(True, True, False, False), Truth(False, False, True, True)  # noqa: FBT003


class Moments:
    """Judges the moments of requirements, each once for what is seen at the end of a tick.

    Args:
        chart: that was explored.
    """

    def __init__(self, chart: ExploredChart) -> None:
        self.chart = chart
        self.guards = chart.analysed.mission.guards
        self.truths: dict[tuple[int, int], Truth] = {}  # by the identities of boxes and guard
        self.ends: dict[tuple[int, int], Truth] = {}  # by those of what is seen and moment
        self.regions: dict[int, GuardRegion] = {}
        self.opened: dict[int, Moment] = {}  # by the identity of the moment, which the model keeps

    def truth(self, moment: Moment | None, edge: Edge) -> Truth:
        """Return what is known of a guard or an entry at the end of a tick."""
        observed = edge.observed
        if moment is None or observed is None:
            return FAILS
        key = (id(observed), id(moment))
        truth = self.ends.get(key)
        if truth is None:
            truth = self.ends[key] = self._of(self._opened(moment), observed)
        return truth

    def _opened(self, moment: Moment) -> Moment:
        if id(moment) not in self.opened:
            self.opened[id(moment)] = opened_up(moment, self.guards)
        return self.opened[id(moment)]

    def _of(self, moment: Moment, observed: Observed) -> Truth:
        match moment:
            case ex.All(parts=parts):
                return _all([self._of(part, observed) for part in parts])
            case ex.Any(parts=parts):
                return _not(_all([_not(self._of(part, observed)) for part in parts]))
            case ex.Not(part=part):
                return _not(self._of(part, observed))
            case ex.Enter(state=state):
                return HOLDS if state in observed.entered else FAILS
            case _:
                return self._leaf(moment, observed)

    def _leaf(self, guard: ex.Expression, observed: Observed) -> Truth:
        if isinstance(guard, ex.In | ex.Finished) or self._assigned(guard):
            return HOLDS if of_chart(guard)(cast("Any", observed)).holds else FAILS
        key = (id(observed.boxes), id(guard))
        if key not in self.truths:
            boxes = observed.boxes
            if id(guard) not in self.regions:
                self.regions[id(guard)] = self.chart.analysed.reader.truth(guard)
            truth = self.regions[id(guard)]
            self.truths[key] = Truth(
                bool(intersection(boxes, truth.may, sure=False)),
                covered(boxes, truth.surely),
                bool(intersection(boxes, truth.may_not, sure=False)),
                covered(boxes, truth.surely_not),
            )
        return self.truths[key]

    def of_chart(self, moment: Moment) -> bool:
        """Say whether a moment depends on states and variables of the chart alone."""
        return all(map(self._is_of_chart, leaves(self._opened(moment))))

    def _is_of_chart(self, leaf: Moment) -> bool:
        return isinstance(leaf, ex.Enter | ex.In | ex.Finished) or self._assigned(leaf)

    def _assigned(self, guard: Moment) -> TypeGuard[ex.VariableGuard]:
        """Say whether a guard compares a variable that the chart itself sets."""
        return isinstance(guard, ex.VariableGuard) and guard.name in self.chart.assigned


def _all(parts: list[Truth]) -> Truth:
    return Truth(
        all(part.may for part in parts),
        all(part.surely for part in parts),
        any(part.may_not for part in parts),
        any(part.surely_not for part in parts),
    )


def _not(truth: Truth) -> Truth:
    return Truth(truth.may_not, truth.surely_not, truth.may, truth.surely)
