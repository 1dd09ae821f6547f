"""The optical-flow navigator over simulated flights, graded by the truth."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hovering import HERE, QUIET, observed, through
from rehearsed import HEAD, flown

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.estimation.builder import build
from missionkit.estimation.optical_flow import dead_reckoning
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.geometry import vec
from missionkit.messages import Imu, Observation
from missionkit.recorder import value_codec
from missionkit.rehearsal.stage import stage
from missionkit.sim.vehicle_parameters import FlowModel, Sensors
from missionkit.sim.world import World


def built(**changes):
    return build(FlowKalman(**changes), {"post": (vec(4.0, 1.0, -1.0), 0.2)}, HERE)


@cache
def recorded(seconds=30.0, seed=1, *, still=False, noisy=False):
    return list(observed(seconds, Sensors() if noisy else QUIET, seed, still=still))


def test_with_perfect_sensors_the_position_is_exact():
    navigator = built()
    known, truth = through(navigator, recorded())
    state = navigator.read(known)
    assert np.linalg.norm(truth.position[:2]) > 2.0
    assert state.position == pytest.approx(truth.position, abs=0.15)
    assert state.velocity == pytest.approx(truth.velocity, abs=0.1)
    assert abs(state.attitude @ truth.attitude) > 1 - 1e-3
    assert state.health.aligned
    assert not state.health.diverged


def test_with_noise_the_error_is_what_it_claims():
    ratios = []
    for seed in range(4):
        navigator = built()
        known, truth = through(navigator, recorded(40.0, seed, noisy=True))
        state = navigator.read(known)
        assert state.position[2] == pytest.approx(truth.position[2], abs=0.1)
        ratios += list((state.position - truth.position)[:2] / state.health.position_sd)
    assert 0.3 < np.sqrt(np.mean(np.square(ratios))) < 1.8


def test_it_starts_where_the_map_says_and_waits_there():
    navigator = built(start=(7.0, -3.0))
    known, _ = through(navigator, recorded()[:100])
    state = navigator.read(known)
    assert state.position == pytest.approx([7.0, -3.0, 0.0], abs=1e-3)
    assert state.targets["post"].position == pytest.approx([4.0, 1.0, -1.0])
    assert not navigator.read(navigator.begin()).health.aligned


def warmed(seen: Observation) -> Observation:
    """The gyroscope's bias changes after the alignment."""
    if seen.now < 12.0:
        return seen
    off = vec(0.002, -0.001, 0.0)
    return replace(seen, imu=tuple(s._replace(gyro=s.gyro + off) for s in seen.imu))


def test_the_bias_is_estimated_in_flight_only_if_it_may_be():
    flight = recorded(75.0, still=True)
    found, truth = through(built(), flight, warmed)
    kept, _ = through(built(bias_gain=0.0), flight, warmed)
    assert found.bias == pytest.approx([0.002, -0.001, 0.0], abs=3e-4)
    assert kept.bias == pytest.approx([0.0, 0.0, 0.0], abs=1e-4)
    assert found.mu[:2, 0] == pytest.approx(truth.position[:2], abs=0.12)
    assert np.linalg.norm(kept.mu[:2, 0] - truth.position[:2]) > 0.2


def without_flow(seen):
    return replace(seen, flow=None) if seen.now > 20.0 else seen


def lost_quality(seen):
    gone = seen.now > 20.0 and seen.flow is not None
    return replace(seen, flow=seen.flow._replace(quality=0.1)) if gone else seen


@pytest.mark.parametrize("change", [without_flow, lost_quality])
def test_without_flow_it_says_so_in_time(change):
    navigator, known = built(), built().begin()
    for seen, _ in recorded():
        known = navigator.propagate(known, change(seen))
        health = navigator.read(known).health
        assert health.diverged == (seen.now > 23.0 + 1e-6)
    assert (health.rejected > 100) == (change is lost_quality)
    assert health.position_sd > 0.4  # 0.13 with flow


def test_a_hole_in_the_flow_is_bridged():
    navigator = built()

    def hole(seen: Observation) -> Observation:
        return replace(seen, flow=None) if 20.0 < seen.now < 21.0 else seen

    known, truth = through(navigator, recorded(), hole)
    assert navigator.read(known).position == pytest.approx(truth.position, abs=0.25)


def drifted(seen: Observation) -> Observation:
    """The range finder falls silent, and the barometer has drifted by 0.8 m."""
    if seen.now <= 20.0:
        return seen
    baro = None if seen.baro is None else seen.baro._replace(height=seen.baro.height + 0.8)
    return replace(seen, range=None, baro=baro)


