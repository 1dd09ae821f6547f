"""Data of a configuration for the tick: guards to evaluate, commanding state, safety."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from missionkit.chart.semantics.compiled_chart import (
    LEAVES,
    AskedGuard,
    Chart,
    CompiledState,
    CompiledTransition,
    Configuration,
    DirectGuard,
    GuardFunction,
    GuardRow,
    Lead,
    TimedTransition,
)
from missionkit.chart.semantics.time_tolerance import EPSILON
from missionkit.messages import Mode

MOST_CONFIGURATIONS = 4096  # configurations remembered
SAFETY = {"land": 2, "return": 1}


def configuration(chart: Chart, active: tuple[str, ...]) -> Configuration:
    """Return what a configuration means for the tick."""
    known = chart.configurations.get(active)
    if known is None:
        if len(chart.configurations) >= MOST_CONFIGURATIONS:
            chart.configurations.clear()
        known = chart.configurations[active] = _stance(chart, active)
    return known


def _stance(chart: Chart, active: tuple[str, ...]) -> Configuration:
    states = tuple([chart.states[name] for name in active])
    ways = [_ways(chart, state) for state in states if state.shape in LEAVES]
    every = tuple({way.transition.number: way for each in ways for way in each}.values())
    pilots = [state for state in states if state.behavior is not None]
    pilot = max(pilots, key=lambda state: len(state.ancestors), default=None)
    direct, plain = _asks(every)
    mode = Mode.GPS if pilot is None else pilot.kind.mode
    guards, danger = _guards(every), _each_once(chart.failsafes)
    promising = tuple([state for state in states if _promises(state)])
    timed = tuple([way.transition for way in every if way.transition.hold])
    pure = all(check is not None for _, _, _, check, *_ in guards)
    safe = all(check is not None for _, _, _, check, *_ in danger)
    alone = pure and not (promising or timed or chart.slots or chart.watch.requirements)
    return Configuration(
        direct=tuple(direct),
        plain=tuple(plain),
        timed=timed,
        timers=tuple([_timer(way) for way in every if _is_timer(way.transition)]),
        guards=guards,
        danger=danger,
        pure=pure,
        alarms=frozenset([name for _, _, name, *_ in danger]),
        simple=guards if alone else None,
        simple_in_air=(*danger, *guards) if alone and safe else None,
        crossings={},
        hears={},
        ways=tuple([tuple([way for way in each if not way.transition.events]) for each in ways]),
        leads=tuple([lead(way) for each in ways for way in each if not way.transition.events]),
        heard=tuple([tuple([way for way in each if way.transition.events]) for each in ways]),
        soonest=min([way.wait for way in every if not way.transition.events], default=inf),
        promising=promising,
        pilot="" if pilot is None else pilot.name,
        mode=mode,
        mode_text=f"mode {mode}",
        flying=any(state.kind.flying for state in states),
        safety=max((SAFETY.get(state.kind.name, 0) for state in states), default=0),
    )


def _ways(chart: Chart, leaf: CompiledState) -> list[TimedTransition]:
    around = (chart.states[name] for name in leaf.ancestors)
    return [
        TimedTransition(transition, _wait(state, transition))
        for state in (leaf, *around)
        for transition in state.transitions
    ]


def _wait(state: CompiledState, transition: CompiledTransition) -> float:
    dwell = state.dwell if transition.patient else 0.0
    return max(dwell, transition.after or 0.0) - EPSILON


def _asks(
    ways: Sequence[TimedTransition],
) -> tuple[list[DirectGuard], list[tuple[GuardFunction, float, str]]]:
    """Return the guards that can be evaluated directly, each once, and the rest.

    One with an event is evaluated for the record only.
    """
    direct: dict[str, DirectGuard] = {}
    plain: list[tuple[GuardFunction, float, str]] = []
    for transition, wait in ways:
        guard = transition.guard
        if transition.ask is None or transition.hold:
            continue
        least, source = inf if transition.events else wait, transition.source
        if guard is not None and guard.check is not None and guard.name not in direct:
            direct[guard.name] = DirectGuard(guard.name, guard.check, least, source)
        else:
            plain.append((transition.ask, least, source))
    return list(direct.values()), plain


def lead(way: TimedTransition) -> Lead:
    """Return a transition as the quick step takes it."""
    transition, wait = way
    name = "" if transition.guard is None else transition.guard.name
    return transition, transition.ask, name, wait, transition.source, transition.hold


def _guards(ways: Sequence[TimedTransition]) -> tuple[GuardRow, ...]:
    """Return the guards in the order in which the general step asks them."""
    timed = [way.transition for way in ways if way.transition.hold]
    others = [way.transition for way in ways if not way.transition.hold]
    own = [it for it in others if it.guard is not None and it.guard.check is not None]
    return _each_once([*own, *others, *timed])


def _each_once(transitions: Sequence[CompiledTransition]) -> tuple[GuardRow, ...]:
    """Return their guards, each once; unknown counts as holding if it does for one of them."""
    found: dict[object, AskedGuard] = {}
    for guard in (transition.guard for transition in transitions):
        if guard is not None:
            key = guard.name or guard.ask
            takes = guard.unknown_takes or (key in found and found[key].unknown_takes)
            found[key] = guard._replace(unknown_takes=takes)
    return tuple([tuple(guard) for guard in found.values()])


def _is_timer(transition: CompiledTransition) -> bool:
    return transition.ask is None and not transition.events


def _timer(way: TimedTransition) -> tuple[float, str]:
    return way.wait, way.transition.source


def _promises(state: CompiledState) -> bool:
    return state.kind.invariant is not None or state.promise is not None
