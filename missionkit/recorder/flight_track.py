"""Track of a run, kept in memory for the summary and the picture."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Quat, Vec3
from missionkit.messages import Cycle, Fired, Goal, Record
from missionkit.recorder import problem_log
from missionkit.recorder.problem_log import Noted

Place = tuple[float, float, float]


class Truth(Protocol):
    """Where a simulated vehicle really is."""

    @property
    def position(self) -> Vec3:
        """Position (3,), m, NED."""

    @property
    def attitude(self) -> Quat:
        """Attitude (4,), body to world."""


class Span(NamedTuple):
    """A stretch of ticks in which a guard gave the same answer."""

    start: float  # s
    end: float  # s
    holds: bool | None


class Visit(NamedTuple):
    """A stretch of ticks in one state."""

    state: str
    start: float  # s
    end: float  # s


class FlightTrack(NamedTuple):
    """One entry per tick in the first lists; the others grow when something happens."""

    times: list[float]  # s
    estimated: list[Place]  # m, NED
    true: list[Place]  # m, NED; empty if the ground truth is unknown
    cycles: list[Cycle]
    visits: list[Visit]
    guards: dict[str, list[Span]]
    transitions: list[tuple[float, Fired]]
    problems: list[Noted]
    goals: list[Goal]  # of each state, the last one


def begin() -> FlightTrack:
    """Return an empty track."""
    return FlightTrack([], [], [], [], [], {}, [], [], [])


def rows(track: FlightTrack, first: int = 0, last: int | None = None) -> npt.NDArray[np.float64]:
    """Return time, estimated and true position of the ticks from `first` to `last`, (N, 7).

    Args:
        track: as recorded so far.
        first: index of the first tick.
        last: index after the last tick; up to the end if absent.

    Returns:
        s, then m, NED; the true position is NaN where it is not known.
    """
    times, estimated = track.times[first:last], track.estimated[first:last]
    true = track.true[first:last] or [(np.nan, np.nan, np.nan)] * len(times)
    places = zip(times, estimated, true, strict=True)
    return np.array([(at, *where, *really) for at, where, really in places]).reshape(-1, 7)


def without_rows(track: FlightTrack) -> FlightTrack:
    """Return a copy of what does not grow at every tick; the timing is left out too."""
    return FlightTrack(
        [],
        [],
        [],
        [],
        list(track.visits),
        {name: list(spans) for name, spans in track.guards.items()},
        list(track.transitions),
        list(track.problems),
        list(track.goals),
    )


def with_rows(track: FlightTrack, rows: npt.NDArray[np.float64]) -> FlightTrack:
    """Return a track with its ticks back, as `rows` gave them."""
    known = rows[~np.isnan(rows[:, 4])]
    return track._replace(
        times=rows[:, 0].tolist(),
        estimated=[(x, y, z) for x, y, z in rows[:, 1:4].tolist()],
        true=[(x, y, z) for x, y, z in known[:, 4:7].tolist()],
    )


def add(track: FlightTrack, record: Record, truth: Truth | None) -> None:
    """Append one tick.

    Args:
        track: appended to.
        record: of one tick.
        truth: at the same time; `None` on a real vehicle.
    """
    now, seen = record.now, record.estimate
    before = track.times[-1] if track.times else now
    track.times.append(now)
    track.estimated.append(tuple(seen.position.tolist()))
    if truth is not None:
        track.true.append(tuple(truth.position.tolist()))
    if record.cycle.total > 0.0:
        track.cycles.append(record.cycle)
    track.transitions.extend((now, fired) for fired in record.fired)
    problem_log.note(track.problems, record.problems, now, before)
    _visit(track, record.state, now)
    _goal(track, seen.goal)
    _answers(track, record, before)


def _visit(track: FlightTrack, state: str, now: float) -> None:
    """Extend the current visit, or end it and start the next."""
    if not track.visits:
        track.visits.append(Visit(state, now, now))
        return
    last = track.visits[-1]
    track.visits[-1] = last._replace(end=now)
    if last.state != state:
        track.visits.append(Visit(state, now, now))


def _goal(track: FlightTrack, goal: Goal | None) -> None:
    if goal is None:
        return
    if track.goals and track.goals[-1].target == goal.target:
        track.goals[-1] = goal
    else:
        track.goals.append(goal)


def _answers(track: FlightTrack, record: Record, before: float) -> None:
    """Extend each guard's last span if its answer is the same as at the previous tick."""
    for name, verdict in record.verdicts:
        spans = track.guards.setdefault(name, [])
        holds = None if verdict.holds is None else bool(verdict.holds)
        if spans and spans[-1].end >= before and spans[-1].holds is holds:
            spans[-1] = Span(spans[-1].start, record.now, holds)
        else:
            spans.append(Span(record.now, record.now, holds))
