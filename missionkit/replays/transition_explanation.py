"""How a transition stood in a flight: its guards, what stood before it, and when it would come."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.semantics.chart_memory import begin
from missionkit.messages import Fired, Verdict
from missionkit.replays.asked_transition import AskedTransition, NamedChart, ways_from
from missionkit.replays.blocked_transition import hindrances, waiting
from missionkit.replays.guard_outlook import Outlook, outlook
from missionkit.replays.state_stays import DecidedTick, Stay, stays_in, until
from missionkit.replays.transition_conjuncts import (
    Conjunct,
    answer_of,
    conjunct,
    conjuncts_in,
)


class Explanation(NamedTuple):
    """How a transition stood.

    Attributes:
        fired: when it was taken; None: it was not.
        at: s, mission time in question: when it was taken, or up to when it was not.
        tick: number of that tick.
        since: s from which on it could have been taken.
        conjuncts: the guards that must hold together.
        before: what stood before it, a sentence each.
        if_nothing_changes: when it would be taken; None: that cannot be told.
        missing: the conjuncts, by index, that did not hold at a tick; each set once.
        rivals: what was taken at ticks at which all conjuncts held.
    """

    fired: Fired | None
    at: float
    tick: int
    since: float
    conjuncts: tuple[Conjunct, ...]
    before: tuple[str, ...]
    if_nothing_changes: Outlook | None = None
    missing: frozenset[frozenset[int]] = frozenset()
    rivals: tuple[Fired, ...] = ()


def explained(
    known: NamedChart, asked: AskedTransition, ticks: Sequence[DecidedTick], at: float | None
) -> Explanation:
    """Return how a transition stood in a flight.

    Args:
        known: the chart that flew.
        asked: the transition.
        ticks: of the flight.
        at: s, mission time; None: when it was first taken, or all the flight if it was not.
    """
    initial = asked.source in begin(known.chart, 0.0).active
    stays = list(stays_in(asked.source, ticks, initial=initial))
    if at is not None:
        at = _nearest(ticks, at)
        stays = [until(it, at) for it in stays if it.ticks[0].now <= at <= it.ticks[-1].now]
    taken = next((it for it in stays if _took(it, asked)), None)
    if taken is not None:
        return _taken(known, asked, taken)
    if not stays:
        return _elsewhere(asked, ticks, at)
    return _not_taken(known, asked, stays)


def _nearest(ticks: Sequence[DecidedTick], at: float) -> float:
    return min((it.now for it in ticks), key=lambda now: abs(now - at))


def _took(stay: Stay, asked: AskedTransition) -> Fired | None:
    """Return the transition if a stay ended with it."""
    every = stay.ticks[-1].decision.fired if stay.left is not None else ()
    return next((it for it in every if _is_it(it, asked)), None)


def _is_it(fired: Fired, asked: AskedTransition) -> bool:
    return fired.reason == asked.compiled.text and asked.to in fired.to.split(", ")


def _taken(known: NamedChart, asked: AskedTransition, stay: Stay) -> Explanation:
    last, fired = stay.ticks[-1], _took(stay, asked)
    parts = _conjuncts(known, asked, stay.ticks)
    since = [it.since for it in parts if it.since is not None]
    came = [it for it in parts if it.since == max(since, default=None)]
    lines = [f"{it.guard} came last, at {it.since:.2f} s" for it in came if len(parts) > 1]
    lines += [
        f"{other.reason} was taken with it" for other in last.decision.fired if other != fired
    ]
    lines += _ready_too(known, asked, stay)
    return Explanation(fired, last.now, last.number, stay.entered, tuple(parts), tuple(lines), None)


def _ready_too(known: NamedChart, asked: AskedTransition, stay: Stay) -> list[str]:
    """Return the transitions whose guards held as well, but which come later."""
    answers, last = dict(stay.ticks[-1].decision.verdicts), stay.ticks[-1]
    lines = []
    for other in ways_from(known, asked.source):
        way, when = other.compiled, other.model.when
        if way.number == asked.compiled.number or when is None or way.events or way.hold:
            continue
        verdict = answer_of(when, answers, known.guard_name)
        if verdict is not None and verdict.holds and last.now - stay.entered >= other.dwell:
            lines.append(f"{', '.join(way.to)} ({way.text}) was ready too, but comes later")
    return lines


def _elsewhere(
    asked: AskedTransition, ticks: Sequence[DecidedTick], at: float | None
) -> Explanation:
    last = ticks[-1] if at is None else next(it for it in ticks if it.now == at)
    active = ", ".join(last.decision.active)
    if at is None:
        line = f"{asked.source} was never active"
    else:
        line = f"at {at:.2f} s {asked.source} was not active: {active} was"
    return Explanation(None, last.now, last.number, last.now, (), (line,))


def _not_taken(known: NamedChart, asked: AskedTransition, stays: Sequence[Stay]) -> Explanation:
    parts = _conjuncts(known, asked, [tick for stay in stays for tick in stay.ticks])
    lines = [line for stay in stays for line in _hindered(known, asked, stay)]
    stay = stays[-1]
    last = stay.ticks[-1]
    if stay.left is not None:
        lines.append(
            f"{asked.source} was left at {last.now:.2f} s: {stay.left.source} -> {stay.left.to} "
            f"({stay.left.reason})"
        )
    later = None if stay.left is not None else _outlook(known, asked, stay)
    begun = stays[0].entered
    missing, rivals = _missing(known, asked, [tick for it in stays for tick in it.ticks])
    return Explanation(
        None, last.now, last.number, begun, tuple(parts), tuple(lines), later, missing, rivals
    )


def _missing(
    known: NamedChart, asked: AskedTransition, ticks: Sequence[DecidedTick]
) -> tuple[frozenset[frozenset[int]], tuple[Fired, ...]]:
    """Return which conjuncts did not hold together, and what was taken where all did."""
    when, guards = asked.model.when, known.mission.guards
    parts = [] if when is None else conjuncts_in(when, guards)
    sets, rivals = set[frozenset[int]](), list[Fired]()
    for tick in ticks:
        answers = _answers(tick)
        every = [answer_of(part, answers, known.guard_name) for part in parts]
        short = [n for n, it in enumerate(every) if it is None or not it.holds]
        sets.add(frozenset(short))
        if not short:
            rivals += tick.decision.fired
    return frozenset(sets), tuple(rivals)


def _hindered(known: NamedChart, asked: AskedTransition, stay: Stay) -> list[str]:
    when = asked.model.when
    verdicts = [
        None if when is None else answer_of(when, _answers(tick), known.guard_name)
        for tick in stay.ticks
    ]
    stands = waiting(stay, verdicts, asked.compiled)
    return list(hindrances(stands, asked.compiled, asked.dwell))


def _conjuncts(
    known: NamedChart, asked: AskedTransition, ticks: Sequence[DecidedTick]
) -> list[Conjunct]:
    if asked.model.when is None:
        return []
    return [
        conjunct(str(ex.text(part)), _answered(known, part, ticks))
        for part in conjuncts_in(asked.model.when, known.mission.guards)
    ]


def _answered(
    known: NamedChart, part: ex.Expression, ticks: Sequence[DecidedTick]
) -> list[tuple[float, Verdict | None]]:
    name = known.guard_name
    return [(tick.now, answer_of(part, _answers(tick), name)) for tick in ticks]


def _answers(tick: DecidedTick) -> dict[str, Verdict]:
    return dict(tick.decision.verdicts)


def _outlook(known: NamedChart, asked: AskedTransition, stay: Stay) -> Outlook | None:
    """Return when the last of the guards that do not hold would; and the timer, if it waits."""
    last, found = stay.ticks[-1], list[Outlook]()
    if asked.compiled.after is not None:
        left = asked.compiled.after - (last.now - stay.entered)
        found.append(Outlook(max(left, 0.0), f"its timer of {asked.compiled.after:g} s runs"))
    if asked.model.when is not None:
        for part in conjuncts_in(asked.model.when, known.mission.guards):
            answers = _answered(known, part, stay.ticks)
            if answers[-1][1] is not None and answers[-1][1].holds:
                continue
            margins = [
                (at, it.margin) for at, it in answers if it is not None and it.margin is not None
            ]
            ahead = outlook(str(ex.text(part)), margins) if margins else None
            if ahead is None:
                return None
            found.append(ahead)
    return max(found, key=lambda it: it.after, default=None)
