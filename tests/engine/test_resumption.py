"""Going on with a flight: listen first, command later."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from itertools import pairwise

import pytest
from rehearsed import precise_stage, short_stage
from typing_extensions import override

from missionkit.engine.flight_end import FlightEnd, FlownFlight
from missionkit.engine.flight_loop import Operator, fly
from missionkit.engine.flight_state import FlightState
from missionkit.engine.resume.resumption import (
    HEARTBEAT_WAIT,
    SETTLING_TIMEOUT,
    SOUND_AFTER,
    Resumption,
)
from missionkit.errors import VehicleError
from missionkit.estimation.error_state_ekf.realignment import SAMPLE_TIME
from missionkit.geometry import norm
from missionkit.messages import Action, Command, Observation, Record
from missionkit.rehearsal.rehearse import Again, Kept, rehearse
from missionkit.rehearsal.stage import Stage
from missionkit.sim.simulated_vehicle import SimulatedVehicle

STAY = """\
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 2}, transitions: [{to: up, when: done}]}
  up: {kind: custom, transitions: [{to: land, after: 10}]}
  land: {kind: land}
"""
AT = 6.0  # s, in the middle of up


class Listening:
    """The simulated vehicle, and when it was observed and commanded."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self.vehicle = vehicle
        self.observed: list[Observation] = []
        self.sent: list[tuple[float, Command]] = []

    async def connect(self) -> None:
        """Nothing to do."""

    async def close(self) -> None:
        """Nothing to do."""

    async def observe(self, until: float) -> Observation:
        self.observed.append(self.vehicle.advance(until))
        return self.observed[-1]

    async def send(self, command: Command) -> None:
        self.sent.append((self.vehicle.now, command))
        self.vehicle.apply(command)


class Manual(Listening):
    """A pilot flies it by hand."""

    @override
    async def observe(self, until: float) -> Observation:
        seen = await super().observe(until)
        status = seen.status
        return seen if status is None else replace(seen, status=status._replace(mode="position"))


class KilledError(BaseException):
    """The process died: a recorder that only fails never ends a flight."""


def saved(ready: Stage, at: float = AT) -> FlightState:
    """Fly to a moment, and leave the vehicle there."""
    courses: list[FlightState] = []

    def keep(course: FlightState, _: Record) -> None:
        courses.append(course)
        if course.memory.now >= at - 1e-6:
            raise KilledError

    with pytest.raises(KilledError):
        asyncio.run(fly(ready.plan, Listening(ready.vehicle), keeper=keep))
    return courses[-1]


def resumed(
    ready: Stage, vehicle: Listening, course: FlightState, gap: float = 1.0, **options: float
) -> tuple[FlownFlight, list[Record]]:
    records: list[Record] = []
    now = course.memory.now + gap
    ready.vehicle.advance(now)
    since = Resumption(course, now)
    watch = (lambda record, _: records.append(record),)
    return asyncio.run(fly(ready.plan, vehicle, watch, resume=since, **options)), records


def test_nothing_is_commanded_before_a_heartbeat_has_come_and_the_estimate_is_sound():
    ready = short_stage(STAY)
    vehicle = Listening(ready.vehicle)
    done, records = resumed(ready, vehicle, saved(ready))
    heard = next(seen.now for seen in vehicle.observed if seen.status is not None)
    assert vehicle.sent[0][0] == records[0].now > max(heard, AT + 1.0 + SOUND_AFTER)
    assert (done.end, done.aborted) == (FlightEnd.LANDED, False)
    assert records[0].state == "up"
    assert records[0].problems[0].startswith("resumed after 2.")
    assert not records[1].problems


@pytest.mark.parametrize(
    ("loss", "waited"),
    [("gnss_lost@3.5", SAMPLE_TIME + SOUND_AFTER), (f"gnss_lost@{AT}", SETTLING_TIMEOUT)],
    ids=["long", "just"],
)
def test_fixes_are_waited_for_only_where_there_were_some(loss, waited):
    ready = short_stage(STAY, loss)
    _, records = resumed(ready, Listening(ready.vehicle), saved(ready))
    assert records[0].now - AT - 1.0 == pytest.approx(waited, abs=0.3)


def test_on_the_ground_a_heartbeat_is_enough():
    ready = short_stage(STAY)
    vehicle = Listening(ready.vehicle)
    course = saved(ready, 1.0)
    done, records = resumed(ready, vehicle, course)
    assert records[0].now - 2.0 <= 0.25  # heartbeats come at 5 Hz
    assert [fired.to for record in records for fired in record.fired] == ["up", "land"]
    assert done.end is FlightEnd.LANDED


