"""How often each state was entered and each transition taken, and what no flight has shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from missionkit.campaigns.flown_chart import Charted
from missionkit.campaigns.run_row import Row
from missionkit.campaigns.visit_log import parts

FAILSAFE_PREFIX = "failsafe "  # begins the reason of its transitions


class ChartCoverage(NamedTuple):
    """Counts over the flights of one variant; runs that gave no flight are left out."""

    flights: int
    entries: Counter[str]  # of each state
    ways: Counter[str]  # of each transition, as rows call it
    passed: Counter[str]  # flights that were in a state
    outcomes: Mapping[str, Counter[str]]  # of those flights
    seconds: Mapping[str, float]  # in each state
    ends: Counter[tuple[str, str]]  # state that commanded last, outcome


class Unflown(NamedTuple):
    """A part of the chart that no flight has reached."""

    what: str  # state, transition, failsafe
    name: str
    chances: int | None = None  # visits to its state, flights for a failsafe


def coverage(rows: Iterable[Row]) -> ChartCoverage:
    """Count the flights of some rows."""
    flights = [row for row in rows if row.flew and row.visits]
    entries, ways, passed = Counter[str](), Counter[str](), Counter[str]()
    outcomes: dict[str, Counter[str]] = {}
    seconds: dict[str, float] = {}
    for row in flights:
        entries.update(row.entries)
        ways.update(row.ways)
        passed.update(row.entries.keys())
        for state in row.entries:
            outcomes.setdefault(state, Counter())[row.outcome] += 1
            seconds[state] = seconds.get(state, 0.0) + row.times.get(state, 0.0)
    ends = Counter((row.visits[-1][0], str(row.outcome)) for row in flights)
    return ChartCoverage(len(flights), entries, ways, passed, outcomes, seconds, ends)


def countable(rows: Sequence[Row]) -> bool:
    """Say whether the rows tell transitions apart: those of older campaigns do not."""
    return all(row.entries for row in rows if row.flew and row.visits)


def unflown(charted: Charted, counts: ChartCoverage) -> Iterator[Unflown]:
    """Yield states never reached, transitions and failsafes never taken, in document order."""
    for name in charted.names:
        if not counts.entries[name]:
            yield Unflown("state", name)
    for (name, _), called in charted.ways.items():
        if not counts.ways[called]:
            source, to, reason = parts(called)
            yield Unflown("transition", f"{source} → {to}, {reason}", counts.entries[name])
    taken = failsafes(counts)
    for failsafe in charted.mission.failsafes:
        if not taken[failsafe.name]:
            yield Unflown("failsafe", failsafe.name, counts.flights)


def failsafes(counts: ChartCoverage) -> Counter[str]:
    """Return how often each failsafe was taken."""
    taken = Counter[str]()
    for called, count in counts.ways.items():
        _, _, reason = parts(called)
        if reason.startswith(FAILSAFE_PREFIX):
            taken[reason.removeprefix(FAILSAFE_PREFIX)] += count
    return taken
