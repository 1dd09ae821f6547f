"""One step of the chart, as a pure function.

Order of precedence: the pilot, then failsafes in document order, then invariants, then the
states' own transitions, inner states before the states around them, in document order. Failsafes
ignore the dwell; a failsafe never leads back to something less safe than what is already
happening (land before return before anything else).
"""

from __future__ import annotations

from collections.abc import Mapping

from missionkit.chart.semantics.chart_memory import ChartMemory, Decision, begin
from missionkit.chart.semantics.compiled_chart import (
    ROOT_STATE,
    Chart,
    CompiledState,
    CompiledTransition,
    Configuration,
    GuardContext,
)
from missionkit.chart.semantics.configuration import SAFETY, configuration
from missionkit.chart.semantics.guard_compiler import FALSE_VERDICT, TRUE_VERDICT
from missionkit.chart.semantics.guard_evaluation import evaluated, ready
from missionkit.chart.semantics.macrostep import Macrostep
from missionkit.chart.semantics.requirement_watch import overdue, verdict, watched
from missionkit.chart.semantics.time_tolerance import EPSILON
from missionkit.messages import ABORT, RETURN_HOME, Estimate, Verdict
from missionkit.number_text import beside
from missionkit.plugin_containment import Containment

__all__ = ["ABORT", "ChartMemory", "Decision", "begin", "decide"]

NOTHING: frozenset[str] = frozenset()
_new = tuple.__new__  # quicker than the class's own


def decide(
    chart: Chart,
    memory: ChartMemory,
    seen: Estimate,
    contain: Containment,
    *,
    frugal: bool = False,
) -> tuple[ChartMemory, Decision]:
    """Advance the guards' windows, ask every guard, and take what is to be taken.

    Args:
        chart: compiled.
        memory: as returned by the last step.
        seen: the estimate at this tick, with the events that came since the last.
        contain: calls the guards; one that raises is unknown and noted.
        frugal: ask no guard that the selection does not need, as the checks before flight do;
            nothing is noted then of how long guards have held.

    Returns:
        What to remember, and what was decided and why. Nothing passed in is changed.
    """
    question = GuardContext(
        seen, memory.windows, contain, memory.active, memory.variables, frugal=frugal
    )
    if chart.slots:
        advance(chart, question)
    return decided(chart, memory, question)


def decided(
    chart: Chart, memory: ChartMemory, question: GuardContext
) -> tuple[ChartMemory, Decision]:
    """Return the same, the windows advanced already, and some of the guards asked perhaps.

    Args:
        chart: compiled.
        memory: as returned by the last step.
        question: with the windows as of this tick; the answers are collected in it.
    """
    seen, frugal, windows = question.seen, question.frugal, tuple(question.windows)
    active, _, _, _, _, _, was_held, was_violated, started, ended, *_ = memory
    here = chart.configurations.get(active) or configuration(chart, active)
    held: dict[int, float] = {}
    forced = None
    flying = acts(seen, here)
    if ended or seen.events or flying:
        forced = _forced(chart, memory, here, question, held, flying=flying)
    moving = not ended and (frugal or evaluated(here, memory, question, held))
    violated = was_violated
    problems: tuple[str, ...] = ()
    if here.promising:
        violated, escape, problems = invariants(here, memory, question)
        forced = forced or escape
    if not frugal and (chart.slots or held != was_held or violated != was_violated):
        memory = memory._replace(windows=windows, held=held, violated=violated)
    escape = None
    if flying and forced is None and memory.monitors:
        forced = escape = requirement(chart, memory, here, seen.now)
    due = bool(memory.delayed) and memory.delayed[0].due <= seen.now + EPSILON
    if started and forced is None and not (moving or due or seen.events):
        decision = _new(Decision, (question.answers, (), (), False, (), problems))
    else:
        memory, decision = Macrostep(chart, memory, question, problems).run(
            forced, rested=not moving
        )
    if not chart.watch.requirements:
        return memory, decision
    return watched_end(chart, memory, decision, question, "" if escape is None else escape.text)


def advance(chart: Chart, question: GuardContext) -> None:
    """Advance every memory; a guard that uses another finds it in an earlier slot."""
    question.windows = windows = list(question.windows)
    for index, slot in enumerate(chart.slots):
        windows[index] = slot.advance(windows[index], question)


def _forced(
    chart: Chart,
    memory: ChartMemory,
    here: Configuration,
    question: GuardContext,
    held: dict[int, float],
    *,
    flying: bool,
) -> CompiledTransition | None:
    """Return what goes before all else: the operator, a failsafe, the chart's end in the air."""
    seen = question.seen
    failsafe = None
    if flying:
        failsafe = _failsafe(chart, memory, here, question, held)
    if seen.events and ABORT in seen.events and chart.land and here.safety < SAFETY["land"]:
        return CompiledTransition(-1, (chart.land,), ABORT)
    wanted = flying and chart.home and here.safety < SAFETY["return"]
    if wanted and RETURN_HOME in seen.events:
        return CompiledTransition(-1, (chart.home,), RETURN_HOME)
    if failsafe is None and memory.ended and chart.land and _in_air(seen):
        return CompiledTransition(-1, (chart.land,), "the chart has ended in the air")
    return failsafe


