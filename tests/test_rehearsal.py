"""The precision task flown in the simulator, with what can go wrong; the truth is the judge."""

from __future__ import annotations

import math

import pytest
from rehearsed import MISSIONS, flown, precise, precise_stage, short, short_stage, timeless

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.scaffold import new
from missionkit.engine.flight_end import FlightEnd
from missionkit.errors import UsageError
from missionkit.geometry import norm
from missionkit.messages import Record
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.world import World


def test_the_precision_task_succeeds():
    flight = precise()
    states = [to for to, _ in flight.went()]
    assert states == ["gps", "visual", "task", "return", "land"]
    assert flight.result.succeeded
    visit = flight.result.grade.visit
    assert visit.position_error < 0.1
    assert math.degrees(visit.yaw_error) < 5.0
    assert flight.result.grade.clearance > 0.3
    assert not any("raised" in problem for problem in flight.problems())


def test_the_leg_by_gps_is_longer_than_sixty_metres_and_the_way_home_ends_at_home():
    flight = precise()
    rows = flight.ready.vehicle.track.rows
    visual, landed = (flight.entered(state) for state in ("visual", "land"))
    before = [record for record in flight.records if record.now < visual][-1]
    assert norm(before.estimate.position) > 60.0
    assert norm(rows[-1, 1:4]) < 2.0
    assert rows[-1, 0] - landed < 20.0


def test_the_injector_runs_for_its_three_seconds_at_the_goal_only():
    flight = precise()
    on = [record for record in flight.records if record.command.payload == "injector"]
    assert {record.state for record in on} == {"task"}
    assert len(on) * 0.05 == pytest.approx(3.0, abs=0.1)


def test_every_verdict_is_true_false_or_unknown_and_every_number_is_a_number():
    for record in precise().records:
        for name, verdict in record.verdicts:
            assert verdict.holds in {True, False, None}, name
            assert type(verdict.holds) in {bool, type(None)}, name
            numbers = (verdict.value, verdict.threshold, verdict.margin)
            assert all(n is None or math.isfinite(n) for n in numbers), name


def test_a_seed_gives_the_same_flight_again_and_another_seed_another():
    first, again = precise(), flown(precise_stage())
    assert timeless(again.records) == timeless(first.records)
    assert again.result.grade == first.result.grade
    other = flown(precise_stage(seed=2, limit=6.0))
    assert timeless(other.records[100:110]) != timeless(first.records[100:110])


def sightings(records: list[Record]) -> list[float]:
    """When the trunk was seen (s)."""
    return [seen.at for record in records for seen in record.estimate.sightings]


def test_a_hidden_marker_is_searched_two_seconds_after_it_was_last_seen():
    flight = precise("marker_hidden@visual:3+6")
    lost = flight.entered("visual") + 3.0
    last = max(at for at in sightings(flight.records) if at < lost + 1.0)
    assert lost - last < 0.15
    assert flight.entered("search") - last == pytest.approx(2.0, abs=0.15)
    assert [to for to, _ in flight.went()] == [
        *("gps", "visual", "search", "visual", "task", "return", "land")
    ]
    assert flight.entered("visual", 1) > lost + 6.0
    assert flight.result.succeeded


def test_a_sagging_battery_leads_home_and_down():
    flight = precise("battery_sag=0.8@15")
    assert flight.went()[1:] == [("return", "failsafe battery"), ("land", "when done")]
    assert flight.entered("return") == pytest.approx(15.0, abs=1.1)  # a reading a second
    assert flight.result.flown.end is FlightEnd.LANDED
    assert flight.result.grade.landed
    assert not flight.result.succeeded
    assert norm(flight.ready.vehicle.truth.position) < 3.0


def test_a_lost_link_lands_where_it_is():
    flight = precise("link_lost@15")
    assert flight.went()[1:] == [("land", "failsafe link")]
    assert flight.entered("land") == pytest.approx(18.0, abs=0.3)
    assert flight.result.flown.end is FlightEnd.SILENT
    assert flight.result.grade.landed


def test_without_satellites_the_flight_ends_safely_on_the_ground():
    flight = precise("gnss_lost@15")
    assert flight.result.grade.landed
    assert not flight.result.grade.crashed
    assert flight.result.flown.end is FlightEnd.LANDED


def test_a_camera_that_dies_is_searched_for_then_given_up():
    flight = precise("camera_off@visual:2")
    assert [to for to, _ in flight.went()] == ["gps", "visual", "search", "gps", "return", "land"]
    assert flight.entered("gps", 1) - flight.entered("search") == pytest.approx(30.0, abs=0.1)
    assert flight.result.grade.landed
    assert not flight.result.succeeded


HOP = """\
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 2}, transitions: [{to: up, when: done}]}
  up: {kind: custom, transitions: [{to: land, after: 2}]}
  side: {kind: custom, transitions: [{to: land, after: 1}]}
  land: {kind: land}
"""


@pytest.mark.parametrize(("visit", "succeeds"), [("up", True), ("side", False)])
def test_success_without_a_target_is_to_have_been_there(visit, succeeds):
    flight = flown(short_stage(HOP + f"success: {{visit: {visit}}}\n"))
    assert flight.result.grade.landed
    assert flight.result.succeeded is succeeds


def test_a_mission_without_success_succeeds_by_landing():
    assert flown(short_stage(HOP)).result.succeeded


def test_a_mission_without_a_world_is_rehearsed_over_an_empty_field(tmp_path):
    path, _ = new("mission", "first", tmp_path)
    named = load(path, builtin())
    assert len(world_of(named, tmp_path).obstacles) == 1
    assert world_of(named.model_copy(update={"world": None}), tmp_path).obstacles == ()
    assert world_of(load(MISSIONS / "precision_task.yaml", builtin()), MISSIONS).world == "orchard"


def test_a_world_that_starts_in_a_wall_of_the_map_is_refused():
    walls = "polygons: [[[3, 0], [4, 0], [4, 4], [3, 4]]]"
    land = "initial: land\nstates: {land: {kind: land}}\n"
    mission = short(f"map: {{north: [-2, 8], east: [-2, 8], {walls}}}\n{land}")
    for start, why in (((3.5, 2.0), "inside a wall of the map"), ((20.0, 0.0), "outside the map")):
        with pytest.raises(UsageError, match=why):
            stage(mission, builtin(), World(world="field", start=start), 1)