def test_the_estimate_gets_over_the_hole_in_its_data_before_anything_is_commanded():
    """Killed at 5 m/s: the filter believes for a while that it still flies so fast."""
    kept: list[Kept] = []
    ready = precise_stage(seed=47)
    rehearse(ready, save=kept.append)
    fast = next(each for each in kept if each.course.memory.now > 63.0)
    rows = ready.vehicle.track.rows
    before = rows[rows[:, 0] <= fast.course.memory.now + 1e-9]
    ready = precise_stage(seed=47)
    wrong: list[float] = []

    def watch(record: Record, _: Observation) -> None:
        wrong.append(norm(record.estimate.velocity - ready.vehicle.truth.velocity))

    done = rehearse(ready, [watch], again=Again(fast, before, 1.0))
    assert max(wrong[:20]) < 0.5
    assert done.succeeded


def test_a_silent_vehicle_is_ordered_to_land_after_a_time_out():
    ready = short_stage(STAY, f"link_lost@{AT}")
    vehicle = Listening(ready.vehicle)
    done, records = resumed(ready, vehicle, saved(ready))
    assert records[0].now == pytest.approx(AT + 1.0 + HEARTBEAT_WAIT + 0.05)
    assert records[0].problems[0].endswith("the vehicle is silent; landing")
    assert vehicle.sent[0][1].action is Action.LAND
    assert done.end is FlightEnd.SILENT
    assert ready.vehicle.truth.on_ground


def test_a_pilot_who_took_over_is_sent_nothing():
    ready = short_stage(STAY)
    course = saved(ready)
    vehicle = Manual(ready.vehicle)
    with pytest.raises(
        VehicleError, match="a pilot is in control, mode position; nothing is commanded"
    ):
        resumed(ready, vehicle, course)
    assert vehicle.sent == []


def test_a_vehicle_that_landed_meanwhile_is_not_armed_again():
    ready = short_stage(STAY)
    course = saved(ready)
    ready.vehicle.apply(Command(action=Action.LAND))
    vehicle = Listening(ready.vehicle)
    done, records = resumed(ready, vehicle, course, gap=20.0)
    assert done.end is FlightEnd.LANDED
    assert [fired.to for record in records for fired in record.fired] == ["land"]
    assert {command.action for _, command in vehicle.sent} <= {None, Action.LAND}


def test_an_abort_stays_an_abort():
    ready = short_stage(STAY)
    course = saved(ready)._replace(aborting=True)
    done, records = resumed(ready, Listening(ready.vehicle), course)
    assert (done.end, done.aborted) == (FlightEnd.LANDED, True)
    assert records[0].fired[0].reason == "operator: land"


def test_the_keeper_is_called_at_every_tick_but_the_last():
    ready = short_stage(STAY)
    courses: list[FlightState] = []
    done = asyncio.run(
        fly(
            ready.plan,
            Listening(ready.vehicle),
            operator=Operator(),
            keeper=lambda course, _: courses.append(course),
        )
    )
    assert len(courses) == done.ticks - 1
    assert [course.flown for course in (courses[0], courses[-1])] == [False, True]


def test_a_rehearsal_is_saved_at_transitions_and_once_a_second():
    kept: list[Kept] = []
    records: list[Record] = []
    rehearse(short_stage(STAY), [lambda record, _: records.append(record)], save=kept.append)
    times = [each.course.memory.now for each in kept]
    assert max(later - before for before, later in pairwise(times)) == pytest.approx(1.0)
    assert {record.now for record in records if record.fired} <= set(times)
    assert len(times) < records[-1].now + 4.0


def test_a_resumed_rehearsal_is_graded_as_a_whole():
    ready, kept = short_stage(STAY + "success: {visit: up}\n"), []
    whole = rehearse(ready, save=kept.append)
    last: Kept = kept[-1]
    assert last.course.memory.chart.state == "land"
    rows = ready.vehicle.track.rows
    before = rows[rows[:, 0] <= last.course.memory.now + 1e-9]
    done = rehearse(short_stage(STAY + "success: {visit: up}\n"), again=Again(last, before, 0.0))
    assert done.succeeded
    assert done.grade.distance == pytest.approx(whole.grade.distance, abs=0.5)
    assert done.grade.duration == pytest.approx(whole.grade.duration, abs=0.5)
