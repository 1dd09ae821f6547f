"""Flying a mission in the built-in simulator."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from typing import NamedTuple

from missionkit.engine.clock import Pace
from missionkit.engine.flight_end import FlownFlight
from missionkit.engine.flight_history import FlightHistory
from missionkit.engine.flight_loop import (
    Keeper,
    Observer,
    Operator,
    each_of,
    fly,
    keep_nothing,
    no_reports,
)
from missionkit.engine.flight_state import FlightState
from missionkit.engine.resume.checkpoint_policy import now_and_then
from missionkit.engine.resume.resumption import Resumption
from missionkit.geometry import Mat
from missionkit.recorder.value_codec import is_plain
from missionkit.rehearsal.grading import Rehearsal, Witness, graded_flight
from missionkit.rehearsal.stage import Stage
from missionkit.sim.vehicle_snapshot import Snapshot, restore, taken


class Kept(NamedTuple):
    """A flight under way, with the simulated vehicle that flies it; fit to be saved."""

    course: FlightState
    vehicle: Snapshot  # without its track
    passage: FlightHistory
    estimate_error: float  # m, largest so far
    lost: tuple[str, ...]  # what could not be saved, a sentence each


class Again(NamedTuple):
    """Saved state from which a rehearsal resumes."""

    kept: Kept
    track: Mat  # (N, TRACK_WIDTH), of the simulated vehicle
    gap: float  # s that the vehicle flew without commands
    changed: bool = False  # the mission is not the one that was flown

    @property
    def now(self) -> float:
        """Mission time (s) at which it resumes."""
        return self.kept.course.memory.now + self.gap


def rehearse(
    ready: Stage,
    observers: Sequence[Observer] = (),
    *,
    operator: Operator | None = None,
    pace: Pace | None = None,
    save: Callable[[Kept], None] | None = None,
    reports: Callable[[], tuple[str, ...]] = no_reports,
    again: Again | None = None,
    keeper: Keeper = keep_nothing,
) -> Rehearsal:
    """Fly and grade.

    Args:
        ready: the flight, set up afresh even when it resumes.
        observers: called after every tick.
        operator: may request a landing.
        pace: lets mission time pass; as fast as possible by default.
        save: called at every transition and once a second with the state to resume from.
        reports: what failed beside the flight since the last call; joins the problems.
        again: the saved state to resume from.
        keeper: called after every tick but the last, besides `save`.
    """
    visits = Witness(ready)
    resume = None if again is None else _restored(ready, visits, again)
    keepers = (keeper,) if save is None else (_keeping(ready, visits, save), keeper)
    flown: list[FlownFlight] = []

    async def flight() -> None:  # returns nothing: asyncio would write it all out as text
        flown.append(
            await fly(
                ready.plan,
                ready.vehicle,
                (visits, *observers),
                operator=operator,
                pace=pace,
                time_limit=ready.mission.settings.time_limit,
                keeper=each_of(*keepers),
                reports=reports,
                resume=resume,
            )
        )

    asyncio.run(flight())
    return graded_flight(ready, flown[0], visits)


def _restored(ready: Stage, visits: Witness, again: Again) -> Resumption:
    """Restore the vehicle, and let it fly on alone, without listening to it."""
    ready.vehicle.track.restore(again.track)
    restore(ready.vehicle, again.kept.vehicle)
    visits.passage = again.kept.passage
    visits.estimate_error = again.kept.estimate_error
    if again.gap > 0.0:
        ready.vehicle.advance(again.now)
    return Resumption(again.kept.course, again.now, again.changed, again.kept.lost)


def _keeping(ready: Stage, visits: Witness, save: Callable[[Kept], None]) -> Keeper:
    """Return what saves it together with the simulated vehicle."""

    def keep(course: FlightState, lost: tuple[str, ...]) -> None:
        save(Kept(course, taken(ready.vehicle), visits.passage, visits.estimate_error, lost))

    return now_and_then(ready.plan.chart, is_plain, keep)
