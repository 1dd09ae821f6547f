"""Without numba the kernels are plain Python; the numbers must be the same."""

from __future__ import annotations

import importlib.util
import sys

import numpy as np
import pytest

from missionkit import jit
from missionkit.estimation.error_state_ekf import process_model, replay, state_layout
from missionkit.estimation.error_state_ekf.measurement_log import row
from missionkit.geometry import normalised, vec

KERNELS = (
    "linear_algebra",
    "error_state_ekf.process_model",
    "error_state_ekf.measurement_models",
    "error_state_ekf.update",
    "error_state_ekf.replay",
)


@pytest.fixture
def plain(monkeypatch):
    """Load the kernels afresh with a `compiled` that does nothing."""
    monkeypatch.setattr(jit, "compiled", lambda function: function)
    for part in KERNELS:
        name = f"missionkit.estimation.{part}"
        spec = importlib.util.find_spec(name)
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, module)
        spec.loader.exec_module(module)
    return sys.modules


def a_flight():
    """Ten intervals, one measurement of each kind, and one that is not a number."""
    rng = np.random.default_rng(5)
    x = rng.normal(size=19) * 0.1
    x[6:10] = normalised(rng.normal(size=4))
    imu = np.zeros((10, 8))
    imu[:, 0] = 0.01 * np.arange(1, 11)
    imu[:, 1:7] = rng.normal(size=(10, 6))
    imu[7, state_layout.GAP] = 0.05
    log = np.array(
        [
            row(kind, 0.008 * (kind + 1), rng.normal(size=3), np.full(3, 0.5), extra=0.5)
            for kind in range(state_layout.KINDS)
        ]
        + [row(state_layout.FIX, 0.09, vec(np.nan, 0, 0), np.full(3, 0.5))]
    )
    xs, Ps = np.array([x, x]), np.array([np.eye(18), np.eye(18)])
    return np.array([0.0, 0.1]), xs, Ps, imu, np.zeros((10, 8)), log


def test_plain_python_gives_the_same_numbers(plain):
    slow = plain["missionkit.estimation.error_state_ekf.replay"]
    assert slow is not replay
    noise, gates = np.full(7, 1e-3), np.array([0.0, 15.1, 18.4, 21.1])
    ours, theirs = a_flight(), a_flight()
    assert replay.replay(0, *ours, noise, gates)
    assert slow.replay(0, *theirs, noise, gates)
    for a, b in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12)
    assert ours[-1][-1, state_layout.OUTCOME] == state_layout.REJECTED
    assert np.all(ours[-1][:-1, state_layout.OUTCOME] == state_layout.ACCEPTED)


def test_plain_python_refuses_the_same_samples(plain):
    slow = plain["missionkit.estimation.error_state_ekf.process_model"]
    samples = np.ones((4, 7))
    samples[:, 0] = [0.01, 0.02, 0.02, 0.2]
    samples[1, 4] = np.inf
    first, second = np.zeros(7), np.zeros(7)
    np.testing.assert_array_equal(
        process_model.intervals(samples, first, 0.03), slow.intervals(samples, second, 0.03)
    )
    np.testing.assert_array_equal(first, second)
