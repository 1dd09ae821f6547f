"""Runs of the exploration, flown: values, times and what guards remember made concrete.

The exploration lets more happen than can: what guards remember is left open, and so are the ages of
states that were entered at different times. A run that is shown is one that the engine has flown.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from heapq import heappop, heappush
from itertools import chain, islice
from typing import Any, NamedTuple

from missionkit.chart.checks.counterexample_text import point as chosen
from missionkit.chart.checks.exploration.concrete_flight import (
    Flier,
    Instant,
    OutOfTicksError,
    Run,
    Ticked,
    as_flown,
)
from missionkit.chart.checks.exploration.exploration_result import Exploration, Link, Node
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.observations import Step
from missionkit.chart.checks.exploration.point_guards import Point
from missionkit.chart.model import guard_expressions as ex
from missionkit.messages.region import Boxes, Quantity

MOST_VISITS = 2  # flights that have come to one node
MOST_VARIANTS = 2  # of one step
MOST_POINTS = 4  # of the boxes of one step
MOST_LASTING = 2  # situations that are tried to last all the way

Goals = Mapping[int, Sequence[Step]]  # steps to take, by the number of the node that they lead from
Links = Mapping[int, Sequence[Link]]
Does = Callable[[Ticked], bool]


class Leg(NamedTuple):
    """One step of a run, and the node that it leads to, None for the last."""

    step: Step
    before: Node
    to: Node | None


class Concrete:
    """Finds flights through an explored chart.

    Args:
        chart: that was explored.
        explored: what it can do.
    """

    def __init__(self, chart: ExploredChart, explored: Exploration) -> None:
        self.chart, self.explored = chart, explored
        self.links = explored.links
        self.latching = list(_latching(chart))
        self.lasting: list[Point] = []  # what has to hold for a while on the way

    @cached_property
    def flier(self) -> Flier:
        """The chart, compiled for its flights when the first is wanted."""
        return Flier(self.chart)

    def taking(self, number: int) -> Run | None:
        """Return a flight that takes a transition, None if none was found."""
        goals: dict[int, list[Step]] = {}
        for start, links in self.explored.links.items():
            for link in links:
                if number in link.step.taken and link.step not in goals.get(start, ()):
                    goals.setdefault(start, []).append(link.step)
        return self.run(goals, lambda tried: number in tried.taken and not tried.restless)

    def run(self, goals: Goals, does: Does, links: Links | None = None) -> Run | None:
        """Return a flight that ends with one of some steps, None if none was found.

        Args:
            goals: the steps.
            does: says of a tick whether it does what is wanted.
            links: the steps to follow on the way, if not all.
        """
        self.links = self.explored.links if links is None else links
        try:
            return self._nearest(goals, does)
        except OutOfTicksError:
            return None

    def _nearest(self, goals: Goals, does: Does) -> Run | None:
        """Follow flights from node to node, those that are the fewest steps from a goal first."""
        far = self._distances(goals)
        if 0 not in far:
            return None
        self.lasting = self._lasting(far)
        waiting = [(far[0], 0, 0, self._begin(goals))]
        visits: Counter[int] = Counter()
        known: set[Any] = set()
        while waiting:
            _, _, number, run = heappop(waiting)
            visits[number] += 1
            if visits[number] > MOST_VISITS:
                continue
            found = self._ended(run, number, goals, does)
            if found is not None:
                return found
            for to, later in self._onward(run, number, far):
                key = _key(to, later)
                if key not in known:
                    known.add(key)
                    heappush(waiting, (far[to], len(known), to, later))
        return None

    def _ended(self, run: Run, number: int, goals: Goals, does: Does) -> Run | None:
        """Return a flight that takes a wanted step from a node, None if it takes none."""
        node = self.explored.nodes[number]
        for step in goals.get(number, ()):
            found = next(filter(does, self._acted_on(run, Leg(step, node, None))), None)
            if found is not None:
                return found.run
        return None

    def _onward(self, run: Run, number: int, far: Mapping[int, int]) -> Iterator[tuple[int, Run]]:
        """Yield flights from a node to those that lead to a goal, with their numbers."""
        nodes = self.explored.nodes
        for link in self.links.get(number, ()):
            if link.to in far:
                followed = self._followed(run, Leg(link.step, nodes[number], nodes[link.to]))
                yield from ((link.to, later) for later in islice(followed, MOST_VARIANTS))

    def _begin(self, goals: Goals) -> Run:
        run = self.flier.begin()
        variables = {**run.memory.variables, **_words(goals, self.chart)}
        return run._replace(memory=run.memory._replace(variables=variables))

    def _distances(self, goals: Goals) -> dict[int, int]:
        """Return how many steps each node is from a goal."""
        before: dict[int, list[int]] = {}
        for number, links in self.links.items():
            for link in links:
                before.setdefault(link.to, []).append(number)
        far = dict.fromkeys(goals, 0)
        waiting = deque(goals)
        while waiting:
            number = waiting.popleft()
            for earlier in before.get(number, ()):
                if earlier not in far:
                    far[earlier] = far[number] + 1
                    waiting.append(earlier)
        return far

    def _lasting(self, far: Mapping[int, int]) -> list[Point]:
        """Return situations that must last for a while before some steps on the way are taken."""
        found: list[Point] = []
        for number in far:
            for link in self.links.get(number, ()):
                if link.to in far and not self.flier.holds.keys().isdisjoint(link.step.taken):
                    found += [it for it in _points(link.step.boxes)[:1] if it not in found]
                if len(found) >= MOST_LASTING:
                    return found
        return found

    def _followed(self, run: Run, leg: Leg) -> Iterator[Run]:
        """Yield flights to where a leg leads."""
        step, to = leg.step, leg.to
        if to is None:
            return
        if not (step.taken or step.events or step.forced) and leg.before.memory.started:
            yield from self._waited(run, leg, to)
            return
        for tried in self._acted_on(run, leg):
            if self._stands_as(tried, to):
                yield tried.run

    def _stands_as(self, tried: Ticked, node: Node) -> bool:
        memory, wanted, capped = tried.run.memory, node.memory, self.chart.capped
        alike = memory.active == wanted.active and memory.started == wanted.started
        return alike and capped(memory.variables) == capped(wanted.variables)

    def _acted_on(self, run: Run, leg: Leg) -> Iterator[Ticked]:
        """Yield the ticks in which something happens, in the situations of a step."""
        step = leg.step
        if not (step.taken or step.events or step.forced) and run.memory.started:
            for point in self._merged(leg):
                yield self.flier.tick(run, Instant(run.now, point))
            return
        broken = step.forced.startswith("invariant")
        starts = not (step.taken or step.forced)
        for prelude in chain((run,), self._prepared(run, leg)):
            for point in self._merged(leg):
                for in_air in self.flier.airs(run.memory):
                    instant = Instant(prelude.now, point, step.events, in_air, broken)
                    tried = self.flier.insisted(prelude, instant, starts=starts)
                    if tried is not None:
                        yield tried._replace(run=as_flown(tried.run, step))

    def _waited(self, run: Run, leg: Leg, to: Node) -> Iterator[Run]:
        """Yield flights in which time passes, with and without what is to hold for a while."""
        entered = run.memory.entered
        until = max((entered[name] + age.low for name, age in to.ages.items()), default=run.now)
        following = self.links.get(to.number, ())[:MOST_POINTS]
        wanted = [point for it in following for point in self._merged(Leg(it.step, to, None))]
        resting = self._resting(leg.before)
        for first in ([], *([point] for point in wanted)):
            waited = self.flier.rested(run, until, [*first, *resting, {}, *wanted])
            if waited is not None:
                yield waited

    def _prepared(self, run: Run, leg: Leg) -> Iterator[Run]:
        """Yield the run after a quiet tick that sets or clears a latch."""
        every = [*self._merged(leg), *self._resting(leg.before)] if self.latching else []
        for quantity, value in self.latching:
            quiet = self.flier.quiet(run, [{**point, quantity: value} for point in every])
            if quiet is not None:
                yield quiet

    def _resting(self, node: Node) -> list[Point]:
        points = _points(self.explored.rests.get(node.number, ()))
        return [*({**point, **last} for last in self.lasting for point in points), *points]

    def _merged(self, leg: Leg) -> list[Point]:
        """Return points of a step, also with what lets the chart rest before it."""
        points = _points(leg.step.boxes)
        before = _points(leg.step.before)
        points = [{**it, **point} for it in before[:2] for point in points] or points
        resting = self._resting(leg.before)[:2]
        if leg.to is not None:
            resting += self._resting(leg.to)[:2]
        around = [*resting, *self.lasting]
        return [*points, *({**it, **point} for it in around for point in points[:2])]


def _key(number: int, run: Run) -> Any:
    """Return what tells flights that have come to a node apart."""
    memory = run.memory
    since = tuple(memory.held.items()), tuple(memory.violated.items())
    return number, run.now, tuple(memory.entered.items()), since, memory.windows, memory.delayed


def _points(boxes: Boxes) -> list[Point]:
    ordered = sorted(boxes, key=lambda box: (None in box.values(), len(box)))
    return [
        {q: None if span is None else chosen(q, span) for q, span in box.items()}
        for box in ordered[:MOST_POINTS]
    ]


def _words(goals: Goals, chart: ExploredChart) -> dict[str, str]:
    """Return the strings that variables are set to before the flight."""
    return {
        quantity.name: quantity.words[int(span.low)]
        for steps in goals.values()
        for step in steps
        for box in step.boxes[:1]
        for quantity, span in box.items()
        if quantity.words and span is not None and quantity.name not in chart.assigned
    }


def _latching(chart: ExploredChart) -> Iterator[tuple[Quantity, float]]:
    """Yield the values that set or clear the latches of a chart."""
    reader = chart.analysed.reader
    named = [*chart.analysed.mission.guards.values(), *(guard for _, guard in chart.tree.guards())]
    latches = {part for it in named for part in ex.parts_of(it) if isinstance(part, ex.Hysteresis)}
    for latch in sorted(latches, key=ex.text):
        quantity = reader.measured(latch.part)
        if quantity is not None:
            yield quantity, latch.enter
            yield quantity, latch.exit + (latch.exit - latch.enter) * 0.1
