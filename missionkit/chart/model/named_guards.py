"""Guards that are defined by other guards: none may wait for itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter

from missionkit.chart.model.guard_expressions import Expression, names_in
from missionkit.errors import Problem

MAX_GUARD_DEPTH = 64
MAX_CIRCLES = 10


def problems_of(guards: Mapping[str, Expression]) -> Iterator[Problem]:
    """Yield a problem for each circle among named guards, and for one that is too deep."""
    needs = {name: {named.name for named in names_in(each)} for name, each in guards.items()}
    for _ in range(MAX_CIRCLES):
        try:
            order = list(TopologicalSorter(needs).static_order())
        except CycleError as error:
            circle: list[str] = list(reversed(error.args[1]))
            yield _circle(guards, circle)
            needs[circle[0]] = set()
        else:
            yield from _too_deep(guards, needs, order)
            return


def _circle(guards: Mapping[str, Expression], circle: list[str]) -> Problem:
    place = next(named.place for named in names_in(guards[circle[0]]) if named.name == circle[1])
    return Problem(place, f"guard {circle[0]!r} refers to itself: {' -> '.join(circle)}")


def _too_deep(
    guards: Mapping[str, Expression], needs: Mapping[str, set[str]], order: list[str]
) -> Iterator[Problem]:
    depth: dict[str, int] = {}
    for name in order:
        depth[name] = 1 + max((depth[needed] for needed in needs.get(name, ())), default=0)
        if depth[name] > MAX_GUARD_DEPTH:
            place = guards[name].place
            yield Problem(
                place, f"guard {name!r} is defined through more than {MAX_GUARD_DEPTH} others"
            )
            return
