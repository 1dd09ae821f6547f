"""Names by which the page knows the transitions of a chart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from missionkit.chart.semantics.compiled_chart import Chart, CompiledState, CompiledTransition
from missionkit.messages import Fired

FAILSAFE, INVARIANT, TRANSITION = "failsafe", "invariant", "transition"


class ChartTransition(NamedTuple):
    """A way from a state to another, or from every state that flies."""

    id: str
    source: str | None  # None: every state that flies
    to: str
    text: str
    guards: tuple[str, ...]
    event: str | None
    kind: str
    hold: float  # s the guards must have held

    def as_value(self, priority: int) -> dict[str, object]:
        """Return it for JSON.

        Args:
            priority: 1 is tried first.
        """
        return {
            "id": self.id,
            "source": self.source,
            "to": self.to,
            "text": self.text,
            "guards": list(self.guards),
            "event": self.event,
            "kind": self.kind,
            "priority": priority,
        }


def transitions(chart: Chart) -> Iterator[ChartTransition]:
    """Yield all transitions in the order of precedence."""
    for failsafe in chart.failsafes:
        yield _transition(failsafe, None, FAILSAFE)
    for each in chart.watch.requirements:
        if each.to is not None:
            yield ChartTransition(
                f"r:{each.name}", None, each.to, each.reason, (each.label,), None, INVARIANT, 0.0
            )
    for state in chart.states.values():
        if state.violated_to is not None and _promises(state):
            text = f"invariant broken for {state.tolerated:g} s"
            guards = (f"I({state.name})",) if state.kind.invariant is not None else ()
            yield ChartTransition(
                f"i:{state.name}", state.name, state.violated_to, text, guards, None, INVARIANT, 0.0
            )
        for one in state.transitions:
            yield _transition(one, state.name, TRANSITION)


def _promises(state: CompiledState) -> bool:
    return state.kind.invariant is not None or state.promise is not None


def _transition(it: CompiledTransition, source: str | None, kind: str) -> ChartTransition:
    to, event = ", ".join(it.to) or source or "", " or ".join(it.events) or None
    return ChartTransition(f"t{it.number}", source, to, it.text, it.reads, event, kind, it.hold)


def way_ids(chart: Chart) -> Mapping[tuple[str, int], str]:
    """Return the id of each transition by its state and its number there."""
    return {
        (state.name, at): f"t{one.number}"
        for state in chart.states.values()
        for at, one in enumerate(state.transitions)
    }


class FiredIds:
    """Finds the id of a transition that was taken."""

    def __init__(self, chart: Chart) -> None:
        self._ids = {
            (it.source or "", it.to, it.text): it.id for it in reversed([*transitions(chart)])
        }
        self._anywhere = {(it.to, it.text): it.id for it in transitions(chart) if it.source is None}

    def of(self, fired: Fired) -> str:
        """Return the id; "" for what no chart declares, such as the operator's landing."""
        own = self._ids.get((fired.source, fired.to, fired.reason))
        return own or self._anywhere.get((fired.to, fired.reason), "")
