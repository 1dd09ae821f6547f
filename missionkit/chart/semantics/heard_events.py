"""Which transitions of a configuration an event concerns: worked out once for each name."""

from __future__ import annotations

from collections.abc import Iterable

from missionkit.chart.semantics.actions_and_events import matches
from missionkit.chart.semantics.compiled_chart import Configuration, Hearing
from missionkit.chart.semantics.configuration import lead

MOST_EVENTS = 64  # names remembered in each configuration


def hearing(here: Configuration, event: str) -> Hearing:
    """Return the transitions that wait for an event, in the order in which they are tried."""
    known = here.hears.get(event)
    if known is None:
        if len(here.hears) >= MOST_EVENTS:
            here.hears.clear()
        ways = [way for ways in here.heard for way in ways]
        found = [lead(way) for way in ways if matches(way.transition.events, event)]
        unguarded = any(way.ask is None for way, *_ in found)
        known = here.hears[event] = tuple(found), unguarded
    return known


def heard(here: Configuration, events: Iterable[str]) -> bool:
    """Say whether a transition waits for one of some events."""
    return any(hearing(here, event)[0] for event in events)


def leads_on(here: Configuration, events: Iterable[str]) -> bool:
    """Say whether one of some events is enough for a transition where no guard holds."""
    for event in events:  # noqa: SIM110 - a generator takes twice as long
        if hearing(here, event)[1]:
            return True
    return False
