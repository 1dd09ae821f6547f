"""What a transition waits for, part by part, and how near each part came in a flight."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, cast

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.semantics.robustness import opened_up
from missionkit.messages import Verdict

Answers = Mapping[str, Verdict]  # of guards, by the name in the record
Name = Callable[[ex.Expression], str]  # what the record calls a guard


class Closest(NamedTuple):
    """The nearest that a guard that did not hold came to holding."""

    margin: float  # negative: what was missing, in the unit of its value
    at: float  # s, mission time


class Conjunct(NamedTuple):
    """One of the guards that must hold together.

    Attributes:
        guard: as a person would say it.
        holds: at the time in question; None: unknown.
        value: that it compares, None if it compares none.
        threshold: that it is compared with.
        margin: how far inside (positive) or outside it is.
        closest: its largest margin in the time in question, None if it compares nothing.
        since: s, mission time from which on it has held without a break; None: it does not.
        why: what its answer says for people.
    """

    guard: str
    holds: bool | None
    value: float | None
    threshold: float | None
    margin: float | None
    closest: Closest | None
    since: float | None
    why: str


def conjuncts_in(when: ex.Expression, named: Mapping[str, ex.Expression]) -> list[ex.Expression]:
    """Return the guards that must hold together, names of combinations looked up.

    Args:
        when: guard of a transition.
        named: the mission's guards.
    """
    opened = cast(ex.Expression, opened_up(when, named))
    if not isinstance(opened, ex.All):
        return [opened]
    return [each for part in opened.parts for each in conjuncts_in(part, named)]


def answer_of(part: ex.Expression, answers: Answers, name: Name) -> Verdict | None:
    """Return a guard's answer from those in the record; None: it was not evaluated.

    Args:
        part: a guard.
        answers: of one tick.
        name: gives what the record calls a guard.
    """
    match part:
        case ex.Not(part=inner):
            return _contrary(answer_of(inner, answers, name))
        case ex.All(parts=parts) | ex.Any(parts=parts):
            every = [answer_of(each, answers, name) for each in parts]
            known = [it for it in every if it is not None]
            return _joined(known, every_one=isinstance(part, ex.All)) if known == every else None
        case _:
            return answers.get(name(part))


def _contrary(verdict: Verdict | None) -> Verdict | None:
    if verdict is None or verdict.holds is None:
        return verdict
    margin = None if verdict.margin is None else -verdict.margin
    return verdict._replace(holds=not verdict.holds, margin=margin)


def _joined(verdicts: Sequence[Verdict], *, every_one: bool) -> Verdict:
    """Return the answer that decides: of `all` the worst, of `any` the best."""
    order = (False, None, True) if every_one else (True, None, False)
    decides = next(it for it in order if any(each.holds is it for each in verdicts))
    alike = [each for each in verdicts if each.holds is decides]
    pick = min if every_one else max
    return pick(alike, key=lambda it: 0.0 if it.margin is None else it.margin)


def conjunct(text: str, answers: Sequence[tuple[float, Verdict | None]]) -> Conjunct:
    """Return how a guard stands at the last of some ticks, and how near it came in them.

    Args:
        text: of the guard.
        answers: time (s) and answer at each tick, the last in question.
    """
    known = [(at, verdict) for at, verdict in answers if verdict is not None]
    now = known[-1][1] if known else Verdict.unknown("it was not evaluated")
    margins = [(verdict.margin, at) for at, verdict in known if verdict.margin is not None]
    best = max(margins, key=lambda it: (it[0], -it[1]), default=None)
    closest = None if best is None else Closest(*best)
    return Conjunct(
        text, now.holds, now.value, now.threshold, now.margin, closest, _since(known), now.why
    )


def _since(known: Sequence[tuple[float, Verdict]]) -> float | None:
    since: float | None = None
    for at, verdict in reversed(known):
        if verdict.holds is not True:
            break
        since = at
    return since
