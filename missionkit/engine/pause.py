"""Pauses: the operator's, and while a pilot or the autopilot itself commands.

While one lasts the behaviour of the commanding state is not asked and keeps its memory, the
vehicle holds its place, and the clocks of the active states stand still. Guards, events and
failsafes work as ever. What the autopilot flies by itself (take-off, landing) is not paused.
"""

from __future__ import annotations

from collections.abc import Iterable

from missionkit.chart.semantics.chart_memory import ChartMemory, Decision
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.configuration import configuration
from missionkit.engine.control_law import ControlLaw
from missionkit.engine.flight_history import failsafe_of
from missionkit.engine.flight_state import BehaviorState
from missionkit.messages import CONTINUE, PAUSE, RETURN_HOME, Estimate, Mode

BY_OPERATOR = f"paused by the operator: {CONTINUE!r} lets it continue"
BY_PILOT = "paused while missionkit is not in control"


def asked(paused: bool, events: Iterable[str]) -> bool:  # noqa: FBT001 - the state before
    """Return whether the operator's pause lasts after the events of a tick.

    Args:
        paused: whether it lasted before.
        events: in the order they came.
    """
    for event in events:
        if event in {PAUSE, CONTINUE, RETURN_HOME}:
            paused = event == PAUSE
    return paused


def reason(chart: Chart, memory: ChartMemory, *, by_operator: bool, in_control: bool) -> str:
    """Return why the behaviour of the commanding state pauses, "" if it does not.

    Args:
        chart: that is flown.
        memory: says which state commands.
        by_operator: the operator's pause lasts.
        in_control: whether missionkit commands.
    """
    if chart.states[memory.state].kind.mode is Mode.NONE:
        return ""
    if not in_control:
        return BY_PILOT
    return BY_OPERATOR if by_operator else ""


def ended(chart: Chart, memory: ChartMemory, decision: Decision, now: float) -> bool:
    """Say whether a tick has ended the operator's pause.

    A failsafe that the mission has written does, and any other that leads home or to the ground.

    Args:
        chart: that is flown.
        memory: after the tick.
        decision: of the tick.
        now: s.
    """
    homewards = configuration(chart, memory.active).safety > 0
    taken = (failsafe_of(fired, chart, now) for fired in decision.fired)
    return any(it is not None and (homewards or not it.default) for it in taken)


def stopped(memory: ChartMemory, duration: float) -> ChartMemory:
    """Return the memory with the clocks of the active states put off by `duration` (s)."""
    entered = {name: at + duration for name, at in memory.entered.items()}
    return memory._replace(entered=entered)


def let_go(law: ControlLaw, acting: BehaviorState, seen: Estimate) -> BehaviorState:
    """Return the state of a behaviour while another flies: control restarts from its motion.

    Args:
        law: makes the controller's memory.
        acting: of the commanding state.
        seen: the estimate at this tick.
    """
    return acting._replace(control=law.moving(seen.velocity), held=None)
