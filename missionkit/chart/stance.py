"""What a configuration means for the tick: whom to ask, who commands, how safe it is."""

from __future__ import annotations

from missionkit.chart.compiled import LEAVES, Chart, Stance, State, Transition
from missionkit.messages import Mode

MOST = 4096  # configurations remembered
SAFETY = {"land": 2, "return": 1}


def stance(chart: Chart, active: tuple[str, ...]) -> Stance:
    """Return what a configuration means for the tick."""
    known = chart.stances.get(active)
    if known is None:
        if len(chart.stances) >= MOST:
            chart.stances.clear()
        known = chart.stances[active] = _stance(chart, active)
    return known


def _stance(chart: Chart, active: tuple[str, ...]) -> Stance:
    states = tuple([chart.states[name] for name in active])
    leaves = [state for state in states if state.shape in LEAVES]
    ways = tuple([_ways(chart, leaf) for leaf in leaves])
    asked = {way.number: way for each in ways for way in each}
    promising = [state for state in states if _promises(state)]
    pilots = [state for state in states if state.behavior is not None]
    pilot = max(pilots, key=lambda state: len(state.ancestors), default=None)
    return Stance(
        active=states,
        asked=tuple(asked.values()),
        ways=ways,
        promising=tuple(promising),
        pilot="" if pilot is None else pilot.name,
        mode=Mode.GPS if pilot is None else pilot.kind.mode,
        flying=any(state.kind.flying for state in states),
        safety=max((SAFETY.get(state.kind.name, 0) for state in states), default=0),
    )


def _promises(state: State) -> bool:
    return state.kind.invariant is not None or state.promise is not None


def _ways(chart: Chart, leaf: State) -> tuple[Transition, ...]:
    around = (chart.states[name] for name in leaf.ancestors)
    return tuple([way for state in (leaf, *around) for way in state.transitions])