def test_without_ranges_it_reports_its_growing_uncertainty_in_time():
    navigator, known = built(), built().begin()
    for seen, truth in recorded():
        known = navigator.propagate(known, drifted(seen))
        state = navigator.read(known)
        off = np.abs(state.position - truth.position)
        assert state.health.diverged == (seen.now > 23.0 + 1e-6)
        assert off[2] < 3.0 * state.health.height_sd + 0.1
        assert np.hypot(*off[:2]) < 3.0 * state.health.position_sd + 0.1
    assert state.health.height_sd > 0.8
    assert off[2] > 0.4


def test_a_vehicle_without_a_range_finder_flies_by_its_barometer_and_is_surer_of_nothing():
    navigator = built()
    known, _ = through(navigator, recorded(), lambda seen: replace(seen, range=None))
    health = navigator.read(known).health
    assert not health.diverged
    assert health.height_sd > 0.9
    assert health.position_sd > 1.0


def test_silence_of_the_inertial_unit_is_reported():
    navigator = built()
    known, _ = through(
        navigator, recorded(), lambda seen: replace(seen, imu=()) if seen.now > 20.0 else seen
    )
    assert navigator.read(known).health.diverged


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e8])
def test_what_is_not_a_number_is_refused(bad):
    def spoilt(seen: Observation) -> Observation:
        if round(seen.now / 0.05) % 4:
            return seen
        wrong = np.array([bad, bad, bad])
        return replace(
            seen,
            imu=(*seen.imu[:-1], Imu(seen.imu[-1].at, wrong, wrong)),
            flow=None if seen.flow is None else seen.flow._replace(flow=wrong[:2]),
            range=None if seen.range is None else seen.range._replace(distance=bad),
            mag=None if seen.mag is None else seen.mag._replace(field=wrong),
            baro=None if seen.baro is None else seen.baro._replace(height=bad),
        )

    navigator = built()
    known, truth = through(navigator, recorded(), spoilt)
    state = navigator.read(known)
    assert state.position == pytest.approx(truth.position, abs=0.4)
    assert not state.health.diverged


def test_it_knows_its_recent_poses():
    navigator = built()
    known, _ = through(navigator, recorded())
    truths = {round(seen.now / 0.05): truth for seen, truth in recorded()}
    last = max(truths)
    past = navigator.pose_at(known, (last - 5) * 0.05)
    assert past.translation == pytest.approx(truths[last - 5].position, abs=0.2)
    assert navigator.pose_at(known, (last - 20) * 0.05) is None
    assert navigator.pose_at(navigator.begin(), 1.0) is None


def test_a_memory_is_a_value_and_can_be_saved():
    navigator = built()
    known, _ = through(navigator, recorded()[:400])
    text = value_codec.written(known)
    seen = recorded()[400][0]
    after = navigator.propagate(known, seen)
    assert value_codec.written(known) == text
    again = navigator.propagate(value_codec.read(text), seen)
    assert value_codec.written(again) == value_codec.written(after)


def test_flow_alone_sums_up_and_suffers_from_its_own_gyroscope():
    def reckoned(sensors: Sensors) -> float:
        flight = list(observed(60.0, sensors, 2, still=True))
        start = flight[299][1].position[:2]
        known = dead_reckoning.begin(start, np.radians(50.0))
        for seen, _ in flight[300:]:
            known = dead_reckoning.reckoned(known, seen)
        return float(np.linalg.norm(known.position - flight[-1][1].position[:2]))

    assert reckoned(QUIET) < 0.02
    biased = FlowModel(sd=(0, 0), scale=0, gyro_sd=0, gyro_bias=0.01, lost=0)
    assert reckoned(QUIET.model_copy(update={"flow": biased})) > 0.3


def test_a_mission_flies_on_it():
    mission = parse(MISSION, "here", builtin())
    flight = flown(stage(mission, builtin(), World(world="hall"), 4))
    assert flight.result.succeeded
    truth = flight.ready.vehicle.track.rows
    farthest = truth[np.argmax(truth[:, 1]), 1:3]
    assert farthest == pytest.approx([4.0, 0.0], abs=0.8)
    assert flight.records[-1].estimate.health.gnss_at is None


MISSION = (
    HEAD
    + """
navigation: {use: flow_kalman}
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


def test_it_flies_on_filterpy_as_on_its_own_kernels():
    flight = recorded(noisy=True)
    ours, _ = through(built(), flight)
    theirs, _ = through(built(axis_filter="filterpy"), flight)
    assert ours.in_air
    np.testing.assert_allclose(theirs.mu, ours.mu, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(theirs.S, ours.S, rtol=0.0, atol=1e-12)
