"""A chart flown tick by tick through situations that are chosen, as the engine flies it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.observations import Step
from missionkit.chart.checks.exploration.point_guards import Point, World, flown_chart
from missionkit.chart.checks.exploration.search import GOAL, IN_AIR, MICROSTEPS, SEEN, numbers_of
from missionkit.chart.semantics.chart_memory import ChartMemory, Decision, begin
from missionkit.chart.semantics.configuration import configuration
from missionkit.chart.semantics.step import decide
from missionkit.messages.region import Interval
from missionkit.plugin_containment import Containment

TICK = 0.05  # s
MOST_TICKS = 3000  # tried for one run; a tick of many microsteps counts more
MOST_WAITS = 8  # times at which something may become ready, waited for in one step
ROUNDING = 1e-9  # s


class Instant(NamedTuple):
    """What is seen in one tick."""

    now: float  # s
    point: Point
    events: tuple[str, ...] = ()
    in_air: bool = True
    broken: bool = False  # the invariants of the kinds of state do not hold


class Run(NamedTuple):
    """A flight so far."""

    memory: ChartMemory
    now: float  # s, of the next tick
    instants: tuple[Instant, ...] = ()
    steps: tuple[tuple[Step, str], ...] = ()  # as flown, each with the state that it leads to


class Ticked(NamedTuple):
    """One tick that was tried."""

    run: Run
    decision: Decision
    taken: tuple[int, ...]  # numbers of the transitions
    restless: bool  # it does not come to rest


class OutOfTicksError(Exception):
    """More ticks were tried than a run is worth."""


class Flier:
    """Flies one chart.

    Args:
        chart: that was explored.
    """

    def __init__(self, chart: ExploredChart) -> None:
        self.chart = chart
        self.world = World()
        self.flown, self.moves = flown_chart(chart, self.world)
        self.holds = {way.number: way.hold for way in self.flown.failsafes if way.hold}
        for state in self.flown.states.values():
            self.holds |= {way.number: way.hold for way in state.transitions if way.hold}
        self.left = MOST_TICKS

    def begin(self) -> Run:
        """Return a flight before its first tick."""
        self.left = MOST_TICKS
        return Run(begin(self.flown, 0.0), 0.0)

    def insisted(self, run: Run, instant: Instant, *, starts: bool) -> Ticked | None:
        """Tick with the same situation until something happens, for what must last a while.

        Args:
            run: so far.
            instant: the situation.
            starts: entering the initial states is enough.
        """
        for _ in range(MOST_WAITS):
            tried = self.tick(run, instant._replace(now=run.now))
            begun = starts and not run.memory.started
            if tried.decision.moves or tried.restless or begun:
                return tried
            run = tried.run
            following = self._following(run)
            if following is None:
                return tried if instant.events else None
            run = run._replace(now=max(run.now, following))
        return None

    def rested(self, run: Run, until: float, points: Sequence[Point]) -> Run | None:
        """Let time pass in ticks in which nothing happens; return None if it cannot.

        Args:
            run: so far.
            until: time (s) of the tick after it.
            points: situations to choose from in each tick.
        """
        while run.now < until - ROUNDING:
            quiet = self.quiet(run, points)
            if quiet is None:
                return None
            following = self._following(quiet) or until
            run = quiet._replace(now=min(max(quiet.now, following), max(until, quiet.now)))
        return run

    def quiet(self, run: Run, points: Sequence[Point]) -> Run | None:
        """Return the run after a tick in which nothing happens, in the first point that lets it."""
        for point in points:
            for in_air in self.airs(run.memory):
                tried = self.tick(run, Instant(run.now, point, (), in_air))
                if not tried.decision.moves and not tried.restless:
                    return tried.run
        return None

    def airs(self, memory: ChartMemory) -> tuple[bool, ...]:
        """Return whether the vehicle is in the air, what is likely first."""
        here = configuration(self.flown, memory.active)
        return (True,) if here.flying or not memory.started else (True, False)

    def _following(self, run: Run) -> float | None:
        """Return when something may become ready next (s), None if nothing may."""
        times = list(self._times(run.memory))
        times += [time + TICK for time in times]
        last = run.instants[-1].now
        return min((time for time in times if time > last + ROUNDING), default=None)

    def _times(self, memory: ChartMemory) -> Iterator[float]:
        for name in memory.active:
            yield from (memory.entered[name] + limit for limit in self.chart.limits[name])
        yield from (each.due for each in memory.delayed)
        yield from (since + self.holds[number] for number, since in memory.held.items())
        for name, since in memory.violated.items():
            yield since + self.flown.states[name].tolerated
        for each, monitor in zip(self.flown.watch.requirements, memory.monitors, strict=True):
            if monitor.broken_since is not None:
                yield monitor.broken_since + each.tolerated

    def tick(self, run: Run, instant: Instant) -> Ticked:
        """Take one tick.

        Raises:
            OutOfTicksError: more were tried than a run is worth.
        """
        self.left -= 1
        if self.left < 0:
            raise OutOfTicksError
        memory = run.memory
        flying = configuration(self.flown, memory.active).flying
        status = IN_AIR._replace(in_air=instant.in_air, armed=instant.in_air)
        seen = SEEN._replace(
            now=instant.now,
            state=memory.state,
            entered_at=memory.entered_at,
            done=self.chart.may_be_done(memory.state) and memory.started,
            goal=GOAL,
            events=instant.events,
            status=None if flying else status,
        )
        self.world.point, self.world.broken = instant.point, instant.broken
        self.moves.noted.clear()
        contain = Containment()
        memory, decision = decide(self.flown, memory, seen, contain)
        taken = tuple([n for key in self.moves.noted for n in numbers_of(key) if n > 0])
        self.left -= len(taken) // MICROSTEPS
        later = Run(memory, instant.now + TICK, (*run.instants, instant), run.steps)
        return Ticked(later, decision, taken, bool(contain.failures))


def as_flown(run: Run, step: Step) -> Run:
    """Return a run with the step that its last tick takes, its time and situation made concrete."""
    instant = run.instants[-1]
    seconds = instant.now - sum(each.seconds for each, _ in run.steps)
    box = {q: None if v is None else Interval(v, v) for q, v in instant.point.items()}
    step = step._replace(seconds=round(seconds, 6), boxes=(box,))
    return run._replace(steps=(*run.steps, (step, run.memory.state)))
