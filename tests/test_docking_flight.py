"""P3's docking flown: the truth is the judge."""

from __future__ import annotations

import math
import re
from functools import cache

import numpy as np
import pytest
from rehearsed import MISSIONS, flown

from missionkit.chart.load import load, parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import FileError, UsageError
from missionkit.geometry import norm
from missionkit.messages import Wrench
from missionkit.outcome import outcome, reason
from missionkit.rehearsal.stage import stage, world_of, world_over_mavlink
from missionkit.sim.fault_injection import parse_fault

FILE = MISSIONS / "docking.yaml"
PAPER = {"accel_noise": "0.0071"}  # of P3's filter


@cache
def docking(seed=1, *faults, start=None, **settings):
    """Fly the mission; `start` is place (m) and angles (deg), which the filter is given too."""
    if start is not None:
        place, angles = map(list, start)
        settings |= {"start": str(place), "start_attitude_deg": str(angles)}
    mission = load(FILE, builtin(), settings)
    world = world_of(mission, MISSIONS)
    if start is not None:
        pose = {"position": start[0], "attitude_deg": start[1]}
        world = world.model_copy(update={"start": world.start.model_copy(update=pose)})
    return flown(stage(mission, builtin(), world, seed, tuple(map(parse_fault, faults))))


def test_it_docks_within_a_centimetre_and_a_degree():
    flight = docking()
    grade = flight.result.grade.docking
    assert flight.result.succeeded
    assert grade.docked
    assert not grade.crashed
    assert grade.position_error < 0.01
    assert math.degrees(grade.attitude_error) < 1.0
    assert grade.separation > 0.0
    assert [to for to, _ in flight.went()][-3:] == ["dock", "docked", "land"]


def entered(flight):
    return [to for to, _ in flight.went()]


def distance(flight, state):
    """Return how far from the target it believes to be as it enters a state (m)."""
    record = next(it for it in flight.records if any(fired.to == state for fired in it.fired))
    return norm(record.estimate.position - record.estimate.targets["target"].position)


def test_by_fixed_distances_it_turns_and_comes_round_where_the_mission_says():
    flight = docking(rule="fixed")
    assert flight.result.succeeded
    assert entered(flight) == ["staged", "reorient", "align", "dock", "docked", "land"]
    assert distance(flight, "reorient") == pytest.approx(0.8, abs=0.02)
    assert distance(flight, "align") == pytest.approx(0.3, abs=0.02)
    assert flight.entered("docked") > docking().entered("docked") + 10.0


def test_by_algorithm_1_kept_out_it_turns_later_and_docks():
    flight = docking(rule="markov", **PAPER)
    assert flight.result.succeeded
    assert entered(flight) == ["staged", "reorient", "align", "dock", "docked", "land"]
    assert 0.55 < distance(flight, "reorient") < 0.75
    assert 0.17 < distance(flight, "align") < 0.25


def test_algorithm_1_as_printed_hits_the_target():
    flight = docking(rule="markov_printed", **PAPER)
    grade = flight.result.grade.docking
    assert outcome(flight.result) == "crash"
    assert reason(flight.result) == "hit the target"
    assert grade.crashed
    assert grade.separation < 0.0


def test_it_skips_the_alignment_when_the_camera_sees_the_target_early():
    flight = docking(rule="fixed", start=((0.85, 1.1, 0.9), (-60.0, 0.0, -90.0)))
    assert flight.result.succeeded
    assert entered(flight) == ["staged", "reorient", "dock", "docked", "land"]


@pytest.mark.parametrize(
    "start",
    [
        ((0.8, 1.2, 0.4), (170.0, -80.0, 30.0)),
        ((1.0, 0.9, 0.5), (90.0, 45.0, 0.0)),
    ],
)
def test_it_docks_from_other_poses(start):
    flight = docking(2, start=start)
    assert flight.result.succeeded
    assert flight.result.grade.docking.separation > 0.0


