"""P3's docking flown: the truth is the judge."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from rehearsed import MISSIONS, flown

from missionkit.chart.load import load, parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import FileError, UsageError
from missionkit.messages import Wrench
from missionkit.outcome import outcome
from missionkit.rehearsal import stage, world_of, world_over_mavlink
from missionkit.sim.fault_injection import parse_fault

FILE = MISSIONS / "docking.yaml"


@cache
def docking(seed=1, *faults):
    mission = load(FILE, builtin())
    world = world_of(mission, MISSIONS)
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
    with pytest.raises(FileError, match=says):
        parse(f"{FILE.read_text()}\n{wanted}\n", str(FILE), builtin())
