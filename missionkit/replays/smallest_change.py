"""The smallest change of a mission's numbers that would have let a transition be taken.

A replay is the judge: a change counts if the first transition that differs from the flight is the
one in question, in the time in question. Each number is moved away from its value in growing steps
until that happens, and the step is then halved until the change is known to half a percent. If no
number does it alone, two are tried: each is first moved as far as it may go, then brought back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from missionkit.replays.mission_numbers import MissionNumber

FIRST_STEP = 0.01  # of the value
STEPS = 10
GROWTH = 4  # of each step over the last
KNOWN_TO = 0.004  # of the change
LESS = 0.99  # of the change: does not fire any more
MOST_TRIALS = 1200
DIGITS = 12

Changes = tuple[tuple[MissionNumber, float], ...]
Judge = Callable[[Changes], bool]  # it is taken with these changes
Allowed = Callable[[Changes], bool]  # the mission may have these values


class Trials:
    """Counts what the judge is asked: a search in a long flight has to end.

    Args:
        judge: says whether the transition is taken.
        allowed: says whether the mission may have some values.
    """

    def __init__(self, judge: Judge, allowed: Allowed) -> None:
        self._judge, self.allowed = judge, allowed
        self.count = 0

    def taken(self, changes: Changes) -> bool:
        """Say whether the transition is taken with some changes."""
        self.count += 1
        return self.count <= MOST_TRIALS and self._judge(changes)


class Bracket(NamedTuple):
    """A change that does not let the transition be taken, and a larger one that does."""

    short: float
    enough: float


def single_changes(numbers: Sequence[MissionNumber], trials: Trials) -> list[Changes]:
    """Return the smallest change of each number that does it alone, the smallest of all first.

    Args:
        numbers: that may be changed.
        trials: judges.
    """
    found = [
        ((number, value),)
        for number in numbers
        if (value := _smallest(number, (), trials)) is not None
    ]
    return sorted(found, key=_size)


def pair_changes(
    pairs: Sequence[tuple[MissionNumber, MissionNumber]], trials: Trials
) -> list[Changes]:
    """Return changes of two numbers of which neither can be smaller, the smallest of all first.

    Args:
        pairs: of numbers none of which does it alone.
        trials: judges.
    """
    found: list[Changes] = []
    for one, other in pairs:
        for far in _ends(other, trials):
            first = _smallest(one, ((other, far),), trials)
            if first is None:
                continue
            second = _smallest(other, ((one, first),), trials)
            if second is not None:
                found.append(((one, first), (other, second)))
    return sorted(found, key=_size)


def less(changes: Changes, index: int = 0) -> Changes:
    """Return changes of which one is 1 % smaller, or smaller by one where it counts something.

    Args:
        changes: of numbers.
        index: of the one.
    """
    number, value = changes[index]
    way = value - number.value
    nearer = value - (1 if way > 0 else -1) if number.whole else number.value + LESS * way
    return (*changes[:index], (number, nearer), *changes[index + 1 :])


def _size(changes: Changes) -> float:
    """Return how large changes are, in proportion to the values."""
    return sum(abs(value - number.value) / _scale(number) for number, value in changes)


def _scale(number: MissionNumber) -> float:
    return abs(number.value) or 1.0


def _smallest(number: MissionNumber, others: Changes, trials: Trials) -> float | None:
    """Return the value nearest to that of the flight with which the transition is taken."""

    def taken(value: float) -> bool:
        return trials.taken((*others, (number, value)))

    brackets = [it for sign in number.signs if (it := _bracket(number, others, trials, sign))]
    nearest = min(brackets, key=lambda it: abs(it.enough - number.value), default=None)
    if nearest is None:
        return None
    narrowed = _narrowed(number, nearest, taken)
    return narrowed.enough if number.whole else _rounded(number.value, narrowed, taken)


def _bracket(number: MissionNumber, others: Changes, trials: Trials, sign: int) -> Bracket | None:
    short = number.value
    for value in _outward(number, others, trials, sign):
        if trials.taken((*others, (number, value))):
            return Bracket(short, value)
        short = value
    return None


def _outward(number: MissionNumber, others: Changes, trials: Trials, sign: int) -> Iterator[float]:
    """Yield values in growing steps, and at last the farthest that the mission may have."""
    last = number.value
    for power in range(STEPS):
        step = FIRST_STEP * _scale(number) * GROWTH**power
        value = number.value + sign * (max(1, round(step)) if number.whole else step)
        if value == last:
            continue
        if not trials.allowed((*others, (number, value))):
            end = _farthest(number, others, trials, Bracket(last, value))
            if end != last:
                yield end
            return
        yield value
        last = value


def _farthest(number: MissionNumber, others: Changes, trials: Trials, between: Bracket) -> float:
    """Return the farthest allowed value between one that is allowed and one that is not."""
    good, bad = between
    zero = type(number.value)(0)
    if min(good, bad) < zero < max(good, bad) and trials.allowed((*others, (number, zero))):
        good = zero  # most limits are there
    for limit in (1.0, 0.0):
        if bad < limit < good or good < limit < bad:
            value = type(number.value)(limit)
            good = value if trials.allowed((*others, (number, value))) else good
    while abs(bad - good) > (1 if number.whole else KNOWN_TO * _scale(number)):
        middle = (good + bad) // 2 if number.whole else (good + bad) / 2
        if trials.allowed((*others, (number, middle))):
            good = middle
        else:
            bad = middle
    return good


def _ends(number: MissionNumber, trials: Trials) -> list[float]:
    """Return the farthest values of a number, both ways."""
    ends = [list(_outward(number, (), trials, sign))[-1:] for sign in number.signs]
    return [value for end in ends for value in end]


def _narrowed(number: MissionNumber, between: Bracket, taken: Callable[[float], bool]) -> Bracket:
    short, enough = between
    while abs(enough - short) > (1 if number.whole else KNOWN_TO * abs(enough - number.value)):
        middle = (short + enough) // 2 if number.whole else (short + enough) / 2
        if middle in (short, enough):
            break
        if taken(middle):
            enough = middle
        else:
            short = middle
    return Bracket(short, enough)


def _rounded(flown: float, between: Bracket, taken: Callable[[float], bool]) -> float:
    """Return the value with the fewest digits whose change, made 1 % smaller, is not enough."""
    short, enough = between
    for digits in range(DIGITS):
        away = 10.0**-digits * (1 if enough > flown else -1)
        for value in (round(enough, digits), round(enough + away / 2, digits)):
            change = abs(value - flown)
            if LESS * change <= abs(short - flown) <= change and taken(value):
                return value
    return enough
