"""Delayed events that nothing hears, and cancellations of events that nothing delays."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model.actions import Cancel, Raise
from missionkit.chart.model.traversal import actions_of
from missionkit.chart.semantics.actions_and_events import matches
from missionkit.errors import Level, Problem, nearest


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield a problem for each delayed event or cancellation without effect."""
    heard = tuple(
        str(event).removesuffix("*").removesuffix(".") or "*"
        for _, state, _ in chart.mission.walk()
        for way in state.transitions
        for event in way.event or ()
    )
    acts = list(actions_of(chart.mission))
    delayed = {act.event for act in acts if isinstance(act, Raise) and act.after is not None}
    for act in acts:
        match act:
            case Raise(event=event, after=float() | str()) if not matches(heard, event):
                message = f"the delayed event {event!r} is heard by no transition"
                remedy, known = "add a transition with that 'event', or remove it", set(heard)
            case Cancel(event=event) if event not in delayed:
                message = f"'cancel': nothing raises {event!r} with a delay"
                remedy, known = "name the event of a {raise: {event: ..., after: ...}}", delayed
            case _:
                continue
        hint = nearest(event, known - {"*"}) if known else ""
        shown = f"{message}; {hint}" if hint else message
        yield Problem(act.place, shown, Level.WARNING, "delayed-event", remedy)
