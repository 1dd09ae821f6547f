"""The flow sensor and the range finder against the truth."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from missionkit.geometry import conjugate, from_euler, rotate, vec
from missionkit.sim.flow_sensor import FlowSensor, RangeSensor
from missionkit.sim.vehicle_parameters import FlowModel, RangeModel

PERFECT = FlowModel(sd=(0, 0), scale=0, gyro_sd=0, gyro_bias=0, lost=0)
DT = 0.05


def state(position, velocity=(0, 0, 0), angles=(0, 0, 0)):
    x = np.zeros(13)
    x[:3], x[3:6], x[6:10] = position, velocity, from_euler(*angles)
    return x


def measured(model, states, seed=0):
    sensor = FlowSensor(model, np.random.default_rng(seed))
    sensor.start(0.0, states[0])
    return [sensor.measure(n * DT, x) for n, x in enumerate(states[1:], 1)]


def test_flow_is_the_velocity_over_the_height():
    states = [state((0.02 * n, -0.04 * n, -2.0)) for n in range(3)]
    for flow in measured(PERFECT, states):
        np.testing.assert_allclose(flow.flow, [-0.4 / 2.0, 0.8 / 2.0], atol=1e-12)
        np.testing.assert_allclose(flow.rates, 0.0, atol=1e-12)
        assert flow.over == pytest.approx(DT)
        assert 0.9 < flow.quality < 1.0


def test_turns_are_seen_too_and_its_gyroscope_measures_them():
    states = [state((0, 0, -3.0), angles=(0.01 * n, 0.0, 0.0)) for n in range(3)]
    for flow in measured(PERFECT, states):
        np.testing.assert_allclose(flow.rates, [0.2, 0.0, 0.0], atol=1e-9)
        np.testing.assert_allclose(flow.flow, [0.0, 0.2], atol=1e-9)


def test_a_tilted_sensor_looks_further_and_aside():
    q = from_euler(0.3, -0.2, 0.8)
    states = [state((0.01 * n, 0.02 * n, -2.0), angles=(0.3, -0.2, 0.8)) for n in range(2)]
    (flow,) = measured(PERFECT, states)
    v = rotate(conjugate(q), vec(0.2, 0.4, 0.0))
    d = 2.0 / rotate(q, vec(0, 0, 1))[2]
    np.testing.assert_allclose(flow.flow, -v[:2] / d, rtol=1e-9)


def test_noise_scale_and_bias_are_those_of_the_model():
    states = [state((0.05 * n, 0.0, -2.0)) for n in range(3000)]
    means, biases = [], []
    for seed in range(30):
        flows = [it for it in measured(FlowModel(), states[:300], seed) if it.quality]
        means.append(np.mean([it.flow for it in flows], axis=0))
        biases.append(np.mean([it.rates for it in flows], axis=0))
    flows = [it for it in measured(FlowModel(), states) if it.quality]
    spread = np.std([it.flow for it in flows], axis=0)
    np.testing.assert_allclose(spread, [0.0388, 0.0499], rtol=0.05)
    np.testing.assert_allclose(np.multiply(spread, 2.0) ** 2, [0.006017, 0.00995], rtol=0.1)
    assert np.mean(means, axis=0)[0] == pytest.approx(-0.5, rel=0.01)
    assert np.std(means, axis=0)[0] == pytest.approx(0.005, rel=0.4)
    assert np.std(biases) == pytest.approx(0.003, rel=0.2)


def test_holes_have_their_share_and_their_length():
    model = FlowModel(lost=0.2, lost_for=0.4)
    flows = measured(model, [state((0, 0, -2.0))] * 15000)
    lost = np.array([it.quality == 0.0 for it in flows])
    assert lost.mean() == pytest.approx(0.2, rel=0.15)
    begins = sum(1 for a, b in pairwise(lost.tolist()) if b and not a)
    assert lost.sum() * DT / begins == pytest.approx(0.4, rel=0.15)
    assert all(not it.flow.any() for it in flows if it.quality == 0.0)


@pytest.mark.parametrize("height", [0.0, 0.2, 11.0])
def test_out_of_its_reach_it_sees_nothing(height):
    (flow,) = measured(PERFECT, [state((0, 0, -height))] * 2)
    assert flow.quality == 0.0
    assert np.isfinite(flow.flow).all()


def test_too_fast_and_on_its_side_it_sees_nothing():
    fast = [state((0.5 * n, 0, -1.0)) for n in range(2)]
    side = [state((0, 0, -1.0), angles=(1.5, 0, 0))] * 2
    assert measured(PERFECT, fast)[0].quality == 0.0
    assert measured(PERFECT, side)[0].quality == 0.0


def test_range_is_the_distance_along_the_axis():
    sensor = RangeSensor(RangeModel(sd=0.0), np.random.default_rng(0))
    tilted = state((5, 6, -2.0), angles=(0.3, 0.4, 1.0))
    assert sensor.measure(1.0, tilted).distance == pytest.approx(2.0 / (np.cos(0.3) * np.cos(0.4)))
    assert sensor.measure(1.0, state((0, 0, -0.1))) is None
    assert sensor.measure(1.0, state((0, 0, -20.0))) is None
    assert sensor.measure(1.0, state((0, 0, -1.0), angles=(2.0, 0, 0))) is None
    noisy = RangeSensor(RangeModel(), np.random.default_rng(1))
    readings = [noisy.measure(0.0, state((0, 0, -2.0))).distance for _ in range(2000)]
    assert np.std(readings) == pytest.approx(0.03, rel=0.1)


def test_a_vehicle_sends_both_with_every_tick_in_the_air(pilot, perfect):
    flight = pilot(perfect)
    flight.rise(2.0)
    flight.fly((1.0, 0.0, 0.0), 3.0)
    flying = flight.seen[-40:]
    assert all(seen.flow is not None and seen.range is not None for seen in flying)
    assert [seen.flow.at for seen in flying] == pytest.approx([seen.now for seen in flying])
    assert flight.seen[10].range is None
    assert flight.seen[10].flow.quality == 0.0
