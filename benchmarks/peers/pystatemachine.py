"""python-statemachine."""

from __future__ import annotations

from typing import Any

from statemachine import State, StateMachine

from benchmarks.peers.ring import Engine, Guards, Machine, Ring, Sky

OPTIONS = {"allow_event_without_transition": True, "catch_errors_as_events": False}


def load(chart: Ring, _: Sky, guards: Guards) -> Machine:
    """Make a class, as a `class` statement would, and an instance of it."""
    states = {name: State(name, initial=name == chart.initial) for name in chart.states}
    ways: Any = None
    for name, out in chart.states.items():
        for to, ask in out:
            way = states[name].to(states[to], cond=guards[ask.name])
            ways = way if ways is None else ways | way
    made: Any = type(StateMachine)("Made", (StateMachine,), {**states, "tick": ways, **OPTIONS})
    machine = made()
    return Machine(machine.tick, lambda: machine.current_state_value)


HOW = "event method, `cond` as functions, errors not caught; load: from a class"
ENGINES = (Engine("python-statemachine", HOW, lambda chart: chart, load, "python-statemachine"),)
