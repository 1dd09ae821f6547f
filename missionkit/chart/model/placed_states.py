"""The tree of a mission's states, walked in document order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from missionkit.chart.model.state_definitions import State


class Placed(NamedTuple):
    """One state of the tree, and the one around it."""

    name: str
    state: State
    parent: str | None


def walk(states: Mapping[str, State], parent: str | None = None) -> Iterator[Placed]:
    """Yield every state of a tree in document order."""
    for name, state in states.items():
        yield Placed(name, state, parent)
        yield from walk(state.states, name)


def around(states: Mapping[str, Placed], parent: str | None) -> tuple[str, ...]:
    """Return a state's parent and the states around that, the innermost first."""
    found: list[str] = []
    while parent is not None:
        found.append(parent)
        parent = states[parent].parent
    return tuple(found)


def firsts(states: Mapping[str, Placed]) -> dict[str, str]:
    """Return the first state of each kind."""
    found: dict[str, str] = {}
    for name, state, _ in states.values():
        found.setdefault(state.kind, name)
    return found
