"""Poses measured from outside: in the simulator, in the filter, and when they are lost."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hovering import HERE, LEGS
from rehearsed import HEAD, flown

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.geometry import exp, multiply, vec
from missionkit.messages import Action, Command, Observation, Setpoint
from missionkit.perception.camera_section import Camera
from missionkit.rehearsal.stage import stage
from missionkit.sim import vehicle_snapshot
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.vehicle_parameters import ExternalPoseModel, Sensors
from missionkit.sim.world import World

STUDIO = World(world="studio", sensors=Sensors(external_pose=ExternalPoseModel()))
BLIND = Camera(use="none")


@cache
def recorded(fault: str = ""):
    """Rest, take off at 3 s, from 8 s on fly legs; no satellites."""
    faults = (parse_fault(fault),) if fault else ()
    vehicle, flight = SimulatedVehicle(STUDIO, BLIND, 1, faults), []
    for tick in range(1, 401):
        seen = replace(vehicle.advance(tick * 0.05), gnss=None)
        if tick == 60:
            vehicle.apply(Command(action=Action.ARM))
        elif tick == 62:
            vehicle.apply(Command(action=Action.TAKE_OFF, height=2.0))
        elif tick >= 160:
            leg = LEGS[(tick - 160) // 100 % len(LEGS)]
            vehicle.apply(Command(Setpoint(np.array(leg), 0.2)))
        flight.append((seen, vehicle.truth))
    return flight


def through(flight, change=lambda seen: seen, **settings):
    navigator = build(VisualInertialEkf(gnss=False, **settings), {}, HERE)
    known = navigator.begin()
    for seen, _ in flight:
        known = navigator.propagate(known, change(seen))
    return navigator.read(known), flight[-1][1]


def test_with_motion_capture_the_estimate_is_as_good_as_that():
    state, truth = through(recorded(), external_pose=True)
    assert np.linalg.norm(truth.position[:2]) > 1.0
    assert state.position == pytest.approx(truth.position, abs=0.02)
    assert state.velocity == pytest.approx(truth.velocity, abs=0.05)
    assert abs(state.attitude @ truth.attitude) > 1 - 1e-4
    assert state.health.placed
    assert not state.health.diverged
    assert state.health.mahalanobis == pytest.approx(0.9, abs=0.35)


def test_a_mission_that_does_not_ask_for_them_flies_without():
    state, _ = through(recorded())
    assert not state.health.placed
    assert state.health.position_sd > 3.0


def test_poses_that_jump_are_refused_and_lost_ones_are_missed():
    def jumping(seen: Observation) -> Observation:
        pose = seen.external_pose
        if pose is None or not 12.0 < seen.now < 12.5:
            return seen
        turn = multiply(exp(vec(0.0, 0.0, 1.5)), pose.attitude)
        wrong = pose._replace(position=pose.position + 3.0, attitude=turn)
        return replace(seen, external_pose=wrong)

    state, truth = through(recorded(), jumping, external_pose=True)
    assert state.position == pytest.approx(truth.position, abs=0.02)
    sooner, _ = through(recorded("external_pose_lost@12")[:245], external_pose=True)
    later, _ = through(recorded("external_pose_lost@12"), external_pose=True, max_position_sd=1.0)
    assert sooner.health.placed
    assert not later.health.placed
    assert later.health.diverged
    assert later.health.cause == f"the position is only known to {later.health.position_sd:.0f} m"


@pytest.mark.parametrize("bad", [np.nan, np.inf, 0.0, 1e9])
def test_what_is_no_pose_is_refused(bad):
    def spoilt(seen: Observation) -> Observation:
        pose = seen.external_pose
        if pose is None or round(seen.now / 0.05) % 3:
            return seen
        place = pose.position if bad == 0.0 else np.full(3, bad)
        return replace(seen, external_pose=pose._replace(position=place, attitude=np.full(4, bad)))

    state, _ = through(recorded()[:250], spoilt, external_pose=True)
    assert state.position == pytest.approx(recorded()[249][1].position, abs=0.03)
    assert not state.health.diverged


def test_the_simulator_says_the_same_again_after_a_snapshot():
    first = SimulatedVehicle(STUDIO, BLIND, 3)
    poses = [first.advance(0.05 * n).external_pose for n in range(1, 30)]
    assert all(pose is not None for pose in poses[1:])
    again = SimulatedVehicle(STUDIO, BLIND, 3)
    vehicle_snapshot.restore(again, vehicle_snapshot.taken(first))
    one, two = first.advance(1.5).external_pose, again.advance(1.5).external_pose
    np.testing.assert_array_equal(one.position, two.position)
    assert one.at == two.at == pytest.approx(1.45)
    assert SimulatedVehicle(World(world="field"), BLIND, 3).advance(1.0).external_pose is None


def test_a_mission_flies_on_it_and_lands_when_it_is_lost():
    mission = parse(MISSION, "here", builtin())
    flight = flown(stage(mission, builtin(), STUDIO, 4))
    assert flight.result.succeeded
    truth = flight.ready.vehicle.track.rows
    farthest = truth[np.argmax(truth[:, 1]), 1:3]
    assert farthest == pytest.approx([4.0, 0.0], abs=0.4)
    lost = flown(stage(mission, builtin(), STUDIO, 4, (parse_fault("external_pose_lost@there:1"),)))
    assert "lost" in " ".join(reason for _, reason in lost.went())
    assert lost.ready.vehicle.truth.on_ground


MISSION = (
    HEAD
    + """
navigation: {use: visual_inertial_ekf, gnss: false, external_pose: true, max_position_sd: 1}
failsafes: [{name: lost, when: estimate_bad, for: 0.2, to: land}]
targets: {there: {position: [4, 0, -2]}}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2}
    transitions: [{to: there, when: done}]
  there:
    kind: return
    behavior: {use: go_to, target: there, height: 2, speed: 0.5, within: 0.3}
    transitions: [{to: land, when: done}, {to: land, after: 60}]
  land: {kind: land}
"""
)
