"""Several vehicles in the simulator: they hear each other, collide, and do without each other."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest
from fleets import fly_fleet, leg
from rehearsed import MISSIONS

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_loop import Operator
from missionkit.errors import UsageError
from missionkit.outcome import outcome
from missionkit.rehearsal.fleet import member_seed, rehearse_fleet
from missionkit.rehearsal.lockstep import Lockstep
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.world import Wind

CROSSING = ("northbound", "eastbound")


def crossing(**settings):
    catalogue, stages = builtin(), {}
    for number, name in enumerate(CROSSING):
        mission = load(MISSIONS / f"{name}.yaml", catalogue, settings)
        world = world_of(mission, MISSIONS)
        stages[name] = stage(mission, catalogue, world, member_seed(7, number))
    return stages


def test_of_two_that_cross_one_waits_and_both_arrive():
    flown = rehearse_fleet(crossing(), {}, separation=8.0)
    north, east = (flown.flights[name] for name in CROSSING)
    assert [outcome(it) for it in (north, east)] == ["success", "success"]
    assert north.passage.spans["waiting"][0] < east.passage.spans["crossing"][1]
    (met,) = flown.encounters
    assert met.least > 8.0
    assert met.conflicts == 0
    assert not flown.collisions


def test_a_fleet_flies_the_same_every_time_whatever_order_it_is_in():
    def tracks(*names):
        legs = {"a": ("[0, 0]", "[6, 0]", 1), "b": ("[0, 9]", "[6, 9]", 2)}
        stages = {name: leg(*legs[name][:2], seed=legs[name][2]) for name in names}
        fly_fleet(**stages)
        return {name: stages[name].vehicle.track.rows for name in names}

    first, again = tracks("a", "b"), tracks("b", "a")
    for name, rows in first.items():
        assert np.array_equal(rows, again[name])


def test_two_that_meet_head_on_crash_and_a_third_flies_on():
    flown, _ = fly_fleet(
        one=leg("[0, 0]", "[14, 0]", seed=1),
        two=leg("[14, 0]", "[0, 0]", seed=2),
        far=leg("[0, 30]", "[14, 30]", seed=3),
    )
    ((at, first, second),) = flown.collisions
    assert {first, second} == {"one", "two"}
    assert flown.flights["one"].grade.crashed
    assert flown.flights["two"].grade.crashed
    assert flown.flights["far"].grade.landed
    least = {(it.first, it.second): it for it in flown.encounters}[("one", "two")]
    assert least.conflicts == 1
    assert least.at == pytest.approx(at, abs=0.2)


def test_a_vehicle_whose_flight_breaks_off_falls_silent_and_stops_nobody():
    lost = leg("[0, 9]", "[40, 9]", seed=2)

    async def dies(until):
        if until > 6.0:
            raise RuntimeError("the process was killed")
        return lost.vehicle.advance(until)

    lost.vehicle.observe = dies
    flown, heard = fly_fleet(kept=leg("[0, 0]", "[40, 0]", seed=1), lost=lost)
    assert flown.flights["lost"] == "RuntimeError: the process was killed"
    assert flown.flights["kept"].grade.landed
    silent = [v.why for now, v in heard.verdicts("kept") if now > 8.0]
    assert silent
    assert all("lost has been silent for" in why for why in silent)


def test_a_vehicle_that_has_landed_is_no_traffic():
    flown, heard = fly_fleet(
        short=leg("[0, 9]", "[1, 9]", seed=1), long=leg("[0, 0]", "[60, 0]", seed=2)
    )
    _, last = heard.verdicts("long")[-1]
    assert flown.flights["short"].flown.duration < flown.flights["long"].flown.duration
    assert (last.holds, last.why) == (False, "no other vehicle is in the air")


def test_without_its_radio_a_vehicle_neither_hears_nor_is_heard():
    _, heard = fly_fleet(
        one=leg("[0, 0]", "[40, 0]", "traffic_lost@8", seed=1),
        two=leg("[0, 9]", "[40, 9]", seed=2),
    )
    for name, other in (("one", "two"), ("two", "one")):
        before = [v for now, v in heard.verdicts(name) if now <= 8.0]
        after = [v for now, v in heard.verdicts(name) if now > 9.3]
        assert before
        assert after
        assert all(it.value == pytest.approx(9.0, abs=2.5) for it in before)
        assert all(it.why.startswith(f"{other} has been silent") for it in after)


def test_what_is_heard_is_the_others_estimate_at_most_a_fifth_of_a_second_old():
    _, heard = fly_fleet(one=leg("[0, 0]", "[12, 0]", seed=1), two=leg("[0, 9]", "[12, 9]", seed=2))
    said = {round(it.now, 3): it.estimate for it in heard.records["two"]}
    checked = 0
    for record in heard.records["one"]:
        (other,) = record.estimate.traffic
        if other.report is not None and not other.ended:
            assert 0.0 < record.now - other.report.at <= 0.2
            assert np.array_equal(other.report.position, said[round(other.report.at, 3)].position)
            checked += 1
    assert checked > 100


def test_a_landing_that_is_requested_lands_all():
    class Landing(Operator):
        def take(self):
            self.count = getattr(self, "count", 0) + 1
            if self.count == 260:  # 6.5 s of two flights
                self.land()
            return super().take()

    flown, _ = fly_fleet(
        operator=Landing(), one=leg("[0, 0]", "[90, 0]"), two=leg("[0, 9]", "[90, 9]")
    )
    for it in flown.flights.values():
        assert it.flown.aborted
        assert it.grade.landed
        assert it.flown.duration < 20.0


def test_vehicles_that_do_not_fit_together_are_refused():
    here, there = leg("[0, 0]", "[9, 0]"), leg("[0.1, 0]", "[9, 9]")
    with pytest.raises(UsageError, match=r"one and two start 0.10 m apart: give each mission"):
        fly_fleet(one=here, two=there)
    windy = there.world.model_copy(update={"wind": Wind(mean=(1.0, 0.0, 0.0))})
    with pytest.raises(UsageError, match="one and two fly in worlds that differ in wind"):
        fly_fleet(one=here, two=there._replace(world=windy))


def test_lockstep_lets_the_flight_furthest_behind_go_next():
    seen, times = [], []
    steps = Lockstep(2, between=times.append)

    async def flight(number, period, count):
        pace = steps.pace(number)
        for tick in range(1, count + 1):
            await pace.until(tick * period)
            seen.append((number, tick * period))
        steps.leave(number)

    async def together():
        await asyncio.gather(flight(0, 0.5, 2), flight(1, 0.25, 6))

    asyncio.run(together())
    assert seen == [
        *((1, 0.25), (0, 0.5), (1, 0.5), (1, 0.75), (0, 1.0), (1, 1.0), (1, 1.25), (1, 1.5))
    ]
    assert times == [0.0, 0.25, 0.5, 0.75, 1.0, 1.25]
