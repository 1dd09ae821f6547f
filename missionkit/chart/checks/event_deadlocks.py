"""Events that the chart raises only after what waits for them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from missionkit.chart.checks.guarded_transitions import AnalysedChart, GuardedTransition
from missionkit.chart.checks.reachability import leads_away
from missionkit.chart.model.actions import Act, Raise
from missionkit.chart.model.nearest_state import OWN_EVENTS
from missionkit.chart.semantics.actions_and_events import matches
from missionkit.errors import Level, Problem


class Raised(NamedTuple):
    """Where the chart raises an event."""

    event: str
    where: str
    state: str


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each transition whose event the chart raises, but never before an operator sends it.

    Everything that might happen without events from outside is taken to happen, whatever the
    guards say, so that an event that is missing then is never raised. Only one that another region
    raises is reported: a state that raises again what an operator sent it first is no mistake.
    """
    raised = list(_all_raised(chart))
    if not raised:
        return
    names = frozenset(each.event for each in raised)
    reached, come = _without_outside(chart, names)
    ways = (way for name in chart.ways if name in reached for way in chart.ways[name])
    for way in ways:
        if not way.may or not way.written or _enabled(way, names, come):
            continue
        words = way.model.event or ()
        missing = [each for each in raised if matches(_plain(words), each.event)]
        if not any(_in_another_region(chart, each.state, way.source) for each in missing):
            continue
        yield Problem(
            way.model.place("event"),
            f"state {way.source!r}: the chart raises event {missing[0].event!r} only "
            f"{missing[0].where}, and never gets there unless the event that {way.source!r} waits "
            "for is sent from outside",
            Level.WARNING,
            "event-deadlock",
            f"raise {missing[0].event!r} where it does not depend on {way.source!r}, or lead out "
            "by a timer",
        )


def _without_outside(chart: AnalysedChart, names: frozenset[str]) -> tuple[set[str], set[str]]:
    """Return the states that may be reached and the events that may come without outside help.

    Args:
        chart: analysed.
        names: of the events that the chart raises; any other may come at any time.
    """
    tree = chart.tree
    starts = [*chart.mission.initial.to, *filter(None, map(tree.of_kind, ("return", "land")))]
    reached = {name for to in starts for name in tree.entered(to)}
    come = set(_events(chart.mission.initial.do))
    come.update(event for each in chart.failsafes for event in _events(each.model.do))
    before = (0, 0)
    while before != (len(reached), len(come)):
        before = len(reached), len(come)
        for name in tuple(reached):
            come.update(_events(_blocks(chart, name)))
            ways = [way for way in chart.ways[name] if way.may and _enabled(way, names, come)]
            come.update(event for way in ways for event in _events(way.model.do))
            ahead = [*(to for way in ways for to in way.model.targets), *leads_away(chart, name)]
            reached.update(*map(tree.entered, ahead))
    return reached, come


def _blocks(chart: AnalysedChart, name: str) -> tuple[Act, ...]:
    """Return what a state does on entry and exit, and on entry to the states inside it."""
    state = chart.tree.states[name].state
    begins = [act for each in (state.initial, state.default) if each for act in each.do]
    return (*state.entry, *state.exit, *begins)


def _in_another_region(chart: AnalysedChart, one: str, other: str) -> bool:
    nested = one == other or one in chart.tree.around(other) or other in chart.tree.around(one)
    return not nested and chart.tree.together(one, other)


def _enabled(way: GuardedTransition, names: frozenset[str], come: set[str]) -> bool:
    """Say whether a transition needs no event, or one that has come or comes from outside."""
    words = _plain(way.model.event or ())
    if not words:
        return True
    for word in words:
        own = [name for name in names if matches((word,), name)]
        if not own or word == "*" or word.startswith(OWN_EVENTS) or not come.isdisjoint(own):
            return True
    return False


def _plain(words: Iterable[str]) -> tuple[str, ...]:
    """Return event descriptors as the engine matches them."""
    return tuple(str(word).removesuffix("*").removesuffix(".") or "*" for word in words)


def _events(acts: Sequence[Act]) -> Iterator[str]:
    yield from (str(act.event) for act in acts if isinstance(act, Raise))


def _all_raised(chart: AnalysedChart) -> Iterator[Raised]:
    for name, (_, state, _) in chart.tree.states.items():
        begins = () if state.initial is None else state.initial.do
        blocks: Mapping[str, Sequence[Act]] = {
            f"on entry to {name!r}": (*state.entry, *begins),
            f"on exit from {name!r}": state.exit,
        }
        for where, acts in blocks.items():
            yield from (Raised(event, where, name) for event in _events(acts))
        for way in chart.ways[name]:
            where = f"in {name!r}, on the way of {way.label}"
            yield from (Raised(event, where, name) for event in _events(way.model.do))
