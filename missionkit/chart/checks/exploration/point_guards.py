"""The chart as it flies, its leaf guards answered by one value of each quantity they read.

Everything else is the engine's own: latches, hold times, timers, invariants and requirements.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from typing_extensions import override

from missionkit.chart.checks.exploration.explored_chart import ExploredChart, NotedMoves
from missionkit.chart.checks.exploration.leaf_compiler import LeafCompiler
from missionkit.chart.checks.guard_regions import GuardRegion, RegionReader
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.semantics.chart_compiler import compile_with
from missionkit.chart.semantics.compiled_chart import (
    Chart,
    CompiledState,
    GuardContext,
    GuardFunction,
)
from missionkit.chart.semantics.guard_compiler import answered
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Boxes, Interval, Quantity

Point = Mapping[Quantity, float | None]  # None: the quantity is not known


@dataclass(slots=True)
class World:
    """What the guards see in a tick."""

    point: Point = field(default_factory=dict)
    broken: bool = False  # the invariants of the kinds of state do not hold


class PointGuard(NamedTuple):
    """A guard that reads quantities."""

    truth: GuardRegion
    measured: Quantity | None  # whose value is that of its verdict


def flown_chart(chart: ExploredChart, world: World) -> tuple[Chart, NotedMoves]:
    """Return a chart as the engine compiles it, but for leaf guards, which look at `world`.

    Args:
        chart: that was explored.
        world: what the guards see; it is changed from tick to tick.
    """
    flown, _ = point_chart(chart.analysed, world)
    moves = NotedMoves()
    return replace(flown, moves=moves), moves


def point_chart(chart: AnalysedChart, world: World) -> tuple[Chart, Mapping[str, PointGuard]]:
    """Return the same for any chart, and its leaf guards by name.

    Args:
        chart: its contracts are carried out.
        world: what the guards see; it is changed from tick to tick.
    """
    asker = _PointCompiler(dict(chart.mission.guards), chart.reader, world)
    compiled = compile_with(asker, chart.mission, chart.tree.catalogue)
    states = {name: _state(state, world) for name, state in compiled.states.items()}
    return replace(compiled, states=states), asker.leaves


def _state(state: CompiledState, world: World) -> CompiledState:
    if state.kind.invariant is None:
        return state

    def check(_: Estimate, __: str | None) -> Verdict:
        return Verdict(holds=not world.broken)

    kept = replace(state.kind.invariant, check=check)
    return replace(state, kind=replace(state.kind, invariant=kept))


class _PointCompiler(LeafCompiler):
    def __init__(self, named: dict[str, ex.Expression], reader: RegionReader, world: World) -> None:
        super().__init__(named)
        self._reader, self._world = reader, world
        self.leaves: dict[str, PointGuard] = {}

    @override
    def _latch(self, name: str, latch: ex.Hysteresis) -> GuardFunction:
        if self._reader.measured(latch.part) is None:
            return self._leaf(name, latch)
        return super()._latch(name, latch)

    @override
    def _leaf(self, name: str, guard: ex.Expression) -> GuardFunction:
        truth, world = self._reader.truth(guard), self._world
        measured = self._reader.measured(guard)
        self.leaves[name] = PointGuard(truth, measured)

        def ask(question: GuardContext) -> Verdict:
            point = as_seen(world.point, question.seen)
            value = None if measured is None else point.get(measured)
            if lies_in(point, truth.surely):
                return Verdict(True, "", value)  # noqa: FBT003
            if lies_in(point, truth.surely_not):
                return Verdict(False, "", value)  # noqa: FBT003
            return Verdict.unknown("not known")

        return answered(name, ask)


def as_seen(point: Point, seen: Estimate) -> Point:
    """Return what is left of a point where a state was just entered, and clocks no older than it.

    Args:
        point: at the beginning of the tick.
        seen: by the guards; without a goal after the state that commands was entered.
    """
    if not any(quantity.at_entry != "kept" for quantity in point):
        return point
    age = seen.now - seen.entered_at
    if seen.goal is None:
        return {q: v if q.at_entry == "kept" else _at_entry(q) for q, v in point.items()}
    return {q: min(v, age) if v is not None and _clock(q) else v for q, v in point.items()}


def _at_entry(quantity: Quantity) -> float | None:
    return 0.0 if quantity.at_entry == "zero" else None


def _clock(quantity: Quantity) -> bool:
    return quantity.at_entry == "zero" and quantity.unit == "s"


def lies_in(point: Point, boxes: Boxes) -> bool:
    """Say whether a point lies in one of some boxes.

    A quantity that the point does not name is not known; a truth value is false.
    """
    return any(
        all(_inside(span, value_of(point, quantity)) for quantity, span in box.items())
        for box in boxes
    )


def value_of(point: Point, quantity: Quantity) -> float | None:
    """Return the value of a quantity at a point, as `lies_in` reads it."""
    if quantity in point:
        return point[quantity]
    is_truth = quantity.whole and (quantity.least, quantity.most) == (0.0, 1.0)
    return 0.0 if is_truth and not quantity.words else None


def _inside(span: Interval | None, value: Any) -> bool:
    if span is None or value is None:
        return span is None and value is None
    above = value > span.low or (value == span.low and not span.low_open)
    return above and (value < span.high or (value == span.high and not span.high_open))
