"""xstate-statemachine."""

from __future__ import annotations

import json
from functools import partial
from typing import Any

from xstate_statemachine import Event, MachineLogic, SyncInterpreter, create_machine

from benchmarks.peers.ring import Engine, Guards, Machine, Predicate, Ring, Sky


def text(chart: Ring) -> str:
    """Write XState's JSON."""
    states = {
        name: {"on": {"TICK": [{"target": to, "guard": ask.name} for to, ask in ways]}}
        for name, ways in chart.states.items()
    }
    return json.dumps({"id": "ring", "initial": chart.initial, "states": states})


def load(written: str, _: Sky, guards: Guards) -> Machine:
    """Read the JSON and start."""
    asked = {name: _asked(guard) for name, guard in guards.items()}
    machine = create_machine(json.loads(written), logic=MachineLogic(guards=asked))
    running = SyncInterpreter(machine).start()
    return Machine(
        partial(running.send, Event("TICK")),
        lambda: next(iter(running.current_state_ids)).removeprefix("ring."),
    )


def _asked(guard: Predicate) -> Any:
    return lambda _context, _event: guard()


HOW = "synchronous interpreter, an event made beforehand, guards as functions; load: from JSON"
ENGINES = (Engine("xstate-statemachine", HOW, text, load, "xstate-statemachine"),)
