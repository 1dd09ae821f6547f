"""Optical flow and range of the simulated autopilot, and a flight that lives by them."""

from __future__ import annotations

import numpy as np
import pytest
from sitl_station import EXACT, Station

from missionkit.messages import OpticalFlow
from missionkit.sitl import flow_range_messages
from missionkit.vehicle.telemetry import ground_sensors

FLOW = OpticalFlow(1.0, np.array((-0.6, -0.25)), np.array((0.01, 0.1, -0.2)), 0.05, 0.8)


@pytest.fixture
def seeing(either: Station) -> Station:
    either.run(1.2)
    either.state.sensed.flow = FLOW
    return either


def test_both_messages_of_flow_are_read_as_they_were_meant(seeing: Station) -> None:
    fields = flow_range_messages.optical_flow_rad(seeing.state).to_dict()
    read = ground_sensors.integrated_flow(fields, 1.0)
    np.testing.assert_allclose(read.flow, FLOW.flow)
    np.testing.assert_allclose(read.rates, FLOW.rates)
    fields = flow_range_messages.optical_flow(seeing.state).to_dict()
    np.testing.assert_allclose(ground_sensors.flow_rate(fields, 1.0, 0.05).flow, FLOW.flow)
    np.testing.assert_allclose(fields["flow_comp_m_x"], -0.25 - 0.01)
    np.testing.assert_allclose(fields["flow_comp_m_y"], 0.6 - 0.1)


def test_on_the_ground_the_range_is_out_of_reach(either: Station) -> None:
    either.run(1.2)
    fields = flow_range_messages.distance_sensor(either.state).to_dict()
    assert ground_sensors.faces_down(fields)
    assert ground_sensors.ground_range(fields, 1.0) is None
    assert fields["current_distance"] < fields["min_distance"]


@pytest.mark.parametrize("name", ["px4", "ardupilot"])
def test_without_satellites_it_is_armed_only_if_its_estimator_has_optical_flow(
    name: str, station: Station
) -> None:
    made = station(name, "gnss_lost", world=EXACT)
    made.run(2.0)
    assert not made.state.positioned
    parameter, value = {"px4": ("EKF2_OF_CTRL", 1), "ardupilot": ("EK3_SRC1_VELXY", 5)}[name]
    made.state.parameters.set(parameter, value)
    assert made.state.positioned
    assert not made.state.blind
