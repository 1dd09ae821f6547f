"""A mission as an SVG picture, drawn without other programs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from textwrap import shorten, wrap
from typing import NamedTuple

from missionkit.chart.drawing import svg_shapes
from missionkit.chart.drawing.chart_overlay import (
    NO_NOTE,
    NO_OVERLAY,
    Overlay,
    OverlayNote,
)
from missionkit.chart.drawing.layered_layout import LayoutBox
from missionkit.chart.drawing.mermaid_text import (
    colour,
    failsafe_text,
    state_text,
    transition_text,
)
from missionkit.chart.drawing.nested_layout import (
    Arrow,
    Drawing,
    Rectangle,
    nested,
)
from missionkit.chart.drawing.problem_marks import UNMARKED, Marks, Way, numbered
from missionkit.chart.drawing.svg_shapes import LINE, PICTURE_MARGIN
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_definitions import State
from missionkit.chart.prose.requirement_text import requirement_text

TITLE_HEIGHT = 66.0  # title
LABEL_WIDTH = 26  # characters
HEADING_HEIGHT = 48.0  # px for name and behaviour
END_PREFIX = "end:"  # before the name of an end: no state is called so


class Shown(NamedTuple):
    """A mission and what is drawn besides."""

    mission: Mission
    marks: Marks = UNMARKED
    overlay: Overlay = NO_OVERLAY
    ids: Mapping[Way, str] | None = None  # of the transitions, where a program shows the picture

    def grouped(self, what: str, name: str, shapes: Iterable[str]) -> Iterator[str]:
        """Yield shapes, in a group that names what they are if the picture has ids.

        Args:
            what: state or transition.
            name: of it.
            shapes: SVG.
        """
        if self.ids is None or not name:
            yield from shapes
            return
        yield f'<g data-{what}="{escape(name)}">'
        yield from shapes
        yield "</g>"

    def note(self, name: str) -> OverlayNote:
        """Return what stands at a state."""
        return self.overlay.states.get(name, NO_NOTE)


class LabelledArrow(NamedTuple):
    """An arrow: its place, the words on it, what is noted below them, how it looks."""

    arrow: Arrow
    lines: Sequence[str] = ()
    noted: Sequence[str] = ()
    style: str = ""
    weight: float = 0.0
    id: str = ""  # of the transition


def svg(
    mission: Mission,
    marks: Marks = UNMARKED,
    overlay: Overlay = NO_OVERLAY,
    key: str = "",
    ids: Mapping[Way, str] | None = None,
) -> str:
    """Return the mission as an SVG document: states coloured by kind, guards on the arrows.

    Args:
        mission: with its default failsafes written out.
        marks: the states and transitions to be drawn in red, and why.
        overlay: notes, weights, and what the chart does not declare.
        key: tells this picture from others on the same page.
        ids: of the transitions; with them, states and transitions are groups with `data-state`
            and `data-transition`.
    """
    shown = Shown(mission, marks, overlay, ids)
    ways = list(_ways(shown))
    parents = {name: parent for name, _, parent in mission.walk()}
    sizes = {name: _size_of(name, state, shown) for name, state, _ in mission.walk()}
    for end in overlay.ends:
        parents[END_PREFIX + end.name] = None
        sizes[END_PREFIX + end.name] = _boxed(end.name, end.lines)
    drawn = nested(sizes, parents, [way.arrow for way in ways])
    strips = list(_strips(shown))
    wide = max([drawn.width, 560.0, *(svg_shapes.strip_width(lines) for _, lines in strips)])
    below = list(svg_shapes.stacked(strips, TITLE_HEIGHT + drawn.height + 30, wide))
    height = (
        TITLE_HEIGHT
        + drawn.height
        + 30
        + sum(svg_shapes.strip_height(it) for _, it in strips)
        + PICTURE_MARGIN
    )
    size = f"{wide + 2 * PICTURE_MARGIN:.0f}", f"{height:.0f}"
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" class="chart" role="img" '
            f'aria-label="{escape(f"the chart of {mission.name}")}" width="{size[0]}" '
            f'height="{size[1]}" viewBox="0 0 {size[0]} {size[1]}">',
            svg_shapes.preamble(key),
            f'<rect width="{size[0]}" height="{size[1]}" fill="#fff"/>',
            *_title(mission),
            f'<g transform="translate({PICTURE_MARGIN + (wide - drawn.width) / 2:.1f} '
            f'{TITLE_HEIGHT:.1f})">',
            *_groups(shown, drawn),
            *(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="#1f2937"/>' for x, y in drawn.dots),
            *_arrows(shown, drawn, ways, key),
            *_labels(shown, drawn, ways),
            *_states(shown, drawn),
            *_ends(overlay, drawn),
            "</g>",
            *below,
            "</svg>\n",
        ]
    )


def _ways(shown: Shown) -> Iterator[LabelledArrow]:
    """Yield every arrow."""
    mission, marks, overlay, ids = shown
    yield from (LabelledArrow(Arrow(None, to, _size([]))) for to in mission.initial.to)
    for name, state, _ in mission.walk():
        for number, each in enumerate(state.transitions):
            found = numbered(marks.ways.get((name, number), ()))
            lines = _wrapped(f"{found} {transition_text(each)}".strip())
            note = overlay.ways.get((name, number), NO_NOTE)
            style = "marked" if found else "pale" if note.pale else ""
            for to in each.targets or (name,):
                arrow = Arrow(name, to, _size([*lines, *note.lines]))
                id_ = (ids or {}).get((name, number), "")
                yield LabelledArrow(arrow, lines, note.lines, style, note.weight, id_)
        if state.initial is not None:
            yield from (LabelledArrow(Arrow(None, to, _size([]), name)) for to in state.initial.to)
        if state.default is not None:
            lines = ["the first time"]
            yield from (
                LabelledArrow(Arrow(name, to, _size(lines)), lines) for to in state.default.to
            )
    for move in overlay.moves:
        to, style = (END_PREFIX + move.to, "") if move.ends else (move.to, "dashed")
        lines, note = _wrapped(move.text), move.note
        arrow = Arrow(move.source, to, _size([*lines, *note.lines]))
        yield LabelledArrow(arrow, lines, note.lines, style, note.weight)


def _wrapped(label: str) -> list[str]:
    return wrap(label, LABEL_WIDTH, break_on_hyphens=False)


def _size(lines: Sequence[str]) -> LayoutBox:
    if not lines:
        return LayoutBox(8, 0)
    return LayoutBox(max(svg_shapes.width(line, 6.6) for line in lines) + 8, LINE * len(lines) + 4)


def _size_of(name: str, state: State, shown: Shown) -> LayoutBox:
    words = f"{name} {numbered(shown.marks.states.get(name, ()))}".rstrip()
    return _boxed(words, [_does(name, state), *shown.note(name).lines])


def _boxed(name: str, lines: Sequence[str]) -> LayoutBox:
    wide = max(svg_shapes.width(line, 6.6) + 24 for line in lines)
    height = HEADING_HEIGHT + LINE * (len(lines) - 1)
    return LayoutBox(max(96.0, svg_shapes.width(name, 9) + 28, wide), height)


def _does(name: str, state: State) -> str:
    if state.kind == "logic":
        return state_text(state)
    return state_text(state) if name == state.kind else f"{state.kind}: {state_text(state)}"


def _title(mission: Mission) -> Iterator[str]:
    yield f'<text class="title" x="{PICTURE_MARGIN}" y="32">{escape(mission.name)}</text>'
    summary = shorten(mission.summary, 90, placeholder=" …")
    yield f'<text class="small" x="{PICTURE_MARGIN}" y="50">{escape(summary)}</text>'


def _arrows(shown: Shown, drawn: Drawing, ways: Sequence[LabelledArrow], key: str) -> Iterator[str]:
    for route, way in zip(drawn.routes, ways, strict=True):
        path = svg_shapes.arrow(route, f"arrow {way.style}".rstrip(), key, way.weight)
        yield from shown.grouped("transition", way.id, [path])


def _labels(shown: Shown, drawn: Drawing, ways: Sequence[LabelledArrow]) -> Iterator[str]:
    for (x, y), way in zip(drawn.labels, ways, strict=True):
        yield from shown.grouped("transition", way.id, _label(x, y, way))


def _label(x: float, y: float, way: LabelledArrow) -> Iterator[str]:
    _, lines, noted, style, *_ = way
    words = [*((it, "small") for it in lines), *((it, "note") for it in noted)]
    if words:
        yield svg_shapes.rectangle(Rectangle(x, y, _size([*lines, *noted])), "label", 3)
    for at, (line, size) in enumerate(words):
        top = y + LINE * (at - (len(words) - 1) / 2) + 4
        yield svg_shapes.text(line, x, top, f"{size} {style}".rstrip())


def _groups(shown: Shown, drawn: Drawing) -> Iterator[str]:
    """Yield the borders of states with states inside, the outermost first."""
    mission = shown.mission
    regions = {
        region for _, state, _ in mission.walk() if state.parallel for region in state.states
    }
    for name, state, _ in mission.walk():
        if state.states:
            style = " around region" if name in regions else " around"
            border = _border(name, state, shown, drawn.states[name], style)
            yield from shown.grouped("state", name, [border])


def _border(name: str, state: State, shown: Shown, place: Rectangle, style: str = "") -> str:
    if name in shown.marks.states:
        style += " marked"
    if shown.note(name).pale:
        style += " pale"
    return svg_shapes.rectangle(place, f"box{style}", 11, f' fill="{colour(state)}"')


def _states(shown: Shown, drawn: Drawing) -> Iterator[str]:
    """Yield the names of all states, and the borders of those without states inside."""
    for name, state, _ in shown.mission.walk():
        yield from shown.grouped("state", name, _state(name, state, shown, drawn.states[name]))


def _state(name: str, state: State, shown: Shown, place: Rectangle) -> Iterator[str]:
    x, y, box = place
    heading = _size_of(name, state, shown)
    if not state.states:
        yield _border(name, state, shown, place)
    else:
        x += (heading.width - box.width) / 2
        y += heading.height / 2 + 2 - box.height / 2
        back = LayoutBox(heading.width - 20, heading.height - 14)
        yield svg_shapes.rectangle(Rectangle(x, y - 1, back), "label", 3)
    found = numbered(shown.marks.states.get(name, ()))
    tone = " marked" if found else " pale" if shown.note(name).pale else ""
    top = y - heading.height / 2
    yield svg_shapes.text(f"{name} {found}".rstrip(), x, top + 21, f"name{tone}")
    yield svg_shapes.text(_does(name, state), x, top + 38, "small")
    yield from _noted(shown.note(name).lines, x, top + 38 + LINE)


def _ends(overlay: Overlay, drawn: Drawing) -> Iterator[str]:
    for name, lines, tone in overlay.ends:
        place = drawn.states[END_PREFIX + name]
        yield svg_shapes.rectangle(place, f"box {tone}", 22)
        top = place.y - place.box.height / 2
        yield svg_shapes.text(name, place.x, top + 21, "name")
        yield from _noted(lines, place.x, top + 38)


def _noted(lines: Sequence[str], x: float, y: float) -> Iterator[str]:
    for at, line in enumerate(lines):
        yield svg_shapes.text(line, x, y + LINE * at, "small")


def _strips(shown: Shown) -> Iterator[tuple[str, list[str]]]:
    """Yield what stands below the chart."""
    mission, marks, overlay, _ = shown
    if marks.lines:
        problems = [line for it in marks.lines for line in svg_shapes.listed(it)]
        yield "strip", ["Problems, marked in red:", *problems]
    if overlay.lines:
        yield "strip notes", [line for it in overlay.lines for line in svg_shapes.listed(it)]
    if mission.failsafes:
        strip_lines = []
        for each in mission.failsafes:
            noted = overlay.failsafes.get(each.name, NO_NOTE).lines
            strip_lines += svg_shapes.listed(": ".join([failsafe_text(each), *noted]))
        yield "strip", ["Failsafes, in every flying state, the first that holds:", *strip_lines]
    if mission.requirements:
        sentences = map(requirement_text, mission.requirements)
        required = [line for it in sentences for line in svg_shapes.listed(it)]
        yield "strip", ["Requirements:", *required]
