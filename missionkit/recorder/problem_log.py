"""Problems as people read them: each kind once, with its first and last time and a count."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

_MEASURED = re.compile(r"-?\d+\.\d+|-?\d+(?= (?:s|ms|m|m/s|cm|deg|%)(?:\W|$))")


class Noted(NamedTuple):
    """A kind of problem: its first message, and when it came up."""

    at: float  # s, mission time
    says: str
    last: float  # s, when it was last reported
    times: int = 1  # that it came up, after a tick without it

    def line(self) -> str:
        """Return it as one line.

        >>> Noted(2.0, "too fast", 2.5).line()
        '2.00 s: too fast'
        >>> Noted(2.0, "too fast", 9.5, 3).line()
        '2.00 s: too fast (3 times until 9.50 s)'
        """
        again = f" ({self.times} times until {self.last:.2f} s)" if self.times > 1 else ""
        return f"{self.at:.2f} s: {self.says}{again}"


@lru_cache(maxsize=1024)
def kind_of(problem: str) -> str:
    """Return a problem without the figures that change from tick to tick.

    >>> kind_of("marker 7 was last seen 0.55 s ago; 12 ms late")
    'marker 7 was last seen # s ago; # ms late'
    """
    return _MEASURED.sub("#", problem)


def note(known: list[Noted], problems: Iterable[str], now: float, before: float) -> list[Noted]:
    """Keep the problems of a tick; return those of a new kind.

    Args:
        known: so far; grows, and its entries are replaced.
        problems: of this tick.
        now: s, mission time of this tick.
        before: s, of the tick before.
    """
    new: list[Noted] = []
    for problem in problems:
        kind = kind_of(problem)
        at = next((i for i, one in enumerate(known) if kind_of(one.says) == kind), None)
        if at is None:
            new.append(Noted(now, problem, now))
            known.append(new[-1])
            continue
        one = known[at]
        again = one.last < before
        known[at] = one._replace(last=now, times=one.times + again)
    return new


def unsaid(problems: Iterable[str], before: Iterable[str]) -> list[str]:
    """Return the problems of a kind that was not reported at the previous tick."""
    kinds = set(map(kind_of, before))
    return [problem for problem in problems if kind_of(problem) not in kinds]