def test_it_docks_to_the_face_that_looks_away_round_the_target():
    flight = docking(face="bottom", world="worlds/docking_far.yaml")
    grade = flight.result.grade.docking
    assert flight.result.succeeded
    assert grade.separation > 0.0
    assert grade.keep_out_time == 0.0


def test_a_rule_that_is_not_known_is_refused():
    with pytest.raises(FileError, match="did you mean 'markov_safe'"):
        load(FILE, builtin(), {"rule": "markov_save"})


def test_only_finite_wrenches_within_its_limits_are_commanded():
    sent = [it.command.setpoint for it in docking().records if it.command.setpoint is not None]
    assert len(sent) > 1000
    assert all(isinstance(one, Wrench) for one in sent)
    forces, torques = (np.array(part) for part in zip(*sent, strict=True))
    assert np.abs(forces).max() <= 0.1 + 1e-9
    assert np.abs(torques).max() <= 0.002 + 1e-9


def test_outliers_among_the_ranges_do_not_keep_it_from_docking():
    assert docking(2, "uwb_outliers=0.1").result.succeeded


def test_without_its_camera_it_tries_three_times_and_ends_clear_of_the_target():
    flight = docking(1, "camera_off")
    assert outcome(flight.result) == "ended_safely"
    assert not flight.result.grade.docking.docked
    assert reason(flight.result) == "holding clear without reaching docked"
    assert [to for to, _ in flight.went()][-2:] == ["back", "land"]


def test_a_failed_battery_leads_to_the_safe_end():
    flight = docking(1, "battery_sag=0.9@50")
    assert outcome(flight.result) == "ended_safely"
    assert flight.result.grade.docking.centre_distance > 0.2


def test_a_free_flyer_is_not_flown_over_mavlink():
    with pytest.raises(UsageError, match="in the simulator only"):
        world_over_mavlink(load(FILE, builtin()), MISSIONS)


def test_a_world_of_another_vehicle_is_refused():
    text = FILE.read_text().replace("worlds/docking.yaml", "worlds/orchard.yaml")
    mission = parse(text, str(FILE), builtin())
    with pytest.raises(FileError, match="is for vehicle 'sim', not for 'free_flyer'"):
        world_of(mission, MISSIONS)


@pytest.mark.parametrize(
    ("wanted", "says"),
    [
        ("control: {use: velocity_pid}", "gives a velocity, but vehicle 'free_flyer'"),
        ("control: {max_force: -1}", "max_force"),
    ],
)
def test_a_controller_that_does_not_fit_is_refused(wanted, says):
    text = FILE.read_text()
    text = re.sub(r"(?m)^ +(effort|slew): .*\n", "", text)
    text = re.sub(r"(?m)^control: .*$", wanted, text)
    with pytest.raises(FileError, match=says):
        parse(text, str(FILE), builtin())


def test_a_navigator_of_another_vehicle_is_refused():
    text = FILE.read_text()
    head, rest = text.split("navigation:\n")
    rest = rest[rest.index("\ntargets:") :]
    head = re.sub(r"(?m)^  (accelerometer|accel_noise|start|start_attitude_deg): .*\n", "", head)
    text = f"{head}navigation: visual_inertial_ekf{rest}"
    with pytest.raises(FileError, match=r"for vehicle 'sim', but .* 'free_flyer': use tandem_ekf"):
        parse(text, str(FILE), builtin())


def test_a_free_flyers_navigator_is_refused_for_a_multicopter():
    anchors = "anchors: {a: [0, 0, 0], b: [1, 0, 0], c: [0, 1, 0]}, position: [0, 0, 0]"
    text = (MISSIONS / "marker_inspection.yaml").read_text()
    text = text.replace("use: visual_inertial_ekf", f"use: tandem_ekf, {anchors}")
    with pytest.raises(FileError, match="for vehicle 'free_flyer', but the mission's is 'sim'"):
        parse(text, "mast.yaml", builtin())
