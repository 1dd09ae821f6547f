"""Asking the guards of a configuration: all of them, for the record explains what stays too."""

from __future__ import annotations

from missionkit.chart.semantics.chart_memory import ChartMemory
from missionkit.chart.semantics.compiled_chart import (
    CompiledTransition,
    Configuration,
    GuardContext,
)
from missionkit.chart.semantics.time_tolerance import EPSILON
from missionkit.chart.semantics.verdict_validation import TRUTHS


def evaluated(
    here: Configuration, memory: ChartMemory, question: GuardContext, held: dict[int, float]
) -> bool:
    """Ask the guards of every transition, and say whether one without an event may be ready.

    Args:
        here: the active configuration, with its guards sorted by how they are asked.
        memory: when each state was entered, and since when guards hold.
        question: the estimate; the answers are collected in it.
        held: filled with the mission time (s) since which each guard with a hold time has held.
    """
    now, entered = question.seen.now, memory.entered
    moving = _asked_directly(here, memory, question)
    if moving is None:
        moving = _asked_carefully(here, memory, question)
    for ask, wait, source in here.plain:
        if ask(question)[0] and now - entered[source] >= wait:
            moving = True
    for transition in here.timed:
        moving = ready(transition, memory, question, held) or moving
    for wait, source in here.timers:
        moving = moving or now - entered[source] >= wait
    return moving


def _asked_directly(
    here: Configuration, memory: ChartMemory, question: GuardContext
) -> bool | None:
    """Ask guards of the package with nothing around them; `None` if one raises or says odd things.

    A margin is the distance of value and threshold, so numbers that are not finite show in it.
    """
    seen, entered, answers = question.seen, memory.entered, question.answers
    now, moving, odd = seen.now, False, 0.0
    try:
        for name, check, wait, source in here.direct:
            verdict = answers[name] = check(seen)
            holds, _, value, _, margin = verdict
            if holds is True:
                moving = moving or now - entered[source] >= wait
            elif type(holds) not in TRUTHS:
                return None
            if margin is not value:
                odd += margin - margin  # type: ignore[operator] # None raises, as it should
    except Exception:  # noqa: BLE001 - evaluated again, contained
        return None
    return moving if type(odd) is float and odd == 0.0 else None


def _asked_carefully(here: Configuration, memory: ChartMemory, question: GuardContext) -> bool:
    """Ask the same guards again, each contained and its answer looked through."""
    for each in here.direct:
        question.answers.pop(each.name, None)
    moving = False
    for ways in (*here.ways, *here.heard):
        for transition, wait in ways:
            guard = transition.guard
            if guard is not None and guard.check is not None and transition.ask is not None:
                holds = transition.ask(question).holds
                entered = memory.entered[transition.source]
                waits = bool(transition.events) or question.seen.now - entered < wait
                moving = moving or (holds is True and not waits and not transition.hold)
    return moving


def ready(
    transition: CompiledTransition,
    memory: ChartMemory,
    question: GuardContext,
    held: dict[int, float],
) -> bool:
    """Ask a transition's guard and say whether it has held for long enough.

    Args:
        transition: without a guard it is ready only if it fires on unknown.
        memory: since when guards hold.
        question: the estimate; the answer is collected in it.
        held: gets the mission time (s) since which this guard has held, by number of transition.
    """
    ask = transition.ask
    holds = None if ask is None else ask(question).holds
    if not (transition.unknown_takes if holds is None else holds):
        return False
    if not transition.hold:
        return True
    now = question.seen.now
    since = held[transition.number] = memory.held.get(transition.number, now)
    return now - since >= transition.hold - EPSILON
