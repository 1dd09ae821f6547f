"""When a ground robot reverses next, by the spins that were seen.

A robot reverses every 20 s, by a clock with a phase of its own. A bump makes it spin by 180 deg
too and leaves the clock alone, so two spins that are no multiple of the period apart say that
one of them was a bump, but not which: the phase is then unknown until a third agrees with one.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from missionkit.ground_robot import GroundRobot

DELAY: Final = 0.15  # s until a spin is noticed, median (docs/studies/tracking.md)
AGREE: Final = 0.6  # s, largest difference of two phases that are one
SURE: Final = 0.4  # s, after which a target that seems to drive would have been seen to spin
GAP: Final = 0.5  # s without a detection, in which a spin may have begun or ended
WHOLE: Final = 0.75  # of half a turn; a touch on top turns by a quarter of it
MOST: Final = 4  # spins remembered


class ReversalClock(NamedTuple):
    """The spins of one target; an immutable value."""

    since: float | None = None  # s, when the spin that lasts began; None: none, or not seen
    drives_since: float | None = None  # s, since when it has been seen to drive
    spins: tuple[float, ...] = ()  # s, when the last whole ones began


def advanced(
    clock: ReversalClock, at: float, before: float, *, spins: bool, robot: GroundRobot
) -> ReversalClock:
    """Return the clock after a frame that showed the target.

    Args:
        clock: before it.
        at: s, of the frame.
        before: s, of the last frame that showed it.
        spins: whether it is likelier to spin than not.
        robot: how it drives.
    """
    if at - before > GAP:
        return clock._replace(since=None, drives_since=None)
    if spins:
        if clock.drives_since is not None and at - clock.drives_since > SURE:
            clock = clock._replace(since=at - DELAY)
        return clock._replace(drives_since=None)
    if clock.drives_since is None:
        clock = clock._replace(drives_since=at)
    if clock.since is not None:
        lasted = at - DELAY - clock.since
        begun = (at - DELAY - robot.spin_time,) if lasted >= WHOLE * robot.spin_time else ()
        return ReversalClock(None, clock.drives_since, (*clock.spins, *begun)[-MOST:])
    due = _phase(clock, robot)
    if due is None:
        return clock
    late = _since_due(due, at, robot)
    if AGREE <= late < AGREE + at - before and at - due > 0.5 * robot.reversal_every:
        agreeing = {it for it in clock.spins if _agree(it, due, robot)}
        return clock._replace(spins=tuple(it for it in clock.spins if it not in agreeing))
    return clock


def reversal_in(clock: ReversalClock, now: float, robot: GroundRobot) -> float | None:
    """Return how long it is (s) until the target reverses next by its clock; None: not known.

    Args:
        clock: of the target.
        now: s.
        robot: how it drives.
    """
    phase = _phase(clock, robot)
    return None if phase is None else robot.reversal_every - _since_due(phase, now, robot)


def spin_left(clock: ReversalClock, now: float, robot: GroundRobot) -> float | None:
    """Return how long (s) the spin goes on that a target is in, if it is a whole one.

    None: it does not spin, or its begin was not seen.

    Args:
        clock: of the target.
        now: s.
        robot: how it drives.
    """
    if clock.since is None:
        return None
    return max(0.0, clock.since + robot.spin_time - now)


def _phase(clock: ReversalClock, robot: GroundRobot) -> float | None:
    """Return the newest spin that most others agree with, None if several are as good."""
    votes = {it: sum(_agree(it, other, robot) for other in clock.spins) for it in clock.spins}
    most = max(votes.values(), default=0)
    best = [it for it in clock.spins if votes[it] == most]
    if not best or not all(_agree(it, best[-1], robot) for it in best):
        return None
    return best[-1]


def _agree(one: float, other: float, robot: GroundRobot) -> bool:
    return abs(math.remainder(one - other, robot.reversal_every)) <= AGREE


def _since_due(phase: float, now: float, robot: GroundRobot) -> float:
    """Return the time (s) since the last reversal that was due."""
    return (now - phase) % robot.reversal_every
