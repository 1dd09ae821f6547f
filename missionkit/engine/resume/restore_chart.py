"""Fitting a saved chart memory to the chart that is flown now."""

from __future__ import annotations

from typing import Any

from missionkit.chart.model.variables import Value, Values
from missionkit.chart.semantics.chart_memory import ChartMemory, begin
from missionkit.chart.semantics.compiled_chart import (
    HISTORY,
    ROOT_STATE,
    Chart,
    GuardMemory,
    Shape,
)
from missionkit.chart.semantics.configuration import configuration
from missionkit.chart.semantics.requirement_monitor import MonitorMemory
from missionkit.chart.semantics.requirement_watch import across_gap
from missionkit.engine.resume.checkpoint_policy import StartsAgain
from missionkit.plugin_containment import PluginError, reporting_faults

RESTARTING = "guards, behaviours and histories restart"


def fitted(
    chart: Chart, saved: ChartMemory, now: float, gap: float, *, changed: bool
) -> tuple[ChartMemory, bool, tuple[str, ...]]:
    """Return the memory to resume with, whether the chart keeps its states, and messages.

    How long a guard has held (`for:`) is not known across a gap: for the states' own transitions
    it restarts, for failsafes and invariants it keeps counting. Times of entry stay, so `after:`
    continues, and so do the times of delayed events.

    Args:
        chart: that is flown now.
        saved: the memory as it was saved.
        now: s.
        gap: s without commands, up to now.
        changed: the mission is not the one that was flown; guards then restart.
    """
    fresh = begin(chart, now)
    if not changed:
        numbers = {failsafe.number for failsafe in chart.failsafes}
        held = {number: since for number, since in saved.held.items() if number in numbers}
        kept = saved._replace(held=held, windows=_windows(chart, fresh, saved, gap))
        return kept._replace(monitors=_monitors(chart, saved, now, gap)), True, ()
    if not stands(chart, saved):
        lost = f"the chart no longer has {', '.join(saved.active)}: it restarts"
        return fresh._replace(variables=_values(chart, saved)), False, (lost,)
    kept = fresh._replace(
        active=saved.active,
        entered=saved.entered,
        variables=_values(chart, saved),
        pilot=configuration(chart, saved.active).pilot,
        started=True,
        ended=saved.ended,
        delayed=saved.delayed,
    )
    restarting = "guards, behaviours, histories and requirements restart"
    return kept, True, (restarting if chart.watch.requirements else RESTARTING,)


def stands(chart: Chart, saved: ChartMemory) -> bool:
    """Say whether a configuration is one of this chart's: legal by SCXML, in document order."""
    if any(name not in chart.states for name in (*saved.active, *saved.entered)):
        return False
    ordered = sorted(set(saved.active), key=lambda name: chart.states[name].order)
    return tuple(ordered) == saved.active and all(
        _legal(chart, name, saved.active) for name in (ROOT_STATE, *saved.active)
    )


def _legal(chart: Chart, name: str, active: tuple[str, ...]) -> bool:
    state = chart.states[name]
    inside = sum(child in active for child in state.children)
    if name != ROOT_STATE and state.parent not in (ROOT_STATE, *active):
        return False
    if state.shape is Shape.PARALLEL:
        return inside == sum(chart.states[it].shape not in HISTORY for it in state.children)
    if name == ROOT_STATE or state.shape is Shape.COMPOUND:
        return inside == 1
    return state.shape not in HISTORY


def _windows(chart: Chart, fresh: ChartMemory, saved: ChartMemory, gap: float) -> tuple[Any, ...]:
    slots = zip(chart.slots, fresh.windows, saved.windows, strict=True)
    return tuple(
        new if old is StartsAgain.BEGIN else _resumed(slot, new, old, gap)
        for slot, new, old in slots
    )


def _monitors(
    chart: Chart, saved: ChartMemory, now: float, gap: float
) -> tuple[MonitorMemory, ...]:
    if gap <= 0.0:
        return saved.monitors
    every = zip(chart.watch.requirements, saved.monitors, strict=True)
    return tuple(across_gap(each, monitor, now) for each, monitor in every)


def _resumed(slot: GuardMemory, new: Any, old: Any, gap: float) -> Any:
    """Return what a guard remembers after the gap; one that cannot say begins again."""
    try:
        with reporting_faults():
            return slot.resumed(old, gap)
    except PluginError:  # does not end the resumption
        return new


def _values(chart: Chart, saved: ChartMemory) -> Values:
    """Return the variables, with the saved values that they still admit."""
    values: dict[str, Value] = {}
    for name, variable in chart.variables.items():
        kept = saved.variables.get(name, variable.initial)
        values[name] = kept if variable.admits(kept) else variable.initial
    return values
