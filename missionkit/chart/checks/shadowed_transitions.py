"""Transitions that can never be taken, or whose order alone decides."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from missionkit.chart.checks.counterexample_text import at, example
from missionkit.chart.checks.guarded_transitions import AnalysedChart, Guarded, GuardedTransition
from missionkit.chart.checks.interval_boxes import covered, intersection
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.semantics.actions_and_events import matches
from missionkit.errors import Level, Problem
from missionkit.guards.state_progress import TIME_IN_STATE

MOST_COMPARED = 60_000  # pairs of transitions in one mission
MOST_EARLIER = 200  # earlier transitions of a state that one is compared with


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield every transition of a state that cannot fire, or fires by its place in the list."""
    left = MOST_COMPARED
    for name, ways in chart.ways.items():
        for at_, way in enumerate(ways):
            if not way.written:
                continue
            if not way.may:
                yield _never(chart, way)
                continue
            if way.model.for_ and way.model.after is not None:
                yield from _idle_timer(way)
            yield from _waits_for_dwell(way)
            before = _before(ways, at_)[-MOST_EARLIER:]
            left -= len(before)
            if left < 0:
                yield _not_compared(way)
                return
            found = _too_late(chart, name, way) or _shadowed(way, before)
            yield from (found,) if found else _overlaps(way, before)


def _before(ways: Sequence[GuardedTransition], at_: int) -> list[GuardedTransition]:
    """Return the ways that go before one: those above it, and for an event all without one."""
    way = ways[at_]
    later = ways[at_ + 1 :] if not way.eventless else ()
    return [*ways[:at_], *(each for each in later if each.eventless)]


def _never(chart: AnalysedChart, way: GuardedTransition) -> Problem:
    guard = way.reason
    return Problem(
        way.model.place("when"),
        f"state {way.source!r}: {guard} can never hold, so the transition never fires: "
        f"{_why(chart, way)}",
        Level.ERROR,
        "never-true",
        "correct the guard, or remove the transition",
    )


def _why(chart: AnalysedChart, way: GuardedTransition) -> str:
    when = way.model.when
    if getattr(when, "kind", "") == "done":
        return "nothing here is ever done"
    return _unsatisfied(chart, when, way.source)


def _unsatisfied(chart: AnalysedChart, when: ex.Expression | None, source: str = "") -> str:
    """Return why a guard never holds."""
    apart = chart.reader.apart(when, source)
    return f"{apart}" if apart else "no combination of values satisfies it"


def _idle_timer(way: GuardedTransition) -> Iterator[Problem]:
    held, after = way.model.for_, way.model.after or 0.0
    if held >= after:
        yield Problem(
            way.model.place("after"),
            f"state {way.source!r}: 'after: {after:g}' has no effect: 'for: {held:g}' counts from "
            f"entry at the earliest, so at {after:g} s the guard cannot have held for "
            f"{held:g} s",
            Level.WARNING,
            "contradictory-timers",
            "remove 'after', or make it longer than 'for'",
        )


def _waits_for_dwell(way: GuardedTransition) -> Iterator[Problem]:
    after = way.model.after
    if after and after < way.dwell:
        yield Problem(
            way.model.place("after"),
            f"state {way.source!r}: 'after: {after:g}' is shorter than the dwell: the transition "
            f"fires at {way.dwell:g} s, not at {after:g} s",
            Level.WARNING,
            "shorter-than-dwell",
            "give the state a shorter 'dwell', or set 'emergency: true'",
        )


def _too_late(chart: AnalysedChart, name: str, way: GuardedTransition) -> Problem | None:
    """Return the problem that something leaves the state before a transition can fire."""
    for other in chart.out_of(name):
        if other.timed and other is not way and other.soonest < way.soonest:
            return Problem(
                way.place,
                f"state {name!r}: {way.label} can never fire: it needs {way.soonest:g} s in the "
                f"state, but {other.label} leaves {_it(name, other)} after {other.soonest:g} s",
                Level.ERROR,
                "contradictory-timers",
                f"make it need less than {other.soonest:g} s, or the other more than "
                f"{way.soonest:g} s",
            )
    return None


def _it(name: str, other: GuardedTransition) -> str:
    return "it" if other.source == name else f"{other.source!r} around it"