def _failsafe(
    chart: Chart,
    memory: ChartMemory,
    here: Configuration,
    question: GuardContext,
    held: dict[int, float],
) -> CompiledTransition | None:
    """Ask every failsafe and return the first that may lead away.

    One that wants to be where the chart already is keeps those after it from leading away.
    """
    chosen: CompiledTransition | None = None
    obeyed = False
    for failsafe in chart.failsafes:
        (to,) = failsafe.to
        rank = SAFETY.get(chart.states[to].kind.name, 0)
        if question.frugal and here.safety and rank <= here.safety:
            continue  # it cannot lead away
        if failsafe.ask is None or failsafe.ask(question)[0] is False:
            continue
        if not ready(failsafe, memory, question, held):
            continue
        obeyed = obeyed or to in memory.active
        safer = rank > here.safety or (rank == here.safety == 0 and not obeyed)
        if chosen is None and safer:
            chosen = failsafe
            if question.frugal:
                break
    return chosen


def _in_air(seen: Estimate) -> bool:
    return seen.status is not None and seen.status.in_air


def acts(seen: Estimate, here: Configuration) -> bool:
    """Say whether failsafes act: in the air, and with rotors turning in a state that flies."""
    status = seen.status
    if status is None or (status.armed and not status.in_air):
        return here.flying
    return status.in_air


def invariants(
    here: Configuration, memory: ChartMemory, question: GuardContext
) -> tuple[Mapping[str, float], CompiledTransition | None, tuple[str, ...]]:
    """Return since when which invariants are broken, the first way out, and the news.

    Args:
        here: the active configuration.
        memory: since when they were broken before.
        question: the estimate; the answers are collected in it.
    """
    violated: dict[str, float] = {}
    escape: CompiledTransition | None = None
    problems: list[str] = []
    now = question.seen.now
    for state in here.promising:
        verdict = _broken(state, question)
        if verdict is None:
            continue
        since = violated[state.name] = memory.violated.get(state.name, now)
        if state.name not in memory.violated:
            problems.append(f"state {state.name!r}: {_reason(verdict)}")
        overdue = now - since >= state.tolerated - EPSILON
        if state.violated_to is not None and overdue and escape is None:
            escape = _escape(state, state.violated_to)
    return violated, escape, tuple(problems)


def requirement(
    chart: Chart, memory: ChartMemory, here: Configuration, now: float
) -> CompiledTransition | None:
    """Return where the first broken requirement leads, if that is no less safe than here.

    Args:
        chart: compiled.
        memory: with the monitors after the last tick.
        here: the active configuration.
        now: s.
    """
    for each, monitor in zip(chart.watch.requirements, memory.monitors, strict=True):
        if each.to is None or not overdue(each, monitor, now):
            continue
        rank = SAFETY.get(chart.states[each.to].kind.name, 0)
        if rank > here.safety or (rank == here.safety == 0 and each.to not in memory.active):
            return CompiledTransition(-1, (each.to,), each.reason, reads=(each.label,))
    return None


def watched_end(
    chart: Chart, memory: ChartMemory, decision: Decision, question: GuardContext, taken: str
) -> tuple[ChartMemory, Decision]:
    """Let the requirements see the end of the tick; they join the answers.

    Args:
        chart: compiled.
        memory: after the tick.
        decision: of the tick.
        question: of the tick, as the guards saw it.
        taken: the reason of the requirement that has led away in this tick.
    """
    now, watch, entered = question.seen.now, chart.watch, NOTHING
    if decision.moves:
        question = _afterwards(memory, decision, question)
        entered = frozenset([entry.name for move in decision.moves for entry in move.entries])
    answers = question.answers  # of a tick without a move those of the decision
    for _, ask in watch.guards:
        ask(question)
    for name, state in watch.entries:
        answers[name] = TRUE_VERDICT if state in entered else FALSE_VERDICT
    every = zip(watch.requirements, memory.monitors, strict=True)
    monitors = tuple([watched(each, monitor, answers, now) for each, monitor in every])
    if taken:
        monitors = tuple(
            monitor._replace(acted=True) if each.reason == taken else monitor
            for each, monitor in zip(watch.requirements, monitors, strict=True)
        )
    for each, monitor in zip(watch.requirements, monitors, strict=True):
        answers[each.label] = verdict(each, monitor, now)
    if monitors != memory.monitors:
        memory = memory._replace(monitors=monitors)
    if answers is not decision.answers:
        decision = decision._replace(answers={**decision.answers, **answers})
    return memory, decision


def _afterwards(memory: ChartMemory, decision: Decision, question: GuardContext) -> GuardContext:
    """Return what guards are asked at the end of a tick in which the chart has moved."""
    seen = question.seen
    done, goal = (False, None) if decision.entered else (seen.done, seen.goal)
    seen = seen.standing(memory.state, memory.entered_at, done=done, goal=goal)
    return GuardContext(seen, memory.windows, question.contain, memory.active, memory.variables)


def _escape(state: CompiledState, to: str) -> CompiledTransition:
    text = f"invariant broken for {state.tolerated:g} s"
    reads = (f"I({state.name})",)
    return CompiledTransition(-1, (to,), text, source=state.name or ROOT_STATE, reads=reads)


def _reason(verdict: Verdict) -> str:
    if verdict.why or verdict.value is None or verdict.threshold is None:
        return verdict.why or "its invariant does not hold"
    shown, limit = beside(verdict.value, verdict.threshold, 2)
    return f"its invariant does not hold: {shown}, the limit is {limit}"


def _broken(state: CompiledState, question: GuardContext) -> Verdict | None:
    """Return the first of the kind's invariant and the mission's own that does not hold."""
    invariant = state.kind.invariant
    if invariant is not None:
        verdict = invariant.check(question.seen, state.target)
        question.answers[f"I({state.name})"] = verdict
        if verdict.holds is False:
            return verdict
    if state.promise is not None:
        verdict = state.promise(question)
        if verdict.holds is False:
            return verdict
    return None
