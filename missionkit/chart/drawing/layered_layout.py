"""Where the boxes, arrows and labels of a chart go: a small layered layout.

States stand in even layers, labels of transitions in the odd layers between them, so that no
label covers another.  Source: K. Sugiyama, S. Tagawa, M. Toda, "Methods for visual understanding
of hierarchical system structures", 1981: ranks, barycentre ordering, straightening.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

ORDERING_SWEEPS = 24
GAP_X = 26.0  # px between neighbours
GAP_Y = 28.0  # px between layers
LOOP = 14.0  # px, half the width of a loop where it turns behind its label

Point = tuple[float, float]


class LayoutBox(NamedTuple):
    """The size of a state or a label (px)."""

    width: float
    height: float


class LayoutLink(NamedTuple):
    """A transition from state number `source` to state number `target`, with its label's size."""

    source: int
    target: int
    label: LayoutBox


class LayerRow(NamedTuple):
    """The middle of a layer and half its height (px)."""

    y: float
    half: float


@dataclass(frozen=True, slots=True)
class Layout:
    """Centres of states and labels, and the points each arrow runs through, in px."""

    states: tuple[Point, ...]
    labels: tuple[Point, ...]
    routes: tuple[tuple[Point, ...], ...]
    width: float
    height: float


@dataclass(slots=True)
class _Graph:
    """States, then one vertex for each layer that a link crosses."""

    boxes: list[LayoutBox]
    ranks: list[int]
    chains: list[list[int]]  # for each link its vertices, the upper state first
    labels: list[int]  # for each link the vertex of its label


def layout(
    states: Sequence[LayoutBox],
    links: Sequence[LayoutLink],
    initial: int,
    low: Collection[int] = (),
) -> Layout:
    """Place a chart with the initial state on top and the states `low` at the bottom.

    Args:
        states: sizes, px.
        links: arrows by the indices of their states in `states`, with labels.
        initial: index of the state that everything starts in.
        low: indices of states that nothing leads out of.
    """
    graph = _with_vertices(states, links, ranks(len(states), links, initial, low))
    layers = _ordered(graph)
    xs, rows = _columns(graph, layers), _rows(graph, layers)
    left = min(x - box.width / 2 for x, box in zip(xs, graph.boxes, strict=True))
    centres = [(x - left, rows[rank].y) for x, rank in zip(xs, graph.ranks, strict=True)]
    right = max(x + box.width / 2 for (x, _), box in zip(centres, graph.boxes, strict=True))
    bottom = rows[-1].y + rows[-1].half
    return Layout(
        tuple(centres[: len(states)]),
        tuple(centres[vertex] for vertex in graph.labels),
        _routes(graph, centres, rows, links),
        right,
        bottom,
    )


def ranks(
    count: int, links: Sequence[LayoutLink], initial: int, low: Collection[int] = ()
) -> list[int]:
    """Return each state's layer: the longest way to it, links that close a circle turned round.

    Nothing leads out of the states `low`: they are in the last layer.

    Args:
        count: number of states.
        links: arrows by the indices of their states.
        initial: index; the search for circles begins there.
        low: indices of states that nothing leads out of.
    """
    ahead: list[list[int]] = [[] for _ in range(count)]
    for source, target, _ in links:
        ahead[source].append(target)
    found = [0] * count
    for state in _finishing_order(ahead, initial):
        for target in ahead[state]:
            found[target] = max(found[target], found[state] + 1)
    return [max(found) if state in low else rank for state, rank in enumerate(found)]


def _finishing_order(ahead: list[list[int]], initial: int) -> list[int]:
    """Return a topological order; drops from `ahead` the links that run back."""
    order: list[int] = []
    seen, open_ = set[int](), set[int]()
    for root in [initial, *range(len(ahead))]:
        stack = [] if root in seen else [root]
        while stack:
            state = stack[-1]
            seen.add(state)
            open_.add(state)
            ahead[state] = [target for target in ahead[state] if target not in open_]
            fresh = [target for target in ahead[state] if target not in seen]
            if fresh:
                stack.append(fresh[0])
            else:
                order.append(stack.pop())
                open_.discard(state)
    return order[::-1]


def _with_vertices(
    states: Sequence[LayoutBox], links: Sequence[LayoutLink], layers: list[int]
) -> _Graph:
    graph = _Graph(list(states), [2 * rank for rank in layers], [], [])
    for source, target, label in links:
        down = layers[source] <= layers[target]
        upper, lower = (source, target) if down else (target, source)
        first, last = 2 * layers[upper], max(2 * layers[lower], 2 * layers[upper] + 2)
        labelled = first + 1 if down else last - 1
        chain = [upper]
        for rank in range(first + 1, last):
            if rank == labelled:
                graph.labels.append(len(graph.boxes))
            chain.append(len(graph.boxes))
            graph.boxes.append(label if rank == labelled else LayoutBox(8.0, 0.0))
            graph.ranks.append(rank)
        graph.chains.append([*chain, lower])
    return graph


