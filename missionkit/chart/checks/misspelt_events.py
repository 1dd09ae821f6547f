"""Events that nothing raises, although the chart raises one with nearly that name."""

from __future__ import annotations

import difflib
from collections.abc import Iterator

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model.actions import Raise
from missionkit.chart.model.nearest_state import OWN_EVENTS
from missionkit.chart.model.traversal import actions_of
from missionkit.chart.semantics.actions_and_events import matches
from missionkit.errors import Level, Problem

ALIKE = 0.75  # of two names, as difflib measures it


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield a warning for each event that is waited for where one that is raised is meant.

    An operator or the vehicle may send any event, so that only a raised one that no transition
    hears makes a name suspicious.
    """
    ways = [way for each in chart.ways.values() for way in each if way.written and way.model.event]
    heard = tuple(word.removesuffix(".*") for way in ways for word in way.model.event or ())
    acts = actions_of(chart.mission)
    raised = {str(act.event) for act in acts if isinstance(act, Raise)}
    unheard = sorted(event for event in raised if not matches(heard, event))
    for way in ways:
        for word in way.model.event or ():
            if word.startswith(OWN_EVENTS) or any(matches((word,), event) for event in raised):
                continue
            meant = difflib.get_close_matches(word, unheard, n=1, cutoff=ALIKE)
            if meant:
                yield Problem(
                    way.model.place("event"),
                    f"state {way.source!r}: nothing raises the event {word!r}; the chart raises "
                    f"{meant[0]!r}, which no transition hears",
                    Level.WARNING,
                    "event-never-raised",
                    f"event: {meant[0]}",
                )
