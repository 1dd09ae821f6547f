"""Result of exploring a chart: its nodes, and what happens between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from missionkit.chart.checks.exploration.clocks import Ages
from missionkit.chart.checks.exploration.observations import Edges, Step
from missionkit.chart.semantics.chart_memory import ChartMemory
from missionkit.chart.semantics.entry_exit_sets import Move
from missionkit.messages import Action
from missionkit.messages.region import Boxes


class Node(NamedTuple):
    """One situation of the chart between two ticks."""

    number: int
    memory: ChartMemory
    ages: Ages
    before: Node | None
    step: Step | None
    aloft: bool = False  # the vehicle may have left the ground; only where the chart disarms


class Link(NamedTuple):
    """A step that leads from one node to another, by its number."""

    to: int
    step: Step


class Circle(NamedTuple):
    """A tick that does not come to rest."""

    node: Node
    step: Step  # how it begins
    taken: tuple[int, ...]  # the transitions that are taken again and again


class Tick(NamedTuple):
    """One path through one tick."""

    memory: ChartMemory
    moves: Sequence[Move]
    step: Step
    circle: tuple[int, ...]  # what is taken again and again, if it does not come to rest
    orders: Sequence[Action]
    fresh: bool  # a guard was asked after the commanding state was entered
    waits: bool  # a guard holds that has not held for long enough: it cannot stay so


class Disarming(NamedTuple):
    """A tick that disarms while the vehicle may be in the air."""

    node: Node
    step: Step
    moves: Sequence[Move]


class Example(NamedTuple):
    """The first tick in which something happens."""

    node: Node
    step: Step
    undone: bool  # the tick does not come to rest, so that the engine undoes it


class Exploration(NamedTuple):
    """What a chart can do."""

    nodes: Sequence[Node]
    taken: Mapping[int, Example]  # by the number of the transition
    reached: Mapping[str, Node]
    left: Mapping[str, Mapping[int, float]]  # state -> what ends it, at an age (s) of at least
    circles: Sequence[Circle]
    disarming: Sequence[Disarming]
    rests: Mapping[int, Boxes]  # by the number of the node: where a tick changes nothing
    links: Mapping[int, Sequence[Link]]  # by the number of the node that they lead from
    edges: Edges  # only of a chart with requirements
    complete: bool  # nothing else can happen
    ticks: int  # tried, those of large charts count more


def joined(parts: Sequence[Exploration]) -> Exploration:
    """Return several explorations of parts of a chart as one; their first nodes are one node."""
    first, *others = parts
    for part in others:
        first = _with(first, part)
    return first


def _with(one: Exploration, other: Exploration) -> Exploration:
    shift = len(one.nodes) - 1

    def at(number: int) -> int:
        return number + shift if number else 0

    def moved(node: Node) -> Node:
        return node._replace(number=at(node.number))

    left = {name: dict(ends) for name, ends in one.left.items()}
    for name, ends in other.left.items():
        known = left.setdefault(name, {})
        for number, age in ends.items():
            known[number] = max(age, known.get(number, age))
    links = {number: list(each) for number, each in one.links.items()}
    for number, each in other.links.items():
        links.setdefault(at(number), []).extend(it._replace(to=at(it.to)) for it in each)
    return Exploration(
        nodes=(*one.nodes, *map(moved, other.nodes[1:])),
        taken={**other.taken, **one.taken},
        reached={**other.reached, **one.reached},
        left=left,
        circles=(*one.circles, *(it._replace(node=moved(it.node)) for it in other.circles)),
        disarming=(*one.disarming, *other.disarming),
        rests={**{at(n): boxes for n, boxes in other.rests.items()}, **one.rests},
        links=links,
        edges=one.edges,  # of a chart with requirements, which is explored as a whole
        complete=one.complete and other.complete,
        ticks=one.ticks + other.ticks,
    )
