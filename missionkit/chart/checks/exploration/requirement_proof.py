"""Requirements, decided before the flight where the chart alone decides them.

A requirement is proved if no run of the exploration breaks it, whatever the guards say that it
leaves open; it is refuted if some run surely does. How long a behaviour takes, and what a guard
says of the world, is left open by the chart: what depends on that is open. So only what the chart
itself decides, its states and variables, refutes that something holds or comes before, and only
a run that the engine has flown, through situations that are chosen for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from heapq import heappop, heappush
from math import inf
from typing import NamedTuple

from missionkit.chart.checks.exploration import clocks
from missionkit.chart.checks.exploration.concrete_flight import Run, Ticked
from missionkit.chart.checks.exploration.concrete_run import Concrete, Does
from missionkit.chart.checks.exploration.exploration_result import Exploration, Link
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.observations import Edge, Step, sooner
from missionkit.chart.checks.exploration.requirement_truth import Moments
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.requirements import Moment, Requirement
from missionkit.chart.semantics.requirement_watch import results

Way = Sequence[tuple[int, Edge, int]]  # from a node to another


class Standing(StrEnum):
    """What is known of a requirement before the flight."""

    PROVED = "proved"
    REFUTED = "refuted"
    OPEN = "open"


class Proof(NamedTuple):
    """What is known of a requirement, and the run that breaks it."""

    requirement: Requirement
    standing: Standing
    run: Run | None = None  # flown by the engine
    always: bool = False  # every run breaks it


class State(NamedTuple):
    """How far a requirement has come on a run."""

    opened: bool
    closed: bool = False
    seen: bool = False  # what must come before has come


Product = tuple[int, State]
Came = Mapping[Product, tuple[Product, Edge]]


def proofs(chart: ExploredChart, explored: Exploration) -> Iterator[Proof]:
    """Yield what is known of each requirement of a chart, in the order of the file."""
    concrete = Concrete(chart, explored)
    for requirement in chart.analysed.mission.requirements:
        yield _Prover(concrete, requirement).proof()


class _Prover:
    """Searches the runs of a chart for one that breaks a requirement."""

    def __init__(self, concrete: Concrete, requirement: Requirement) -> None:
        self.concrete = concrete
        self.chart = chart = concrete.chart
        self.explored = concrete.explored
        self.model = requirement
        always = requirement.always
        self.fails = None if always is None else ex.Not(always, always.place)
        self.limit = inf if requirement.limit is None else requirement.limit
        self.refuting = False  # only the chart's own states and variables count as sure
        self.moments = Moments(chart)

    def proof(self) -> Proof:
        """Return what is known of the requirement."""
        if self.model.existence is not None or self.model.response is not None:
            return self._of_what_must_come()
        self.refuting = True
        way = self._breaking(sure=True)
        self.refuting = False
        if way:
            return self._refuted(way, self._broken)
        if self.explored.complete and not self._breaking(sure=False):
            return Proof(self.model, Standing.PROVED)
        return Proof(self.model, Standing.OPEN)

    def _of_what_must_come(self) -> Proof:
        """Refute what never comes, or not in time, once it is called for."""
        model, response, truth = self.model, self.model.response, self.moments.truth
        wanted = model.existence if response is None else response.then
        called = model.after if response is None else response.when
        if not self.explored.complete:
            return Proof(model, Standing.OPEN)
        ends = [it for it in self._edges() if truth(wanted, it[1]).may]
        soon = sooner(self.explored.edges, ends)
        if called is None:
            late = self._too_late(soon.get(0, inf))
            return Proof(model, Standing.REFUTED if late else Standing.OPEN, always=late)
        calls = [(n, edge) for n, edge in self._edges() if truth(called, edge).may]
        scoped = model.while_ is not None or (
            response is not None and (model.after or model.before)
        )
        if not calls or (not scoped and all(self._answered(wanted, edge) for _, edge in calls)):
            return Proof(model, Standing.PROVED)
        for number, edge in () if scoped else calls:
            late = self._too_late(min(soon.get(to, inf) for to in edge.to))
            if late and truth(called, edge).surely and not truth(wanted, edge).may:
                return self._refuted(self._path(number, edge), _taking(edge.step))
        return Proof(model, Standing.OPEN)

    def _refuted(self, way: Way, does: Does) -> Proof:
        """Return a requirement as refuted if the engine flies a run, as open otherwise."""
        links: dict[int, list[Link]] = {}
        for start, edge, to in way[:-1]:
            links.setdefault(start, []).append(Link(to, edge.step))
        last, edge, _ = way[-1]
        run = self.concrete.run({last: [edge.step]}, does, links)
        if run is None:
            return Proof(self.model, Standing.OPEN)
        return Proof(self.model, Standing.REFUTED, run)

    def _broken(self, tried: Ticked) -> bool:
        """Say whether the requirement's own monitor finds it broken after a tick."""
        watched, monitors = self.concrete.flier.flown.watch.requirements, tried.run.memory.monitors
        every = results(watched, monitors, over=False)
        return any(it.fulfilled is False for it in every if it.name == self.model.name)

    def _too_late(self, seconds: float) -> bool:
        return seconds == inf or seconds > self.limit

    def _answered(self, wanted: Moment | None, edge: Edge) -> bool:
        return self.moments.truth(wanted, edge).surely

    def _edges(self) -> Iterator[tuple[int, Edge]]:
        for number, edges in self.explored.edges.items():
            yield from ((number, edge) for edge in edges if edge.observed is not None)

    def _breaking(self, *, sure: bool) -> Way:
        """Return a run that breaks a safety requirement, empty if there is none.

        Args:
            sure: it must break it; otherwise it is enough that it may.
        """
        first = (0, State(opened=self.model.after is None))
        costs: dict[Product, float] = {first: 0.0}  # s since the requirement counts, at the least
        came: dict[Product, tuple[Product, Edge]] = {}
        waiting = [(0.0, 0, first)]
        while waiting:
            cost, _, here = heappop(waiting)
            if cost > costs[here]:
                continue
            for edge, later, after, broken in self._following(here, cost, sure=sure):
                if broken:
                    return self._way(came, here, edge)
                for there in ((to, after) for to in edge.to):
                    if later < costs.get(there, inf):
                        costs[there], came[there] = later, (here, edge)
                        heappush(waiting, (later, len(came), there))
        return ()

    def _following(
        self, here: Product, cost: float, *, sure: bool
    ) -> Iterator[tuple[Edge, float, State, bool]]:
        """Yield the edges from a place in the search, the time then, and what they do.

        Args:
            here: the node, and how far the requirement has come there.
            cost: s since it counts, at the least.
            sure: look for what surely breaks it.
        """
        number, state = here
        for edge in self.explored.edges.get(number, ()):
            later = cost + edge.step.seconds if state.opened else 0.0
            after, broken = state, False
            if edge.observed is not None:
                after, broken = self._stepped(number, state, edge, sure=sure)
            if later > self.limit and self._timed:
                continue  # it no longer counts
            if not after.closed:
                yield edge, later, after, broken

    @property
    def _timed(self) -> bool:
        return self.model.precedence is None

    def _stepped(self, number: int, state: State, edge: Edge, *, sure: bool) -> tuple[State, bool]:
        """Return how far the requirement has come after a tick, and whether that breaks it."""
        model = self.model
        opened = state.opened or self._happens(model.after, edge, sure=sure)
        if not opened:
            return state, False
        if model.precedence is None and self._happens(model.before, edge, sure=not sure):
            return State(opened, closed=True), False
        during = model.while_ is None or self._happens(model.while_, edge, sure=sure)
        if model.precedence is not None:
            seen = state.seen or self._happens(model.precedence, edge, sure=not sure)
            called = self._happens(model.before, edge, sure=sure)
            late = seen and not sure and not self._in_time(number, edge)
            return State(opened, seen=seen), called and during and (not seen or late)
        if model.never is not None:
            return State(opened), during and self._happens(model.never, edge, sure=sure)
        return State(opened), during and self._happens(self.fails, edge, sure=sure)

    def _in_time(self, number: int, edge: Edge) -> bool:
        """Say whether what came before a moment surely did so within the time bound."""
        if self.limit == inf:
            return True
        first, observed = self.model.precedence, edge.observed
        if not isinstance(first, ex.Enter) or observed is None:
            return False
        if first.state in observed.entered:
            return True
        node = self.explored.nodes[number]
        age = clocks.resting(node.ages, self.chart.limits).get(first.state)
        return age is not None and age.high <= self.limit

    def _happens(self, moment: Moment | None, edge: Edge, *, sure: bool) -> bool:
        if moment is None:
            return False
        truth = self.moments.truth(moment, edge)
        if sure and self.refuting:
            return truth.surely and self.moments.of_chart(moment)
        return truth.surely if sure else truth.may

    def _way(self, came: Came, here: Product, edge: Edge) -> Way:
        """Return the way to a place in the search, and one more edge from it."""
        found = [(here[0], edge, edge.to[0])]
        while here in came:
            before, edge = came[here]
            found.append((before[0], edge, here[0]))
            here = before
        return found[::-1]

    def _path(self, number: int, edge: Edge) -> Way:
        """Return the shortest way to a tick that is an edge from a node."""
        found = [(number, edge, edge.to[0])]
        node = self.explored.nodes[number]
        while node.before is not None and node.step is not None:
            found.append((node.before.number, Edge((node.number,), node.step, None), node.number))
            node = node.before
        return found[::-1]


def _taking(step: Step) -> Does:
    return lambda tried: tried.taken == step.taken
