"""The same step by a short cut, for ticks at which nothing unusual happens: nearly all of them.

The guards of a configuration stand in one row and are asked in one loop. As soon as something is
unusual, the general step takes over: the pilot's abort, a delayed event that is due, a failsafe or
a broken invariant, a guard that fails or answers oddly, outputs, a second transition in the same
tick. An event leads on like a guard that holds, once nothing without an event is ready.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from missionkit.chart.semantics import entry_exit_sets
from missionkit.chart.semantics.chart_memory import ChartMemory, Decision, DelayedEvent, begin
from missionkit.chart.semantics.compiled_chart import (
    Chart,
    CompiledTransition,
    Configuration,
    Crossing,
    GuardContext,
    Lead,
)
from missionkit.chart.semantics.configuration import configuration
from missionkit.chart.semantics.guard_evaluation import ready
from missionkit.chart.semantics.guard_rows import Answers, asked, none_holds
from missionkit.chart.semantics.heard_events import heard, hearing, leads_on
from missionkit.chart.semantics.macrostep import ORDERS, Macrostep
from missionkit.chart.semantics.step import (
    acts,
    advance,
    decided,
    invariants,
    requirement,
    watched_end,
)
from missionkit.chart.semantics.time_tolerance import EPSILON
from missionkit.messages import Estimate, Fired
from missionkit.plugin_containment import Containment

__all__ = ["begin", "decide"]

Outcome = tuple[ChartMemory, Decision]
_new = tuple.__new__  # quicker than the class's own


def decide(
    chart: Chart, memory: ChartMemory, seen: Estimate, contain: Containment
) -> tuple[ChartMemory, Decision]:
    """Return exactly what `step.decide` returns.

    Args:
        chart: compiled.
        memory: as returned by the last step.
        seen: the estimate at this tick, with the events that came since the last.
        contain: calls the guards; one that raises is unknown and noted.
    """
    known = memory[:]  # a plain tuple, which is taken apart twice as fast
    active, entered, windows, variables, _, _, held, violated, started, ended, delayed, _ = known
    here = chart.configurations.get(active) or configuration(chart, active)
    flying = acts(seen, here)
    pressing = (seen.events or delayed) and _pressing(seen, delayed)
    usual = started and not (pressing or violated or ended)
    simple = here.simple_in_air if flying else here.simple
    outcome: Outcome | None = None
    if usual and simple is not None and not held:
        answers: Answers = {}
        holding = asked(simple, seen, answers)
        if holding == "" and not _called(here, entered, seen):
            return memory, _new(Decision, (answers, (), (), False, (), ()))
        if holding is not None and not (flying and holding in here.alarms):
            outcome = _moved(chart, memory, here, seen, answers)
    if outcome is None:
        question = GuardContext(seen, windows, contain, active, variables)
        if chart.slots:
            advance(chart, question)
        if usual:
            outcome = _in_context(chart, memory, here, question, flying=flying)
        if outcome is None:
            outcome = decided(chart, memory, question)
    return outcome


def _in_context(
    chart: Chart, memory: ChartMemory, here: Configuration, question: GuardContext, *, flying: bool
) -> Outcome | None:
    """Return the outcome of a tick, guards asked with all there is; None: it is unusual."""
    seen, answers = question.seen, question.answers
    if flying and asked(here.danger, seen, answers, question) != "":
        return None
    holding = asked(here.guards, seen, answers, question)
    if holding is None or (here.promising and invariants(here, memory, question)[0]):
        return None
    if flying and memory.monitors and requirement(chart, memory, here, seen.now) is not None:
        return None
    memory = _remembering(chart, memory, here, question, holding=bool(holding))
    outcome: Outcome | None = memory, _new(Decision, (answers, (), (), False, (), ()))
    if holding or _called(here, memory.entered, seen):
        outcome = _moved(chart, memory, here, seen, answers, question)
    memory, decision = outcome or Macrostep(chart, memory, question, ()).run(None, rested=False)
    if not chart.watch.requirements:
        return memory, decision
    return watched_end(chart, memory, decision, question, "")


def _remembering(
    chart: Chart, memory: ChartMemory, here: Configuration, question: GuardContext, *, holding: bool
) -> ChartMemory:
    """Return the memory with the windows, and since when guards hold, as of this tick."""
    held: dict[int, float] = {}
    if holding:
        for transition in here.timed:
            ready(transition, memory, question, held)
    if not chart.slots and held == memory.held:
        return memory
    active, entered, _, variables, pilot, history, _, *rest = memory
    windows = tuple(question.windows)
    return _new(ChartMemory, (active, entered, windows, variables, pilot, history, held, *rest))


def _pressing(seen: Estimate, delayed: Sequence[DelayedEvent]) -> bool:
    """Say whether the pilot aborts, or a delayed event is due."""
    ordered = not ORDERS.isdisjoint(seen.events)
    return ordered or (bool(delayed) and delayed[0].due <= seen.now + EPSILON)


def _called(here: Configuration, entered: Mapping[str, float], seen: Estimate) -> bool:
    """Say whether a transition without a guard may be ready."""
    if here.timers and _due(here, entered, seen.now):
        return True
    return bool(seen.events) and leads_on(here, seen.events)


def _due(here: Configuration, entered: Mapping[str, float], now: float) -> bool:
    """Say whether a transition without a guard is ready."""
    return any(now - entered[source] >= wait for wait, source in here.timers)


def _moved(
    chart: Chart,
    memory: ChartMemory,
    here: Configuration,
    seen: Estimate,
    answers: Answers,
    question: GuardContext | None = None,
) -> Outcome | None:
    """Take the first transition that is ready, if that is all that happens; None: it is not."""
    now = seen.now
    way, events = _chosen(here, memory, seen, answers, question)
    if way is None:
        return memory, _new(Decision, (answers, (), (), False, (), ()))
    crossing = here.crossings.get(way.number) or _crossing(chart, memory, here, way)
    if crossing is None:
        return None
    move, there, to, outputs, restless = crossing
    if events and heard(there, events):
        return None
    known = memory[:]
    before, was_entered, windows, variables, pilot, history, held, violated, *more = known
    active = move.active
    entered = dict.fromkeys(active, now)
    for name in move.kept:
        entered[name] = was_entered[name]
    if held:
        held = {number: since for number, since in held.items() if number not in move.gone}
    if move.history:
        history = {**history, **move.history}
    commands = there.pilot
    after = _new(
        ChartMemory,
        (
            active,
            entered,
            windows,
            variables,
            commands,
            history,
            held,
            violated,
            *more,
        ),
    )
    fresh = commands != pilot or (pilot or before[-1]) in move.exited
    if restless and not _rests(there, after, seen, fresh=fresh):
        return None
    verdicts = tuple([(name, answers[name]) for name in way.reads if name in answers])
    fired = _new(Fired, (way.source, to, way.text, verdicts, outputs))
    return after, _new(Decision, (answers, (fired,), (move,), fresh, (), ()))


def _chosen(
    here: Configuration,
    memory: ChartMemory,
    seen: Estimate,
    answers: Answers,
    question: GuardContext | None,
) -> tuple[CompiledTransition | None, tuple[str, ...]]:
    """Return the first transition that is ready, without an event or with one, and those left."""
    events = seen.events
    way = _first(here.leads, memory, seen.now, answers, question)
    while way is None and events:
        way = _first(hearing(here, events[0])[0], memory, seen.now, answers, question)
        events = events[1:]
    return way, events


def _first(
    leads: Iterable[Lead],
    memory: ChartMemory,
    now: float,
    answers: Answers,
    question: GuardContext | None,
) -> CompiledTransition | None:
    """Return the first transition that is ready."""
    entered = memory.entered
    for way, ask, name, wait, source, hold in leads:
        if ask is not None:
            verdict = answers[name] if name or question is None else ask(question)
            if verdict[0] is not True:
                continue
        held = not hold or now - memory.held.get(way.number, now) >= hold - EPSILON
        if held and now - entered[source] >= wait:
            return way
    return None


def _crossing(
    chart: Chart, memory: ChartMemory, here: Configuration, way: CompiledTransition
) -> Crossing | None:
    """Return where a transition leads if it does nothing else; remembered if history is no part."""
    if len(here.ways) > 1 or not way.to:
        return None
    move = entry_exit_sets.move(chart, memory.active, (way,), memory.history)
    if move.says or move.ended:
        return None
    there = configuration(chart, move.active)
    restless = bool(move.kept) or there.soonest <= 0.0
    crossing = (move, there, ", ".join(way.to), (there.mode_text,), restless)
    if chart.moves.get((memory.active, way.number)) is move:
        here.crossings[way.number] = crossing
    return crossing


def _rests(there: Configuration, after: ChartMemory, seen: Estimate, *, fresh: bool) -> bool:
    """Say whether nothing more is ready after a transition, as far as the estimate shows."""
    if not there.pure or (there.timers and _due(there, after.entered, seen.now)):
        return False
    state = there.pilot or after.active[-1]
    done, goal = (False, None) if fresh else (seen.done, seen.goal)
    stands = (state, after.entered[state], done, goal)
    later = _new(Estimate, seen[:-4] + stands)
    return none_holds(there.guards, later)
