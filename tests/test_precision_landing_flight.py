"""The precision landing flown: without satellites, by its markers; the truth is the judge."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from rehearsed import MISSIONS, flown, killed, timeless

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.prepared_mission import prepare
from missionkit.planning.rotor_power import RotorPower
from missionkit.rehearsal.rehearse import Again, rehearse
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.fault_injection import parse_fault

MISSION = MISSIONS / "precision_landing.yaml"


@cache
def landed(*faults, seed=1, camera="corners", settings=()):
    mission = load(MISSION, builtin(), dict(settings))
    eye = mission.camera.model_copy(update={"use": camera})
    mission = mission.model_copy(update={"camera": eye})
    world = world_of(mission, MISSIONS)
    return flown(stage(mission, builtin(), world, seed, tuple(map(parse_fault, faults))))


def missed(flight):
    """How far from the middle of the pad it stands, in truth (m)."""
    pad = flight.ready.world.marker(227).position
    return float(np.hypot(*(flight.ready.vehicle.truth.position[:2] - pad[:2])))


def states(flight):
    return [to for to, _ in flight.went()]


@pytest.mark.parametrize("camera", ["corners", "rendered"])
def test_it_lands_on_the_pad_by_what_the_camera_sees(camera):
    flight = landed(camera=camera)
    assert states(flight) == ["ready", "glide", "descend", "land"]
    assert flight.result.succeeded
    assert missed(flight) < 0.15
    assert {record.estimate.health.gnss_at for record in flight.records} == {None}
    assert flight.problems() == []


def test_it_touches_the_ground_gently_and_once():
    rows = landed().ready.vehicle.track.rows
    last = np.flatnonzero(rows[:, 14] == 0.0)[-1]
    assert rows[last, 6] < 1.0
    assert landed().result.grade.touched_at is None


def test_no_lower_than_the_uncertainty_allows_before_the_pad_was_seen():
    flight = landed()
    for record in flight.records:
        pad = record.estimate.targets["pad"]
        if record.state == "glide" and pad.seen_at is None:
            assert record.estimate.position[2] < -1.4


def test_a_covered_pad_makes_it_deviate_and_it_lands_once_the_pad_appears():
    flight = landed("marker_hidden@glide+9")
    assert states(flight) == ["ready", "glide", "deviate", "descend", "land"]
    assert flight.result.succeeded
    assert missed(flight) < 0.15


def test_the_rule_says_why_it_deviated():
    flight = landed("marker_hidden@glide+9")
    to = next(i for i, r in enumerate(flight.records) if any(f.to == "deviate" for f in r.fired))
    verdicts = dict(flight.records[to].verdicts)
    rule = next(v for v in verdicts.values() if "deviate to glide" in v.why)
    assert rule.value <= rule.threshold == 0.25
    assert "glide to deviate" in rule.why


def test_without_a_pad_it_climbs_to_look_and_goes_home():
    flight = landed("marker_hidden@ready")
    assert states(flight) == ["ready", "glide", "deviate", "back", "land"]
    assert not flight.result.succeeded
    assert flight.result.flown.end is FlightEnd.LANDED
    assert flight.result.grade.landed
    heights = [-r.estimate.position[2] for r in flight.records if r.state == "deviate"]
    assert heights[-1] > 4.0
    assert np.hypot(*flight.ready.vehicle.truth.position[:2]) < 1.5


def test_satellites_that_go_wrong_are_not_listened_to():
    flight = landed("gnss_jump=40@ready")
    assert flight.result.succeeded
    assert missed(flight) < 0.15


def test_the_cone_that_is_sure_to_be_in_view_is_that_of_the_missions_camera():
    """480 px at a focal length of 300 px, tilted down by 68 degrees: the lower edge is nearest."""
    chart = prepare(load(MISSION, builtin()), builtin()).chart
    angle = chart.states["glide"].behavior.half_angle_deg
    assert angle == pytest.approx(np.degrees(np.arctan(240.0 / 300.0)) - 22.0, abs=0.1)


def test_the_mission_plans_with_the_rotors_of_its_world():
    mission = load(MISSION, builtin())
    frame = world_of(mission, MISSIONS).quadrotor
    for name in ("glide", "deviate", "descend"):
        flown = mission.by_name()[name].state.behavior.plugin
        assert (flown.rotors or RotorPower()) == frame.rotors
        assert (flown.mass, flown.drag) == (frame.mass, frame.drag_quadratic)


@pytest.mark.parametrize(
    ("state", "gap", "on_the_pad"),
    [("glide", 0.2, True), ("descend", 0.5, True), ("glide", 2.0, False)],
)
def test_a_landing_that_was_killed_lands_after_it_was_resumed(state, gap, on_the_pad):
    """Without satellites and before the pad was seen, a long gap leaves no position: it lands."""
    mission, world = landed().ready.mission, landed().ready.world
    inside = []

    def late(each):
        if each.course.memory.chart.state == state:
            inside.append(each.course.memory.now)
        return bool(inside) and each.course.memory.now > inside[0] + 0.6

    kept, before = killed(stage(mission, builtin(), world, 1), late)
    again = stage(mission, builtin(), world, 1)
    result = rehearse(again, again=Again(kept, before, gap))
    assert result.flown.end is FlightEnd.LANDED
    assert not again.vehicle.truth.crashed
    assert result.succeeded is on_the_pad


def test_the_same_seed_gives_the_same_flight():
    again = flown(stage(landed().ready.mission, builtin(), landed().ready.world, 1))
    assert timeless(again.records[::20]) == timeless(landed().records[::20])
