"""Whose behaviour commands after the chart has moved, and what the others remember meanwhile.

A behaviour begins when its state is entered and ends when it is left. While a state inside
commands, the behaviour of the state around it pauses and keeps its memory. Where a history may
lead back, the memory is kept past the end, and given back when it does.
"""

from __future__ import annotations

from collections.abc import Iterable

from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.entry_exit_sets import Move
from missionkit.engine.memory import Hands, Paused


def handed_over(
    chart: Chart, hands: Hands, before: str, after: str, moves: Iterable[Move]
) -> Hands:
    """Return the hands of the state that commands now; not begun if it must begin afresh.

    Args:
        chart: the chart that moved.
        hands: as they were when `before` commanded.
        before: the state that commanded, empty if none did.
        after: the state that commands now, empty if none does.
        moves: what the chart did in between, in order.
    """
    paused, past = dict(hands.paused), dict(hands.past)
    if before and hands.begun:
        paused[before] = Paused(hands.behavior, hands.done, hands.goal)
    for move in moves:
        for name in move.exited:
            left = paused.pop(name, None)
            if left is not None and chart.states[name].remembered:
                past[name] = left
        for name in move.restored & past.keys():
            paused[name] = past.pop(name)
    taken = paused.pop(after, None)
    memory = taken or Paused(None, done=False, goal=None)
    return hands._replace(
        behavior=memory.behavior,
        done=memory.done,
        goal=memory.goal,
        begun=taken is not None,
        paused=paused,
        past=past,
    )
