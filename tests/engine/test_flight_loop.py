"""The shell around the tick: how flights end, and what the vehicle and the observers get."""

from __future__ import annotations

import asyncio
import signal
from dataclasses import replace
from itertools import count
from typing import Any

import pytest
from rehearsed import flown, short_stage
from typing_extensions import override

from missionkit.api import interrupts
from missionkit.engine import flight_end, flight_loop
from missionkit.engine.flight_end import FlightEnd, FlownFlight
from missionkit.engine.flight_loop import Observer, Operator, fly
from missionkit.errors import UsageError, VehicleError
from missionkit.messages import Action, Command, Observation, Record
from missionkit.plugin_containment import Interrupted
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage
from missionkit.sim.simulated_vehicle import SimulatedVehicle

HOP = """\
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 2}, transitions: [{to: up, when: done}]}
  up: {kind: custom, transitions: [{to: land, after: %s}]}
  land: {kind: land}
"""
STAY = HOP % 999
HOP = HOP % 2
LISTENING = STAY.replace("after: 999}", "after: 999}, {to: land, event: enough}")
ENDING = STAY.replace("{to: land, after: 999}", "{to: over, after: 1}") + "  over: {final: true}\n"


RETURNING = """\
initial: up
states:
  up: {kind: idle, behavior: {use: take_off, height: 3}, transitions: [{to: back, when: done}]}
  back: {kind: land, behavior: hold, entry: [{vehicle: return}]}
  never: {kind: custom, behavior: hold, transitions: [{to: back, after: 5}]}
"""


