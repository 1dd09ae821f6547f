"""What can be seen at the end of the ticks of an exploration, and which tick follows which."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from missionkit.chart.model.variables import Values
from missionkit.messages.region import Boxes


class Step(NamedTuple):
    """How one node of the search leads to another."""

    seconds: float  # that pass before it, at least
    events: tuple[str, ...]  # from outside, in this order
    taken: tuple[int, ...]  # numbers of the transitions
    boxes: Boxes  # where the quantities may lie
    before: Boxes = ()  # where they may lie before a state that commands is entered, if it is
    forced: str = ""  # why it leads away where no transition of the file does


class Observed(NamedTuple):
    """What requirements see at the end of a tick."""

    active: tuple[str, ...]
    entered: frozenset[str]
    variables: Values
    boxes: Boxes  # where the quantities may lie


class Edge(NamedTuple):
    """A tick, or time that passes, and the nodes that it may lead to."""

    to: tuple[int, ...]
    step: Step
    observed: Observed | None  # None: time passes in ticks that are edges of their own


Edges = Mapping[int, Sequence[Edge]]  # by the number of the node that they lead from


def sooner(edges: Edges, ends: Iterable[tuple[int, Edge]]) -> dict[int, float]:
    """Return for each node how soon (s, at the least) one of some edges can be taken.

    Args:
        edges: of an exploration.
        ends: the edges that are waited for, with the nodes that they lead from.
    """
    before: dict[int, list[tuple[int, float]]] = {}
    for number, each in edges.items():
        for edge in each:
            for to in edge.to:
                before.setdefault(to, []).append((number, edge.step.seconds))
    found = {number: edge.step.seconds for number, edge in ends}
    waiting = deque(found)
    while waiting:
        number = waiting.popleft()
        for earlier, seconds in before.get(number, ()):
            total = found[number] + seconds
            if total < found.get(earlier, float("inf")):
                found[earlier] = total
                waiting.append(earlier)
    return found
