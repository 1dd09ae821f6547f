from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from missionkit.geometry import conjugate, exp, from_euler, multiply, rotate, yaw_of
from missionkit.messages import Observation
from missionkit.sim.ground_truth import TrueState
from missionkit.sim.kernel_layout import gauss_markov
from missionkit.sim.random_blocks import Normals, streams
from missionkit.sim.sensors import BaroSensor, BatteryGauge, Beat, GnssSensor, MagnetometerSensor
from missionkit.sim.vehicle_parameters import (
    BaroModel,
    BatteryModel,
    GnssModel,
    ImuModel,
    MagnetometerModel,
    Sensors,
)
from missionkit.sim.world import Box, Wind, World

REST = np.array([3.0, -2.0, -5.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
GRAVITY_NED = np.array([0.0, 0.0, 9.80665])
Make = Callable[..., Any]


def test_blocks_give_one_sequence_at_any_block_size() -> None:
    whole = Normals(np.random.default_rng(3), 2, 7).take(40)
    parts = Normals(np.random.default_rng(3), 2, 11)
    cut = np.concatenate([parts.take(n) for n in (1, 5, 0, 13, 21)])
    assert np.array_equal(whole, cut)


def test_gauss_markov_is_exact_at_any_step(rng: np.random.Generator) -> None:
    for dt in (0.01, 1.0):
        keep, kick = gauss_markov(0.8, 3.0, dt)
        x = 0.8 * rng.standard_normal(4000)
        for _ in range(20):
            x = keep * x + kick * rng.standard_normal(4000)
        assert x.std() == pytest.approx(0.8, rel=0.05)


def test_gusts_have_their_variance_and_correlation_time(pilot: Make) -> None:
    flight = pilot(World(world="gusty", wind=Wind(gust=1.5, gust_tau=0.5)))
    plant = flight.vehicle._plant
    gusts = []
    for step in range(10, 40000, 10):
        plant.advance(step)
        gusts.append(plant.memory[35:38].copy())
    series = np.array(gusts)
    assert series[:, :2].std() == pytest.approx(1.5, rel=0.08)
    assert series[:, 2].std() == pytest.approx(0.75, rel=0.12)
    lagged = np.corrcoef(series[:-10, 0], series[10:, 0])[0, 1]
    assert lagged == pytest.approx(np.exp(-1.0), abs=0.08)


def test_inertial_unit_at_rest_measures_minus_gravity_bias_and_noise(pilot: Make) -> None:
    flight = pilot(World(world="rest"))
    flight.wait(40.0)
    samples = [s for seen in flight.seen for s in seen.imu]
    accel = np.array([s.accel for s in samples])
    gyro = np.array([s.gyro for s in samples])
    assert [round(s.at * 100) for s in samples[:3]] == [1, 2, 3]
    assert len(samples) == 4000
    assert accel.mean(axis=0) == pytest.approx([0.0, 0.0, -9.80665], abs=0.15)
    assert accel.std(axis=0) == pytest.approx(0.2, rel=0.1)
    assert gyro.std(axis=0) == pytest.approx(0.015, rel=0.1)
    assert np.abs(gyro.mean(axis=0)).max() > 2e-4


def test_inertial_samples_integrate_to_the_true_motion(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    flight.fly((2.0, 1.0, 0.0), 3.0, spin=0.6)
    start, first = flight.vehicle.truth, len(flight.seen)
    flight.fly((-2.0, 2.0, -0.5), 3.0, spin=-0.8)
    q, v = integrated(start, flight.seen[first:])
    truth = flight.vehicle.truth
    assert v == pytest.approx(truth.velocity, abs=0.01)
    assert abs(q @ truth.attitude) > 1 - 1e-6


def test_inertial_samples_integrate_to_the_true_motion_through_a_touch_down(
    perfect: World, pilot: Make
) -> None:
    flight = pilot(perfect)
    flight.rise(1.0)
    start, first = flight.vehicle.truth, len(flight.seen)
    flight.fly((1.0, 0.5, 0.9), 0.9, spin=0.3)
    flight.fly((-1.5, 1.5, 0.9), 0.8)  # it turns back as it touches, and leans
    q, v = integrated(start, flight.seen[first:])
    truth = flight.vehicle.truth
    rows = flight.vehicle.track.rows
    in_air = rows[rows[:, 14] == 0.0][-1]
    assert flight.vehicle._plant.on_ground
    assert np.linalg.norm(in_air[8:10]) > 0.05  # half a lean of 6 deg
    assert v == pytest.approx(truth.velocity, abs=0.03)
    assert abs(q @ truth.attitude) > 1 - 1e-6


def integrated(start: TrueState, seen: Sequence[Observation]) -> tuple[np.ndarray, np.ndarray]:
    """Return attitude and velocity after all inertial samples."""
    q, v = start.attitude, start.velocity
    for s in (s for it in seen for s in it.imu):
        middle = multiply(q, exp(0.005 * s.gyro))
        v = v + 0.01 * (rotate(middle, s.accel) + GRAVITY_NED)
        q = multiply(q, exp(0.01 * s.gyro))
    return q, v


def test_fix_errors_have_white_and_correlated_parts() -> None:
    runs = []
    for seed in range(60):
        sensor = GnssSensor(GnssModel(), np.random.default_rng(seed))
        runs.append([sensor.measure(0.2 * n, REST, np.zeros(3)) for n in range(100)])
    errors = np.array([[fix.position - REST[:3] for fix in run] for run in runs])
    steps = np.diff(errors, axis=1).std(axis=(0, 1)) / np.sqrt(2)
    assert steps == pytest.approx([0.4, 0.4, 0.7], rel=0.1)
    assert errors.mean(axis=1).std(axis=0) == pytest.approx(0.5, rel=0.3)
    velocities = np.array([[fix.velocity for fix in run] for run in runs])
    assert velocities.std() == pytest.approx(0.08, rel=0.05)
    assert runs[0][0].position_sd == pytest.approx(np.hypot([0.4, 0.4, 0.7], 0.5))


def test_fixes_come_five_times_a_second_and_a_tenth_late(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.wait(10.0)
    fixes = [(seen.now, seen.gnss.at) for seen in flight.seen if seen.gnss]
    assert len(fixes) == 49
    assert all(now - at == pytest.approx(0.1) for now, at in fixes)


def test_barometer_starts_at_the_height_and_drifts() -> None:
    first, last, steps = [], [], []
    for seed in range(80):
        sensor = BaroSensor(BaroModel(drift_tau=20.0), np.random.default_rng(seed))
        heights = [sensor.measure(0.0, REST, stuck=False).height - 5.0 for _ in range(600)]
        first.append(np.mean(heights[:10]))
        last.append(np.mean(heights[-10:]))
        steps.append(np.diff(heights).std() / np.sqrt(2))
    assert np.mean(steps) == pytest.approx(0.15, rel=0.05)
    assert np.std(first) < 0.1
    assert np.std(last) == pytest.approx(0.3, rel=0.25)


def test_magnetometer_gives_the_heading() -> None:
    sensor = MagnetometerSensor(MagnetometerModel(sd=0.0, hard_iron=0.0), np.random.default_rng(0))
    state = REST.copy()
    state[6:10] = from_euler(0.2, -0.1, 1.1)
    field = sensor.measure(1.0, state).field
    level = rotate(from_euler(0.2, -0.1, 0.0), field)
    assert np.linalg.norm(field) == pytest.approx(1.0)
    assert -np.arctan2(level[1], level[0]) == pytest.approx(1.1)


def test_scan_points_turn_back_into_the_world(perfect: World, pilot: Make) -> None:
    wall = Box(use="box", min=(8.0, -20.0), max=(9.0, 20.0), height=20.0)
    flight = pilot(perfect.model_copy(update={"obstacles": (wall,), "start_yaw_deg": 30.0}))
    flight.rise()
    flight.fly((0.0, 4.0, 0.0), 0.6)
    seen, truth = flight.seen[-1], flight.vehicle.truth
    scan = seen.scan or flight.seen[-2].scan
    while seen.scan is None:
        flight.fly((0.0, 4.0, 0.0), 0.05)
        seen, truth = flight.seen[-1], flight.vehicle.truth
        scan = seen.scan
    world = np.array([rotate(truth.attitude, p) + truth.position for p in scan.points])
    assert abs(truth.attitude[1]) > 0.02
    assert world[:, 0] == pytest.approx(8.0, abs=1e-6)
    assert world[:, 2] == pytest.approx(truth.position[2], abs=1e-6)
    first = rotate(conjugate(from_euler(0, 0, yaw_of(truth.attitude))), world[0] - truth.position)
    assert first[1] == pytest.approx(0.0, abs=1e-6)


def test_battery_counts_energy() -> None:
    gauge = BatteryGauge(BatteryModel(capacity=10.0, charge=0.9))
    reading = gauge.measure(5.0, 3600.0 * 4.0, 180.0)
    assert reading.charge == pytest.approx(0.5)
    assert 14.0 < reading.voltage < 15.0
    assert gauge.charge(1e9) == 0.0


def test_hover_takes_the_power_that_the_world_says(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    before = flight.vehicle.truth.energy
    flight.wait(10.0)
    assert flight.vehicle.truth.energy - before == pytest.approx(1800.0, rel=0.02)
    charges = [seen.battery for seen in flight.seen if seen.battery]
    assert np.diff([b.at for b in charges]) == pytest.approx(1.0)


def test_beat_keeps_its_rate_over_coarse_steps() -> None:
    beat = Beat(10.0)
    assert [step for step in range(0, 101, 10) if beat.due(step)] == [20, 40, 60, 80, 100]


def test_streams_are_independent_and_reproducible() -> None:
    first, again, other = streams(1), streams(1), streams(2)
    draws = {name: rng.random() for name, rng in first.items()}
    assert len(set(draws.values())) == len(draws)
    assert draws == {name: rng.random() for name, rng in again.items()}
    assert draws["imu"] != other["imu"].random()


def test_sensor_overrides_reach_the_vehicle(pilot: Make) -> None:
    world = World(world="quiet", sensors=Sensors(imu=ImuModel(accel_noise=0.0, accel_bias=0.0)))
    flight = pilot(world)
    flight.wait(2.0)
    accel = np.array([s.accel for seen in flight.seen for s in seen.imu])
    assert accel.std(axis=0).max() < 0.01
