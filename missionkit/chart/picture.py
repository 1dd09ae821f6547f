"""A mission as an SVG picture, drawn without other programs."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from html import escape
from itertools import pairwise

from missionkit.chart.diagram import colour, failsafe_text, state_text, transition_text
from missionkit.chart.layout import Box, Layout, Link, Point, layout
from missionkit.chart.model import Mission, State

MARGIN = 24.0
TOP = 92.0  # title and the initial dot
LINE = 15.0
LABEL_WIDTH = 26  # characters
_STYLE = (
    "text{font-family:Helvetica,Arial,'DejaVu Sans',sans-serif;fill:#1f2937}"
    ".title{font-size:19px;font-weight:bold}.name{font-size:15px;font-weight:bold}"
    ".small{font-size:12px}.box{stroke:#4b5563;stroke-width:1.4}"
    ".arrow{fill:none;stroke:#4b5563;stroke-width:1.4}.strip{fill:#fdf2f2;stroke:#d08a8a}"
    ".label{fill:#fff;fill-opacity:.92}"
)
_ARROW = (
    '<marker id="arrow" viewBox="0 0 10 10" refX="9.5" refY="5" markerWidth="8" markerHeight="8" '
    'orient="auto"><path d="M0 0L10 5L0 10z" fill="#4b5563"/></marker>'
)


def svg(mission: Mission) -> str:
    """Return the mission as an SVG document: states coloured by kind, guards on the arrows."""
    failsafes = [failsafe_text(each) for each in mission.failsafes]
    boxes = [_state_box(name, state) for name, state, _ in mission.walk()]
    placed, labels = _placed(mission, boxes)
    initial = list(mission.by_name()).index(mission.initial.to[0])
    width = max([placed.width, 560.0, *(_width(line, 6.4) + 24 for line in failsafes)])
    strip_at = TOP + placed.height + 30
    height = strip_at + (LINE * (len(failsafes) + 1) + 24 if failsafes else 0) + MARGIN
    size = f"{width + 2 * MARGIN:.0f}", f"{height:.0f}"
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]}" height="{size[1]}" '
            f'viewBox="0 0 {size[0]} {size[1]}">',
            f"<style>{_STYLE}</style><defs>{_ARROW}</defs>",
            '<rect width="100%" height="100%" fill="#fff"/>',
            *_title(mission),
            f'<g transform="translate({MARGIN + (width - placed.width) / 2:.1f} {TOP:.1f})">',
            *_initial_dot(placed.states[initial], boxes[initial]),
            *_arrows(placed),
            *_labels(placed, labels),
            *_states(mission, placed, boxes),
            "</g>",
            *_strip(failsafes, strip_at, width),
            "</svg>\n",
        ]
    )


def _placed(mission: Mission, boxes: Sequence[Box]) -> tuple[Layout, list[list[str]]]:
    """Return the layout, and the lines of each transition's label."""
    numbers = {name: at for at, name in enumerate(mission.by_name())}
    labels, links = [], []
    for name, label, to in _ways(mission):
        labels.append(_wrapped(label))
        links.append(Link(numbers[name], numbers[to], _size(labels[-1])))
    return layout(boxes, links, numbers[mission.initial.to[0]]), labels


def _ways(mission: Mission) -> Iterator[tuple[str, str, str]]:
    """Yield source, label and target of every arrow."""
    for name, state, _ in mission.walk():
        for each in state.transitions:
            for to in each.targets or (name,):
                yield name, transition_text(each), to
        begins = [to for start in (state.initial, state.default) if start for to in start.to]
        together = list(state.states) if state.parallel else []
        for to in begins or together:
            yield name, "together" if together and not begins else "begins in", to


def _wrapped(label: str) -> list[str]:
    return textwrap.wrap(label, LABEL_WIDTH, break_on_hyphens=False)


def _width(line: str, character: float) -> float:
    return character * len(line)


def _size(lines: Sequence[str]) -> Box:
    return Box(max((_width(line, 6.6) for line in lines), default=0) + 8, LINE * len(lines) + 4)


def _state_box(name: str, state: State) -> Box:
    return Box(max(96.0, _width(name, 9) + 28, _width(_does(name, state), 6.6) + 24), 48.0)


def _does(name: str, state: State) -> str:
    return state_text(state) if name == state.kind else f"{state.kind}: {state_text(state)}"


def _title(mission: Mission) -> Iterator[str]:
    yield f'<text class="title" x="{MARGIN}" y="32">{escape(mission.name)}</text>'
    summary = textwrap.shorten(mission.summary, 90, placeholder=" …")
    yield f'<text class="small" x="{MARGIN}" y="50">{escape(summary)}</text>'


def _initial_dot(centre: Point, box: Box) -> Iterator[str]:
    x, top = centre[0], centre[1] - box.height / 2
    yield f'<circle cx="{x:.1f}" cy="{top - 26:.1f}" r="6" fill="#1f2937"/>'
    yield _arrow(f"M{x:.1f} {top - 20:.1f}L{x:.1f} {top:.1f}")


def _arrows(placed: Layout) -> Iterator[str]:
    for route in placed.routes:
        yield _arrow(_curve(route))


def _arrow(path: str) -> str:
    return f'<path class="arrow" d="{path}" marker-end="url(#arrow)"/>'


def _curve(points: Sequence[Point]) -> str:
    """Return a smooth path that leaves and meets every layer vertically."""
    path = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
    for (x, y), (u, v) in pairwise(points):
        middle = (y + v) / 2
        path += f"C{x:.1f} {middle:.1f} {u:.1f} {middle:.1f} {u:.1f} {v:.1f}"
    return path


def _labels(placed: Layout, labels: Sequence[Sequence[str]]) -> Iterator[str]:
    for (x, y), lines in zip(placed.labels, labels, strict=True):
        box = _size(lines)
        yield (
            f'<rect class="label" x="{x - box.width / 2:.1f}" y="{y - box.height / 2:.1f}" '
            f'width="{box.width:.1f}" height="{box.height:.1f}" rx="3"/>'
        )
        for at, line in enumerate(lines):
            yield _text(line, x, y + LINE * (at - (len(lines) - 1) / 2) + 4, "small")


def _states(mission: Mission, placed: Layout, boxes: Sequence[Box]) -> Iterator[str]:
    for (name, state, _), (x, y), box in zip(mission.walk(), placed.states, boxes, strict=True):
        yield (
            f'<rect class="box" x="{x - box.width / 2:.1f}" y="{y - box.height / 2:.1f}" '
            f'width="{box.width:.1f}" height="{box.height:.1f}" rx="11" fill="{colour(state)}"/>'
        )
        yield _text(name, x, y - 3, "name")
        yield _text(_does(name, state), x, y + 14, "small")


def _strip(failsafes: Sequence[str], y: float, width: float) -> Iterator[str]:
    if not failsafes:
        return
    height = LINE * (len(failsafes) + 1) + 16
    yield (
        f'<rect class="strip" x="{MARGIN}" y="{y:.1f}" width="{width:.1f}" '
        f'height="{height:.1f}" rx="8"/>'
    )
    lines = ["Failsafes, in every flying state, the first that holds:", *failsafes]
    for at, line in enumerate(lines):
        top = y + 20 + LINE * at
        yield f'<text class="small" x="{MARGIN + 12}" y="{top:.1f}">{escape(line)}</text>'


def _text(line: str, x: float, y: float, style: str) -> str:
    return (
        f'<text class="{style}" x="{x:.1f}" y="{y:.1f}" text-anchor="middle">{escape(line)}</text>'
    )
