"""Where the states of a tree go: every state with states inside is a layout of its own.

An arrow that crosses the border of a state runs through a port: a point in the first or last
layer of the layout inside. Which of the two is known from the layout around, so ranks are found
from the outside in, sizes from the inside out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from missionkit.chart.drawing.layered_layout import (
    Layout,
    LayoutBox,
    LayoutLink,
    Point,
    layout,
    ranks,
)

PAD = 16.0  # px between what is inside a state and its border
HEAD = 6.0  # px around its heading
DOT_BOX = LayoutBox(12.0, 12.0)
BARE_BOX = LayoutBox(8.0, 0.0)  # an arrow without a label, a port
Parents = Mapping[str, str | None]


class Arrow(NamedTuple):
    """An arrow between two states; without a `source` it is where `around` begins."""

    source: str | None
    target: str
    label: LayoutBox
    around: str | None = None


class Rectangle(NamedTuple):
    """A centre and a size, in px."""

    x: float
    y: float
    box: LayoutBox


@dataclass(frozen=True, slots=True)
class Drawing:
    """States, beginnings, and for each arrow its label's centre and its points, in px."""

    states: Mapping[str, Rectangle]
    dots: tuple[Point, ...]
    labels: tuple[Point, ...]
    routes: tuple[tuple[Point, ...], ...]
    width: float
    height: float


class _Piece(NamedTuple):
    """Part of an arrow on one level."""

    arrow: int
    link: LayoutLink
    order: int = 0  # of the pieces of one arrow: those at its source first
    backwards: bool = False  # the arrow runs against the link
    edge: str | None = None  # the border of the state around where the arrow begins or ends


class _Crossing(NamedTuple):
    """An arrow whose source or target is deeper inside a state, and where it crosses the border."""

    arrow: int
    at_source: bool
    on_top: bool


@dataclass(slots=True)
class _Level:
    """One layout: the states directly inside another, beginnings, and ports."""

    depth: int
    nodes: dict[object, int] = field(default_factory=dict)
    low: set[int] = field(default_factory=set)
    pieces: list[_Piece] = field(default_factory=list)
    crossings: list[_Crossing] = field(default_factory=list)
    placed: Layout | None = None

    def node(self, key: object) -> int:
        """Return the number of a state, port or beginning."""
        return self.nodes.setdefault(key, len(self.nodes))


def nested(sizes: Mapping[str, LayoutBox], parents: Parents, arrows: Sequence[Arrow]) -> Drawing:
    """Place a tree of states.

    Args:
        sizes: of each state, in document order; of one with states inside: of its heading.
        parents: the state around each state.
        arrows: what leads where.
    """
    chart = _Nested(sizes, parents, arrows)
    for name in chart.levels:
        chart.connect(name)
    for name in reversed(chart.levels):
        chart.place(name)
    return chart.drawing()