class Around:
    """A vehicle around the simulated one; what it changes is up to its heirs."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self.vehicle = vehicle
        self.calls: list[str] = []
        self.commands: list[Command] = []

    async def connect(self) -> None:
        self.calls.append("connect")

    async def observe(self, until: float) -> Observation:
        self.calls.append("observe")
        return self.vehicle.advance(until)

    async def send(self, command: Command) -> None:
        self.calls.append("send")
        self.commands.append(command)
        self.vehicle.apply(command)

    async def close(self) -> None:
        self.calls.append("close")


class Disarming(Around):
    """Says from 8 s on that it stands disarmed."""

    @override
    async def observe(self, until: float) -> Observation:
        seen = await super().observe(until)
        if until < 8.0 or seen.status is None:
            return seen
        return replace(seen, status=seen.status._replace(armed=False, in_air=False))


class Stubborn(Around):
    """Does not land."""

    @override
    async def send(self, command: Command) -> None:
        await super().send(Command() if command.action is Action.LAND else command)


def flight_of(
    ready: Stage, vehicle: Around, *observers: Observer, **options: Any
) -> tuple[FlownFlight, list[Record]]:
    records: list[Record] = []
    observers = (*observers, lambda record, _: records.append(record))
    return asyncio.run(fly(ready.plan, vehicle, observers, **options)), records


def went(records: list[Record]) -> list[tuple[str, str]]:
    return [(fired.to, fired.reason) for r in records for fired in r.fired]


def test_a_flight_ends_when_it_has_landed():
    ready = short_stage(HOP)
    flight = flown(ready)
    assert (flight.result.flown.end, flight.result.flown.aborted) == (FlightEnd.LANDED, False)
    assert flight.went() == [("up", "when done"), ("land", "after 2 s")]
    assert flight.result.succeeded
    assert ready.vehicle.truth.on_ground
    last = flight.records[-1]
    assert not last.estimate.status.armed
    assert flight.result.flown.duration == last.now
    assert flight.result.flown.ticks == len(flight.records)
    assert flight.result.flown.memory.now == last.now


def test_the_vehicle_is_connected_observed_and_commanded_once_a_tick_and_closed():
    ready = short_stage(HOP)
    vehicle = Around(ready.vehicle)
    done, records = flight_of(ready, vehicle)
    assert vehicle.calls == ["connect", *["observe", "send"] * done.ticks, "close"]
    assert vehicle.commands == [record.command for record in records]
    assert [record.now for record in records] == [n * 0.05 for n in range(1, done.ticks + 1)]


def test_when_time_is_up_the_mission_lands():
    ready = short_stage(STAY)
    done, records = flight_of(ready, Around(ready.vehicle), time_limit=8.0)
    assert went(records) == [("up", "when done"), ("land", "operator: land")]
    assert next(r.now for r in records if r.state == "land") == 8.0
    assert (done.end, done.aborted) == (FlightEnd.LANDED, True)


class Impatient(Operator):
    """Wants down from 6 s on."""

    def __call__(self, record: Record, _: Observation) -> None:
        if record.now > 6.0:
            self.land()


def test_the_operator_lands_at_the_next_tick():
    ready, operator = short_stage(STAY), Impatient()
    done, records = flight_of(ready, Around(ready.vehicle), operator, operator=operator)
    assert went(records)[-1] == ("land", "operator: land")
    assert next(r.now for r in records if r.state == "land") == pytest.approx(6.1)
    assert (done.end, done.aborted) == (FlightEnd.LANDED, True)


class Calling(Operator):
    """Sends the chart an event at 5 s."""

    def __call__(self, record: Record, _: Observation) -> None:
        if record.now == pytest.approx(5.0):
            self.send("enough.now")


def test_an_operators_event_is_handled_at_the_next_tick_only():
    ready, operator = short_stage(LISTENING), Calling()
    _, records = flight_of(ready, Around(ready.vehicle), operator, operator=operator)
    assert [r.now for r in records for fired in r.fired if fired.to == "land"] == [
        pytest.approx(5.05)
    ]
    assert "on enough" in [fired.reason for r in records for fired in r.fired]


def test_an_invalid_event_is_refused():
    with pytest.raises(UsageError, match="event 'operator: land': expected words joined by"):
        Operator().send("operator: land")


def test_a_chart_that_has_ended_in_the_air_lands():
    ready = short_stage(ENDING)
    done, records = flight_of(ready, Around(ready.vehicle))
    assert went(records)[-1] == ("land", "the chart has ended in the air")
    assert done.end is FlightEnd.LANDED


def test_landing_before_the_start_never_takes_off():
    ready = short_stage(HOP)
    operator = Operator()
    operator.land()
    done, records = flight_of(ready, Around(ready.vehicle), operator=operator)
    assert (done.end, done.aborted) == (FlightEnd.NEVER_LEFT, True)
    assert done.duration < 1.0
    assert {record.command.action for record in records} <= {Action.LAND, None}


def test_a_vehicle_that_disarms_in_flight_ends_it_after_three_seconds():
    ready = short_stage(STAY)
    done, _ = flight_of(ready, Disarming(ready.vehicle))
    assert done.end is FlightEnd.GROUNDED
    assert done.duration == pytest.approx(11.0, abs=0.3)  # heartbeats come at 5 Hz


def test_a_return_that_the_chart_has_ordered_ends_like_a_landing():
    ready = short_stage(RETURNING)
    flight = flown(ready)
    assert flight.result.flown.end is FlightEnd.LANDED
    assert flight.result.succeeded
    assert not flown(short_stage(RETURNING + "success: {visit: never}\n")).result.succeeded


def test_an_abort_has_its_limit(monkeypatch):
    monkeypatch.setattr(flight_end, "LONGEST_ABORT", 4.0)
    ready = short_stage(STAY)
    done, _ = flight_of(ready, Stubborn(ready.vehicle), time_limit=8.0)
    assert (done.end, done.duration) == (FlightEnd.OUT_OF_TIME, 12.0)


def test_a_vehicle_that_has_fallen_silent_while_landing_is_given_up():
    flight = flown(short_stage(HOP, "link_lost@6"))
    assert flight.result.flown.end is FlightEnd.SILENT
    assert flight.result.flown.duration == pytest.approx(126.0, abs=0.3)
    assert not flight.result.succeeded
    assert flight.result.grade.landed  # as the truth has it


@pytest.mark.parametrize("believed", [False, True])
def test_overruns_are_counted_and_used_only_on_request(monkeypatch, believed):
    laps = count()
    # Four readings of the stopwatch a tick: three parts of 16 ms, from the 20th tick on of 20 ms.
    monkeypatch.setattr(flight_loop, "stopwatch", lambda: clock_at(next(laps)))
    ready = short_stage(HOP)
    done, records = flight_of(ready, Around(ready.vehicle), believe_stopwatch=believed)
    assert [record.cycle.overruns for record in records[17:22]] == [0, 0, 0, 1, 2]
    assert records[-1].cycle.overruns == done.ticks - 20
    assert records[30].cycle.total == pytest.approx(0.06)
    guards_see = [record.estimate.cycle.overruns for record in records[18:24]]
    assert guards_see == ([0, 0, 0, 1, 2, 3] if believed else [0] * 6)


def clock_at(reading: int) -> float:
    tick, part = divmod(reading, 4)
    return tick + part * (0.016 if tick < 20 else 0.02)


def test_the_pace_is_called_before_every_tick():
    asked: list[float] = []

    class Pace:
        async def until(self, at: float) -> None:
            asked.append(at)

    ready = short_stage(HOP)
    _, records = flight_of(ready, Around(ready.vehicle), pace=Pace())
    assert asked == [record.now for record in records]


def test_an_unreachable_vehicle_is_reported_to_the_caller():
    class Gone(Around):
        @override
        async def connect(self) -> None:
            raise VehicleError("no heartbeat")

    ready = short_stage(HOP)
    with pytest.raises(VehicleError, match="no heartbeat"):
        flight_of(ready, Gone(ready.vehicle))


def test_an_observer_that_raises_ends_no_flight_and_is_raised_when_it_is_over():
    ready, states = short_stage(HOP), []

    def fails(record: Record, _: Observation) -> None:
        raise ValueError(f"no idea at {record.now:g} s")

    def watches(record: Record, _: Observation) -> None:
        states.append((record.state, record.problems))

    with pytest.raises(ValueError, match=r"no idea at 0\.05 s"):
        asyncio.run(fly(ready.plan, ready.vehicle, (fails, watches)))
    assert states[-1][0] == "land"
    reported = [problem for _, problems in states for problem in problems]
    assert reported == ["observer 1 raised ValueError: no idea at 0.05 s; the flight continues"]


def test_an_observer_that_raises_what_ends_a_program_ends_no_flight():
    ready, states = short_stage(HOP), []

    def fails(record: Record, _: Observation) -> None:
        states.append(record.state)
        raise SystemExit

    with pytest.raises(SystemExit):
        asyncio.run(fly(ready.plan, ready.vehicle, (fails,)))
    assert states[-1] == "land"


def test_what_raises_is_left_to_those_who_take_reports():
    ready = short_stage(HOP)

    def fails(*_: object) -> None:
        raise ValueError("no disk")

    flown = asyncio.run(fly(ready.plan, ready.vehicle, keeper=fails, reports=lambda: ()))
    assert flown.end is FlightEnd.LANDED


@pytest.mark.parametrize("number", interrupts.STOPPING)
def test_a_signal_lands_the_vehicle(number):
    ticks, operator = count(), Operator()

    def watch(*_):
        if next(ticks) in {40, 41}:  # two at once count as one
            signal.raise_signal(number)

    with interrupts.landing_on_interrupt(operator):
        result = rehearse(short_stage(STAY), (watch,), operator=operator)
    assert result.flown.end is FlightEnd.LANDED
    assert result.flown.aborted


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_second_signal_that_a_destructor_swallows_stops_the_program(monkeypatch):
    monkeypatch.setattr(interrupts, "SAME_KEYPRESS", -1.0)
    ticks, operator = count(), Operator()

    class Dying:
        def __del__(self):
            signal.raise_signal(signal.SIGTERM)

    def watch(*_):
        tick = next(ticks)
        if tick == 40:
            signal.raise_signal(signal.SIGTERM)
        elif tick == 45:
            Dying()

    with interrupts.landing_on_interrupt(operator), pytest.raises(Interrupted):
        rehearse(short_stage(STAY), (watch,), operator=operator)
    assert operator.wants_down
    assert next(ticks) == 46