def _shadowed(way: GuardedTransition, before: Sequence[GuardedTransition]) -> Problem | None:
    able = [one for one in before if _as_soon(one, way)]
    for one in able:
        if covered(way.may, one.surely):
            return _told_shadowed(way, one)
    at_once = [one for one in able if not one.model.for_]
    if len(at_once) > 1:
        together = tuple(box for one in at_once for box in one.surely)
        if covered(way.may, together):
            return Problem(
                way.place,
                f"state {way.source!r}: {way.label} can never fire: whenever it is ready, one of "
                f"the {len(at_once)} transitions above it is too, for example {at(way.truth.may)}",
                Level.ERROR,
                "shadowed-transition",
                "move it above them, or remove it",
            )
    return None


def _as_soon(one: GuardedTransition, way: GuardedTransition) -> bool:
    """Say whether `one` is taken before `way` wherever the guards of both hold."""
    if one.model.for_ > way.model.for_:
        return False
    if one.model.event is None:
        return True
    return way.model.event is not None and all(
        matches(one.model.event, event) for event in way.model.event
    )


def _told_shadowed(way: GuardedTransition, one: GuardedTransition) -> Problem:
    both = intersection(way.truth.may, one.truth.surely, sure=False)
    shown = example(both or way.truth.may)
    where = f"at {shown} both" if shown else "both always"
    return Problem(
        way.place,
        f"state {way.source!r}: {where} {one.label} and {way.label} hold; the first wins, so "
        "the second can never fire",
        Level.ERROR,
        "shadowed-transition",
        f"move it above line {one.place.line}, or remove it",
    )


def _overlaps(way: GuardedTransition, before: Sequence[GuardedTransition]) -> Iterator[Problem]:
    """Yield a transition that can hold together with an earlier one over the same quantities."""
    if not way.eventless or not way.model.to:
        return
    mine = _asked(way)
    for one in before:
        if not mine or not one.written or not one.model.to or one.model.to == way.model.to:
            continue
        if not one.eventless or _asked(one) != mine:
            continue
        both = intersection(one.truth.may, way.truth.may, sure=False)
        if both and not covered(one.truth.may, way.truth.may):
            yield Problem(
                way.place,
                f"state {way.source!r}: at {example(both)} both {one.label} and {way.label} hold; "
                "only their order in the file decides",
                Level.WARNING,
                "overlap",
                "make the guards mutually exclusive, or the first a special case of the second",
            )
            return


def _asked(way: GuardedTransition) -> frozenset[object]:
    return frozenset(
        quantity for box in way.truth.may for quantity in box if quantity != TIME_IN_STATE
    )


def _not_compared(way: GuardedTransition) -> Problem:
    return Problem(
        way.place,
        f"transitions from here on were not compared with each other: there are more than "
        f"{MOST_COMPARED} pairs",
        Level.WARNING,
        "too-many-to-compare",
        "use fewer transitions in one state",
    )


def failsafes(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield every failsafe that can never act, because of its guard or of one above it."""
    for at_, late in enumerate(chart.failsafes[:MOST_EARLIER]):
        name = late.model.name
        if not late.may:
            yield Problem(
                late.model.place("when"),
                f"failsafe {name!r}: its guard can never hold: "
                f"{_unsatisfied(chart, late.model.when)}",
                Level.ERROR,
                "never-true",
                "correct the guard",
            )
            continue
        for early in chart.failsafes[:at_]:
            if _hides(early, late):
                yield _hidden(early, late)
                break


def _hides(early: Guarded, late: Guarded) -> bool:
    return (
        early.rank >= late.rank
        and early.model.for_ <= late.model.for_
        and covered(late.may, early.surely)
    )


def _hidden(early: Guarded, late: Guarded) -> Problem:
    one, other = early.model.name, late.model.name
    shown = example(intersection(late.may, early.surely, sure=False) or late.may)
    return Problem(
        late.model.place(),
        f"{f'at {shown}' if shown else 'always'} both {one!r} and {other!r} hold; {other!r} can "
        "never fire",
        Level.ERROR,
        "shadowed-failsafe",
        f"move failsafe {other!r} above {one!r}, or remove it",
    )
