"""Robustness: how far a guard is from changing its answer, with bounds where it is unknown.

A score orders answers before margins: everything that holds is above everything that does not, and
at a margin of 0 the answer still counts. Minimum, maximum and negation of scores are then those of
signal temporal logic, and their first part is two-valued logic. Where the answer is not known, or
not known yet, a pair of scores bounds it from below and above.

Source: J. V. Deshmukh et al., "Robust online monitoring of signal temporal logic", Formal Methods
in System Design 51, 2017.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from math import inf
from typing import NamedTuple, cast

from missionkit.chart.model import guard_expressions as ex
from missionkit.messages import Verdict

Score = tuple[int, float]  # 1 holds, -1 does not; margin
LEAST: Score = (-1, -inf)
GREATEST: Score = (1, inf)


class Bounds(NamedTuple):
    """A score, from below and above; equal where it is known."""

    low: Score
    high: Score

    @property
    def known(self) -> bool:
        """Whether the score is known."""
        return self.low is self.high or self.low == self.high


UNKNOWN = Bounds(LEAST, GREATEST)
HOLDS, FAILS = Bounds(GREATEST, GREATEST), Bounds(LEAST, LEAST)
Leaf = ex.Expression | ex.Enter  # not made of others
Answers = Mapping[str, Verdict]  # of guards, by name
Formula = Callable[[Answers], Bounds]


def negated(score: Score) -> Score:
    """Return the score of the contrary."""
    return -score[0], -score[1]


def bounds_of(verdict: Verdict) -> Bounds:
    """Return the score of a guard's answer; without a margin it is infinitely far from changing."""
    if verdict.holds is None:
        return UNKNOWN
    margin = verdict.margin
    if margin is None:
        return HOLDS if verdict.holds else FAILS
    if verdict.holds:
        score: Score = (1, max(margin, 0.0))
    else:
        score = (-1, min(margin, 0.0))
    return Bounds(score, score)


def formula(expression: ex.Expression | ex.Enter, name: Callable[[Leaf], str]) -> Formula:
    """Compile a guard expression: minimum of `all`, maximum of `any`.

    Args:
        expression: of guards.
        name: gives what the answer of a guard that is not `all`, `any` or `not` is called.
    """
    match expression:
        case ex.All(parts=parts) | ex.Any(parts=parts):
            join = min if isinstance(expression, ex.All) else max
            return _joined(join, tuple(formula(part, name) for part in parts))
        case ex.Not(part=part):
            inner = formula(part, name)
            return lambda answers: contrary(inner(answers))
        case _:
            label = name(expression)
            return lambda answers: bounds_of(answers[label]) if label in answers else UNKNOWN


def _joined(join: Callable[[Iterable[Score]], Score], parts: tuple[Formula, ...]) -> Formula:
    def score(answers: Answers) -> Bounds:
        every = [part(answers) for part in parts]
        return Bounds(join([it.low for it in every]), join([it.high for it in every]))

    return score


def contrary(bounds: Bounds) -> Bounds:
    """Return the bounds of the contrary."""
    return Bounds(negated(bounds.high), negated(bounds.low))


def leaves(expression: ex.Expression | ex.Enter) -> Iterator[Leaf]:
    """Yield the guards of an expression that are not `all`, `any` or `not`."""
    match expression:
        case ex.All(parts=parts) | ex.Any(parts=parts):
            for part in parts:
                yield from leaves(part)
        case ex.Not(part=part):
            yield from leaves(part)
        case _:
            yield expression


def opened_up(
    expression: ex.Expression | ex.Enter, named: Mapping[str, ex.Expression]
) -> ex.Expression | ex.Enter:
    """Return an expression in which a name of `all`, `any` or `not` is replaced by what it means.

    Args:
        expression: of guards.
        named: the mission's guards, none defined by itself.
    """
    match expression:
        case ex.All(parts=parts, place=place):
            return ex.All(tuple(_opened(part, named) for part in parts), place)
        case ex.Any(parts=parts, place=place):
            return ex.Any(tuple(_opened(part, named) for part in parts), place)
        case ex.Not(part=part, place=place):
            return ex.Not(_opened(part, named), place)
        case ex.Named(name=name) if isinstance(named[name], ex.All | ex.Any | ex.Not | ex.Named):
            return opened_up(named[name], named)
        case _:
            return expression


def _opened(expression: ex.Expression, named: Mapping[str, ex.Expression]) -> ex.Expression:
    return cast(ex.Expression, opened_up(expression, named))
