"""The visual-inertial filter with optical flow and range finder in place of satellites."""

from __future__ import annotations

import numpy as np
import pytest
from hovering import HERE, observed, through

from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf import measurement_models, state_layout
from missionkit.estimation.error_state_ekf.measurement_log import row
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.geometry import exp, from_euler, multiply
from missionkit.sim.vehicle_parameters import Sensors


def plus(x, d):
    return np.concatenate([x[:6] + d[:6], multiply(x[6:10], exp(d[6:9])), x[10:] + d[9:]])


@pytest.mark.parametrize(
    ("kind", "rows", "reach"),
    [(state_layout.FLOW, 2, 2.3), (state_layout.RANGE, 1, 0.0), (state_layout.STILL, 3, 0)],
)
def test_derivatives_of_flow_and_range(kind, rows, reach):
    rng, h = np.random.default_rng(0), 1e-6
    x = 0.3 * rng.normal(size=16)
    x[6:10], x[2] = from_euler(0.2, -0.3, 1.0), -2.0
    measured = row(kind, 0.0, (0.1, 0.2, 0.0), np.eye(3), extra=reach)
    H = np.zeros((3, 15))
    assert measurement_models.predict(x, measured, H, np.zeros(3)) == rows

    def residual(d):
        r = np.zeros(3)
        measurement_models.predict(plus(x, d), measured, np.zeros((3, 15)), r)
        return r

    numeric = [(residual(-h * e) - residual(h * e)) / (2 * h) for e in np.eye(15)]
    np.testing.assert_allclose(H, np.column_stack(numeric), atol=1e-6)


def test_it_flies_by_flow_and_without_it_is_lost():
    flight = list(observed(40.0, Sensors(), 2))
    with_flow = build(VisualInertialEkf(flow=True, fix_drift_sd=0.0, origin_sd=0.1), {}, HERE)
    known, truth = through(with_flow, flight)
    state = with_flow.read(known)
    assert state.position == pytest.approx(truth.position, abs=0.4)
    assert state.velocity == pytest.approx(truth.velocity, abs=0.15)
    assert state.health.position_sd < 0.4
    assert not state.health.diverged
    blind = build(VisualInertialEkf(fix_drift_sd=0.0, origin_sd=0.1), {}, HERE)
    known, _ = through(blind, flight)
    assert blind.read(known).health.position_sd > 2.0
