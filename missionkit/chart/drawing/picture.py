"""A mission as an SVG picture, drawn without other programs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from itertools import pairwise
from textwrap import shorten, wrap

from missionkit.chart.drawing.diagram import colour, failsafe_text, state_text, transition_text
from missionkit.chart.drawing.layout import Box, Point
from missionkit.chart.drawing.marks import UNMARKED, Marks, numbered
from missionkit.chart.drawing.nested import Arrow, Drawing, Rectangle, nested
from missionkit.chart.model.mission import Mission, State

MARGIN = 24.0
TOP = 66.0  # title
LINE = 15.0
LABEL_WIDTH = 26  # characters
LIST_WIDTH = 110  # characters
RED = "#c81e1e"
_STYLE = (
    "text{font-family:Helvetica,Arial,'DejaVu Sans',sans-serif;fill:#1f2937}"
    ".title{font-size:19px;font-weight:bold}.name{font-size:15px;font-weight:bold}"
    ".small{font-size:12px}.box{stroke:#4b5563;stroke-width:1.4}.around{fill-opacity:.35}"
    ".region{stroke-dasharray:6 4}"
    ".arrow{fill:none;stroke:#4b5563;stroke-width:1.4}.strip{fill:#fdf2f2;stroke:#d08a8a}"
    ".label{fill:#fff;fill-opacity:.92}"
    f".marked{{stroke:{RED};stroke-width:2.6}}text.marked{{fill:{RED};stroke:none}}"
)


def _tip(name: str, fill: str) -> str:
    return (
        f'<marker id="{name}" viewBox="0 0 10 10" refX="9.5" refY="5" markerWidth="8" '
        'markerHeight="8" orient="auto" markerUnits="userSpaceOnUse">'
        f'<path d="M0 0L10 5L0 10z" fill="{fill}"/></marker>'
    )


def svg(mission: Mission, marks: Marks = UNMARKED) -> str:
    """Return the mission as an SVG document: states coloured by kind, guards on the arrows.

    Args:
        mission: with its default failsafes written out.
        marks: the states and transitions to be drawn in red, and why.
    """
    ways = list(_ways(mission, marks))
    parents = {name: parent for name, _, parent in mission.walk()}
    sizes = {name: _heading(name, state, marks) for name, state, _ in mission.walk()}
    drawn = nested(sizes, parents, [arrow for arrow, _, _ in ways])
    strips = list(_strips(mission, marks))
    width = max([drawn.width, 560.0, *(_strip_width(lines) for lines in strips)])
    below = list(_stacked(strips, TOP + drawn.height + 30, width))
    height = TOP + drawn.height + 30 + sum(_strip_height(lines) + 14 for lines in strips) + MARGIN
    size = f"{width + 2 * MARGIN:.0f}", f"{height:.0f}"
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]}" height="{size[1]}" '
            f'viewBox="0 0 {size[0]} {size[1]}">',
            f"<style>{_STYLE}</style><defs>{_tip('arrow', '#4b5563')}{_tip('red', RED)}</defs>",
            '<rect width="100%" height="100%" fill="#fff"/>',
            *_title(mission),
            f'<g transform="translate({MARGIN + (width - drawn.width) / 2:.1f} {TOP:.1f})">',
            *_groups(mission, drawn, marks),
            *(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="#1f2937"/>' for x, y in drawn.dots),
            *_arrows(drawn, ways),
            *_labels(drawn, ways),
            *_states(mission, drawn, marks),
            "</g>",
            *below,
            "</svg>\n",
        ]
    )


_Way = tuple[Arrow, Sequence[str], bool]  # its place, the lines of its label, whether it is marked


def _ways(mission: Mission, marks: Marks) -> Iterator[_Way]:
    """Yield every arrow."""
    yield from ((Arrow(None, to, _size([])), [], False) for to in mission.initial.to)
    for name, state, _ in mission.walk():
        for number, each in enumerate(state.transitions):
            found = numbered(marks.ways.get((name, number), ()))
            lines = _wrapped(f"{found} {transition_text(each)}".strip())
            for to in each.targets or (name,):
                yield Arrow(name, to, _size(lines)), lines, bool(found)
        if state.initial is not None:
            yield from ((Arrow(None, to, _size([]), name), [], False) for to in state.initial.to)
        if state.default is not None:
            lines = ["the first time"]
            yield from ((Arrow(name, to, _size(lines)), lines, False) for to in state.default.to)


def _wrapped(label: str) -> list[str]:
    return wrap(label, LABEL_WIDTH, break_on_hyphens=False)


def _width(line: str, character: float) -> float:
    return character * len(line)


def _size(lines: Sequence[str]) -> Box:
    if not lines:
        return Box(8, 0)
    return Box(max(_width(line, 6.6) for line in lines) + 8, LINE * len(lines) + 4)


def _heading(name: str, state: State, marks: Marks) -> Box:
    shown = f"{name} {numbered(marks.states.get(name, ()))}".rstrip()
    return Box(max(96.0, _width(shown, 9) + 28, _width(_does(name, state), 6.6) + 24), 48.0)


def _does(name: str, state: State) -> str:
    if state.kind == "logic":
        return state_text(state)
    return state_text(state) if name == state.kind else f"{state.kind}: {state_text(state)}"


def _title(mission: Mission) -> Iterator[str]:
    yield f'<text class="title" x="{MARGIN}" y="32">{escape(mission.name)}</text>'
    summary = shorten(mission.summary, 90, placeholder=" …")
    yield f'<text class="small" x="{MARGIN}" y="50">{escape(summary)}</text>'


def _arrows(drawn: Drawing, ways: Sequence[_Way]) -> Iterator[str]:
    for route, (_, _, marked) in zip(drawn.routes, ways, strict=True):
        style, tip = ("arrow marked", "red") if marked else ("arrow", "arrow")
        yield f'<path class="{style}" d="{_curve(route)}" marker-end="url(#{tip})"/>'


def _curve(points: Sequence[Point]) -> str:
    """Return a smooth path that leaves and meets every layer vertically."""
    path = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
    for (x, y), (u, v) in pairwise(points):
        middle = (y + v) / 2
        path += f"C{x:.1f} {middle:.1f} {u:.1f} {middle:.1f} {u:.1f} {v:.1f}"
    return path


def _labels(drawn: Drawing, ways: Sequence[_Way]) -> Iterator[str]:
    for (x, y), (_, lines, marked) in zip(drawn.labels, ways, strict=True):
        if lines:
            yield _rectangle(Rectangle(x, y, _size(lines)), "label", 3)
        for at, line in enumerate(lines):
            style = "small marked" if marked else "small"
            yield _text(line, x, y + LINE * (at - (len(lines) - 1) / 2) + 4, style)


def _groups(mission: Mission, drawn: Drawing, marks: Marks) -> Iterator[str]:
    """Yield the borders of states with states inside, the outermost first."""
    regions = {
        region for _, state, _ in mission.walk() if state.parallel for region in state.states
    }
    for name, state, _ in mission.walk():
        if state.states:
            style = " around region" if name in regions else " around"
            yield _border(name, state, drawn.states[name], marks, style)


def _border(name: str, state: State, place: Rectangle, marks: Marks, style: str = "") -> str:
    marked = " marked" if name in marks.states else ""
    return _rectangle(place, f"box{style}{marked}", 11, f' fill="{colour(state)}"')


def _states(mission: Mission, drawn: Drawing, marks: Marks) -> Iterator[str]:
    """Yield the names of all states, and the borders of those without states inside."""
    for name, state, _ in mission.walk():
        x, y, box = drawn.states[name]
        if not state.states:
            yield _border(name, state, drawn.states[name], marks)
        else:
            heading = _heading(name, state, marks)
            x, y = x + (heading.width - box.width) / 2, y + 26 - box.height / 2
            yield _rectangle(Rectangle(x, y - 1, Box(heading.width - 20, 34)), "label", 3)
        found = numbered(marks.states.get(name, ()))
        yield _text(f"{name} {found}".rstrip(), x, y - 3, "name marked" if found else "name")
        yield _text(_does(name, state), x, y + 14, "small")


def _strips(mission: Mission, marks: Marks) -> Iterator[list[str]]:
    """Yield what stands below the chart."""
    if marks.lines:
        yield ["Problems, marked in red:", *(line for it in marks.lines for line in _listed(it))]
    if mission.failsafes:
        failsafes = [line for each in mission.failsafes for line in _listed(failsafe_text(each))]
        yield ["Failsafes, in every flying state, the first that holds:", *failsafes]


def _listed(line: str) -> list[str]:
    return wrap(line, LIST_WIDTH, subsequent_indent="    ", break_on_hyphens=False)


def _strip_width(lines: Sequence[str]) -> float:
    return max(_width(line, 6.4) + 24 for line in lines)


def _strip_height(lines: Sequence[str]) -> float:
    return LINE * len(lines) + 16


def _stacked(strips: Sequence[Sequence[str]], y: float, width: float) -> Iterator[str]:
    for lines in strips:
        height = _strip_height(lines)
        yield (
            f'<rect class="strip" x="{MARGIN}" y="{y:.1f}" width="{width:.1f}" '
            f'height="{height:.1f}" rx="8"/>'
        )
        for at, line in enumerate(lines):
            indent = 12 + 16 * line.startswith(" ")
            top = y + 20 + LINE * at
            text = escape(line.strip())
            yield f'<text class="small" x="{MARGIN + indent}" y="{top:.1f}">{text}</text>'
        y += height + 14


def _rectangle(place: Rectangle, style: str, radius: int, more: str = "") -> str:
    x, y, box = place
    return (
        f'<rect class="{style}" x="{x - box.width / 2:.1f}" y="{y - box.height / 2:.1f}" '
        f'width="{box.width:.1f}" height="{box.height:.1f}" rx="{radius}"{more}/>'
    )


def _text(line: str, x: float, y: float, style: str) -> str:
    return (
        f'<text class="{style}" x="{x:.1f}" y="{y:.1f}" text-anchor="middle">{escape(line)}</text>'
    )
