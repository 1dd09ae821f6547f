"""Search through everything that a chart can do, the shortest runs first."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Sequence
from typing import Any, cast

from missionkit.chart.checks.exploration import clocks
from missionkit.chart.checks.exploration.clocks import ENTERED, Age, Ages
from missionkit.chart.checks.exploration.exploration_result import (
    Circle,
    Disarming,
    Example,
    Exploration,
    Link,
    Node,
    Tick,
    joined,
)
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.held_guards import LongAgo
from missionkit.chart.checks.exploration.independent_regions import independent
from missionkit.chart.checks.exploration.observations import Edge, Observed, Step
from missionkit.chart.checks.exploration.oracle import LONG_AGO, Choice, Situation
from missionkit.chart.checks.interval_boxes import EVERYWHERE, kept_at_entry
from missionkit.chart.semantics.chart_memory import ChartMemory, begin
from missionkit.chart.semantics.configuration import configuration
from missionkit.chart.semantics.step import decide
from missionkit.messages import ABORT, Action, Estimate, Goal, VehicleStatus
from missionkit.messages.region import Boxes
from missionkit.plugin_containment import Containment

MOST_TICKS = 25_000  # ticks tried in one chart
TICKS_EACH = 25  # for each state, in a chart that is larger than that
MOST_AGES = 6  # intervals of the clocks kept apart, for one situation of the chart
MOST_INTERVALS = 400_000  # of quantities, worked out on the way
MOST_EVENTS = 2  # from outside in one tick, where their order can matter
MICROSTEPS = 8  # that take as long as a tick
STATES = 8  # that make a tick take as long again
NOWHERE = cast("Any", ())
GOAL = Goal(NOWHERE, None, 0.0)
SEEN = Estimate(0.0, NOWHERE, NOWHERE, NOWHERE, NOWHERE, NOWHERE)
IN_AIR = VehicleStatus(0.0, armed=True, in_air=True, ready=True, mode="")


class Search:
    """Explores one chart."""

    def __init__(self, chart: ExploredChart, most: int = MOST_TICKS) -> None:
        self.chart = chart
        self.most = most
        self.ticks = 0
        self.nodes: list[Node] = []
        self.waiting: deque[Node] = deque()
        self.known: dict[Any, list[Node]] = {}
        self.edges: dict[int, list[Edge]] = {}
        self.kept: dict[int, tuple[Boxes, Boxes]] = {}
        self.ends: dict[Any, Observed] = {}  # each once: what they say is worked out once
        self.observed = bool(chart.analysed.mission.requirements)
        self.taken: dict[int, Example] = {}
        self.rests: dict[int, Boxes] = {}
        self.links: dict[int, list[Link]] = {}
        self.reached: dict[str, Node] = {}
        self.left: dict[str, dict[int, float]] = {}
        self.circles: list[Circle] = []
        self.disarming: list[Disarming] = []
        self.complete = True
        self.held: list[LongAgo] = []

    def run(self) -> Exploration:
        """Return everything that can happen, or what was found up to the bound."""
        first = begin(self.chart.chart, 0.0)
        self._add(Node(0, first, self._ages(first.active), None, None))
        while self.waiting:
            if self._exhausted():
                self.complete = False
                break
            self._follow(self.waiting.popleft())
        return Exploration(
            *(self.nodes, self.taken, self.reached, self.left),
            *(self.circles, self.disarming, self.rests, self.links),
            *(self.edges, self.complete, self.ticks),
        )

    def _exhausted(self) -> bool:
        return self.ticks >= self.most or self.chart.oracle.work >= MOST_INTERVALS

    def _ages(self, active: Sequence[str]) -> dict[str, Age]:
        return {name: Age(0.0, 0.0, 0) for name in active if self.chart.limits[name]}

    def _add(self, node: Node) -> int:
        """Keep a node unless it is known for all its ages; return the number that stands for it."""
        memory, limits = node.memory, self.chart.limits
        every = clocks.groups(node.ages, limits)
        cell = tuple([clocks.following(age.low, each) for age, each in every.values()])
        key = (
            *(memory.active, memory.started, memory.ended, node.aloft, cell, _waits(node)),
            tuple(memory.history.items()),
            self.chart.capped(memory.variables),
            tuple([each.event for each in memory.delayed]),
            tuple([age.group for age in node.ages.values()]),
        )
        known = self.known.setdefault(key, [])
        for each in known:
            if clocks.inside(node.ages, each.ages):
                return each.number
        if len(known) >= MOST_AGES:
            node = node._replace(ages=clocks.widened(node.ages, limits))
        node = node._replace(number=len(self.nodes))
        known.append(node)
        self.nodes.append(node)
        self.waiting.append(node)
        for name in memory.active:
            self.reached.setdefault(name, node)
        return node.number

    def _follow(self, node: Node) -> None:
        """Add every node that one tick or time leads to."""
        limits = self.chart.limits
        ages = clocks.resting(node.ages, limits) if node.memory.started else dict(node.ages)
        rests = False
        ticks = _waits(node)
        if node.memory.started and (node.step is None or node.step.taken):
            situation = Situation(self.chart.oracle, (), 0.0)
            self._note(node, ages, self._tick(node, situation, (ABORT,)))
        every = [(), *self._events(node.memory, ())]
        for events in every:
            for tick in self._paths(node, ages, events):
                rests = self._note(node, ages, tick) or rests
                if tick.moves and self.chart.judges_itself:
                    every += [it for it in self._events(tick.memory, events) if it not in every]
        for seconds, later in clocks.passed(node.ages, limits):
            if not rests and (ticks or seconds > clocks.TICK):
                continue  # something happens at every tick
            step = Step(seconds, (), (), EVERYWHERE)
            to = self._add(Node(0, node.memory, later, node, step, node.aloft))
            self._link(node, (to,), step)
            self._connect(node, Edge((to,), step, None))

    def _note(self, node: Node, ages: Ages, tick: Tick) -> bool:
        """Add what a path leads to; say whether nothing happens on it."""
        self._note_taken(node, tick)
        if tick.circle:
            self.circles.append(Circle(node, tick.step, tick.circle))
            for active, _ in self.chart.moves.noted:
                self.reached.update(dict.fromkeys(active, node) | self.reached)
        if not tick.moves:
            self._observe(node, tick, (node.number,))
            return not tick.step.events and self._note_rest(node, tick)
        kept = set(node.memory.active)
        for move in tick.moves:
            kept &= set(move.kept)
            for name in move.active:
                self.reached.setdefault(name, node)
        self._note_left(node, tick, kept)
        aloft = self._aloft(node, tick)
        later = {
            name: ages[name] if name in kept else ENTERED
            for name in tick.memory.active
            if self.chart.limits[name]
        }
        parts = clocks.split(later, self.chart.limits)
        nodes = (Node(0, tick.memory, part, node, tick.step, aloft) for part in parts)
        to = tuple(map(self._add, nodes))
        self._link(node, to, tick.step)
        self._observe(node, tick, to)
        return False

    def _link(self, node: Node, to: tuple[int, ...], step: Step) -> None:
        links = self.links.setdefault(node.number, [])
        links += [Link(number, step) for number in to]

    def _observe(self, node: Node, tick: Tick, to: tuple[int, ...]) -> None:
        """Note what a tick leads to and what requirements see at its end."""
        if not self.observed:
            return
        entered = frozenset([entry.name for move in tick.moves for entry in move.entries])
        boxes = tick.step.boxes
        if tick.moves and not tick.fresh:  # no guard was asked since
            boxes = self._kept(boxes)
        ends = Observed(tick.memory.active, entered, tick.memory.variables, boxes)
        key = (ends.active, entered, id(ends.variables), id(boxes))
        self._connect(node, Edge(to, tick.step, self.ends.setdefault(key, ends)))

    def _kept(self, boxes: Boxes) -> Boxes:
        """Return what entering a state leaves of boxes: the same object for the same boxes."""
        known = self.kept.get(id(boxes))
        if known is None:
            known = self.kept[id(boxes)] = (boxes, kept_at_entry(boxes))
        return known[1]

    def _connect(self, node: Node, edge: Edge) -> None:
        if self.observed:
            self.edges.setdefault(node.number, []).append(edge)

    def _note_taken(self, node: Node, tick: Tick) -> None:
        for number in tick.step.taken:
            known = self.taken.get(number)
            if known is None or (known.undone and not tick.circle):
                self.taken[number] = Example(node, tick.step, undone=bool(tick.circle))

    def _note_rest(self, node: Node, tick: Tick) -> bool:
        if not tick.waits or node.number not in self.rests:
            self.rests[node.number] = tick.step.boxes
        return True

    def _aloft(self, node: Node, tick: Tick) -> bool:
        """Say whether the vehicle may be in the air when a tick acts; note one that disarms it."""
        active, started = node.memory.active, node.memory.started
        taken = tick.step.taken
        aloft = self.chart.off_ground.after(active, taken, started=started, before=node.aloft)
        if aloft and Action.DISARM in tick.orders:
            self.disarming.append(Disarming(node, tick.step, tick.moves))
        return aloft

    def _note_left(self, node: Node, tick: Tick, kept: set[str]) -> None:
        """Note what ended each state that is not active any more, and how old it was."""
        for name, age in node.ages.items():
            if name not in kept:
                left = self.left.setdefault(name, {})
                for number in tick.step.taken[:1]:
                    left[number] = max(age.low, left.get(number, 0.0))

    def _events(self, memory: ChartMemory, before: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
        """Yield some events, each with one more that may come from outside and is heard."""
        here = configuration(self.chart.chart, memory.active)
        if memory.started and len(before) < MOST_EVENTS:
            heard = self.chart.from_outside(way[0] for ways in here.heard for way in ways)
            yield from ((*before, event) for event in heard)

    def _paths(self, node: Node, ages: Ages, events: tuple[str, ...]) -> Iterator[Tick]:
        plan: Sequence[Choice] | None = ()
        while plan is not None and not self._exhausted():
            situation = Situation(self.chart.oracle, plan, self._age(node.memory, ages))
            situation.ages = {name: age.high for name, age in ages.items()}
            yield self._tick(node, situation, events)
            plan = situation.following()

    def _age(self, memory: ChartMemory, ages: Ages) -> float:
        return ages[memory.state].high if memory.state in ages else math.inf

    def _tick(self, node: Node, situation: Situation, events: tuple[str, ...]) -> Tick:
        """Take one path through a tick by the engine's own selection."""
        self.ticks += 1 + len(node.memory.active) // STATES
        chart, oracle = self.chart.chart, self.chart.oracle
        oracle.situation = situation
        here = configuration(chart, node.memory.active)
        memory = self._prepared(node, situation)
        may_fly = memory.started or self.chart.apart  # another region may fly from the start
        in_air = not here.flying and may_fly and situation.pick(2) == 1
        seen = SEEN._replace(
            state=memory.state,
            entered_at=memory.entered[memory.state],
            done=self.chart.may_be_done(memory.state) and memory.started,
            goal=GOAL,
            events=events,
            status=IN_AIR if in_air else None,
        )
        self.chart.moves.noted.clear()
        contain = Containment()
        after, decision = decide(chart, memory, seen, contain, frugal=True)
        self.ticks += len(self.chart.moves.noted) // MICROSTEPS
        numbers = [numbers_of(key) for key in self.chart.moves.noted]
        taken = tuple([number for each in numbers for number in each if number > 0])
        circle = _period(numbers) if contain.failures else ()
        forced = "" if taken or not decision.fired else decision.fired[0].reason
        step = Step(0.0, events, taken, situation.known.boxes, situation.before, forced)
        waits = any(each.since == SEEN.now for each in self.held)
        return Tick(after, decision.moves, step, circle, decision.orders, situation.fresh, waits)

    def _prepared(self, node: Node, situation: Situation) -> ChartMemory:
        """Return the memory of a node, as of now, with what is left open chosen when asked for."""
        memory = node.memory
        here = configuration(self.chart.chart, memory.active)
        entered = {
            name: -node.ages[name].low if name in node.ages else LONG_AGO for name in memory.active
        }
        timed = (*here.timed, *(each for each in self.chart.chart.failsafes if each.hold))
        held: dict[int, LongAgo] = {}
        self.held = []
        for each in timed if memory.started else ():
            held[each.number] = LongAgo(self.chart.oracle, each, self.held)
            self.held.append(held[each.number])
        violated = {state.name: LONG_AGO for state in here.promising}
        prepared = memory._replace(
            entered=entered, held=cast("Any", held), violated=violated, windows=()
        )
        if not memory.delayed:
            return prepared
        due = situation.pick(len(memory.delayed) + 1)
        delayed = [
            each._replace(due=LONG_AGO if at < due else -LONG_AGO)
            for at, each in enumerate(memory.delayed)
        ]
        return prepared._replace(delayed=tuple(delayed))


