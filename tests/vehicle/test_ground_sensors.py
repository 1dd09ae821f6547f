import math

import numpy as np
import pytest

from missionkit.vehicle.telemetry.ground_sensors import (
    GroundSensors,
    flow_rate,
    ground_range,
    integrated_flow,
    joined,
)

# 1 m/s north and 0.5 m/s east at 2 m, nose to the north, pitching up at 0.1 rad/s:
# the image moves by -v_x / d - w_y along x, and by -v_y / d along y.
FLOW = np.array((-0.5 - 0.1, -0.25))
RAD = {
    "sensor_id": 0, "integration_time_us": 50_000, "integrated_x": 0.05 * -0.25,
    "integrated_y": 0.05 * 0.6, "integrated_xgyro": 0.0, "integrated_ygyro": 0.05 * 0.1,
    "integrated_zgyro": 0.0, "quality": 204, "distance": 2.0,
}  # fmt: skip
RATE = {
    "sensor_id": 0, "flow_x": 0, "flow_y": 0, "flow_comp_m_x": 0.0, "flow_comp_m_y": 0.0,
    "quality": 204, "ground_distance": 2.0, "flow_rate_x": -0.25, "flow_rate_y": 0.6,
}  # fmt: skip
DOWN = {
    "min_distance": 20, "max_distance": 1200, "current_distance": 153, "type": 0, "id": 0,
    "orientation": 25, "covariance": 255, "signal_quality": 0,
}  # fmt: skip


def test_integrals_become_rates_of_the_image():
    flow = integrated_flow(RAD, 3.0)
    np.testing.assert_allclose(flow.flow, FLOW)
    np.testing.assert_allclose(flow.rates, (0.0, 0.1, 0.0))
    assert (flow.at, flow.over, flow.quality) == (3.0, pytest.approx(0.05), 0.8)


def test_rates_of_ardupilot_mean_the_same():
    flow = flow_rate(RATE, 3.0, 0.1)
    np.testing.assert_allclose(flow.flow, FLOW)
    assert flow.rates is None
    assert (flow.over, flow.quality) == (0.1, 0.8)


def test_a_part_that_is_not_known_leaves_the_rest():
    without = integrated_flow({**RAD, "integrated_xgyro": None}, 3.0)
    assert without.rates is None
    assert without.quality == 0.8
    blind = integrated_flow({**RAD, "integrated_x": math.nan}, 3.0)
    assert blind.quality == 0.0
    assert integrated_flow({**RAD, "integration_time_us": 0}, 3.0) is None


def test_flow_in_pixels_only_is_a_problem():
    sensors = GroundSensors()
    old = {**RATE, "flow_rate_x": 0.0, "flow_rate_y": 0.0, "flow_x": 12}
    assert sensors.flow([], [(old, 1.0), (old, 1.1)]) is None
    assert "flow_rate_x" in sensors.problems[0]


def test_flows_of_one_tick_are_joined_and_holes_left_out():
    a, b = integrated_flow(RAD, 3.0), integrated_flow({**RAD, "integrated_y": 0.0}, 3.05)
    both = joined([a, a._replace(quality=0.0, flow=np.zeros(2)), b])
    assert (both.at, both.over) == (3.05, pytest.approx(0.1))
    np.testing.assert_allclose(both.flow, (0.5 * FLOW[0], FLOW[1]))
    assert joined([a._replace(quality=0.0)]).quality == 0.0


def test_a_range_down_is_read_and_one_that_is_not_valid_is_not():
    assert ground_range(DOWN, 3.0).distance == pytest.approx(1.53)
    for change in ({"current_distance": 1201}, {"current_distance": 19}, {"signal_quality": 1}):
        assert ground_range({**DOWN, **change}, 3.0) is None
    assert ground_range({**DOWN, "signal_quality": 100}, 3.0) is not None


def test_only_sensors_that_face_down_measure_the_height():
    assert GroundSensors().range([({**DOWN, "orientation": 0}, 1.0)]) is None


def test_of_several_sensors_the_one_with_the_lowest_id_counts_while_it_works():
    sensors, other = GroundSensors(), {**DOWN, "id": 3, "current_distance": 400}
    for n in range(10):
        at = 0.1 * n
        assert sensors.range([(DOWN, at), (other, at)]).distance == pytest.approx(1.53)
    out = {**DOWN, "current_distance": 1300}
    ranges = [sensors.range([(out, 1.0 + 0.1 * n), (other, 1.0 + 0.1 * n)]) for n in range(10)]
    assert ranges[0] is None
    assert ranges[-1].distance == 4.0


def test_of_two_flow_sensors_one_counts():
    sensors = GroundSensors()
    second = {**RAD, "sensor_id": 1, "integrated_x": 0.0}
    flow = sensors.flow([(RAD, 1.0), (second, 1.0)], [(RATE, 1.0)])
    np.testing.assert_allclose(flow.flow, FLOW)
    assert flow.over == pytest.approx(0.05)
