"""The times that a flight was in a state, from its recorded decisions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from missionkit.messages import Fired
from missionkit.recorder.flight_journal import Decision


class DecidedTick(NamedTuple):
    """What one tick of a flight decided."""

    number: int
    now: float  # s, mission time
    decision: Decision


class Stay(NamedTuple):
    """A time in a state.

    Attributes:
        entered: s, mission time.
        ticks: at which its transitions were tried; the last is that at which it was left.
        left: the transition that left it, None if the flight or the record ended in it.
    """

    entered: float
    ticks: Sequence[DecidedTick]
    left: Fired | None


def stays_in(state: str, ticks: Sequence[DecidedTick], *, initial: bool) -> Iterator[Stay]:
    """Yield the times that a flight was in a state.

    Args:
        state: a name of the mission.
        ticks: of the flight.
        initial: it is active before the first tick.
    """
    begun, entered = (0, ticks[0].now if ticks else 0.0) if initial else (-1, 0.0)
    for index, tick in enumerate(ticks):
        inside = state in tick.decision.active
        again = any(it.source == state and it.to == state for it in tick.decision.fired)
        if begun >= 0 and (not inside or again):
            fired = tick.decision.fired
            yield Stay(entered, ticks[begun : index + 1], fired[0] if fired else None)
            begun = -1
        if inside and begun < 0:
            begun, entered = index + 1, tick.now
    if begun >= 0 and begun < len(ticks):
        yield Stay(entered, ticks[begun:], None)


def until(stay: Stay, at: float) -> Stay:
    """Return a stay up to a time (s)."""
    ticks = _while(stay.ticks, lambda tick: tick.now <= at + 1e-9)
    return stay._replace(ticks=ticks, left=stay.left if len(ticks) == len(stay.ticks) else None)


def _while(
    ticks: Sequence[DecidedTick], holds: Callable[[DecidedTick], bool]
) -> Sequence[DecidedTick]:
    count = next((n for n, tick in enumerate(ticks) if not holds(tick)), len(ticks))
    return ticks[:count]
