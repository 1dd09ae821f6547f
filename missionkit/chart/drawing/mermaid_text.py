"""A mission as a diagram: labels in words, and Mermaid text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from missionkit.chart.drawing.chart_overlay import NO_NOTE, NO_OVERLAY, Overlay
from missionkit.chart.drawing.problem_marks import UNMARKED, Marks, numbered
from missionkit.chart.model.guard_expressions import text
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_definitions import Failsafe, Start, State, Transition
from missionkit.chart.prose.requirement_text import requirement_text

KIND_COLOURS = {
    "idle": "#e5e7eb",
    "gps": "#cfe3fb",
    "visual": "#d3f0d8",
    "search": "#fdeec2",
    "task": "#e6d8f8",
    "return": "#cdeef2",
    "land": "#f5dcc9",
    "hover": "#fbd5d5",
}
OTHER_COLOUR = "#f1f1f1"
LINE_INDENT = "    "


def transition_text(transition: Transition) -> str:
    """Say when a transition is taken: "not converged for 2 s", "after 30 s"."""
    parts = [f"on {' or '.join(transition.event)}"] if transition.event else []
    if transition.when is not None:
        parts.append(text(transition.when) + _lasting(transition.for_))
    if transition.after is not None:
        parts.append(f"after {transition.after:g} s")
    return " and ".join(parts)


def failsafe_text(failsafe: Failsafe) -> str:
    """Say when a failsafe is taken and where it leads."""
    unknown = "" if failsafe.unknown == "take" else ", not when unknown"
    label_text = f"{text(failsafe.when)}{_lasting(failsafe.for_)}{unknown}"
    return f"{failsafe.name}: {label_text} → {failsafe.to}"


def state_text(state: State) -> str:
    """Say what a state does: "go to trunk"."""
    if state.behavior is None:
        return shape_text(state)
    words = state.behavior.kind.replace("_", " ")
    target = getattr(state.behavior.plugin, "target", None)
    return f"{words} {target}" if isinstance(target, str) else words


def shape_text(state: State) -> str:
    """Say what a state without a behaviour is for."""
    if state.history is not None:
        return f"{state.history} history"
    if state.final:
        return "final"
    if state.states:
        count = "1 state" if len(state.states) == 1 else f"{len(state.states)} states"
        return f"{count} {'together' if state.parallel else 'inside'}"
    return "waits"


def colour(state: State) -> str:
    """Return the colour of a state's kind."""
    return KIND_COLOURS.get(state.kind, OTHER_COLOUR)


def mermaid(mission: Mission, marks: Marks = UNMARKED, overlay: Overlay = NO_OVERLAY) -> str:
    """Return the mission as a Mermaid state diagram; what is marked has numbers and a red border.

    Mermaid cannot colour, dash or widen the arrows of a state diagram: notes stand in words only.

    Args:
        mission: elaborated, so that its default failsafes are drawn.
        marks: numbers of the problems found, by state and transition.
        overlay: what a campaign flew, as notes beside states and transitions.
    """
    ids = _ids(mission.by_name())
    first = ids[mission.initial.to[0]]
    lines = ["stateDiagram-v2", *_starts(mission.initial, ids, LINE_INDENT)]
    lines += _drawn(mission.states, _Marked(ids, marks, overlay), LINE_INDENT)
    lines += _moves(overlay, ids)
    failsafes = [
        _with(failsafe_text(each), overlay.failsafes.get(each.name, NO_NOTE).lines)
        for each in mission.failsafes
    ]
    lines += _note(f"left of {first}", "in every flying state:", failsafes)
    required = list(map(requirement_text, mission.requirements))
    lines += _note(f"left of {first}", "requirements:", required)
    lines += _note(f"right of {first}", "problems:", marks.lines)
    for name, state, _ in mission.walk():
        border = "#c81e1e,stroke-width:3px" if name in marks.states else "#555"
        lines.append(
            f"{LINE_INDENT}style {ids[name]} fill:{colour(state)},stroke:{border},color:#111"
        )
    return "\n".join(lines) + "\n"


class _Marked(NamedTuple):
    ids: Mapping[str, str]
    marks: Marks
    overlay: Overlay


def _with(label_text: str, notes: Iterable[str]) -> str:
    return "; ".join(filter(None, (label_text, *notes)))


def _moves(overlay: Overlay, ids: Mapping[str, str]) -> Iterator[str]:
    for move in overlay.moves:
        to = "[*]" if move.ends else ids[move.to]
        label_text = _escaped(_with(move.to if move.ends else move.text, move.note.lines))
        yield f"{LINE_INDENT}{ids[move.source]} --> {to} : {label_text}"


def _note(where: str, heading: str, lines: Iterable[str]) -> Iterator[str]:
    label_text = [_escaped(" ".join(line.split())) for line in lines]
    if label_text:
        yield f"{LINE_INDENT}note {where}"
        yield from (f"{LINE_INDENT}{LINE_INDENT}{line}" for line in (heading, *label_text))
        yield f"{LINE_INDENT}end note"


def _starts(start: Start | None, ids: Mapping[str, str], margin: str) -> Iterator[str]:
    for name in () if start is None else start.to:
        yield f"{margin}[*] --> {ids[name]}"


def _drawn(states: Mapping[str, State], marked: _Marked, margin: str) -> Iterator[str]:
    ids, marks, overlay = marked
    for name, state in states.items():
        found, noted = numbered(marks.states.get(name, ())), overlay.states.get(name, NO_NOTE).lines
        label_text = f"{name} {found}".rstrip()
        label = (
            _escaped(_with(label_text, noted)) if state.states else label_text
        )  # it has no room below
        yield f'{margin}state "{label}" as {ids[name]}'
        if state.states:
            yield f"{margin}state {ids[name]} {{"
            yield from _starts(state.initial, ids, margin + LINE_INDENT)
            yield from _regions(state, marked, margin + LINE_INDENT)
            yield f"{margin}}}"
        else:
            yield f"{margin}{ids[name]} : {_escaped(f'{state.kind}, {state_text(state)}')}"
            yield from (f"{margin}{ids[name]} : {_escaped(line)}" for line in noted)
        for number, transition in enumerate(state.transitions):
            found = numbered(marks.ways.get((name, number), ()))
            label_text = f"{found} {transition_text(transition)}".strip()
            label = _escaped(_with(label_text, overlay.ways.get((name, number), NO_NOTE).lines))
            for to in transition.targets or (name,):
                yield f"{margin}{ids[name]} --> {ids[to]} : {label}"


def _regions(state: State, marked: _Marked, margin: str) -> Iterator[str]:
    if not state.parallel:
        yield from _drawn(state.states, marked, margin)
        return
    for at, (name, region) in enumerate(state.states.items()):
        if at:
            yield f"{margin}--"
        yield from _drawn({name: region}, marked, margin)


def _ids(names: Iterable[str]) -> dict[str, str]:
    """Return an identifier for each state: Mermaid has words of its own and allows no hyphen."""
    return {name: f"s{at}_{re.sub(r'[-/]', '_', name)}" for at, name in enumerate(names)}


def _escaped(label: str) -> str:
    return "".join(f"#{ord(c)};" if c in '#;:"<>' else c for c in label)


def _lasting(seconds: float) -> str:
    return f" for {seconds:g} s" if seconds else ""
