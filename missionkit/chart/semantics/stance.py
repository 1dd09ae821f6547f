"""What a configuration means for the tick: whom to ask, who commands, how safe it is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf

from missionkit.chart.semantics.compiled import (
    LEAVES,
    Ask,
    Chart,
    Direct,
    Stance,
    State,
    Transition,
    Way,
)
from missionkit.messages import Mode

MOST = 4096  # configurations remembered
SAFETY = {"land": 2, "return": 1}
EPSILON = 1e-9  # s; ticks are multiples of the period, up to rounding


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
    ways = [_ways(chart, state) for state in states if state.shape in LEAVES]
    every = tuple({way.transition.number: way for each in ways for way in each}.values())
    pilots = [state for state in states if state.behavior is not None]
    pilot = max(pilots, key=lambda state: len(state.ancestors), default=None)
    direct = tuple(_direct(every))
    mode = Mode.GPS if pilot is None else pilot.kind.mode
    return Stance(
        direct=direct,
        plain=tuple([each for way in every for each in _plain(way, direct)]),
        timed=tuple([way.transition for way in every if way.transition.hold]),
        timers=tuple([_timer(way) for way in every if _is_timer(way.transition)]),
        ways=tuple([tuple([way for way in each if not way.transition.events]) for each in ways]),
        heard=tuple([tuple([way for way in each if way.transition.events]) for each in ways]),
        soonest=min([way.wait for way in every if not way.transition.events], default=inf),
        promising=tuple([state for state in states if _promises(state)]),
        pilot="" if pilot is None else pilot.name,
        mode=mode,
        mode_text=f"mode {mode}",
        flying=any(state.kind.flying for state in states),
        safety=max((SAFETY.get(state.kind.name, 0) for state in states), default=0),
    )


def _ways(chart: Chart, leaf: State) -> list[Way]:
    around = (chart.states[name] for name in leaf.ancestors)
    return [
        Way(transition, _wait(state, transition))
        for state in (leaf, *around)
        for transition in state.transitions
    ]


def _wait(state: State, transition: Transition) -> float:
    dwell = state.dwell if transition.patient else 0.0
    return max(dwell, transition.after or 0.0) - EPSILON


def _direct(ways: Sequence[Way]) -> Iterator[Direct]:
    """Yield the guards that can be asked without ado, each once."""
    seen: set[str] = set()
    for transition, wait in ways:
        if (
            transition.check is not None
            and not transition.hold
            and not seen.intersection(transition.reads)
        ):
            seen.update(transition.reads)
            (name,) = transition.reads
            # one with an event is asked for the record only
            yield Direct(
                name, transition.check, inf if transition.events else wait, transition.source
            )


def _plain(way: Way, direct: Sequence[Direct]) -> list[tuple[Ask, float, str]]:
    transition, wait = way
    wait = inf if transition.events else wait
    mine = transition.check is not None and any(
        (each.check, each.wait, each.source) == (transition.check, wait, transition.source)
        for each in direct
    )
    if transition.ask is None or transition.hold or mine:
        return []
    return [(transition.ask, wait, transition.source)]


def _is_timer(transition: Transition) -> bool:
    return transition.ask is None and not transition.events


def _timer(way: Way) -> tuple[float, str]:
    return way.wait, way.transition.source


def _promises(state: State) -> bool:
    return state.kind.invariant is not None or state.promise is not None
