"""transitions."""

from __future__ import annotations

from typing import Any

from transitions import Machine as Flat
from transitions.extensions import HierarchicalMachine

from benchmarks.peers.ring import Engine, Guards, Machine, Ring, Sky

Rows = list[tuple[str, str, str]]


class Model:
    """The model that the machine adds `tick` and `state` to."""

    tick: Any
    state: str


def text(chart: Ring) -> tuple[str, list[str], Rows]:
    """Write initial state, states, and (source, target, guard) of each transition."""
    rows = [(name, to, ask.name) for name, ways in chart.states.items() for to, ask in ways]
    return chart.initial, list(chart.states), rows


def _load(kind: type[Flat]) -> Any:
    def load(written: tuple[str, list[str], Rows], _: Sky, guards: Guards) -> Machine:
        initial, states, rows = written
        ways = [["tick", name, to, [guards[guard]]] for name, to, guard in rows]
        model = Model()
        kind(model, states, initial, ways, auto_transitions=False)
        return Machine(model.tick, lambda: model.state)

    return load


HOW = "trigger on the model, conditions as functions, no automatic transitions; load: from lists"
ENGINES = (
    Engine("transitions", HOW, text, _load(Flat), "transitions"),
    Engine("transitions, hierarchical", HOW, text, _load(HierarchicalMachine), "transitions"),
)
