"""Circles of transitions that hold together: charts that go to and fro, slowed by the dwell."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from itertools import takewhile

from missionkit.chart.checks.counterexample_text import at
from missionkit.chart.checks.guarded_transitions import (
    AnalysedChart,
    GuardedTransition,
    circle_text,
)
from missionkit.chart.checks.interval_boxes import intersection, remains
from missionkit.chart.model.actions import Assign
from missionkit.errors import Level, Problem
from missionkit.messages.region import Boxes

LONGEST_LOOP = 8  # transitions in a circle
MOST_BOXES_MET = 20_000  # of the search in one mission: pairs of boxes that are met
MOST_ABOVE = 16  # boxes of ways above one that are cut out of its own
Step = tuple[GuardedTransition, Boxes]
Circle = tuple[GuardedTransition, ...]


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield circles that only the dwell slows down."""
    for circle, held in _circles(chart):
        first = circle[0]
        period = sum(way.dwell for way in circle)
        yield Problem(
            first.place,
            f"state {first.source!r}: {at(held)} {circle_text(circle)} hold: the chart loops every "
            f"{period:g} s, as fast as the dwell allows",
            Level.WARNING,
            "oscillation",
            "separate the guards by a gap (hysteresis), or require a time with 'for' or 'after'",
        )


def _after_dwell(way: GuardedTransition) -> Boxes:
    """Return when a transition is ready, by its conditions on the outside world only."""
    model = way.model
    waits = max(model.for_, model.after or 0.0)
    if not (way.eventless and way.written and model.to and model.when is not None and way.dwell):
        return ()
    if waits > way.dwell:
        return ()
    return tuple(
        box for box in way.truth.may if all(quantity.at_entry == "kept" for quantity in box)
    )


def _circles(chart: AnalysedChart) -> Iterator[tuple[Circle, Boxes]]:
    """Yield circles of ways whose regions meet, each way in one at most."""
    ways = [way for each in chart.ways.values() for way in each]
    steps = [(way, region) for way in ways for region in (_after_dwell(way),) if region]
    search = _Search(chart, steps, _trimmed(_followers(chart, steps)))
    reported: set[int] = set()
    for start in search.follows:
        if search.budget <= 0:
            return
        found = None if start in reported else search.shortest(start)
        if found is None:
            continue
        circle, held = found
        reported.update(circle)
        tour = tuple(steps[each][0] for each in circle)
        if held and not _changes_itself(chart, tour, held):
            yield tour, held


class _Search:
    """Looks for circles whose regions meet, shortest first, until its budget is used up."""

    def __init__(
        self, chart: AnalysedChart, steps: Sequence[Step], follows: Mapping[int, Sequence[int]]
    ) -> None:
        self.chart = chart
        self.steps = steps
        self.follows = follows
        self.budget = MOST_BOXES_MET
        self.regions: dict[int, Boxes] = {}

    def region(self, place: int) -> Boxes:
        """Return when a way is ready and none above it in its state goes before."""
        if place not in self.regions:
            way, ready = self.steps[place]
            above = takewhile(lambda one: one is not way, self.chart.ways[way.source])
            before = [
                box for one in above if one.eventless and not one.model.for_ for box in one.surely
            ]
            left = remains(ready, tuple(before[:MOST_ABOVE]))
            self.budget -= 8 * len(before[:MOST_ABOVE])
            self.regions[place] = ready if left is None else left
        return self.regions[place]

    def shortest(self, start: int) -> tuple[tuple[int, ...], Boxes] | None:
        """Return the shortest circle through a way, and where all of it is ready."""
        waiting: deque[tuple[tuple[int, ...], Boxes]] = deque([((start,), self.region(start))])
        while waiting:
            path, held = waiting.popleft()
            for following in self.follows[path[-1]]:
                if self.budget <= 0:
                    return None
                if following == start:
                    return path, held
                if following in path or len(path) >= LONGEST_LOOP:
                    continue
                self.budget -= 1 + len(held) * len(self.region(following))
                both = intersection(held, self.region(following), sure=False)
                if both:
                    waiting.append(((*path, following), both))
        return None


def _followers(chart: AnalysedChart, steps: Sequence[Step]) -> dict[int, list[int]]:
    """Return which steps may come right after which, by their place in the list."""
    of_source: dict[str, list[int]] = {}
    for place, (way, _) in enumerate(steps):
        of_source.setdefault(way.source, []).append(place)
    follows: dict[int, list[int]] = {}
    for place, (way, _) in enumerate(steps):
        entered = {
            name for to in way.model.targets for name in chart.tree.entered_from(way.source, to)
        }
        follows[place] = [other for name in sorted(entered) for other in of_source.get(name, ())]
    return follows


def _trimmed(follows: dict[int, list[int]]) -> dict[int, list[int]]:
    """Return only what may lie on a circle: something comes after it, and something before."""
    before: dict[int, list[int]] = {place: [] for place in follows}
    for place, others in follows.items():
        for other in others:
            before[other].append(place)
    gone = _dead_ends(before, follows) | _dead_ends(follows, before)
    return {
        place: [other for other in others if other not in gone]
        for place, others in follows.items()
        if place not in gone
    }


def _dead_ends(before: dict[int, list[int]], after: dict[int, list[int]]) -> set[int]:
    """Return what leads nowhere but to dead ends."""
    left = {place: len(others) for place, others in after.items()}
    waiting = [place for place, count in left.items() if not count]
    gone: set[int] = set()
    while waiting:
        place = waiting.pop()
        gone.add(place)
        for other in before[place]:
            left[other] -= 1
            if not left[other]:
                waiting.append(other)
    return gone


def _changes_itself(chart: AnalysedChart, circle: Circle, held: Boxes) -> bool:
    """Say whether the circle assigns a variable that its own guards read: it may come to rest."""
    read = {quantity.name for box in held for quantity in box}
    read |= {quantity.name for way in circle for box in way.may for quantity in box}
    states = chart.tree.states
    acts = [act for way in circle for act in way.model.do]
    for way in circle:
        names = {way.source, *(name for to in way.model.targets for name in chart.tree.entered(to))}
        acts += [act for name in sorted(names) for act in states[name].state.entry]
        acts += states[way.source].state.exit
    return any(isinstance(act, Assign) and act.variable in read for act in acts)
