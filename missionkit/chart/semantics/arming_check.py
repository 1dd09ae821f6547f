"""Check before arming: no failsafe may hold that would land the vehicle at once."""

from __future__ import annotations

from missionkit.chart.semantics.chart_memory import ChartMemory
from missionkit.chart.semantics.compiled_chart import Chart, CompiledTransition, GuardContext
from missionkit.messages import Estimate, Verdict
from missionkit.plugin_containment import Containment


def against_arming(chart: Chart, memory: ChartMemory, seen: Estimate, contain: Containment) -> str:
    """Return which failsafe holds on the ground already, and why; "" if none does.

    A failsafe counts that holds now, for however long it would have to in the air; and one that
    cannot tell, if it would act at once then. What counts from the entry of a state counts as if
    one had been entered just now.

    Args:
        chart: compiled; its failsafes are looked at.
        memory: of the state on the ground. Nothing is changed in it.
        seen: the estimate at this tick, on the ground.
        contain: calls the guards; a guard that raises is unknown.
    """
    fresh = seen.standing(memory.state, seen.now, done=False, goal=None)
    question = GuardContext(fresh, memory.windows, contain, memory.active, memory.variables)
    for failsafe in chart.failsafes:
        if failsafe.ask is None:
            continue
        verdict = failsafe.ask(question)
        unknown = verdict.holds is None and failsafe.unknown_takes and not failsafe.hold
        if verdict.holds or unknown:
            return _said(failsafe, verdict, question)
    return ""


def _said(failsafe: CompiledTransition, verdict: Verdict, question: GuardContext) -> str:
    """Return such as `failsafe battery holds: battery below (floor 0.2), now 0.12`."""
    read = [(name, question.answers[name]) for name in failsafe.reads if name in question.answers]
    parts = [_figure(name, answer) for name, answer in read] or [verdict.why]
    how = "holds" if verdict.holds else "is unknown"
    return f"{failsafe.text} {how}: {', '.join(filter(None, parts))}".rstrip(": ")


def _figure(name: str, verdict: Verdict) -> str:
    now = verdict.why if verdict.value is None else f"now {verdict.value:.3g}"
    return f"{name}, {now}" if now else name