def _waits(node: Node) -> bool:
    """Say whether time has passed to a node: then a tick is due in it."""
    before, step = node.before, node.step
    if before is None or step is None or not before.memory.started:
        return False
    return not (step.taken or step.events or step.forced)


def numbers_of(key: Any) -> tuple[int, ...]:
    """Return the transitions of a microstep, by its key in the memo of moves."""
    chosen = key[1]
    return (chosen,) if isinstance(chosen, int) else tuple([each[0] for each in chosen])


def _period(steps: Sequence[tuple[int, ...]]) -> tuple[int, ...]:
    """Return what is taken between the last microstep and the same one before it."""
    last = steps[-1]
    back = next((n for n in range(2, len(steps) + 1) if steps[-n] == last), len(steps))
    return tuple([number for step in steps[-back:-1] or steps[-1:] for number in step])


def explore(chart: ExploredChart, most: int | None = None) -> Exploration:
    """Return everything that a chart can do; independent regions are explored apart.

    Args:
        chart: to explore.
        most: ticks to try; None: as many as the size of the chart warrants.
    """
    if most is None:
        most = max(MOST_TICKS, TICKS_EACH * len(chart.tree.states))
    apart = independent(chart)
    if apart is None:
        return Search(chart, most).run()
    parallel, regions = apart
    return joined([Search(chart.with_one(parallel, it), most).run() for it in regions])