def _neighbours(graph: _Graph) -> list[list[int]]:
    near: list[list[int]] = [[] for _ in graph.boxes]
    for chain in graph.chains:
        for a, b in pairwise(chain):
            near[a].append(b)
            near[b].append(a)
    return near


def _ordered(graph: _Graph) -> list[list[int]]:
    """Return the layers, each from left to right, by barycentres of the layers beside it."""
    layers: list[list[int]] = [[] for _ in range(max(graph.ranks) + 1)]
    for vertex, rank in enumerate(graph.ranks):
        layers[rank].append(vertex)
    near = _neighbours(graph)
    position = {v: at / len(layer) for layer in layers for at, v in enumerate(layer)}
    for sweep in range(ORDERING_SWEEPS):
        downwards = sweep % 2 == 0
        for layer in layers if downwards else reversed(layers):
            beside = {
                v: [position[n] for n in near[v] if (graph.ranks[n] < graph.ranks[v]) == downwards]
                for v in layer
            }
            layer.sort(key=lambda v: _mean(beside[v], position[v]))
            position |= {v: (at + 0.5) / len(layer) for at, v in enumerate(layer)}
    return layers


def _columns(graph: _Graph, layers: list[list[int]]) -> list[float]:
    """Return x of each vertex: near its neighbours, never overlapping in its layer."""
    near = _neighbours(graph)
    xs = [0.0] * len(graph.boxes)
    for layer in layers:
        for vertex, x in zip(layer, _spread(graph, layer, [0.0] * len(layer)), strict=True):
            xs[vertex] = x
    for sweep in range(ORDERING_SWEEPS):
        for layer in layers if sweep % 2 == 0 else reversed(layers):
            wanted = [_mean([xs[n] for n in near[v]], xs[v]) for v in layer]
            for vertex, x in zip(layer, _spread(graph, layer, wanted), strict=True):
                xs[vertex] = x
    return xs


def _spread(graph: _Graph, layer: list[int], wanted: list[float]) -> list[float]:
    """Move positions apart, as little to the left as to the right."""
    halves = [graph.boxes[vertex].width / 2 for vertex in layer]
    apart = [a + b + GAP_X for a, b in pairwise(halves)]
    right, left = list(wanted), list(wanted)
    for at, gap in enumerate(apart):
        right[at + 1] = max(right[at + 1], right[at] + gap)
    for at in range(len(apart) - 1, -1, -1):
        left[at] = min(left[at], left[at + 1] - apart[at])
    return [(a + b) / 2 for a, b in zip(left, right, strict=True)]


def _rows(graph: _Graph, layers: list[list[int]]) -> list[LayerRow]:
    rows, top = [], 0.0
    for layer in layers:
        height = max((graph.boxes[vertex].height for vertex in layer), default=0.0)
        rows.append(LayerRow(top + height / 2, height / 2))
        top += height + GAP_Y
    return rows


def _routes(
    graph: _Graph, centres: list[Point], rows: list[LayerRow], links: Sequence[LayoutLink]
) -> tuple[tuple[Point, ...], ...]:
    """Return each arrow's points, from its source to its target."""
    routes = []
    for number, (link, chain) in enumerate(zip(links, graph.chains, strict=True)):
        points = [_port(graph, centres, number, 0, below=True)]
        for vertex in chain[1:-1]:
            (x, y), half = centres[vertex], rows[graph.ranks[vertex]].half
            points += [(x, y - half), (x, y + half)]
        looped = link.source == link.target
        if looped:
            (x, y), wide = centres[chain[1]], min(LOOP, graph.boxes[chain[1]].width / 4)
            points[1:] = [(x - wide, y), (x, y), (x + wide, y)]
        points.append(_port(graph, centres, number, 1, below=looped))
        routes.append(tuple(points if chain[0] == link.source else points[::-1]))
    return tuple(routes)


def _port(graph: _Graph, centres: list[Point], number: int, end: int, *, below: bool) -> Point:
    """Return where on a state's edge an end of a link is: ends stand in the order of their links.

    Args:
        graph: the states and links.
        centres: of its vertices.
        number: of the link.
        end: 0 for the upper end of its chain, 1 for the lower.
        below: whether it ends at the lower edge.
    """
    state = graph.chains[number][-end]
    ends = [
        (centres[chain[at]][0], other, tip)
        for other, chain in enumerate(graph.chains)
        for tip, at in ((0, 1), (1, -2))
        if chain[-tip] == state and (tip == 0 or chain[0] == chain[-1]) == below
    ]
    at = [(other, tip) for _, other, tip in sorted(ends)].index((number, end))
    (x, y), box = centres[state], graph.boxes[state]
    offset = box.width * ((at + 1) / (len(ends) + 1) - 0.5)
    return x + 0.8 * offset, y + (box.height / 2 if below else -box.height / 2)


def _mean(values: list[float], default: float) -> float:
    return sum(values) / len(values) if values else default