class _Nested:
    """The levels of a tree while they are placed."""

    def __init__(
        self, sizes: Mapping[str, LayoutBox], parents: Parents, arrows: Sequence[Arrow]
    ) -> None:
        self.sizes = dict(sizes)
        self.headings = sizes
        self.parents = parents
        self.arrows = arrows
        self.levels: dict[str | None, _Level] = {None: _Level(0)}
        self.own: dict[str | None, list[int]] = {}
        for name in sizes:
            if name in parents.values():
                self.levels[name] = _Level(len(self.around(name)))
        for name in sizes:
            self.levels[parents[name]].node(name)
        for number, arrow in enumerate(arrows):
            self.own.setdefault(self.level_of(arrow), []).append(number)

    def around(self, name: str | None) -> list[str | None]:
        """Return a state and those around it, the innermost first, the whole last."""
        chain = [name]
        while name is not None:
            name = self.parents[name]
            chain.append(name)
        return chain

    def level_of(self, arrow: Arrow) -> str | None:
        """Return the state inside which an arrow runs."""
        if arrow.source is None:
            return arrow.around
        if arrow.source == arrow.target:
            return self.parents[arrow.target]
        inner = set(self.around(arrow.source))
        return next(name for name in self.around(arrow.target) if name in inner)

    def inside(self, level: str | None, name: str) -> str:
        """Return the state directly inside `level` that is `name` or around it."""
        chain = self.around(name)
        return str(chain[chain.index(level) - 1])

    def connect(self, name: str | None) -> None:
        """Find the links of a level, and where they cross the borders of its states."""
        level = self.levels[name]
        level.pieces = [self.main(name, number) for number in self.own.get(name, ())]
        level.pieces += [self.through(name, crossing) for crossing in level.crossings]
        links = [piece.link for piece in level.pieces]
        rank = ranks(len(level.nodes), links, self.initial(level), level.low)
        for piece in level.pieces:
            down = rank[piece.link.source] <= rank[piece.link.target]
            self.cross(level, piece, piece.link.source, at_source=not piece.backwards, top=not down)
            self.cross(level, piece, piece.link.target, at_source=piece.backwards, top=down)

    def initial(self, level: _Level) -> int:
        return level.nodes.get("", 0)

    def main(self, name: str | None, number: int) -> _Piece:
        """Return the piece of an arrow on its own level."""
        level, arrow = self.levels[name], self.arrows[number]
        edge = None
        if arrow.source is None:
            source = level.node("")
        elif arrow.source == name:
            source, edge = level.node(("port", number)), "top"
        else:
            source = level.node(self.inside(name, arrow.source))
        if arrow.target == name:
            target, edge = level.node(("port", number)), "bottom"
            level.low.add(target)
        else:
            target = level.node(self.inside(name, arrow.target))
        return _Piece(number, LayoutLink(source, target, arrow.label), edge=edge)

    def through(self, name: str | None, crossing: _Crossing) -> _Piece:
        """Return the piece of an arrow between a state inside and the border."""
        level, arrow = self.levels[name], self.arrows[crossing.arrow]
        end = arrow.source if crossing.at_source else arrow.target
        state = level.node(self.inside(name, str(end)))
        port = level.node(("port", crossing.arrow))
        order = -level.depth if crossing.at_source else level.depth
        if crossing.on_top:
            return _Piece(
                crossing.arrow, LayoutLink(port, state, BARE_BOX), order, crossing.at_source
            )
        level.low.add(port)
        return _Piece(
            crossing.arrow, LayoutLink(state, port, BARE_BOX), order, not crossing.at_source
        )

    def cross(self, level: _Level, piece: _Piece, node: int, *, at_source: bool, top: bool) -> None:
        """Let an arrow cross the border of a state that is not its end."""
        arrow = self.arrows[piece.arrow]
        end = arrow.source if at_source else arrow.target
        key = next(key for key, number in level.nodes.items() if number == node)
        if isinstance(key, str) and key and key != end:
            self.levels[key].crossings.append(_Crossing(piece.arrow, at_source, top))

    def place(self, name: str | None) -> None:
        """Lay a level out; the states inside it have been before."""
        level = self.levels[name]
        boxes = [self.box(key) for key in level.nodes]
        links = [piece.link for piece in level.pieces]
        level.placed = placed = layout(boxes, links, self.initial(level), level.low)
        if name is not None:
            wide = max(self.sizes[name].width, placed.width + 2 * PAD)
            self.sizes[name] = LayoutBox(wide, self.head(name) + placed.height + PAD)

    def head(self, name: str) -> float:
        """Return how much room a state with states inside has for its heading (px)."""
        return self.headings[name].height + HEAD

    def box(self, key: object) -> LayoutBox:
        """Return the size of a state, a beginning or a port."""
        if isinstance(key, str):
            return self.sizes[key] if key else DOT_BOX
        return BARE_BOX

    def drawing(self) -> Drawing:
        """Return everything in the coordinates of the whole."""
        states: dict[str, Rectangle] = {}
        dots: list[Point] = []
        labels: dict[int, Point] = {}
        pieces: list[tuple[int, int, tuple[Point, ...]]] = []
        for name, level in self.levels.items():
            placed, (left, top) = _placed(level), self.corner(states, name)
            for (x, y), (key, box) in zip(
                placed.states, ((key, self.box(key)) for key in level.nodes), strict=True
            ):
                if key == "":
                    dots.append((left + x, top + y))
                elif isinstance(key, str):
                    states[key] = Rectangle(left + x, top + y, box)
            for piece, route, (x, y) in zip(
                level.pieces, placed.routes, placed.labels, strict=True
            ):
                points = [(left + u, top + v) for u, v in route]
                if name is not None:
                    points = _to_edge(points, piece.edge, states[name])
                if piece.order == 0:
                    labels[piece.arrow] = (left + x, top + y)
                ordered = tuple(points[::-1] if piece.backwards else points)
                pieces.append((piece.arrow, piece.order, ordered))
        return Drawing(
            states,
            tuple(dots),
            tuple(labels[number] for number in range(len(self.arrows))),
            tuple(_joined(pieces, len(self.arrows))),
            _placed(self.levels[None]).width,
            _placed(self.levels[None]).height,
        )

    def corner(self, states: Mapping[str, Rectangle], name: str | None) -> Point:
        """Return where the layout inside a state begins."""
        if name is None:
            return 0.0, 0.0
        x, y, box = states[name]
        return x - _placed(self.levels[name]).width / 2, y - box.height / 2 + self.head(name)


def _placed(level: _Level) -> Layout:
    if level.placed is None:
        raise ValueError("a level is drawn before it is placed")
    return level.placed


def _to_edge(points: list[Point], edge: str | None, around: Rectangle) -> list[Point]:
    """Let an arrow begin or end at the border of the state around it."""
    half = around.box.height / 2
    if edge == "top":
        return [(points[0][0], around.y - half), *points]
    if edge == "bottom":
        return [*points, (points[-1][0], around.y + half)]
    return points


def _joined(
    pieces: list[tuple[int, int, tuple[Point, ...]]], count: int
) -> Iterator[tuple[Point, ...]]:
    """Yield the points of each arrow, its pieces put together."""
    routes: list[list[Point]] = [[] for _ in range(count)]
    for number, _, points in sorted(pieces, key=lambda piece: piece[:2]):
        routes[number] += points
    yield from map(tuple, routes)
