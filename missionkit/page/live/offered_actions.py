"""What a pilot at the page may do now."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from missionkit.chart.model.actions import Raise
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.traversal import actions_of
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.configuration import SAFETY, configuration
from missionkit.messages import (
    CONTROL_RESUMED,
    GROUND_TOUCHED,
    MARKER_DUPLICATED,
    MARKER_UPSIDE_DOWN,
    Mode,
    Observation,
    Record,
    is_event,
)

OWN_EVENTS = frozenset((CONTROL_RESUMED, GROUND_TOUCHED, MARKER_DUPLICATED, MARKER_UPSIDE_DOWN))
CHART_EVENTS = ("done.state.", "error.")  # what the chart says to itself


class Offer(NamedTuple):
    """Something that can be done now."""

    action: str
    event: str | None = None
    dangerous: bool = False

    def as_value(self) -> dict[str, object]:
        """Return it for JSON."""
        event = {} if self.event is None else {"event": self.event}
        return {"action": self.action, **event, **({"dangerous": True} if self.dangerous else {})}


def raised_events(mission: Mission) -> frozenset[str]:
    """Return the events that a mission raises itself."""
    return frozenset(str(it.event) for it in actions_of(mission) if isinstance(it, Raise))


def offered(
    chart: Chart, raised: frozenset[str], record: Record, seen: Observation, *, controls: bool
) -> Iterator[Offer]:
    """Yield what a pilot may do now.

    Args:
        chart: that is flown.
        raised: events that the mission raises itself.
        record: of the last tick.
        seen: its observation.
        controls: control can be given back after a pilot's takeover.
    """
    status, here = record.estimate.status, configuration(chart, record.active)
    in_air = status is not None and status.in_air
    if controls and not seen.in_control:
        yield Offer("give_back", dangerous=True)
    if record.paused:
        yield Offer("continue")
    elif record.mode is not Mode.NONE or not in_air:
        yield Offer("hold")
    if in_air and chart.home and here.safety < SAFETY["return"]:
        yield Offer("return")
    if in_air and chart.land and here.safety < SAFETY["land"]:
        yield Offer("land", dangerous=True)
    for event in dict.fromkeys(_events(chart, record.active)):
        if event not in raised | OWN_EVENTS and not event.startswith(CHART_EVENTS):
            yield Offer("event", event)


def _events(chart: Chart, active: tuple[str, ...]) -> Iterator[str]:
    """Yield the events that lead out of the active states."""
    for name in active:
        for transition in chart.states[name].transitions:
            yield from filter(is_event, transition.events)
