"""A recorded flight, ticked again: the same observations, what this plan makes of them."""

from __future__ import annotations

import bisect
from collections.abc import Iterator
from typing import NamedTuple

from missionkit.engine.flight_state import FlightMemory
from missionkit.engine.prepared_mission import PreparedMission, begin
from missionkit.engine.tick import tick
from missionkit.errors import UsageError
from missionkit.messages import Estimate, Observation, Record
from missionkit.perception.vision_recording import ReplayedVision
from missionkit.plugin_containment import Containment
from missionkit.recorder.flight_journal import Decision, decision_of, whole
from missionkit.recorder.journal_reader import Journal, memory_of, tick_of


class ReplayedTick(NamedTuple):
    """One tick of a flight, and what was decided when it was ticked again."""

    number: int
    now: float  # s, mission time
    flown: Decision
    replayed: Decision
    memory: FlightMemory  # after the tick, as replayed
    record: Record  # as replayed
    observation: Observation  # without its image
    seen: Estimate  # what the chart was asked with
    stopped: float  # s by which the clocks of the chart were put off before that: a pause


class ReplayStart(NamedTuple):
    """Where a replay starts."""

    number: int  # of its first tick
    memory: FlightMemory


def replayed(
    plan: PreparedMission, journal: Journal, start: ReplayStart | None = None
) -> Iterator[ReplayedTick]:
    """Yield every tick from a start on, up to a gap in the journal.

    Args:
        plan: what decides.
        journal: of a flight with the same sensors.
        start: None: the first tick of the journal.

    Raises:
        UsageError: the journal cannot be replayed from there, or was changed.
    """
    number, memory = start or start_at(plan, journal, 0.0)
    eye, contain = ReplayedVision(plan.eye), Containment()
    plan = plan._replace(eye=eye, arm_anyway=journal.head.arm_anyway)
    for now, text in journal.ticks[number - first_number(journal) :]:
        given = tick_of(journal, text)
        if given.number != number:
            return
        eye.shown = given.image
        observation = whole(given)
        done = tick(plan, memory, observation, contain)
        memory, record = done.memory, done.record
        yield ReplayedTick(
            number,
            now,
            given.decision,
            decision_of(record),
            memory,
            record,
            observation,
            done.seen,
            done.stopped,
        )
        number += 1


def start_at(plan: PreparedMission, journal: Journal, since: float) -> ReplayStart:
    """Return the last memory of the journal that is not later than a time.

    Args:
        plan: gives the memory at the start of the mission.
        journal: of a flight.
        since: s, mission time.

    Raises:
        UsageError: the journal holds no memory that is early enough, or it was changed.
    """
    times = [at for at, _ in journal.memories]
    index = bisect.bisect_right(times, since) - 1
    if index < 0:
        if journal.head.begins:
            return ReplayStart(0, begin(plan))
        if not times:
            raise UsageError(f"{journal.path}: a resumed flight without a memory to start from")
        index = 0
    saved = memory_of(journal, journal.memories[index][1])
    if not isinstance(saved.memory, FlightMemory):
        raise UsageError(f"{journal.path}: a memory was changed after the flight")
    return ReplayStart(saved.number, saved.memory)


def first_number(journal: Journal) -> int:
    """Return the number of the first tick that is there."""
    return tick_of(journal, journal.ticks[0][1]).number if journal.ticks else 0
