"""The tick is a pure function: what was observed decides what is done, to the bit."""

from __future__ import annotations

import pickle

import pytest
from rehearsed import Flight, plain, precise, timeless

from missionkit.engine.flight_state import FlightMemory
from missionkit.engine.prepared_mission import PreparedMission, begin
from missionkit.engine.tick import tick
from missionkit.messages import Observation, Record
from missionkit.plugin_containment import Containment

SAVED_AT = 620  # ticks; in the middle of visual servoing


@pytest.fixture(scope="module")
def flight() -> Flight:
    return precise()


def replayed(
    plan: PreparedMission, memory: FlightMemory, observations: list[Observation]
) -> tuple[FlightMemory, list[Record]]:
    records = []
    for observation in observations:
        done = tick(plan, memory, observation, Containment())
        memory = done.memory
        records.append(done.record)
    return memory, records


@pytest.fixture(scope="module")
def saved(flight: Flight) -> FlightMemory:
    memory, _ = replayed(
        flight.ready.plan, begin(flight.ready.plan), flight.observations[:SAVED_AT]
    )
    return memory


def test_a_flight_replays_from_its_observations(flight: Flight):
    _, records = replayed(flight.ready.plan, begin(flight.ready.plan), flight.observations[:200])
    assert timeless(records) == timeless(flight.records[:200])


def test_a_flight_continues_from_a_memory_saved_midway(flight: Flight, saved: FlightMemory):
    restored = pickle.loads(pickle.dumps(saved))  # noqa: S301
    later = slice(SAVED_AT, SAVED_AT + 200)
    _, records = replayed(flight.ready.plan, restored, flight.observations[later])
    assert records[0].state == "visual"
    assert sum(len(record.estimate.sightings) for record in records) > 150
    assert timeless(records) == timeless(flight.records[later])


def test_a_tick_leaves_memory_and_observation_as_they_were(flight: Flight, saved: FlightMemory):
    before = plain(saved), pickle.dumps(saved)
    for observation in flight.observations[SAVED_AT : SAVED_AT + 5]:
        seen = plain(observation)
        tick(flight.ready.plan, saved, observation, Containment())
        assert (plain(saved), pickle.dumps(saved)) == before
        assert plain(observation) == seen


def test_the_observation_matters(flight: Flight, saved: FlightMemory):
    plan, observation = flight.ready.plan, flight.observations[SAVED_AT]
    blind = Observation(observation.now)
    first, second = (tick(plan, saved, seen, Containment()) for seen in (observation, blind))
    assert plain(first.record.estimate) != plain(second.record.estimate)


def test_the_three_parts_are_timed_with_the_stopwatch_that_is_passed_in(flight: Flight):
    laps = iter([1.0, 1.25, 1.75, 1.875])
    plan = flight.ready.plan
    done = tick(plan, begin(plan), flight.observations[0], Containment(), lambda: next(laps))
    assert done.took == (0.25, 0.5, 0.125)
    assert tick(plan, begin(plan), flight.observations[0], Containment()).took == (0.0, 0.0, 0.0)


def test_on_entry_the_behaviour_sees_the_new_state(flight: Flight):
    for record in flight.records:
        if record.fired:
            assert record.estimate.state == record.state == record.fired[-1].to
            assert record.estimate.entered_at == record.now
            assert (record.estimate.done, record.estimate.goal) == (False, None)


def test_a_lasting_failure_is_reported_once(flight: Flight):
    plan, memory = flight.ready.plan, begin(flight.ready.plan)
    reported = []
    for observation in flight.observations[:3]:
        contain = Containment()
        contain.note("gust raised ValueError: no")
        done = tick(plan, memory, observation, contain)
        memory = done.memory
        reported.append(done.record.problems)
        assert memory.acting.failing == ("gust raised ValueError: no",)
    assert reported == [("gust raised ValueError: no",), (), ()]
