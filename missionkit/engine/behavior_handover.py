"""Whose behaviour commands after the chart has moved, and what the others remember meanwhile.

A behaviour begins when its state is entered and ends when it is left. While a state inside
commands, the behaviour of the state around it pauses and keeps its memory. Where a history may
lead back, the memory is kept past the end, and given back when it does.
"""

from __future__ import annotations

from collections.abc import Iterable

from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.entry_exit_sets import Move
from missionkit.engine.flight_state import BehaviorState, PausedBehavior


def handed_over(
    chart: Chart, acting: BehaviorState, before: str, after: str, moves: Iterable[Move]
) -> BehaviorState:
    """Return the state of the commanding behaviour; not begun if it has to restart.

    Args:
        chart: the chart that moved.
        acting: as they were when `before` commanded.
        before: the state that commanded, empty if none did.
        after: the state that commands now, empty if none does.
        moves: what the chart did in between, in order.
    """
    paused, past = dict(acting.paused), dict(acting.past)
    if before and acting.begun:
        paused[before] = PausedBehavior(acting.behavior, acting.done, acting.goal)
    for move in moves:
        for name in move.exited:
            left = paused.pop(name, None)
            if left is not None and chart.states[name].remembered:
                past[name] = left
        for name in move.restored & past.keys():
            paused[name] = past.pop(name)
    taken = paused.pop(after, None)
    memory = taken or PausedBehavior(None, done=False, goal=None)
    return acting._replace(
        behavior=memory.behavior,
        done=memory.done,
        goal=memory.goal,
        begun=taken is not None,
        paused=paused,
        past=past,
    )
