"""Transitions of parallel regions between which nothing but the order in the file decides."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from missionkit.chart.checks.counterexample_text import at
from missionkit.chart.checks.guarded_transitions import AnalysedChart, GuardedTransition
from missionkit.chart.checks.interval_boxes import intersection
from missionkit.errors import Level, Place, Problem

MOST_PAIRS = 10_000  # pairs in one mission


def overlaps(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield transitions that leave a parallel state for different places and hold together."""
    left = MOST_PAIRS
    reported: set[Place] = set()
    for name, (_, state, _) in chart.tree.states.items():
        if not state.parallel:
            continue
        leaving = _leaving(chart, name)
        for here, there in combinations(leaving.values(), 2):
            for one in here:
                for other in there:
                    left -= 1
                    if left < 0:
                        return
                    if other.place not in reported:
                        found = list(_undecided(name, one, other))
                        reported.update(problem.place for problem in found)
                        yield from found


def _leaving(chart: AnalysedChart, around: str) -> dict[str, list[GuardedTransition]]:
    """Return the ways out of a parallel state by the region they begin in."""
    tree = chart.tree
    found: dict[str, list[GuardedTransition]] = {}
    for source, ways in chart.ways.items():
        path = (source, *tree.around(source))
        if around not in path[1:]:
            continue
        region = path[path.index(around) - 1]
        found.setdefault(region, []).extend(
            way for way in ways if any(around not in tree.around(to) for to in way.model.targets)
        )
    return found


def _undecided(name: str, one: GuardedTransition, other: GuardedTransition) -> Iterator[Problem]:
    if one.model.to == other.model.to or one.model.event != other.model.event:
        return
    both = intersection(one.truth.may, other.truth.may, sure=False)
    if both and one.written and other.written:
        yield Problem(
            other.place,
            f"state {name!r}: {at(both)} both {one.label} in {one.source!r} and {other.label} in "
            f"{other.source!r} hold; their regions have equal rank, so only their order in "
            "the file decides",
            Level.WARNING,
            "overlap",
            f"write both as transitions of {name!r}, the more important first",
        )
