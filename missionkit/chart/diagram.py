"""A mission as a diagram: labels in words, and Mermaid text."""

from __future__ import annotations

from collections.abc import Iterable

from missionkit.chart.expressions import text
from missionkit.chart.model import Failsafe, Mission, State, Transition

COLOURS = {
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


def transition_text(transition: Transition) -> str:
    """Say when a transition is taken: "not converged for 2 s", "after 30 s"."""
    parts = [f"on {transition.event}"] if transition.event else []
    if transition.when is not None:
        parts.append(text(transition.when) + _lasting(transition.for_))
    if transition.after is not None:
        parts.append(f"after {transition.after:g} s")
    return " and ".join(parts)


def failsafe_text(failsafe: Failsafe) -> str:
    """Say when a failsafe is taken and where it leads."""
    unknown = "" if failsafe.unknown == "take" else ", not when unknown"
    said = f"{text(failsafe.when)}{_lasting(failsafe.for_)}{unknown}"
    return f"{failsafe.name}: {said} → {failsafe.to}"


def state_text(state: State) -> str:
    """Say what a state does: "go to trunk"."""
    words = state.behavior.kind.replace("_", " ")
    target = getattr(state.behavior.plugin, "target", None)
    return f"{words} {target}" if isinstance(target, str) else words


def colour(state: State) -> str:
    """Return the colour of a state's kind."""
    return COLOURS.get(state.kind, OTHER_COLOUR)


def mermaid(mission: Mission) -> str:
    """Return the mission as a Mermaid state diagram."""
    ids = _ids(mission.states)
    lines = ["stateDiagram-v2", f"    [*] --> {ids[mission.initial]}"]
    for name, state in mission.states.items():
        lines.append(f'    state "{name}" as {ids[name]}')
        lines.append(f"    {ids[name]} : {_escaped(f'{state.kind}, {state_text(state)}')}")
        for transition in state.transitions:
            label = _escaped(transition_text(transition))
            lines.append(f"    {ids[name]} --> {ids[transition.to]} : {label}")
    if mission.failsafes:
        lines.append(f"    note left of {ids[mission.initial]}")
        lines.append("        in every flying state:")
        lines += [f"        {_escaped(failsafe_text(each))}" for each in mission.failsafes]
        lines.append("    end note")
    for name, state in mission.states.items():
        lines.append(f"    style {ids[name]} fill:{colour(state)},stroke:#555,color:#111")
    return "\n".join(lines) + "\n"


def _ids(names: Iterable[str]) -> dict[str, str]:
    """Return an identifier for each state: Mermaid has words of its own and allows no hyphen."""
    return {name: f"s{at}_{name.replace('-', '_')}" for at, name in enumerate(names)}


def _escaped(label: str) -> str:
    return "".join(f"#{ord(c)};" if c in '#;:"<>' else c for c in label)


def _lasting(seconds: float) -> str:
    return f" for {seconds:g} s" if seconds else ""
